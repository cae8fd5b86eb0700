//! The 2-D skewed buffers on their channels: planes are written beam by beam and read ray by ray.
//!
//! ```text
//!               write port                        read port
//!   [aligned] ─────────────► ring of planes ─────────────────► [rays]
//!                            (and the first)     ray j of planes i and i+1
//! ```

use crate::PlaneStore;
use cube3_cfb::{Beam, VoxelBeam};
use cube3_channel::{Account, Activity, Channel, PortState, Wait};
use cube3_host::{Geometry, MachineSpec};
use serde::{Deserialize, Serialize};

/// A ray slot of two neighbouring planes.
#[derive(Clone, Debug, Default)]
pub struct RayPair<D> {
    /// Plane of ray slots; the pair is this and the next.
    pub plane: u32,
    /// Ray slot.
    pub slot: u32,
    /// The voxels.
    pub data: D,
}

/// The voxels of a ray slot in two planes, in lane order. Where slots need their own cells, two rays one after the other: of
/// column L and of column R.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RayVoxels {
    /// Plane i.
    pub current: Vec<u16>,
    /// Plane i + 1, or the row below plane i; zeros beyond the last.
    pub below: Vec<u16>,
}

/// The memory of the buffers: planes of voxels, or nothing where only time counts.
pub trait Store {
    /// What aligned beams carry.
    type Input: Default;
    /// What ray pairs carry.
    type Output: Default;

    /// Writes the beam of a plane at a depth.
    fn write(&mut self, beam: &Beam<Self::Input>);

    /// Reads ray slot `j` of `plane` and of `below`, if there is one; `kept` says that `below` is the plane kept from
    /// the start.
    fn read(&self, plane: usize, below: Option<usize>, kept: bool, j: usize, output: &mut Self::Output);
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
    fn read(&self, _: usize, _: Option<usize>, _: bool, _: usize, _: &mut ()) {}
}

impl Store for PlaneStore {
    type Input = VoxelBeam;
    type Output = RayVoxels;

    fn write(&mut self, beam: &Beam<VoxelBeam>) {
        let voxels = beam.row.map(|_| beam.data.0.as_slice());
        PlaneStore::write(self, beam.plane as usize, beam.depth as usize, voxels);
    }

    fn read(&self, plane: usize, below: Option<usize>, kept: bool, j: usize, output: &mut RayVoxels) {
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
    /// Planes in the ring.
    pub planes: usize,
    /// Cycles to write a beam: ⌈n_u / lanes⌉.
    pub write_cycles: u64,
    /// Cycles to read a ray: ⌈n_w / lanes⌉.
    pub read_cycles: u64,
    /// Beams of a plane.
    pub depths: u32,
    /// Ray slots of a plane.
    pub slots: u32,
    /// Planes of the frame.
    pub frame_planes: u32,
    /// Whether the last plane is read with the first.
    pub closes: bool,
}

impl DsbSpec {
    /// The data sheet for a machine and the geometry of a frame.
    pub fn new(machine: &MachineSpec, geometry: &Geometry) -> DsbSpec {
        let [slots, frame_planes] = geometry.slot_counts();
        DsbSpec {
            planes: machine.dsb.planes,
            write_cycles: geometry.size[0].div_ceil(machine.lanes) as u64,
            read_cycles: geometry.size[2].div_ceil(machine.lanes) as u64,
            depths: geometry.size[2] as u32,
            slots: slots as u32,
            frame_planes: frame_planes as u32,
            closes: geometry.closes()[1],
        }
    }
}

/// The 2-D skewed buffers.
#[derive(Clone, Debug)]
pub struct DsbUnit<S> {
    spec: DsbSpec,
    memory: S,
    state: State,
    write_account: Account,
    read_account: Account,
}

/// Where the two ports are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    /// Planes written whole.
    complete: u32,
    /// Cycles spent on the beam at the write port.
    write_spent: u64,
    /// Plane that is being read.
    plane: u32,
    /// Ray slot that is next.
    slot: u32,
    /// Cycles spent on the ray at the read port.
    read_spent: u64,
}

impl<S: Store> DsbUnit<S> {
    /// The write port's name.
    pub const WRITE: &'static str = "dsb.write";
    /// The read port's name.
    pub const READ: &'static str = "dsb.read";

    /// Empty buffers.
    pub fn new(spec: DsbSpec, memory: S) -> DsbUnit<S> {
        let account = Account::default();
        DsbUnit { spec, memory, state: State::default(), write_account: account, read_account: account }
    }

    /// One cycle of both ports: a plane that is read out gives its buffer to the write port at once, and a plane
    /// that is full can be read from the next cycle on.
    #[inline]
    pub fn tick(&mut self, aligned: &mut Channel<Beam<S::Input>>, rays: &mut Channel<RayPair<S::Output>>) -> bool {
        let read = self.read(rays);
        let moved = self.read_account.record(read);
        let write = self.write(aligned);
        self.write_account.record(write) | moved
    }

    #[inline]
    fn write(&mut self, aligned: &mut Channel<Beam<S::Input>>) -> Activity {
        let Some(beam) = aligned.front() else {
            return Activity::Starved;
        };
        if !self.has_buffer(beam.plane) {
            return Activity::Blocked;
        }
        let needed = if beam.row.is_some() { self.spec.write_cycles } else { 1 };
        if self.state.write_spent + 1 < needed {
            self.state.write_spent += 1;
            return Activity::Busy;
        }
        self.memory.write(beam);
        self.state.complete += u32::from(beam.depth + 1 == self.spec.depths);
        self.state.write_spent = 0;
        aligned.pop_slot();
        Activity::Busy
    }

    /// Whether the ring has a buffer for a plane: planes from the one being read on are still needed.
    fn has_buffer(&self, plane: u32) -> bool {
        ((plane - self.state.plane) as usize) < self.spec.planes
    }

    #[inline]
    fn read(&mut self, rays: &mut Channel<RayPair<S::Output>>) -> Activity {
        let State { plane, slot, complete, .. } = self.state;
        let last = plane + 1 == self.spec.frame_planes;
        let needed = if last { plane + 1 } else { plane + 2 };
        if self.done() || complete < needed {
            return Activity::Starved;
        }
        if self.state.read_spent + 1 < self.spec.read_cycles {
            self.state.read_spent += 1;
            return Activity::Busy;
        }
        let Some(pair) = rays.push_slot() else {
            return Activity::Blocked;
        };
        let below = if last { self.spec.closes.then_some(0) } else { Some(plane as usize + 1) };
        pair.plane = plane;
        pair.slot = slot;
        self.memory.read(plane as usize, below, last, slot as usize, &mut pair.data);
        self.state.read_spent = 0;
        self.state.slot += 1;
        if self.state.slot == self.spec.slots {
            self.state.slot = 0;
            self.state.plane += 1;
        }
        Activity::Busy
    }

    /// Whether every ray of the frame has been read.
    pub fn done(&self) -> bool {
        self.state.plane == self.spec.frame_planes
    }

    /// What stops the two ports inside of the unit, when nothing moves: the write port without a buffer, the read port
    /// without a plane.
    pub fn inner_waits(&self, aligned: &Channel<Beam<S::Input>>) -> Vec<Wait> {
        let mut waits = Vec::new();
        let held = (self.state.complete - self.state.plane.min(self.state.complete)) as usize;
        let wait = |unit, port: &str, state, upon| Wait {
            unit,
            port: port.into(),
            state,
            occupancy: held,
            capacity: self.spec.planes,
            upon,
        };
        if aligned.front().is_some_and(|beam| !self.has_buffer(beam.plane)) {
            waits.push(wait(Self::WRITE, "plane buffers", PortState::Full, Self::READ));
        }
        if !self.done() && self.state.complete < (self.state.plane + 2).min(self.spec.frame_planes) {
            waits.push(wait(Self::READ, "the plane below", PortState::Empty, Self::WRITE));
        }
        waits
    }

    /// What the write and the read port did with their cycles.
    pub fn accounts(&self) -> [&Account; 2] {
        [&self.write_account, &self.read_account]
    }
}
