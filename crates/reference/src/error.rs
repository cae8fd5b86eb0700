//! Why there is no picture.

use cube3_scene::SceneError;
use cube3_volume::NonFinite;

/// Why the ray caster refused its input; each message has place, reason and what would be right.
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
