//! `cube3 stress`: lines, files, exit codes.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn cube3(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cube3")).current_dir(folder).args(arguments).output().unwrap()
}

#[test]
fn every_case_of_a_group_has_a_line_and_every_method_a_row() {
    let folder = tempfile::tempdir().unwrap();
    let output = cube3(folder.path(), &["stress", "--only", "volumes", "--out", "out"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text.lines().filter(|line| line.contains("volumes: ")).count(), 3, "{text}");
    let file: Value = serde_json::from_slice(&std::fs::read(folder.path().join("out/stress.json")).unwrap()).unwrap();
    assert_eq!(file["schema"], 1);
    let rows = file["rows"].as_array().unwrap();
    let methods: Vec<&str> = rows.iter().map(|row| row["method"].as_str().unwrap()).collect();
    for method in cube3_method::METHODS {
        assert_eq!(methods.iter().filter(|name| **name == method.about.name).count(), 3, "{}", method.about.name);
    }
    for row in rows {
        assert!(row["error"].as_f64().unwrap() <= row["bound"].as_f64().unwrap(), "{row}");
        assert_eq!([&row["kept"], &row["finite"], &row["in_range"]], [&Value::Bool(true); 3]);
    }
    let csv = std::fs::read_to_string(folder.path().join("out/stress.csv")).unwrap();
    assert_eq!(csv.lines().count(), rows.len() + 1);
}

/// The classic formulas fail, are told so, and count for nothing; those that are used hold.
#[test]
fn classic_formulas_fail_beside_those_that_are_used() {
    let folder = tempfile::tempdir().unwrap();
    let output = cube3(folder.path(), &["stress", "--only", "formulas", "--each"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text.matches("fails, as is known").count(), 10, "{text}");
    assert_eq!(text.lines().filter(|line| line.contains(" holds")).count(), 16, "{text}");
    assert!(folder.path().join("out/stress/stress.json").exists());
}

#[test]
fn a_text_that_no_case_has_and_a_method_that_is_none_are_told() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, part) in [
        (["stress", "--only", "sauce"], "no case has this text; groups are clips, fields, formulas,"),
        (["stress", "--methods", "convergd"], "did you mean converged?"),
        (["stress", "--threads", "0"], "--threads 0: give 1 to"),
    ] {
        let output = cube3(folder.path(), &arguments);
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && told.contains(part), "{told}");
        assert!(!folder.path().join("out").exists());
    }
}
