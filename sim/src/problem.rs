//! What a person is told when something cannot be done: one message, with place, reason and remedy.

use std::error::Error;
use std::fmt;

/// A problem in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem(String);

impl Problem {
    /// A problem from its message.
    pub fn new(message: impl Into<String>) -> Problem {
        Problem(message.into())
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl<E: Error> From<E> for Problem {
    fn from(error: E) -> Problem {
        Problem(error.to_string())
    }
}

/// Something, or a problem in words.
pub type Outcome<T> = Result<T, Problem>;
