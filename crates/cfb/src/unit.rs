//! The frame buffer on its channel: it scans the planes of a frame and sends a beam for each slot.
//!
//! ```text
//!   (plane i, depth k) counters ──► modules ──► [beams]
//! ```

use crate::FrameBuffer;
use crate::golden::Skew;
use cube3_channel::{Account, Activity, Channel, Reason};
use cube3_host::{FrameSetup, Geometry, MachineSpec, RaySlots};
use serde::{Deserialize, Serialize};

/// A beam on its way: the row of voxels that plane `plane` of ray slots has at depth `depth`.
#[derive(Clone, Debug, Default)]
pub struct Beam<D> {
    /// Frame, from 0.
    pub frame: u32,
    /// Plane of ray slots, from 0.
    pub plane: u32,
    /// Depth k.
    pub depth: u32,
    /// Row v of the volume; none where a padded plane is outside of it.
    pub row: Option<u32>,
    /// The voxels.
    pub data: D,
}

/// The voxels of a beam in lane order; where slots need their own cells, of two beams one after the other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VoxelBeam(pub Vec<u16>);

/// Where beams come from: a frame buffer with voxels, or nothing where only time counts.
pub trait Fetch {
    /// What a beam carries.
    type Output: Default;

    /// Reads the beam along u at row `v` and plane `w`; where slots need their own cells, also the one that the rays of `plane` have
    /// below it.
    fn fetch(&self, setup: &FrameSetup, plane: usize, v: usize, w: usize, output: &mut Self::Output);
}

/// A frame buffer for timing alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoVoxels;

impl Fetch for NoVoxels {
    type Output = ();

    #[inline(always)]
    fn fetch(&self, _: &FrameSetup, _: usize, _: usize, _: usize, _: &mut ()) {}
}

impl Fetch for FrameBuffer {
    type Output = VoxelBeam;

    fn fetch(&self, setup: &FrameSetup, plane: usize, v: usize, w: usize, output: &mut VoxelBeam) {
        let geometry = &setup.geometry;
        FrameBuffer::fetch(self, &geometry.axes, v, w, &mut output.0);
        if geometry.doubled() {
            let mut below = vec![0; output.0.len()];
            if let Some(v) = geometry.row_below(plane, w) {
                FrameBuffer::fetch(self, &geometry.axes, v, w, &mut below);
            }
            output.0.append(&mut below);
        }
    }
}

/// Data sheet of the frame buffer for one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CfbSpec {
    /// Cycles of a beam without conflicts: ⌈n_u / lanes⌉.
    pub beam_cycles: u64,
    /// Further cycles of a beam, in which modules serve voxels that share one.
    pub conflict_cycles: u64,
}

impl CfbSpec {
    /// The data sheet for a machine and the geometry of a frame.
    pub fn new(machine: &MachineSpec, geometry: &Geometry) -> CfbSpec {
        let skew = Skew { coefficients: machine.cfb.skew, lanes: machine.lanes };
        let beam_cycles = geometry.size[0].div_ceil(machine.lanes) as u64;
        let all = skew.beam_cycles(geometry.axes.axis[0], geometry.size[0]) as u64;
        CfbSpec { beam_cycles, conflict_cycles: all - beam_cycles }
    }
}

/// The frame buffer unit.
#[derive(Clone, Debug)]
pub struct CfbUnit<F> {
    specs: Vec<CfbSpec>,
    memory: F,
    state: State,
    account: Account,
}

/// Where the scan is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    frame: u32,
    plane: u32,
    depth: u32,
    spent: u64,
    fetched: u64,
}

impl<F: Fetch> CfbUnit<F> {
    /// The unit's name.
    pub const NAME: &'static str = "cfb";

    /// A frame buffer at the start of the first of some frames.
    pub fn new(specs: Vec<CfbSpec>, memory: F) -> CfbUnit<F> {
        CfbUnit { specs, memory, state: State::default(), account: Account::default() }
    }

    /// One cycle. `frames` are the registers of all frames, of which those before `released` may be scanned.
    #[inline]
    pub fn tick(&mut self, frames: &[FrameSetup], released: u32, beams: &mut Channel<Beam<F::Output>>) -> Activity {
        let activity = self.step(frames, released, beams);
        self.account.record(activity)
    }

    #[inline]
    fn step(&mut self, frames: &[FrameSetup], released: u32, beams: &mut Channel<Beam<F::Output>>) -> Activity {
        if self.done() || self.state.frame >= released {
            return Activity::Starved;
        }
        let (setup, spec) = (&frames[self.state.frame as usize], self.specs[self.state.frame as usize]);
        let row = row(&setup.geometry, self.state.plane, self.state.depth);
        let needed = if row.is_some() { spec.beam_cycles + spec.conflict_cycles } else { 1 };
        if self.state.spent + 1 < needed {
            self.state.spent += 1;
            let working = self.state.spent <= spec.beam_cycles;
            return if working { Activity::Busy } else { Activity::Waiting(Reason::BankConflict) };
        }
        let Some(beam) = beams.push_slot() else {
            return Activity::Blocked;
        };
        beam.frame = self.state.frame;
        beam.plane = self.state.plane;
        beam.depth = self.state.depth;
        beam.row = row;
        if let Some(v) = row {
            let [plane, depth] = [self.state.plane, self.state.depth].map(|i| i as usize);
            self.memory.fetch(setup, plane, v as usize, depth, &mut beam.data);
            self.state.fetched += 1;
        }
        let conflict = spec.conflict_cycles > 0 && row.is_some();
        self.advance(&setup.geometry);
        if conflict { Activity::Waiting(Reason::BankConflict) } else { Activity::Busy }
    }

    fn advance(&mut self, geometry: &Geometry) {
        self.state.spent = 0;
        self.state.depth += 1;
        if self.state.depth as usize == geometry.size[2] {
            self.state.depth = 0;
            self.state.plane += 1;
            if self.state.plane as usize == geometry.slot_counts()[1] {
                self.state.plane = 0;
                self.state.frame += 1;
            }
        }
    }

    /// Whether every beam of every frame has been sent.
    pub fn done(&self) -> bool {
        self.state.frame as usize == self.specs.len()
    }

    /// Beams fetched from the modules.
    pub fn fetched(&self) -> u64 {
        self.state.fetched
    }

    /// What the unit did with its cycles.
    pub fn account(&self) -> &Account {
        &self.account
    }
}

/// The row of the volume that plane `plane` of ray slots has at a depth.
#[inline]
fn row(geometry: &Geometry, plane: u32, depth: u32) -> Option<u32> {
    if let Some(pass) = &geometry.perspective {
        return u32::try_from(pass.v.near(plane as usize, depth as usize))
            .ok()
            .filter(|&row| row < geometry.size[1] as u32);
    }
    let rows = geometry.size[1] as u32;
    let shift = geometry.v.columns[depth as usize];
    match geometry.slots {
        RaySlots::Wrapped => Some((plane + shift) % rows),
        RaySlots::Padded => (plane + shift).checked_sub(geometry.shear_v() as u32).filter(|&row| row < rows),
    }
}
