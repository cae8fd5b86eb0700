//! The 2-D skewed buffers on their channels: planes are written beam by beam and read ray by ray.
//!
//! ```text
//!               write port                        read port
//!   [aligned] ─────────────► ring of planes ─────────────────► [rays]
//!                            (and the first)     ray j of planes i and i+1
//! ```
//! Where the ray slots of a plane are taken in sections, a plane of the ring has the slots of one: all planes of a section come before
//! those of the next.

use crate::PlaneStore;
use cube3_cfb::{Beam, VoxelBeam};
use cube3_channel::{Account, Activity, Archive, ArchiveError, Archived, Channel, Payload, PortState, Reason, Wait};
use cube3_frame::{BeamPlace, RayPlace, Schedule};
use cube3_machine::MachineSpec;
use serde::{Deserialize, Serialize};

/// A ray slot of two neighbouring planes.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct RayPair<D> {
    /// Frame, from 0.
    pub frame: u32,
    /// Plane of ray slots; the pair is this and the next.
    pub plane: u32,
    /// Ray slot.
    pub slot: u32,
    /// The voxels.
    pub data: D,
}

/// The voxels of a ray slot in two planes, in order of depth, filled up with zeros to whole chunks of lanes: that at depth k is in lane
/// `(slot + k) mod lanes`. Where slots need their own cells, two rays one after the other: of
/// column L and of column R.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RayVoxels {
    /// Plane i.
    pub current: Vec<u16>,
    /// Plane i + 1, or the row below plane i; zeros beyond the last.
    pub below: Vec<u16>,
}

/// The memory of the buffers: planes of voxels, or nothing where only time counts.
pub trait Store: Archived {
    /// What aligned beams carry.
    type Input: Default;
    /// What ray pairs carry.
    type Output: Payload;

    /// Writes the beam of a plane at a depth.
    fn write(&mut self, beam: &Beam<Self::Input>);

    /// Reads ray slot `j` of a section's plane, `at`, and of its plane `below`, if there is one; `kept` says that `below` is the plane
    /// kept from the section's start.
    fn read(&self, at: [u32; 2], below: Option<u32>, kept: bool, j: usize, output: &mut Self::Output);
}

/// Buffers for timing alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoPlanes;

impl Store for NoPlanes {
    type Input = ();
    type Output = ();

    #[inline(always)]
    fn write(&mut self, _: &Beam<()>) {}

    #[inline(always)]
    fn read(&self, _: [u32; 2], _: Option<u32>, _: bool, _: usize, _: &mut ()) {}
}

impl Archived for NoPlanes {
    fn archive(&mut self, _: &mut Archive<'_>) -> Result<(), ArchiveError> {
        Ok(())
    }
}

impl Store for PlaneStore {
    type Input = VoxelBeam;
    type Output = RayVoxels;

    fn write(&mut self, beam: &Beam<VoxelBeam>) {
        let voxels = beam.row.map(|_| beam.data.0.as_slice());
        let Beam { section, plane, depth, .. } = *beam;
        PlaneStore::write(self, BeamPlace { section, plane, depth }, voxels);
    }

    fn read(&self, [section, plane]: [u32; 2], below: Option<u32>, kept: bool, j: usize, output: &mut RayVoxels) {
        let (plane, below) = (self.plane(section, plane), below.map(|below| self.plane(section, below)));
        if self.has_cells() {
            for (copy, ray) in [&mut output.current, &mut output.below].into_iter().enumerate() {
                ray.clear();
                self.read_copy(plane, false, j, 2 * copy, ray);
                self.read_copy(plane, false, j, 2 * copy + 1, ray);
            }
            return;
        }
        PlaneStore::read(self, plane, false, j, &mut output.current);
        match below {
            Some(below) => PlaneStore::read(self, below, kept, j, &mut output.below),
            None => {
                output.below.clear();
                output.below.resize(output.current.len(), 0);
            }
        }
    }
}

/// Data sheet of the skewed buffers for one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DsbSpec {
    /// The order of the beams that are written and of the rays that are read. A whole beam is written in [`Schedule::aligned_cycles`]:
    /// where slots need their own cells, the four words of a slot side by side.
    pub schedule: Schedule,
    /// Planes in the ring.
    pub planes: usize,
    /// Ports of a module, which holds its part of every plane: 2 write and read in the same cycle, 1 does one of the two.
    pub ports: usize,
}

impl DsbSpec {
    /// The data sheet for a machine and a frame, which has this schedule there.
    pub fn new(machine: &MachineSpec, schedule: Schedule) -> DsbSpec {
        DsbSpec { schedule, planes: machine.dsb.planes, ports: machine.dsb.ports }
    }

    /// Cycles to write a beam of a section.
    #[inline]
    fn cycles_of<D>(&self, beam: &Beam<D>) -> u64 {
        if beam.row.is_none() {
            1
        } else if self.schedule.sections().is_whole() {
            self.schedule.aligned_cycles()
        } else {
            self.schedule.piece_cycles(beam.voxels)
        }
    }
}

/// The 2-D skewed buffers.
#[derive(Clone, Debug)]
pub struct DsbUnit<S> {
    frames: Vec<DsbFrame<S>>,
    single_port: bool,
    state: State,
    write_account: Account,
    read_account: Account,
}

/// A frame's data sheet and memory.
#[derive(Clone, Debug)]
struct DsbFrame<S> {
    spec: DsbSpec,
    memory: S,
    /// Planes of the frames before, those of each section, and their sections.
    base: u64,
    sections: u32,
}

/// Where the two ports are. Planes are counted over all sections of all frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    /// Planes written whole.
    written: u64,
    /// Cycles spent on the beam at the write port.
    write_spent: u64,
    /// Frame that is being read.
    frame: u32,
    /// The ray that is next.
    place: RayPlace,
    /// Cycles spent on the ray at the read port.
    read_spent: u64,
}

impl<S: Store> DsbUnit<S> {
    /// The write port's name.
    pub const WRITE: &'static str = "dsb.write";
    /// The read port's name.
    pub const READ: &'static str = "dsb.read";

    /// Empty buffers: a data sheet and a memory for each frame.
    pub fn new(parts: impl IntoIterator<Item = (DsbSpec, S)>) -> DsbUnit<S> {
        let (mut planes, mut sections) = (0, 0);
        let frame = |(spec, memory): (DsbSpec, S)| {
            let before = (planes, sections);
            planes += spec.schedule.planes_of_frame();
            sections += spec.schedule.sections().count() as u32;
            DsbFrame { spec, memory, base: before.0, sections: before.1 }
        };
        let frames: Vec<DsbFrame<S>> = parts.into_iter().map(frame).collect();
        let single_port = frames.iter().any(|frame| frame.spec.ports == 1);
        let account = Account::default();
        DsbUnit { frames, single_port, state: State::default(), write_account: account, read_account: account }
    }

    /// One cycle of both ports: a plane that is read out gives its buffer to the write port at once, and a plane
    /// that is full can be read from the next cycle on. Where modules have one port, reading goes first, since what follows
    /// lives on it. What the write and the read port did.
    #[inline]
    pub fn tick(
        &mut self,
        aligned: &mut Channel<Beam<S::Input>>,
        rays: &mut Channel<RayPair<S::Output>>,
    ) -> [Activity; 2] {
        let read = self.read(rays);
        let taken = self.single_port && read == Activity::Busy;
        let write = if taken { self.wait_for_port(aligned) } else { self.write(aligned) };
        [self.write_account.record(write), self.read_account.record(read)]
    }

    /// What the write port does while the read port has the modules.
    fn wait_for_port(&self, aligned: &Channel<Beam<S::Input>>) -> Activity {
        match aligned.front() {
            None => aligned.lack(),
            Some(beam) if !self.has_buffer(beam) => Activity::Blocked,
            Some(_) => Activity::Waiting(Reason::Port),
        }
    }

    #[inline]
    fn write(&mut self, aligned: &mut Channel<Beam<S::Input>>) -> Activity {
        let Some(beam) = aligned.front() else {
            return aligned.lack();
        };
        if !self.has_buffer(beam) {
            return Activity::Blocked;
        }
        let DsbFrame { spec, memory, .. } = &mut self.frames[beam.frame as usize];
        let needed = spec.cycles_of(beam);
        if self.state.write_spent + 1 < needed {
            self.state.write_spent += 1;
            return Activity::Busy;
        }
        memory.write(beam);
        self.state.written += u64::from(spec.schedule.is_last_depth(beam.depth));
        self.state.write_spent = 0;
        aligned.pop_slot();
        Activity::Busy
    }

    /// Whether the ring has a buffer for the plane of a beam: planes from the one being read on are still needed. The buffers of first
    /// planes serve two sections, the one being read and the next.
    #[inline]
    fn has_buffer<D>(&self, beam: &Beam<D>) -> bool {
        let DsbFrame { spec, base, sections, .. } = &self.frames[beam.frame as usize];
        let ahead = base + spec.schedule.plane_number(beam.section, beam.plane) - self.released();
        let reading = self.frames.get(self.state.frame as usize).map_or(0, |frame| frame.sections);
        let reading = reading + self.state.place.section;
        let next = self.state.frame as usize == self.frames.len() || sections + beam.section <= reading + 1;
        ahead < spec.planes as u64 && next
    }

    /// Planes read out, over all frames.
    #[inline]
    fn released(&self) -> u64 {
        let State { frame, place: RayPlace { section, plane, .. }, .. } = self.state;
        match self.frames.get(frame as usize) {
            Some(DsbFrame { spec, base, .. }) => base + spec.schedule.plane_number(section, plane),
            None => self.frames.last().map_or(0, |DsbFrame { spec, base, .. }| base + spec.schedule.planes_of_frame()),
        }
    }

    #[inline]
    fn read(&mut self, rays: &mut Channel<RayPair<S::Output>>) -> Activity {
        let State { frame, place, written, .. } = self.state;
        let RayPlace { section, plane, slot } = place;
        let Some(DsbFrame { spec, memory, base, .. }) = self.frames.get(frame as usize) else {
            return Activity::Starved;
        };
        let schedule = &spec.schedule;
        if written < base + schedule.planes_read(section, plane) {
            return Activity::Starved;
        }
        if self.state.read_spent + 1 < schedule.ray_cycles() {
            self.state.read_spent += 1;
            return Activity::Busy;
        }
        let Some(pair) = rays.push_slot() else {
            return rays.refusal();
        };
        let kept = schedule.is_last_plane(plane);
        pair.frame = frame;
        pair.plane = plane;
        pair.slot = slot;
        memory.read([section, plane], schedule.below(plane), kept, slot as usize, &mut pair.data);
        self.state.read_spent = 0;
        self.state.frame += u32::from(schedule.next_ray(&mut self.state.place));
        Activity::Busy
    }

    /// Whether every ray of every frame has been read.
    pub fn done(&self) -> bool {
        self.state.frame as usize == self.frames.len()
    }

    /// What stops the two ports inside of the unit, when nothing moves: the write port without a buffer, the read port
    /// without a plane.
    pub fn inner_waits(&self, aligned: &Channel<Beam<S::Input>>) -> Vec<Wait> {
        let mut waits = Vec::new();
        let held = self.state.written.saturating_sub(self.released()) as usize;
        let Some(DsbFrame { spec, base, .. }) = self.frames.get(self.state.frame as usize) else {
            return waits;
        };
        let wait = |unit, port: &str, state, upon| Wait {
            unit,
            port: port.into(),
            state,
            occupancy: held,
            capacity: spec.planes,
            upon,
        };
        if aligned.front().is_some_and(|beam| !self.has_buffer(beam)) {
            waits.push(wait(Self::WRITE, "plane buffers", PortState::Full, Self::READ));
        }
        let RayPlace { section, plane, .. } = self.state.place;
        if self.state.written < base + spec.schedule.planes_read(section, plane) {
            waits.push(wait(Self::READ, "the plane below", PortState::Empty, Self::WRITE));
        }
        waits
    }

    /// What the write and the read port did with their cycles.
    pub fn accounts(&self) -> [&Account; 2] {
        [&self.write_account, &self.read_account]
    }
}

impl<S: Archived> Archived for DsbUnit<S> {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let DsbUnit { frames, single_port: _, state, write_account, read_account } = self;
        archive.item(state)?;
        archive.item(write_account)?;
        archive.item(read_account)?;
        frames.iter_mut().try_for_each(|DsbFrame { spec: _, memory, base: _, sections: _ }| memory.archive(archive))
    }
}
