//! The TOML reader's and serde's messages, in the words of a file's author.

use crate::locate::{key_at, line_at};
use crate::nearest_name;
use std::fmt;
use toml::de::DeTable;

/// Why a text could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unread {
    /// The line, from 1; none where the reader names no place.
    pub line: Option<usize>,
    /// The path of the key at fault; empty where no key is concerned.
    pub key: String,
    /// What is wrong.
    pub reason: String,
    /// What would be right, as an instruction.
    pub right: String,
}

impl Unread {
    /// What the reader's error means, in a text of which so much of a document could be read.
    pub fn new(error: &toml::de::Error, text: &str, document: &DeTable) -> Unread {
        let start = error.span().map(|span| span.start);
        let (reason, right) = explain(error.message());
        Unread {
            line: start.map(|start| line_at(text, start)),
            key: start.map_or_else(String::new, |start| key_at(document, start)),
            reason,
            right,
        }
    }
}

impl fmt::Display for Unread {
    /// Key, reason and remedy.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Unread { key, reason, right, .. } = self;
        let colon = if key.is_empty() { "" } else { ": " };
        write!(f, "{key}{colon}{reason}; {right}")
    }
}

/// The reason and what would be right, from one message of the TOML reader.
fn explain(message: &str) -> (String, String) {
    let message = message.trim().replace('\n', " ");
    let (what, expected) = match message.split_once(", expected ") {
        Some((what, expected)) => (what, Some(expected)),
        None => (message.split(", there are no").next().unwrap_or_default(), None),
    };
    if let Some(key) = what.strip_prefix("unknown field ") {
        return (format!("there is no key {key}"), suggest(key, "keys here", expected));
    }
    if let Some(name) = what.strip_prefix("unknown variant ") {
        return (format!("{name} is not known"), suggest(name, "choices", expected));
    }
    if let Some(key) = what.strip_prefix("missing field ") {
        return (format!("the key {key} is missing"), format!("give {key}"));
    }
    if let Some((reason, right)) = what.split_once("; ") {
        return (reason.to_owned(), right.to_owned());
    }
    let right = match expected {
        Some(expected) => format!("give {}", in_plain_words(expected)),
        None => "correct the TOML".to_owned(),
    };
    (what.to_owned(), right)
}

/// The name nearest to `unknown` of those that serde lists, each between backticks, and all of them.
fn suggest(unknown: &str, kind: &str, listed: Option<&str>) -> String {
    let Some(listed) = listed else {
        return "leave it out".to_owned();
    };
    let known: Vec<&str> = listed.split('`').skip(1).step_by(2).collect();
    let all = known.join(", ");
    match nearest_name(unknown.trim_matches('`'), known) {
        Some(name) => format!("did you mean `{name}`? The {kind} are {all}"),
        None => format!("the {kind} are {all}"),
    }
}

/// What serde expects, for one who does not know Rust's types.
fn in_plain_words(expected: &str) -> &str {
    match expected {
        "f64" => "a number",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number from 0 up",
        "a boolean" => "true or false",
        "a string" | "path string" => "text in quotes",
        "an array of length 2" => "a list of 2 numbers",
        "an array of length 3" => "a list of 3 numbers",
        "a sequence" => "a list",
        _ if expected.starts_with("struct ") => "a table of keys",
        _ => expected,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_near_name_is_offered_and_a_far_one_is_not() {
        let (reason, right) = explain("unknown field `tilt`, expected `yaw_deg` or `tilt_deg`");
        assert_eq!(reason, "there is no key `tilt`");
        assert_eq!(right, "did you mean `tilt_deg`? The keys here are yaw_deg, tilt_deg");
        let (_, right) = explain("unknown field `zoom`, expected `yaw_deg` or `tilt_deg`");
        assert_eq!(right, "the keys here are yaw_deg, tilt_deg");
    }

    #[test]
    fn types_are_in_plain_words() {
        let (reason, right) = explain("invalid type: string \"x\", expected f64\n");
        assert_eq!(reason, "invalid type: string \"x\"");
        assert_eq!(right, "give a number");
    }
}
