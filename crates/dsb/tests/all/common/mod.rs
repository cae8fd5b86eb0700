//! What several tests need.

use cube3_frame::FrameSetup;
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::MachineSpec;
use cube3_scene::{Scene, View};

/// Rays along z, and a little along x, so that u is x.
pub fn setup(machine: &MachineSpec, dims: [usize; 3]) -> FrameSetup {
    let scene = Scene { view: View::from_direction([1e-6, 0.0, 1.0], None), ..Scene::default() };
    let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
    frame_setup(&scene, machine, &volume, true).unwrap().setup
}
