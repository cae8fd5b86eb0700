//! What is wrong with a machine.

use crate::relations::Conflict;
use cube3_parameter::{Fault, Unread};

/// What is wrong with a machine, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MachineError {
    /// Not TOML, a key or a name that is not known, a value of another kind.
    #[error("{place}: {unread}")]
    Syntax {
        /// File and line.
        place: String,
        /// Key, reason and remedy.
        unread: Unread,
    },
    /// A value out of its range.
    #[error("{place}: {fault}")]
    Value {
        /// File, and line where the key stands in it.
        place: String,
        /// Key, value, range and the nearest legal value.
        fault: Box<Fault>,
    },
    /// Values that do not go together.
    #[error("{place}: {conflict}")]
    Conflict {
        /// File, and line where the key stands in it.
        place: String,
        /// Key, value, reason and remedy.
        conflict: Conflict,
    },
}

impl MachineError {
    /// The key at fault; empty where none is.
    pub fn key(&self) -> &str {
        match self {
            MachineError::Syntax { unread, .. } => &unread.key,
            MachineError::Value { fault, .. } => &fault.key,
            MachineError::Conflict { conflict, .. } => conflict.key,
        }
    }
}
