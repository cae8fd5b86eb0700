//! A frame of a cube against a bus that takes every beam, by the axes of beam and depth.

use cube3_cfb::memory::{MemoryCounters, Supply};
use cube3_cfb::{Beam, CfbSpec, CfbUnit, NoVoxels};
use cube3_channel::Channel;
use cube3_frame::Schedule;
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::MachineSpec;
use cube3_scene::{Scene, View};
use std::sync::Arc;

/// The axes, and a direction that has them.
pub const VIEWS: [(&str, [f64; 3]); 6] = [
    ("x, y", [0.3, 1.0, 0.1]),
    ("x, z", [0.3, 0.1, 1.0]),
    ("y, x", [1.0, 0.3, 0.1]),
    ("y, z", [0.1, 0.3, 1.0]),
    ("z, x", [1.0, 0.1, 0.3]),
    ("z, y", [0.1, 1.0, 0.3]),
];

/// Cycles of a frame with as many voxels a side as lanes, and what the modules did.
///
/// # Errors
/// A frame that cannot be set up, a reorder buffer that is too small.
pub fn run(machine: &MachineSpec, direction: [f64; 3]) -> Result<(u64, MemoryCounters), Box<dyn std::error::Error>> {
    let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
    let volume = VolumeInfo { dims: [machine.lanes; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let setups = [Arc::new(frame_setup(&scene, machine, &volume, true)?.setup)];
    let spec = CfbSpec::new(machine, &setups[0].geometry, Schedule::new(machine, &setups[0].geometry));
    let mut cfb = CfbUnit::new(vec![spec], NoVoxels).with_modules(Supply::new(machine, &setups)?);
    let mut beams = Channel::<Beam<()>>::new("beams", 4, 2)?;
    let mut cycles = 0;
    while !cfb.done() {
        beams.pop_slot();
        cfb.tick(&setups, 1, &mut beams);
        beams.commit();
        cycles += 1;
    }
    Ok((cycles, cfb.memory_counters().first().copied().unwrap_or_default()))
}
