//! The table of methods: one row for each way to make a picture.
//!
//! ```text
//!   METHODS ──find──► Method ──Choice "image-order:0.25"──► render(Subject) ──► Rendering { picture, phases, samples, bytes, bound }
//! ```
//! - [`Method`]: a row: what is said of it, and how it makes a picture.
//! - [`Choice`]: a row with its options, as it stands on a command line.
//! - [`Subject`]: scene, volume and machine.
//! - [`Cache`]: pictures that are kept by what they were made of.
//!
//! A method that needs scene and volume alone is a [`SceneMethod`](cube3_rendering::SceneMethod) of its own crate; it is one line of [`METHODS`].
//! Those of the machine, with its clock and without, and of its twin in reals stand here: they need registers, which the host makes.

#![warn(missing_docs)]

mod cache;
mod choice;
mod error;
mod machine;
mod own_error;
mod subject;
mod table;
mod twin;

pub use cache::{Cache, Kept};
pub use choice::Choice;
pub use error::RenderError;
pub use own_error::{OwnError, own_error};
pub use subject::Subject;
pub use table::{
    CONVERGED, CYCLE, FUNCTION, IMAGE_ORDER, METHODS, Method, Render, RenderMachine, SHEARED, TRUE, find, names,
};
