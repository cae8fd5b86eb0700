//! Why a scene, a machine or a volume cannot be had.

use cube3_machine::{MachineError, PRESETS};
use cube3_scene::SceneError;
use cube3_volume::VolumeError;
use std::path::PathBuf;

/// Why a scene, a machine or a volume cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum InputError {
    /// A scene file.
    #[error(transparent)]
    Scene(Box<SceneError>),
    /// What is in a machine file.
    #[error(transparent)]
    Machine(Box<MachineError>),
    /// A machine file that cannot be read, and no preset of that name.
    #[error("{name}: {error}; give a machine file, or one of {}", presets())]
    MachineFile {
        /// The name that was given.
        name: String,
        /// Why it cannot be read.
        error: std::io::Error,
    },
    /// A volume file, or a phantom.
    #[error(transparent)]
    Volume(Box<VolumeError>),
    /// Several volumes where one is asked for.
    #[error("{} is the first of a series of {count} volumes; give --frames N too, or a single volume", first.display())]
    Series {
        /// The first.
        first: PathBuf,
        /// How many.
        count: usize,
    },
    /// A place in a series, of a phantom.
    #[error("a phantom is no series in a file: leave --time (volume.time in the scene) out, or give a volume file")]
    TimeOfPhantom,
    /// A phase for each volume, of a phantom that does not move.
    #[error("phantom {name} does not move; leave phase_per_frame out, or take beating-heart")]
    StillPhantom {
        /// The phantom.
        name: String,
    },
    /// Values that are no labels.
    #[error("{volume}: {error}")]
    Labels {
        /// The volume.
        volume: String,
        /// Why not.
        error: Box<VolumeError>,
    },
    /// A label that has no word in those of the first volume of a series.
    #[error(
        "{volume}: labels: the largest is {largest}, and the words of the series' first volume go up to {most}; raise words.table_bits in the \
         machine file to {bits}"
    )]
    LabelsBeyond {
        /// The volume.
        volume: String,
        /// Its largest label.
        largest: f64,
        /// The largest that has a word.
        most: f64,
        /// Bits of a voxel word.
        bits: u32,
    },
    /// A voxel that is no number.
    #[error(
        "{volume}: voxel ({}, {}, {}) is {value}, not a number; repair the data, or give --mask-non-finite to make such voxels word 0",
        .position[0], .position[1], .position[2]
    )]
    NonFinite {
        /// The volume.
        volume: String,
        /// The voxel x, y, z.
        position: [usize; 3],
        /// What it is.
        value: f64,
    },
    /// Volumes of a series on two grids.
    #[error(transparent)]
    Grids(Box<TwoGrids>),
}

impl From<SceneError> for InputError {
    fn from(error: SceneError) -> InputError {
        InputError::Scene(Box::new(error))
    }
}

impl From<MachineError> for InputError {
    fn from(error: MachineError) -> InputError {
        InputError::Machine(Box::new(error))
    }
}

impl From<VolumeError> for InputError {
    fn from(error: VolumeError) -> InputError {
        InputError::Volume(Box::new(error))
    }
}

/// Volumes of a series on two grids.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "{volume} has {dims:?} voxels of {spacing:?}, and {first} has {first_dims:?} of {first_spacing:?}: the volumes of a series need one grid"
)]
pub struct TwoGrids {
    /// The volume.
    pub volume: String,
    /// Its voxels along x, y, z.
    pub dims: [usize; 3],
    /// Its voxels' sides.
    pub spacing: [f64; 3],
    /// The first volume.
    pub first: String,
    /// Its voxels along x, y, z.
    pub first_dims: [usize; 3],
    /// Its voxels' sides.
    pub first_spacing: [f64; 3],
}

fn presets() -> String {
    PRESETS.map(|(name, _)| name).join(", ")
}
