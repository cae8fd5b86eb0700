//! Volumes of scenes.

use crate::{Machine, Outcome, Scene, Volume};
use cube3_volume::ReadOptions;

/// Reads or makes a scene's volume, and turns it into a machine's voxel words.
///
/// # Errors
/// A file that cannot be read, a phantom that is not known, voxels that are not finite.
///
/// ```
/// use cube3::{Machine, Scene, load};
/// use cube3_scene::VolumeSource;
///
/// let scene = Scene { volume: VolumeSource::from_phantom("sphere", 16), ..Scene::default() };
/// let volume = load(&scene, &Machine::default())?;
/// assert_eq!(volume.dims(), [16; 3]);
/// # Ok::<(), cube3::Error>(())
/// ```
pub fn load(scene: &Scene, machine: &Machine) -> Outcome<Volume> {
    Ok(cube3_inputs::load_volume(scene, machine, &ReadOptions::default(), false)?)
}
