//! The fast bus on its channels: a rotation of each beam, in perspective a monotone gather (de-fan).
//!
//! ```text
//!   [beams] ──► turn by X(k) and the skews, or gather by the fan ──► [aligned]
//!               channels × slices                words on the links between boards
//! ```
//! A beam leaves when its slices are over and links have room for its words; the words follow it, and the buffers wait for them.

use crate::{BoardSpec, LinkWords, Links, Rotator};
use cube3_cfb::{Beam, VoxelBeam};
use cube3_channel::{
    Account, Activity, Archive, ArchiveError, Archived, Channel, ClockDomain, Payload, Reason, TokenTransfer,
};
use cube3_frame::{FrameSetup, Schedule};
use cube3_machine::MachineSpec;
use serde::{Deserialize, Serialize};
use std::borrow::Borrow;
use std::ops::Range;

/// What the bus does with a beam: turns or gathers its voxels, or nothing where only time counts.
pub trait Align {
    /// What beams carry before.
    type Input: Default;
    /// What beams carry after.
    type Output: Payload;

    /// Aligns the beam of a plane, its row `v` and a depth, `at`: in a parallel view voxels `columns` of it.
    fn align(
        &self,
        setup: &FrameSetup,
        at: [usize; 3],
        columns: &[Range<usize>; 2],
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
    fn align(&self, _: &FrameSetup, _: [usize; 3], _: &[Range<usize>; 2], _: &(), _: &mut ()) {}
}

impl Align for Rotator {
    type Input = VoxelBeam;
    type Output = VoxelBeam;

    fn align(
        &self,
        setup: &FrameSetup,
        [plane, v, depth]: [usize; 3],
        columns: &[Range<usize>; 2],
        input: &VoxelBeam,
        output: &mut VoxelBeam,
    ) {
        match &setup.geometry.perspective {
            None => self.align_columns(&setup.geometry, v, depth, columns, &input.0, &mut output.0),
            Some(_) => self.gather(&setup.geometry, plane, depth, &input.0, &mut output.0),
        }
    }
}

/// Data sheet of the bus for one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BusSpec {
    /// Words of a beam: n_u; where slots need their own cells, four for each slot.
    pub words: u64,
    /// Cycles that the lanes need to give and take a beam: ⌈n_u / lanes⌉.
    pub lane_cycles: u64,
    /// Slices of a beam: ⌈n_u / channels⌉.
    pub slices: u64,
    /// The order of the beams. Where it has sections a beam has the voxels of one, for n_u.
    pub schedule: Schedule,
    channels: u64,
}

/// A beam on the bus: its words, the cycles that the lanes need for it, its slices.
#[derive(Clone, Copy, Debug)]
struct BeamWords {
    words: u64,
    lane_cycles: u64,
    slices: u64,
}

impl BusSpec {
    /// The data sheet for a machine and a frame, which has this schedule there.
    pub fn new(machine: &MachineSpec, schedule: Schedule) -> BusSpec {
        // Where slots need their own cells, two rows are gathered twice, each time for every slot.
        let (words, gathers) = (schedule.aligned_words() as u64, schedule.words_of_slot() as u64);
        let channels = channels(machine) as u64;
        BusSpec {
            words: gathers * words,
            lane_cycles: gathers * schedule.aligned_cycles(),
            slices: gathers * words.div_ceil(channels),
            schedule,
            channels,
        }
    }

    /// Those of a beam of so many voxels.
    #[inline]
    fn of_voxels(&self, voxels: u32) -> BeamWords {
        let BusSpec { words, lane_cycles, slices, schedule, channels } = self;
        if schedule.sections().is_whole() {
            return BeamWords { words: *words, lane_cycles: *lane_cycles, slices: *slices };
        }
        let words = u64::from(voxels);
        BeamWords { words, lane_cycles: schedule.piece_cycles(voxels), slices: words.div_ceil(*channels) }
    }
}

/// Channels of the bus.
fn channels(machine: &MachineSpec) -> usize {
    machine.bus.channels.unwrap_or(machine.lanes)
}

/// Slices a pipeline cycle.
fn slice_clock(machine: &MachineSpec) -> ClockDomain {
    ClockDomain::from_hertz(machine.bus.clock_hz.unwrap_or(machine.clock_hz), machine.clock_hz)
}

/// What the bus has carried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BusCounters {
    /// Voxel words.
    pub words: u64,
    /// Voxel words that its channels could have carried in the cycles of the run.
    pub slots: u64,
    /// Words of beams over the links between boards, over all links and both directions.
    pub link_words: u64,
    /// Most words of one beam over one link in one direction.
    pub link_peak: u64,
}

/// The fast bus.
#[derive(Clone, Debug)]
pub struct BusUnit<B> {
    /// Data sheet of each frame.
    specs: Vec<BusSpec>,
    boards: BoardSpec,
    channels: u64,
    clock: ClockDomain,
    /// Whether slices or links can hold a beam longer than its lanes do, or words on links are counted.
    limited: bool,
    /// Words of the beam in hand or sent last over each link, forwards and backwards; nothing on one board.
    crossing: Vec<[u64; 2]>,
    /// Whether they are those of the beam in hand.
    counted: bool,
    /// Whether a beam of voxels has left in this cycle.
    sent: bool,
    wires: B,
    state: State,
    account: Account,
}

/// The beam in hand, and what has been carried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    /// Cycles spent on the beam in hand.
    spent: u64,
    /// Its slices, where they can be too few.
    slices: Option<TokenTransfer>,
    words: u64,
    link_words: u64,
    link_peak: u64,
}

impl<B: Align> BusUnit<B> {
    /// The unit's name.
    pub const NAME: &'static str = "bus";

    /// A bus for frames of these schedules. A beam takes as long as its lanes and its slices need.
    pub fn new(machine: &MachineSpec, schedules: impl IntoIterator<Item = Schedule>, wires: B) -> BusUnit<B> {
        let clock = slice_clock(machine);
        let (ticks, cycles) = clock.ratio();
        let scarce = channels(machine) < machine.lanes || ticks < cycles;
        let boards = BoardSpec::new(machine);
        BusUnit {
            specs: schedules.into_iter().map(|schedule| BusSpec::new(machine, schedule)).collect(),
            boards,
            channels: channels(machine) as u64,
            clock,
            limited: scarce || boards.boards > 1,
            crossing: vec![[0; 2]; if boards.boards > 1 { boards.boards } else { 0 }],
            counted: false,
            sent: false,
            wires,
            state: State {
                spent: 0,
                slices: scarce.then(|| TokenTransfer::new(clock)),
                words: 0,
                link_words: 0,
                link_peak: 0,
            },
            account: Account::default(),
        }
    }

    /// One cycle. `links` are those between boards as the last cycle left them, where there are several boards.
    #[inline]
    pub fn tick(
        &mut self,
        frames: &[impl Borrow<FrameSetup>],
        beams: &mut Channel<Beam<B::Input>>,
        aligned: &mut Channel<Beam<B::Output>>,
        links: Option<&Links>,
    ) -> Activity {
        self.sent = false;
        let activity = self.step(frames, beams, aligned, links);
        self.account.record(activity)
    }

    #[inline]
    fn step(
        &mut self,
        frames: &[impl Borrow<FrameSetup>],
        beams: &mut Channel<Beam<B::Input>>,
        aligned: &mut Channel<Beam<B::Output>>,
        links: Option<&Links>,
    ) -> Activity {
        let Some(beam) = beams.front() else {
            if self.limited {
                self.rest();
            }
            return Activity::Starved;
        };
        let frame = beam.frame as usize;
        let sent = self.specs[frame].of_voxels(beam.voxels);
        let needed = if beam.row.is_some() { sent.lane_cycles } else { 1 };
        let mut activity = Activity::Busy;
        if self.limited
            && let Some(v) = beam.row
        {
            if !self.crossing.is_empty() && !self.counted {
                let place = [beam.plane, v, beam.depth].map(|i| i as usize);
                let slots = self.specs[frame].schedule.sections().slots(beam.section as usize);
                self.boards.beam_words(&frames[frame].borrow().geometry, slots, place, &mut self.crossing);
                self.counted = true;
            }
            if self.state.spent >= needed {
                // The cycle in which the last slices come is one of waiting, too.
                activity = Activity::Waiting(Reason::BusSlice);
            }
            if self.state.slices.is_some_and(|slices| !slices.completes(sent.slices)) {
                self.carry();
                return activity;
            }
        }
        if self.state.spent + 1 < needed {
            self.carry();
            return Activity::Busy;
        }
        if let Some(links) = links
            && beam.row.is_some()
            && aligned.can_push()
            && !links.has_room(&self.crossing)
        {
            return Activity::Waiting(Reason::Link);
        }
        let Some(output) = aligned.push_slot() else {
            return Activity::Blocked;
        };
        output.frame = beam.frame;
        output.section = beam.section;
        output.plane = beam.plane;
        output.depth = beam.depth;
        output.row = beam.row;
        output.voxels = beam.voxels;
        if let Some(v) = beam.row {
            let at = [beam.plane, v, beam.depth].map(|i| i as usize);
            let geometry = &frames[frame].borrow().geometry;
            let sections = self.specs[frame].schedule.sections();
            let columns = if sections.is_whole() {
                [0..geometry.size[0], 0..0]
            } else {
                geometry.columns(sections.slots(beam.section as usize), at[2])
            };
            self.wires.align(frames[frame].borrow(), at, &columns, &beam.data, &mut output.data);
            self.state.words += sent.words;
        }
        let empty = beam.row.is_none();
        beams.pop_slot();
        self.state.spent = 0;
        if self.limited {
            if empty { self.rest() } else { self.finish(sent.slices) }
        }
        activity
    }
}

impl<B> BusUnit<B> {
    /// Words over each link, forwards and backwards, of the beam that has left in this cycle, where there are links.
    #[inline]
    pub fn sent(&self) -> Option<&[[u64; 2]]> {
        self.sent.then_some(&self.crossing)
    }

    fn carry(&mut self) {
        self.state.spent += 1;
        if let Some(slices) = &mut self.state.slices {
            slices.carry();
        }
    }

    fn finish(&mut self, sent: u64) {
        let LinkWords { busiest, all } = LinkWords::of(&self.crossing);
        self.state.link_words += all;
        self.state.link_peak = self.state.link_peak.max(busiest);
        self.counted = false;
        self.sent = !self.crossing.is_empty();
        if let Some(slices) = &mut self.state.slices {
            slices.finish(sent);
        }
    }

    /// A cycle in which no voxel is on the bus.
    fn rest(&mut self) {
        if let Some(slices) = &mut self.state.slices {
            slices.rest();
        }
    }

    /// What has been carried.
    pub fn counters(&self) -> BusCounters {
        let slices = self.clock.ticks_before(self.account.cycles()) as u64;
        let State { words, link_words, link_peak, .. } = self.state;
        BusCounters { words, slots: slices * self.channels, link_words, link_peak }
    }

    /// What the unit did with its cycles.
    pub fn account(&self) -> &Account {
        &self.account
    }
}

impl<B> Archived for BusUnit<B> {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let BusUnit {
            specs: _,
            boards: _,
            channels: _,
            clock: _,
            limited: _,
            crossing: _,
            counted: _,
            sent: _,
            wires: _,
            state,
            account,
        } = self;
        archive.item(state)?;
        archive.item(account)
    }
}
