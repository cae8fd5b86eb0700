//! `tests/golden_breaks.toml` fits the definitions as they are. Whether each break is caught is what the program `break-golden` tries.

use cube3_tests::golden_breaks::{breaks, definitions};

/// Breaks of each file at least.
const LEAST: usize = 5;

#[test]
fn every_text_to_be_replaced_is_there_once_and_changes_something() {
    let faults: Vec<String> = breaks().iter().filter_map(|of| of.text().err()).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    for of in breaks() {
        assert_ne!(of.find, of.replace, "{}", of.what);
        assert!(definitions().contains(&of.file), "{} is not a definition", of.file);
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
