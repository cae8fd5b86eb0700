//! Scene, machine and volume of a run: files, presets and phantoms, and voxels as a machine's words.
//!
//! ```text
//!   file or phantom ──read_volume──► Incoming ──to_words──► LoadedVolume: data in its own values, and as voxel words
//!   several, or one that moves ──Series──► volume by volume
//! ```

#![warn(missing_docs)]

mod error;
mod files;
mod notes;
mod series;
mod volume;

pub use error::{InputError, TwoGrids};
pub use files::{machine, scene};
pub use series::{KEPT_VOLUMES, Series};
pub use volume::{Incoming, LoadedVolume, labels_to_words, load_volume, read_options, read_volume, to_words};
