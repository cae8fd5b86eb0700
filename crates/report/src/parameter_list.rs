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
            let default = match &parameter.default {
                Value::Absent => "none".to_owned(),
                value => value.to_string(),
            };
            vec![parameter.name().to_owned(), default, range(parameter), parameter.about.to_owned()]
        });
        text += &format!("{}\n", render(&["key", "default", "range", "what"], rows.collect(), &[]));
    }
    text
}

/// The range with its unit; of choices the names alone.
fn range(parameter: &Description) -> String {
    let range = match &parameter.legal {
        Legal::Anything => return String::new(),
        Legal::OneOf(values) => values.iter().map(Value::to_string).collect::<Vec<_>>().join(", "),
        legal => legal.to_string(),
    };
    format!("{range} {}", parameter.unit).trim_end().to_owned()
}

/// Names, each with what stands behind it, in two columns of a terminal of 80.
pub fn name_list(names: &[(&str, String)]) -> String {
    let rows = names.iter().map(|(name, about)| vec![(*name).to_owned(), about.clone()]);
    format!("{}\n", render(&[], rows.collect(), &[]))
}
