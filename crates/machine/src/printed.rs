//! A machine as a commented file, ready to edit.

use crate::{MachineSpec, PARAMETERS, SECTIONS};
use cube3_parameter::{Legal, Parameter, Value};
use std::fmt::Write;

/// Columns of a line.
const WIDTH: usize = 112;
/// Columns before a comment, where keys and values are no longer.
const COMMENT: usize = 26;

impl MachineSpec {
    /// The machine as a file in which every key stands with what it is and its range. Keys that are absent are commented out, with an example.
    pub fn commented(&self) -> String {
        let mut text = String::new();
        for (section, above) in SECTIONS {
            if !section.is_empty() {
                text.push('\n');
            }
            for line in wrapped(above, WIDTH - 2) {
                let _ = writeln!(text, "# {line}");
            }
            if !section.is_empty() {
                let _ = writeln!(text, "[{section}]");
            }
            for row in PARAMETERS {
                if let Some(name) = name_in(section, row.key) {
                    text += &self.commented_key(name, row);
                }
            }
        }
        text
    }

    /// A key with its value and its comment, in as many lines as the comment needs.
    fn commented_key(&self, name: &str, row: &Parameter<MachineSpec>) -> String {
        let key = match (row.get)(self) {
            Value::Absent => format!("#{name} = {}", row.example),
            value => format!("{name} = {value}"),
        };
        let mut lines = String::new();
        let mut key = format!("{:COMMENT$}", format!("{key} "));
        let column = key.chars().count();
        for line in wrapped(&self.comment(row), WIDTH - column - 2) {
            let _ = writeln!(lines, "{key}# {line}");
            key = " ".repeat(column);
        }
        lines
    }

    /// What a key is, and its range.
    fn comment(&self, row: &Parameter<MachineSpec>) -> String {
        let (about, because, legal) = (row.about, row.because, (row.legal)(self));
        let range = legal.of(row.unit);
        match legal {
            Legal::Anything => about.to_owned(),
            Legal::OneOf(names) if names.len() > 1 => format!("{about}; {range}"),
            _ if because.is_empty() => format!("{about}; {range}"),
            _ => format!("{about}; {range} ({because})"),
        }
    }
}

/// The key of a row in a table of the file; none where it is not in it.
fn name_in(section: &str, key: &'static str) -> Option<&'static str> {
    match section {
        "" => (!key.contains('.')).then_some(key),
        _ => key.strip_prefix(section)?.strip_prefix('.'),
    }
}

/// A text in lines of so many columns; a longer word has a line of its own.
fn wrapped(text: &str, columns: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= columns => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_commented_default_is_the_default() {
        let text = MachineSpec::default().commented();
        assert_eq!(MachineSpec::from_toml(&text, "default").unwrap(), MachineSpec::default());
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
    }

    #[test]
    fn with_its_options_taken_in_it_is_a_machine_that_gives_each_its_example() {
        let text = MachineSpec::default().commented();
        let taken = |line: &str| match line.strip_prefix('#') {
            Some(option) if !option.starts_with(' ') => option.to_owned(),
            _ => line.to_owned(),
        };
        let text: Vec<String> = text.lines().map(taken).collect();
        // The examples are those of a memory with bursts behind mini-blocks.
        let text =
            text.join("\n").replace("memory = \"ideal\"", "memory = \"sdram\"").replace("\"rows\"", "\"mini-blocks\"");
        let machine = MachineSpec::from_toml(&text, "options").unwrap();
        for row in PARAMETERS.iter().filter(|row| row.optional) {
            assert_ne!((row.get)(&machine), Value::Absent, "{}", row.key);
        }
        assert_eq!(MachineSpec::from_toml(&machine.commented(), "again").unwrap(), machine);
    }

    #[test]
    fn every_row_is_in_one_section_and_has_an_example_where_it_may_be_absent() {
        for row in PARAMETERS {
            assert_eq!(
                SECTIONS.iter().filter(|(section, _)| name_in(section, row.key).is_some()).count(),
                1,
                "{}",
                row.key
            );
            assert_eq!(row.example.is_empty(), !row.optional, "{}", row.key);
        }
    }
}
