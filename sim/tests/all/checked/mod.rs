//! Reports as the command writes them, each held against the JSON schema that ships with it.

#[path = "../../../../crates/report/tests/all/follows/mod.rs"]
mod follows;

use cube3_report::JSON_SCHEMA;
use serde_json::Value;
use std::path::Path;

/// The report in a folder.
pub fn report(folder: &Path) -> Value {
    let path = folder.join("report.json");
    let report = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    let faults = follows::faults(&serde_json::from_str(JSON_SCHEMA).unwrap(), &report);
    assert!(faults.is_empty(), "{}: {}", path.display(), faults.join("\n"));
    report
}
