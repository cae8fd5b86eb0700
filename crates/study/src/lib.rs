//! Studies of designs: what each choice costs, and what it does to the picture.
//!
//! - [`words`]: word lengths.

#![warn(missing_docs)]

mod error;
pub mod words;

pub use error::StudyError;
