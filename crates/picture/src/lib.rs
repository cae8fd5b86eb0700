//! Pictures in linear RGB, and what making one took.
//!
//! Every way to make a picture gives a [`Rendering`]; a [`Watch`] is told how far it is.

#![warn(missing_docs)]

mod error;
mod picture;
mod rendering;

pub use error::PictureError;
pub use picture::Picture;
pub use rendering::{Phase, Rendering, Watch};
