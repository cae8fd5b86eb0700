//! What a way to make a picture is: its name and source, its options, what of a scene it can show.
//!
//! ```text
//!   SceneMethod { about: About { name, source, supports, options }, render } ──row──► the table of methods (crate `method`)
//!   scene ──Feature::needed_by──► About::lacks ──► render(SceneSubject, Settings) ──► Rendering
//! ```
//! A method that needs scene and volume alone is a [`SceneMethod`] of its own crate, and one line of the table.

#![warn(missing_docs)]

mod about;
mod error;
mod feature;
mod options;

pub use about::{About, RenderScene, RenderSparse, SceneMethod, SceneSubject, Sparse};
pub use error::MethodError;
pub use feature::Feature;
pub use options::{MethodOption, OptionKind, Settings};
