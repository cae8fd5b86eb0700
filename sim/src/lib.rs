//! The `cube3` command: one file a command, no arithmetic.

#![warn(missing_docs)]

mod animation;
pub mod bench;
pub mod command;
mod output;
pub mod problem;
mod progress;
