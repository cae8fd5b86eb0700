//! What is recorded of what.

use cube3_frame::FrameSetup;
use cube3_machine::MachineSpec;
use std::sync::Arc;

/// A run: a machine, the frames that it renders one after another, and a volume of voxel words, x fastest.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// The machine.
    pub machine: &'a MachineSpec,
    /// The registers of its frames.
    pub frames: &'a [Arc<FrameSetup>],
    /// Voxels along x, y, z.
    pub dims: [usize; 3],
    /// Voxel words.
    pub voxels: &'a [u16],
}

/// Which part of the traffic.
#[derive(Clone, Copy, Debug)]
pub struct Excerpt<'a> {
    /// The frame, from 0; of a picture in perspective, its passes are frames.
    pub frame: usize,
    /// The first transaction of the unit in that frame, from 0; of a channel the first cycle of the run.
    pub first: usize,
    /// How many at most.
    pub count: usize,
    /// The channel that is taken for the unit `channel`, by its name in traces.
    pub channel: &'a str,
}
