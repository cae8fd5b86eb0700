//! Lists of parameters for a terminal.

use crate::table::render;
use cube3_parameter::{Description, Legal, Value};

/// The parameters of a kind of file, a table for each table of the file. No line is wider than 80 columns, and the text ends in a newline.
pub fn parameter_list(parameters: &[Description]) -> String {
    let mut text = String::new();
    for part in parameters.chunk_by(|a, b| a.section() == b.section()) {
        let section = part.first().map_or("", Description::section);
        if !section.is_empty() {
            let table = match section.strip_suffix("[]") {
                Some(list) => format!("[[{list}]]"),
                None => format!("[{section}]"),
            };
            text += &format!("\n{table}\n");
        }
        let rows = part.iter().map(|parameter| {
            vec![parameter.name().to_owned(), default(&parameter.default), range(parameter), parameter.about.to_owned()]
        });
        text += &format!("{}\n", render(&["key", "default", "range", "what"], rows.collect(), &[]));
    }
    text
}

/// The default; of what is absent, in every element of a list too, `none`.
fn default(value: &Value) -> String {
    match value {
        Value::Absent => "none".to_owned(),
        Value::List(values) if values.iter().all(|value| *value == Value::Absent) => "none".to_owned(),
        value => value.to_string(),
    }
}

/// The range with its unit; of choices the names alone.
fn range(parameter: &Description) -> String {
    match &parameter.legal {
        Legal::Anything => String::new(),
        Legal::OneOf(values) if values.len() > 1 => values.iter().map(Value::to_string).collect::<Vec<_>>().join(", "),
        legal => legal.of(parameter.unit),
    }
}

/// Names, each with what stands behind it, in two columns of a terminal of 80.
pub fn name_list(names: &[(&str, String)]) -> String {
    let rows = names.iter().map(|(name, about)| vec![(*name).to_owned(), about.clone()]);
    format!("{}\n", render(&[], rows.collect(), &[]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_parameter::ValueKind;

    fn parameter(key: &'static str, legal: Legal, default: Value) -> Description {
        let (unit, about) =
            ("metres", "how high it is above the sea, or above the street, or above the floor that it is on");
        Description {
            key,
            kind: ValueKind::Real,
            unit,
            legal,
            because: "",
            default,
            optional: true,
            about,
            source: "ours",
        }
    }

    #[test]
    fn a_list_has_a_table_for_each_table_of_the_file_and_fits_the_terminal() {
        let names = Legal::names(["low", "high"]);
        let list = parameter_list(&[
            parameter("height", Legal::real(0.0, 4.5), Value::Real(2.0)),
            parameter("lamp.height", names, Value::Text("low".into())),
            parameter("lamp.depth", Legal::Anything, Value::Absent),
            parameter("row[].height", Legal::finite(), Value::List(vec![Value::Absent])),
        ]);
        assert!(list.lines().all(|line| line.chars().count() <= 80) && list.ends_with('\n'), "{list}");
        let starts: Vec<Vec<&str>> = list
            .lines()
            .map(|line| line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).take(3).collect())
            .collect();
        for expected in [
            vec!["height", "2.0", "0 to 4.5 metres"],
            vec!["[lamp]"],
            vec!["height", "\"low\"", "\"low\", \"high\""],
            vec!["[[row]]"],
            vec!["height", "none", "a finite number of metres"],
        ] {
            assert!(starts.contains(&expected), "{expected:?} in {list}");
        }
    }
}
