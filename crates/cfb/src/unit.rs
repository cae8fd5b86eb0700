//! The frame buffer on its channel: it scans the planes of a frame and sends a beam for each slot.
//!
//! ```text
//!   (section, plane i, depth k) in order ──► modules ──► [beams]
//! ```
//! Where a machine takes the ray slots of a plane in sections, a beam is what the slots of the section have of a row.

use crate::memory::{MemoryCounters, ReorderCounters, Supply, SupplyState};
use crate::scan::{CfbSpec, Fetching, Scan};
use crate::{AcquisitionPort, FrameBuffer, PortSpec};
use cube3_channel::{Account, Activity, Archive, ArchiveError, Archived, Channel, Payload, Reason};
use cube3_frame::{BeamPlace, FrameSetup};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::Arc;

/// A beam on its way: the row of voxels that plane `plane` of ray slots has at depth `depth`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Beam<D> {
    /// Frame, from 0.
    pub frame: u32,
    /// Section of ray slots, from 0.
    pub section: u32,
    /// Plane of ray slots, from 0.
    pub plane: u32,
    /// Depth k.
    pub depth: u32,
    /// Row v of the volume; none where the padded slots are outside of it.
    pub row: Option<u32>,
    /// Voxels of each of its rows that it brings: all of them, or those of the section's slots.
    pub voxels: u32,
    /// The row. Voxels of other sections than the beam's are there, too, and nothing reads them.
    pub data: D,
}

/// The voxels of a beam in lane order; where slots need their own cells, of two beams one after the other.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct VoxelBeam(pub Vec<u16>);

/// Where beams come from: a frame buffer with voxels, or nothing where only time counts.
pub trait Fetch {
    /// What a beam carries.
    type Output: Payload;

    /// Reads the beam along u at row `v` and plane `w`; where slots need their own cells, also the one that the rays of `plane` have
    /// below it.
    fn fetch(&self, setup: &FrameSetup, plane: usize, v: usize, w: usize, output: &mut Self::Output);

    /// Takes words of the volumes that come in, counted from the first word of the first.
    fn write(&mut self, words: Range<u64>);

    /// The buffers of a double buffer change roles.
    fn swap(&mut self);
}

/// A frame buffer for timing alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoVoxels;

impl Fetch for NoVoxels {
    type Output = ();

    #[inline(always)]
    fn fetch(&self, _: &FrameSetup, _: usize, _: usize, _: usize, _: &mut ()) {}

    #[inline(always)]
    fn write(&mut self, _: Range<u64>) {}

    #[inline(always)]
    fn swap(&mut self) {}
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

    fn write(&mut self, words: Range<u64>) {
        FrameBuffer::write(self, words);
    }

    fn swap(&mut self) {
        FrameBuffer::swap(self);
    }
}

/// The frame buffer unit.
#[derive(Clone, Debug)]
pub struct CfbUnit<F> {
    specs: Vec<CfbSpec>,
    memory: F,
    /// Modules that do not give any word in any cycle.
    modules: Option<Supply>,
    port: Option<AcquisitionPort>,
    /// Frames that begin a picture; each does where there are none.
    pictures: Vec<u32>,
    state: State,
    account: Account,
}

/// What the unit remembers.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    scan: Scan,
    fetched: u64,
    modules: Option<SupplyState>,
}

impl<F: Fetch> CfbUnit<F> {
    /// The unit's name.
    pub const NAME: &'static str = "cfb";

    /// A frame buffer at the start of the first of some frames, whose modules give any word in any cycle.
    pub fn new(specs: Vec<CfbSpec>, memory: F) -> CfbUnit<F> {
        CfbUnit {
            specs,
            memory,
            modules: None,
            port: None,
            pictures: Vec::new(),
            state: State::default(),
            account: Account::default(),
        }
    }

    /// With modules that take their time.
    pub fn with_modules(mut self, modules: Option<Supply>) -> CfbUnit<F> {
        self.state.modules = modules.as_ref().map(|modules| modules.start(self.specs.len()));
        self.modules = modules;
        self
    }

    /// Lets volumes come in while frames are read.
    pub fn acquire(&mut self, port: PortSpec) {
        self.port = Some(AcquisitionPort::new(port));
    }

    /// Sets the frames that begin a picture, in order: a double buffer changes roles before these alone.
    pub fn begin_pictures(&mut self, frames: Vec<u32>) {
        self.pictures = frames;
    }

    /// The port that volumes come in through, where there is one.
    pub fn port(&self) -> Option<&AcquisitionPort> {
        self.port.as_ref()
    }

    /// The memory.
    pub fn memory_mut(&mut self) -> &mut F {
        &mut self.memory
    }

    /// One cycle. `frames` are the registers of all frames, of which those before `released` may be scanned.
    #[inline(always)]
    pub fn tick(
        &mut self,
        frames: &[Arc<FrameSetup>],
        released: u32,
        beams: &mut Channel<Beam<F::Output>>,
    ) -> Activity {
        let activity = if self.port.is_none() {
            self.read(frames, released, beams)
        } else {
            self.read_and_write(frames, released, beams)
        };
        self.account.record(activity)
    }

    /// A cycle of the modules.
    #[inline(always)]
    fn read(&mut self, frames: &[Arc<FrameSetup>], released: u32, beams: &mut Channel<Beam<F::Output>>) -> Activity {
        if let (Some(modules), Some(state)) = (&self.modules, &mut self.state.modules) {
            modules.ask(state, frames, &self.specs, released);
        }
        let activity = self.step(frames, released, beams);
        if let Some(modules) = &mut self.state.modules {
            modules.end_cycle();
        }
        activity
    }

    /// A cycle with an acquisition port. What is written in it is there for the beam that is fetched in it. In a cycle that
    /// is taken from reads, the modules' own time stands still.
    fn read_and_write(
        &mut self,
        frames: &[Arc<FrameSetup>],
        released: u32,
        beams: &mut Channel<Beam<F::Output>>,
    ) -> Activity {
        let reads = self.reads(frames, released, beams);
        if let Some(port) = &mut self.port {
            port.arrive();
            let scan = &self.state.scan;
            let begins = self.pictures.is_empty() || self.pictures.binary_search(&scan.frame).is_ok();
            if scan.between_frames() && begins && port.can_show() {
                port.show();
                self.memory.swap();
            }
            let steals = port.steals(reads);
            self.memory.write(port.write(steals || !reads));
            if steals {
                return Activity::Waiting(Reason::Port);
            }
        }
        self.read(frames, released, beams)
    }

    /// Whether the modules are read in this cycle if nothing else takes it.
    fn reads(&self, frames: &[Arc<FrameSetup>], released: u32, beams: &Channel<Beam<F::Output>>) -> bool {
        let Scan { frame, spent, .. } = self.state.scan;
        if self.done() || frame >= released {
            return false;
        }
        let spec = &self.specs[frame as usize];
        let fetching = spec.fetching(&frames[frame as usize].geometry, &self.state.scan);
        let last = spent + 1 >= fetching.cycles;
        fetching.row.is_some() && (!last || beams.can_push())
    }

    #[inline(always)]
    fn step(&mut self, frames: &[Arc<FrameSetup>], released: u32, beams: &mut Channel<Beam<F::Output>>) -> Activity {
        if self.done() || self.state.scan.frame >= released {
            return Activity::Starved;
        }
        let CfbUnit { specs, memory, modules, port, state, .. } = self;
        let Scan { frame, place: BeamPlace { section, plane, depth }, spent } = state.scan;
        let (setup, spec) = (&*frames[frame as usize], &specs[frame as usize]);
        let Fetching { row, voxels, cycles, work } = spec.fetching(&setup.geometry, &state.scan);
        let last = spent + 1 >= cycles;
        if last && !beams.can_push() {
            return Activity::Blocked;
        }
        if let (Some(modules), Some(supply)) = (modules, &mut state.modules) {
            if let Some(activity) = modules.take(supply, &setup.geometry, spec, &state.scan) {
                return activity;
            }
            if last {
                modules.end_beam(supply, &setup.geometry, spec, &state.scan);
            }
        }
        state.scan.spent += 1;
        if last && let Some(beam) = beams.push_slot() {
            beam.frame = frame;
            beam.section = section;
            beam.plane = plane;
            beam.depth = depth;
            beam.row = row;
            beam.voxels = voxels;
            if let Some(v) = row {
                memory.fetch(setup, plane as usize, v as usize, depth as usize, &mut beam.data);
                let below = setup.geometry.row_below(plane as usize, depth as usize);
                state.fetched += 1 + u64::from(setup.geometry.doubled() && below.is_some());
                if let Some(port) = port {
                    port.fetched();
                }
            }
            state.scan.advance(&spec.schedule);
        }
        if spent < work { Activity::Busy } else { Activity::Waiting(Reason::BankConflict) }
    }

    /// Whether every beam of every frame has been sent.
    pub fn done(&self) -> bool {
        self.state.scan.frame as usize == self.specs.len()
    }

    /// Beams fetched from the modules, where there are sections pieces of beams.
    pub fn fetched(&self) -> u64 {
        self.state.fetched
    }

    /// What the modules have done, by frame, summed over the modules; nothing where they give any word in any cycle.
    pub fn memory_counters(&self) -> &[MemoryCounters] {
        self.state.modules.as_ref().map_or(&[], SupplyState::counters)
    }

    /// What the reorder buffer has done, where modules read mini-blocks.
    pub fn reorder_counters(&self) -> Option<ReorderCounters> {
        self.state.modules.as_ref().and_then(SupplyState::reorder)
    }

    /// What the unit did with its cycles.
    pub fn account(&self) -> &Account {
        &self.account
    }
}

impl<F> Archived for CfbUnit<F> {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let CfbUnit { specs: _, memory: _, modules: _, port, pictures: _, state, account } = self;
        archive.item(port)?;
        archive.item(state)?;
        archive.item(account)
    }
}
