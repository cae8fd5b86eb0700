//! What is kept in the repository is what the program makes: the pages of the book, the reference vectors and their test benches.

use cube3_vectors::{UnitFormat, Vectors, pages, testbench, units};
use std::path::Path;

fn kept(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn assert_kept(path: &str, made: &str, remedy: &str) {
    let kept = kept(path);
    let line = kept.lines().zip(made.lines()).position(|(kept, made)| kept != made);
    assert!(kept == made, "{path} is not what the program makes (line {line:?}, from 0): {remedy}");
}

#[test]
fn the_data_sheets_of_the_book_are_those_of_the_code() {
    for page in pages::pages().unwrap() {
        let path = format!("docs/src/{}", page.file);
        assert_kept(&path, &page.text, "cube3 vectors --pages docs/src");
    }
}

#[test]
fn every_unit_is_on_one_page() {
    let pages = pages::pages().unwrap();
    for unit in units() {
        let name = format!("\nVectors: `{}`.", unit.sheet().name);
        assert_eq!(pages.iter().filter(|page| page.text.contains(&name)).count(), 1, "{name}");
    }
}

#[test]
fn the_reference_vectors_regenerate_to_the_same_bytes() {
    let remedy = "cube3 vectors --reference --out traces/vectors; say in the changelog why bits changed";
    for unit in units() {
        let vectors = Vectors::directed(unit.as_ref(), UnitFormat::reference(), 7).unwrap();
        let name = vectors.set.sheet.name;
        assert_kept(&format!("traces/vectors/{name}.hex"), &vectors.text(), remedy);
        for (table, text) in vectors.table_texts() {
            assert_kept(&format!("traces/vectors/{name}.{table}.hex"), &text, remedy);
        }
    }
}

#[test]
fn the_test_benches_are_those_of_the_data_sheets() {
    for unit in units() {
        let sheet = unit.sheet();
        let text = testbench::text(&sheet, &UnitFormat::reference()).unwrap();
        let path = format!("tests/rtl/tb/{}.sv", testbench::name(&sheet));
        assert_kept(&path, &text, "cube3 vectors --reference --testbench --out DIR, and move the benches there");
    }
}
