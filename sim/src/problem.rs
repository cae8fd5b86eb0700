//! What a person is told when something cannot be done: one message, with place, reason and remedy.

use std::error::Error;
use std::fmt;

/// A problem in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    message: String,
    /// What the command ends with.
    code: u8,
}

/// What a command ends with that cannot do what it was asked.
const CANNOT: u8 = 2;

/// What a command ends with that has done it, and found something wrong.
const FOUND: u8 = 1;

impl Problem {
    /// A problem from its message.
    pub fn new(message: impl Into<String>) -> Problem {
        Problem { message: message.into(), code: CANNOT }
    }

    /// What a command was to look for and has found.
    pub fn found(message: impl Into<String>) -> Problem {
        Problem { message: message.into(), code: FOUND }
    }

    /// The command's exit code: 2 where it cannot do what it was asked, 1 where it has found what it was to look for.
    pub fn code(&self) -> u8 {
        self.code
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl<E: Error> From<E> for Problem {
    fn from(error: E) -> Problem {
        Problem::new(error.to_string())
    }
}

/// Something, or a problem in words.
pub type Outcome<T> = Result<T, Problem>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_found_and_what_cannot_be_done_end_otherwise() {
        let codes = [Problem::found("beyond its bound").code(), Problem::new("no file").code()];
        assert_eq!(codes, [1, 2]);
        assert_eq!(Problem::from(std::fmt::Error).code(), 2);
    }
}
