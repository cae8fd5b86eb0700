//! `report.json`.

use std::io::Write;

use serde_json::Value;

use crate::{ReportError, RunReport, SCHEMA};

/// The report as indented JSON with a newline at the end. Equal reports give equal bytes.
///
/// # Errors
///
/// [`ReportError::NotFinite`] when a number is NaN or infinite: JSON would silently say `null`.
pub fn to_json(report: &RunReport) -> Result<String, ReportError> {
    report.check_finite()?;
    let mut text = serde_json::to_string_pretty(report)?;
    text.push('\n');
    Ok(text)
}

/// Writes [`to_json`] to `out`. Nothing is written when the report is refused.
///
/// # Errors
///
/// As [`to_json`], and [`ReportError::Io`] when `out` fails.
pub fn write_json(report: &RunReport, out: &mut impl Write) -> Result<(), ReportError> {
    out.write_all(to_json(report)?.as_bytes())?;
    Ok(())
}

/// Reads what [`to_json`] wrote. Keys that this version does not know are passed over.
///
/// # Errors
///
/// [`ReportError::Schema`] for a report of another layout, [`ReportError::Json`] for anything else.
pub fn from_json(text: &str) -> Result<RunReport, ReportError> {
    let value: Value = serde_json::from_str(text)?;
    if let Some(found) = value.get("schema").and_then(Value::as_u64)
        && found != u64::from(SCHEMA)
    {
        return Err(ReportError::Schema { found, expected: SCHEMA });
    }
    Ok(serde_json::from_value(value)?)
}
