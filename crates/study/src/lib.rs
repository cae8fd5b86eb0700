//! Studies of designs: what each choice costs, and what it does to the picture.
//!
//! - [`stress`]: the stiff and the extreme.
//! - [`words`]: word lengths.

#![warn(missing_docs)]

mod error;
pub mod stress;
pub mod words;

pub use error::StudyError;
