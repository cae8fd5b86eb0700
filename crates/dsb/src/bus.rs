//! The fast bus on its channels: a rotation of each beam, in perspective a monotone gather (de-fan).
//!
//! ```text
//!   [beams] ──► turn by X(k) and the skews, or gather by the fan ──► [aligned]
//! ```

use crate::Rotator;
use cube3_cfb::{Beam, VoxelBeam};
use cube3_channel::{Account, Activity, Channel};
use cube3_host::{FrameSetup, Geometry, MachineSpec};
use serde::{Deserialize, Serialize};

/// What the bus does with a beam: turns or gathers its voxels, or nothing where only time counts.
pub trait Align {
    /// What beams carry before.
    type Input: Default;
    /// What beams carry after.
    type Output: Default;

    /// Aligns the beam of row `v` of a plane at a depth.
    fn align(
        &self,
        setup: &FrameSetup,
        plane: usize,
        v: usize,
        depth: usize,
        input: &Self::Input,
        output: &mut Self::Output,
    );
}

/// A bus for timing alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoBus;

impl Align for NoBus {
    type Input = ();
    type Output = ();

    #[inline(always)]
    fn align(&self, _: &FrameSetup, _: usize, _: usize, _: usize, _: &(), _: &mut ()) {}
}

impl Align for Rotator {
    type Input = VoxelBeam;
    type Output = VoxelBeam;

    fn align(
        &self,
        setup: &FrameSetup,
        plane: usize,
        v: usize,
        depth: usize,
        input: &VoxelBeam,
        output: &mut VoxelBeam,
    ) {
        match &setup.geometry.perspective {
            None => Rotator::align(self, &setup.geometry, v, depth, &input.0, &mut output.0),
            Some(_) => self.gather(&setup.geometry, plane, depth, &input.0, &mut output.0),
        }
    }
}

/// The fast bus.
#[derive(Clone, Debug)]
pub struct BusUnit<B> {
    /// Cycles of a beam, for each frame.
    cycles: Vec<u64>,
    wires: B,
    state: State,
    account: Account,
}

/// Cycles spent on the beam in hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    spent: u64,
}

impl<B: Align> BusUnit<B> {
    /// The unit's name.
    pub const NAME: &'static str = "bus";

    /// A bus on which a beam takes ⌈n_u / lanes⌉ cycles, for the frames of these geometries.
    pub fn new<'a>(machine: &MachineSpec, geometries: impl IntoIterator<Item = &'a Geometry>, wires: B) -> BusUnit<B> {
        let cycles = geometries.into_iter().map(|geometry| geometry.size[0].div_ceil(machine.lanes) as u64).collect();
        BusUnit { cycles, wires, state: State::default(), account: Account::default() }
    }

    /// One cycle.
    #[inline]
    pub fn tick(
        &mut self,
        frames: &[FrameSetup],
        beams: &mut Channel<Beam<B::Input>>,
        aligned: &mut Channel<Beam<B::Output>>,
    ) -> Activity {
        let activity = self.step(frames, beams, aligned);
        self.account.record(activity)
    }

    #[inline]
    fn step(
        &mut self,
        frames: &[FrameSetup],
        beams: &mut Channel<Beam<B::Input>>,
        aligned: &mut Channel<Beam<B::Output>>,
    ) -> Activity {
        let Some(beam) = beams.front() else {
            return Activity::Starved;
        };
        let frame = beam.frame as usize;
        let needed = if beam.row.is_some() { self.cycles[frame] } else { 1 };
        if self.state.spent + 1 < needed {
            self.state.spent += 1;
            return Activity::Busy;
        }
        let Some(output) = aligned.push_slot() else {
            return Activity::Blocked;
        };
        output.frame = beam.frame;
        output.plane = beam.plane;
        output.depth = beam.depth;
        output.row = beam.row;
        if let Some(v) = beam.row {
            let [plane, depth] = [beam.plane, beam.depth].map(|i| i as usize);
            self.wires.align(&frames[frame], plane, v as usize, depth, &beam.data, &mut output.data);
        }
        beams.pop_slot();
        self.state.spent = 0;
        Activity::Busy
    }

    /// What the unit did with its cycles.
    pub fn account(&self) -> &Account {
        &self.account
    }
}
