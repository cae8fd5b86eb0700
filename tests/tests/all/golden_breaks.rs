//! `tests/golden_breaks.toml` and `tests/measurement_breaks.toml` fit the code as it is. Whether each break is caught is what the program
//! `break-golden` tries.

use cube3_tests::golden_breaks::{Changes, breaks, definitions, measurement_breaks, one_each, root};
use std::collections::BTreeSet;

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
            assert!(
                root().join(format!("tests/tests/all/{test}.rs")).is_file(),
                "{}: there is no test {test}",
                of.what
            );
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

#[test]
fn one_break_of_each_is_one_for_every_definition() {
    let files: Vec<String> = one_each(&breaks()).into_iter().map(|of| of.file).collect();
    assert_eq!(files.len(), definitions().len());
    assert!(definitions().iter().all(|file| files.contains(file)), "{files:?}");
}

#[test]
fn a_break_is_tried_again_where_its_file_has_changed_or_it_is_new() {
    let all = breaks();
    let [old, new] = [&all[0], &all[1]];
    let other = all.iter().find(|of| of.file != old.file).unwrap();
    let unchanged = Changes { files: BTreeSet::from(["README.md".into()]), listed: vec![old.clone(), other.clone()] };
    assert!(!unchanged.touch(old) && unchanged.touch(new));
    let changed = Changes { files: BTreeSet::from([other.file.clone()]), ..unchanged };
    assert!(changed.touch(other) && !changed.touch(old));
}
