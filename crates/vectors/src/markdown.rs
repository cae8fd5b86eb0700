//! Sheets as sections of the book.

use crate::expression::ExpressionError;
use crate::{Port, Sheet, UnitFormat, bits_of};
use std::fmt::Write;

impl Sheet {
    /// The sheet as a section of a page, with widths and ranges also as numbers in a format.
    ///
    /// # Errors
    /// An expression of the sheet without a value.
    pub fn markdown(&self, format: &UnitFormat) -> Result<String, ExpressionError> {
        section(self, format)
    }
}

/// An expression as it is printed.
fn shown(expression: &str) -> String {
    expression.replace('*', "·").replace('-', "−").replace("(M)", "M")
}

/// An expression with its value, where that is not the same text.
fn with_value(expression: &str, format: &UnitFormat) -> Result<String, ExpressionError> {
    let value = format.evaluate(expression)?;
    let number = value.to_string();
    if number == expression {
        Ok(number)
    } else {
        Ok(format!("{} = {}", shown(expression), number.replace('-', "−")))
    }
}

fn ports(text: &mut String, direction: &str, ports: &[Port], format: &UnitFormat) -> Result<(), ExpressionError> {
    for port in ports {
        let count = if port.count == "1" { String::new() } else { format!("[{}]", shown(port.count)) };
        let sign = if port.signed { "signed" } else { "unsigned" };
        let range = port.range.map_or(String::new(), |[low, high]| format!("; {} to {}", shown(low), shown(high)));
        let _ = writeln!(
            text,
            "| {direction} | `{}{count}` | {} | {sign} | {}{range} |",
            port.name,
            with_value(port.bits, format)?,
            port.meaning
        );
    }
    Ok(())
}

/// The parameters of the RTL module with their values.
fn parameters(sheet: &Sheet, format: &UnitFormat) -> String {
    let (_, further) = sheet.rtl();
    let set = format.settings().into_iter().filter(|(name, _)| sheet.parameters.contains(name));
    let mut all: Vec<String> = set.map(|(name, value)| format!("`{}` = {value}", name.to_uppercase())).collect();
    all.extend(
        further
            .split(", ")
            .filter(|further| !further.is_empty())
            .map(|further| format!("`{}`", further.trim_start_matches('.').replace('(', " = ").replace(')', ""))),
    );
    all.extend(sheet.tables.iter().map(|table| format!("`{}_FILE`, a file of that table", table.name.to_uppercase())));
    if all.is_empty() { "none".into() } else { all.join(", ") }
}

/// A sheet with the numbers of a format.
fn section(sheet: &Sheet, format: &UnitFormat) -> Result<String, ExpressionError> {
    let mut text = String::new();
    let (module, _) = sheet.rtl();
    let _ = writeln!(text, "## {}\n\n{}\n", sheet.title, sheet.purpose);
    let _ = writeln!(text, "Vectors: `{}`. RTL: `tests/rtl/{module}.sv`. Source: {}.\n", sheet.name, sheet.source);
    let _ = writeln!(text, "Parameters: {}.\n", parameters(sheet, format));
    let _ = writeln!(text, "| | port | bits | | meaning |\n| --- | --- | --- | --- | --- |");
    ports(&mut text, "in", &sheet.inputs, format)?;
    ports(&mut text, "out", &sheet.outputs, format)?;
    if !sheet.tables.is_empty() {
        let _ = writeln!(text, "\n| table | entries | bits | holds |\n| --- | --- | --- | --- |");
        for table in &sheet.tables {
            let (entries, bits) = (with_value(table.entries, format)?, with_value(table.bits, format)?);
            let _ = writeln!(text, "| `{}` | {entries} | {bits} | {} |", table.name, table.meaning);
        }
    }
    if !sheet.wires.is_empty() {
        let _ = writeln!(text, "\n| wire | is | from | to | bits |\n| --- | --- | --- | --- | --- |");
        for wire in &sheet.wires {
            let count = if wire.count == "1" { String::new() } else { format!("[{}]", shown(wire.count)) };
            let ends = [format.evaluate(wire.range[0])?, format.evaluate(wire.range[1])?];
            let loose = if wire.tight { "" } else { " (bound)" };
            let _ = writeln!(
                text,
                "| `{}{count}` | {} | {} | {} | {}{loose} |",
                wire.path(),
                wire.formula,
                shown(wire.range[0]),
                shown(wire.range[1]),
                bits_of(ends)
            );
        }
    }
    Ok(text)
}
