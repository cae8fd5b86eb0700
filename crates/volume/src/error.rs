//! What can go wrong with a volume, each with place, reason and remedy.

use std::fmt;

use thiserror::Error;

use crate::SampleType;

/// A value that is NaN or infinite where a number is needed, and where it lies.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "voxel ({}, {}, {}) is {value}, not a number; mask such voxels or repair the data",
    position[0], position[1], position[2]
)]
pub struct NonFinite {
    /// The first such voxel in storage order, (x, y, z).
    pub position: [usize; 3],
    /// NaN, +∞ or −∞.
    pub value: f64,
}

/// What helps where the operating system could not do something with a file.
fn remedy_of_io(action: &str) -> &'static str {
    match action {
        "open" => "give the path of a file that is there and may be read",
        "write" => "give a path in a folder that is there and may be written to, with room for the file",
        _ => "look whether the file is whole and its drive still answers",
    }
}

/// Every failure of this crate. The message names the place, the reason and what would be right.
#[derive(Debug, Error)]
pub enum VolumeError {
    /// The operating system could not open, read or write a file.
    #[error("{file}: cannot {action}: {source}; {}", remedy_of_io(action))]
    Io {
        /// The file, as given.
        file: String,
        /// What was being done: "open", "read", "write".
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A header says something that cannot be right.
    #[error("{file}: {place}: {reason}; {remedy}")]
    Header {
        /// The file, as given.
        file: String,
        /// The line, field or key.
        place: String,
        /// What is wrong there.
        reason: String,
        /// What would be right.
        remedy: String,
    },
    /// A correct file of a kind that is not read here.
    #[error("{file}: {place}: {what} is not supported; {remedy}")]
    Unsupported {
        /// The file, as given.
        file: String,
        /// The line, field or key.
        place: String,
        /// What the file asks for.
        what: String,
        /// What to do instead.
        remedy: String,
    },
    /// Fewer bytes (or numbers, in text encodings) than the header promises.
    #[error(
        "{file}: voxel data: the header promises {promised} {unit}, the file holds {found}; \
         the file is cut short or the header's sizes are wrong"
    )]
    Truncated {
        /// The file that holds the voxels.
        file: String,
        /// How many units the header promises from where the voxel data start.
        promised: u64,
        /// How many are there.
        found: u64,
        /// "bytes" or "numbers".
        unit: &'static str,
    },
    /// A compressed file that is too short for what the header promises, however well it is compressed.
    #[error(
        "{file}: voxel data: the header promises {promised} bytes, and a compressed file of this length holds {most} at \
         most; the file is cut short or the header's sizes are wrong"
    )]
    CannotHold {
        /// The file that holds the voxels.
        file: String,
        /// How many bytes the header promises.
        promised: u64,
        /// How many can be there.
        most: u64,
    },
    /// A bare raw file whose length is not that of the layout given.
    #[error(
        "{file}: the layout ({layout}) needs {needed} bytes, the file holds {found}; \
         correct the dimensions, the type or the bytes to skip"
    )]
    RawLength {
        /// The file, as given.
        file: String,
        /// The layout in words.
        layout: String,
        /// Bytes that the layout needs, with those skipped.
        needed: u64,
        /// Bytes in the file.
        found: u64,
    },
    /// A bare raw file came without a layout.
    #[error(
        "{file}: a raw file does not say what it holds; give its dimensions and sample type (and its endian if it is not little; on the command line --dims 256x256x99 --type u8 --endian big)"
    )]
    RawLayoutMissing {
        /// The file, as given.
        file: String,
    },
    /// A compressed stream that does not decode, or whose checksum is wrong.
    #[error("{file}: voxel data: the compressed stream is damaged ({reason}); fetch the file again")]
    Inflate {
        /// The file that holds the voxels.
        file: String,
        /// The decoder's reason.
        reason: String,
    },
    /// The volume needs more memory than allowed.
    #[error(
        "{file}: {dims} voxels of {sample_type} need {needed} bytes of memory, the limit is \
         {limit}; raise the memory limit or take a smaller volume"
    )]
    TooLarge {
        /// The file, as given, or the name of what would be made.
        file: String,
        /// The dimensions, "x×y×z".
        dims: String,
        /// The type in memory.
        sample_type: SampleType,
        /// Bytes needed ("more than 2^64" where the product overflows).
        needed: String,
        /// Bytes allowed.
        limit: u64,
    },
    /// A stored number does not fit the type that it is kept in.
    #[error("{file}: voxel data: {value} at number {index} does not fit {sample_type}; {remedy}")]
    DoesNotFit {
        /// The file that holds the voxels.
        file: String,
        /// The number as text.
        value: String,
        /// Its index in storage order, from 0.
        index: u64,
        /// The type that it should have fitted.
        sample_type: SampleType,
        /// What to do.
        remedy: String,
    },
    /// The format of a file is not one of those known.
    #[error(
        "{file}: unknown volume format; known are .nrrd, .nhdr, .nii, .hdr with .img, .mhd, .mha, all of them gzipped too, \
         and .raw with a layout"
    )]
    UnknownFormat {
        /// The file, as given.
        file: String,
    },
    /// Dimensions, spacing, origin or sample count that make no grid.
    #[error("{what}: {reason}; {remedy}")]
    Grid {
        /// "dimensions", "spacing", "origin", "samples".
        what: &'static str,
        /// What is wrong.
        reason: String,
        /// What would be right.
        remedy: &'static str,
    },
    /// A parameter outside its range.
    #[error("{name}: {reason}; {remedy}")]
    Parameter {
        /// The parameter's name.
        name: &'static str,
        /// What is wrong.
        reason: String,
        /// What would be right.
        remedy: &'static str,
    },
    /// A voxel that is NaN or infinite.
    #[error(transparent)]
    NonFinite(#[from] NonFinite),
}

/// Dimensions as a person writes them: `3×4×5`.
impl VolumeError {
    /// A name that is none of a parameter's.
    pub(crate) fn unknown(parameter: &'static str, name: &str, remedy: &'static str) -> VolumeError {
        VolumeError::Parameter { name: parameter, reason: format!("'{name}' is not known"), remedy }
    }
}

pub(crate) fn show_dims(dims: &[impl fmt::Display]) -> String {
    let words: Vec<String> = dims.iter().map(|d| d.to_string()).collect();
    words.join("×")
}
