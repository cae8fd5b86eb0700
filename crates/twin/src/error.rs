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
    /// A perspective view, for a caster of parallel rays.
    #[error("view.perspective: the casters on the base plane have parallel rays; leave it out, or take image-order")]
    Perspective,
}
