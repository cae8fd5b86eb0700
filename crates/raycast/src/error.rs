//! Why there is no picture.

use cube3_scene::SceneError;
use cube3_volume::NonFinite;

/// Why a ray caster refused its input; each message has place, reason and what would be right.
#[derive(Debug, thiserror::Error)]
pub enum RaycastError {
    /// The scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A voxel that is NaN or infinite.
    #[error("volume: {0}")]
    NonFinite(#[from] NonFinite),
    /// A volume whose parts do not fit together, or whose values cannot be subtracted.
    #[error("volume: {reason}; {right}")]
    Volume {
        /// What is wrong.
        reason: String,
        /// What would be right.
        right: &'static str,
    },
    /// A geometry of another volume.
    #[error(
        "geometry: made for {made:?} voxels along u, v, w, the volume has {volume:?}; set the frame up for this volume"
    )]
    Geometry {
        /// The geometry's size.
        made: [usize; 3],
        /// The volume's, in the geometry's axes.
        volume: [usize; 3],
    },
    /// A perspective view, for a caster of parallel rays.
    #[error("view.perspective: the casters on the base plane have parallel rays; leave it out, or take image-order")]
    Perspective,
    /// An option out of range.
    #[error("{name}: {value} is {reason}; {right}")]
    Option {
        /// The option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is wrong.
        reason: &'static str,
        /// What would be right.
        right: &'static str,
    },
}
