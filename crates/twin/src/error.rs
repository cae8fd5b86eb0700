//! Why there is no picture.

use cube3_scene::SceneError;

/// Why a caster on the base plane refused its input; each message has place, reason and what would be right.
#[derive(Debug, thiserror::Error)]
pub enum TwinError {
    /// The scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A volume or a border that the reference refuses too.
    #[error(transparent)]
    Input(#[from] cube3_reference::RaycastError),
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
    /// The geometry of a perspective pass for a parallel view, or the other way round.
    #[error(
        "geometry: its rays are {}, the scene's are {}; set the frame up for this scene",
        rays(*.geometry),
        rays(!*.geometry)
    )]
    Rays {
        /// Whether the geometry's rays are those of an eye.
        geometry: bool,
    },
    /// An estimator of parallel rays, in perspective.
    #[error(
        "gradient: estimator {name} needs parallel rays, and in perspective each ray has its own direction; take 6, 12, 26, 6d or 26d"
    )]
    Estimator {
        /// Its name.
        name: &'static str,
    },
}

/// Rays in words.
fn rays(from_eye: bool) -> &'static str {
    if from_eye { "those of an eye" } else { "parallel" }
}
