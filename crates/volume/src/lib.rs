//! Voxel grids: file formats, phantoms, conversion to voxel words.
//!
//! A [`Volume`] is a grid of samples of one of eight numeric types, x fastest, then y, then z, with
//! a spacing and an origin. It comes from a file ([`read`]), from a formula ([`Phantom`]), or from
//! [`Volume::new`]. The machine stores unsigned words of 1 to 16 bits ([`VoxelWords`]); the way
//! there is [`Volume::to_words`], which says what it rounded and clipped.
//!
//! ```text
//!   file ──► read ──► Volume ──► to_words ──► VoxelWords ──► cubic frame buffer
//!   Phantom::generate ──┘  └──► write ──► file          resample: Volume ──► Volume on another grid
//! ```
//!
//! Files are read under three rules: no header is believed before it is checked against the bytes
//! that are really there, no memory is taken beyond [`ReadOptions::memory_limit_bytes`], and no
//! bytes whatever make a reader panic.

mod blocks;
mod described;
mod error;
mod file_info;
mod files;
mod format;
mod layout;
mod limits;
mod metaimage;
mod nifti;
mod nrrd;
mod nrrd_axes;
mod nrrd_header;
mod open;
mod parts;
mod phantom;
mod place;
mod raw;
mod raw_layout;
mod readable;
mod resample;
mod sample_type;
mod samples;
mod source;
mod statistics;
mod stream;
mod text;
mod thickness;
mod volume;
mod words;
mod world;
mod write;

pub use error::{NonFinite, VolumeError};
pub use file_info::FileInfo;
pub use format::FileFormat;
pub use limits::{Memory, MemoryBound, ReadOptions, available_memory, memory_bounds};
pub use open::{inspect, read, read_bytes};
pub use phantom::{Phantom, PhantomParams};
pub use raw_layout::{Endian, RawLayout};
pub use readable::readable;
pub use resample::{Filter, NewGrid, ResampleReport, Resampling, resample, resample_bytes};
pub use sample_type::SampleType;
pub use samples::{Sample, Samples};
pub use statistics::Histogram;
pub use thickness::thick_dims;
pub use volume::Volume;
pub use words::{ConversionReport, NonFiniteRule, VoxelWords, WordConversion, WordRounding};
pub use world::{AxisOrder, LeftOver, Ordering, Space, World};
pub use write::{Packing, check_name, write, write_packed, write_raw};
