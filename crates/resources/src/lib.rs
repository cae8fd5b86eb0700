//! What a machine is made of, counted from its configuration, and what flows through its interfaces in a run.

#![warn(missing_docs)]

mod overlap;
mod resources;

pub use overlap::Overlap;
pub use resources::{FRAME_BUFFER, memory, operators, resources};
