//! `tests/golden_breaks.toml` and `tests/measurement_breaks.toml` fit the code as it is. Whether each break is caught is what the program
//! `break-golden` tries.

use cube3_tests::golden_breaks::{breaks, definitions, measurement_breaks, root};

/// Breaks of each file at least.
const LEAST: usize = 5;

#[test]
fn every_text_to_be_replaced_is_there_once_and_changes_something() {
    let all = [breaks(), measurement_breaks()].concat();
    let faults: Vec<String> = all.iter().filter_map(|of| of.text().err()).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    for of in all {
        assert_ne!(of.find, of.replace, "{}", of.what);
    }
    for of in breaks() {
        assert!(definitions().contains(&of.file), "{} is not a definition", of.file);
        assert_eq!(of.test, None, "{}: a definition is held by the tests of its crate", of.what);
    }
    for of in measurement_breaks() {
        assert!(!definitions().contains(&of.file), "{} is a definition", of.file);
        if let Some(test) = of.test {
            assert!(root().join(format!("tests/tests/{test}.rs")).is_file(), "{}: there is no test {test}", of.what);
        }
    }
}

#[test]
fn every_definition_is_broken_in_five_ways_at_least() {
    let breaks = breaks();
    for file in definitions() {
        let count = breaks.iter().filter(|of| of.file == file).count();
        assert!(count >= LEAST, "{file} has {count} breaks in golden_breaks.toml");
    }
}
