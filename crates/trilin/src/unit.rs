//! The interpolators on their channels: a pair of discrete rays in, a ray of samples out.
//!
//! ```text
//!   [rays] ──► ray j of planes i, i+1 ──► with ray j−1 ──► [samples] of ray j−1
//! ```
//! Ray j of a plane is finished by ray j+1. The last ray of a plane is finished by the first where slots are
//! shared, which is kept for it, and by nothing where they are not; it leaves while the next plane begins.

use crate::lanes::TrilinLanes;
use bitvec::prelude::*;
use cube3_channel::{Account, Activity, Archive, ArchiveError, Archived, Channel, Payload};
use cube3_dsb::golden::{ray_lane, ray_pieces};
use cube3_dsb::{RayPair, RayVoxels};
use cube3_host::{Fan, FrameSetup, Geometry, MachineSpec, Reuse, SampleBounds};
use cube3_word::vectorised;
use serde::{Deserialize, Serialize};

/// A slot of continuous rays.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct SampleRay<D> {
    /// Frame, from 0.
    pub frame: u32,
    /// Plane of ray slots.
    pub plane: u32,
    /// Ray slot.
    pub slot: u32,
    /// The samples.
    pub data: D,
}

/// The samples of a ray slot, in lane order.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RaySamples {
    /// Sample words; 0 where there is none.
    pub samples: Vec<i32>,
    /// Which lanes hold a sample of the volume.
    pub present: BitVec,
}

/// The interpolators' arithmetic, or nothing where only time counts.
pub trait Interpolate: Archived {
    /// What ray pairs carry.
    type Input: Default;
    /// What rays of samples carry.
    type Output: Payload;

    /// Takes the next pair of a plane.
    fn take(&mut self, setup: &FrameSetup, pair: &mut RayPair<Self::Input>);

    /// Gives the samples of a slot, after the pair on its right has been taken, or after the last of the plane.
    fn give(&mut self, setup: &FrameSetup, plane: usize, slot: usize, output: &mut Self::Output);
}

/// Interpolators for timing alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoSamples;

impl Interpolate for NoSamples {
    type Input = ();
    type Output = ();

    #[inline(always)]
    fn take(&mut self, _: &FrameSetup, _: &mut RayPair<()>) {}

    #[inline(always)]
    fn give(&mut self, _: &FrameSetup, _: usize, _: usize, _: &mut ()) {}
}

impl Archived for NoSamples {
    fn archive(&mut self, _: &mut Archive<'_>) -> Result<(), ArchiveError> {
        Ok(())
    }
}

/// A discrete ray slot of one plane as an interpolator holds it, in order of depth.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Held {
    /// Lifted voxels.
    voxels: Vec<i32>,
    /// Voxels lerped along w, where they are kept.
    edges: Vec<i32>,
}

/// The interpolators with their registers.
#[derive(Clone, Debug)]
pub struct Interpolator {
    lanes: usize,
    arithmetic: TrilinLanes,
    reuse: Reuse,
    /// The first pair of the plane, the pair before, and the newest: current plane and the one below.
    first: [Held; 2],
    before: [Held; 2],
    newest: [Held; 2],
    /// Lerps along u of the plane below, for each slot: those of the current plane next time.
    sides: Vec<Vec<i32>>,
    lerps: u64,
    scratch: [Vec<i32>; 3],
    /// Which rays of a parallel frame lie in the volume at each depth; the rays of a slot, and which of its samples do, along u and along v.
    bounds: Option<SampleBounds>,
    rays: Vec<i32>,
    inside: [Vec<i32>; 2],
    /// The plane that the latter is for.
    placed: Option<usize>,
    /// Lerps along u of a slot: their memory.
    lerped: [Vec<i32>; 2],
}

impl Interpolator {
    /// Interpolators for a frame.
    pub fn new(setup: &FrameSetup, lanes: usize) -> Interpolator {
        let keeps_planes = matches!(setup.reuse, Reuse::Plane | Reuse::Both);
        let [slots, _] = setup.geometry.slot_counts();
        let empty = || [Held::default(), Held::default()];
        Interpolator {
            lanes,
            arithmetic: TrilinLanes::new(&setup.words),
            reuse: setup.reuse,
            first: empty(),
            before: empty(),
            newest: empty(),
            sides: vec![Vec::new(); if keeps_planes { slots } else { 0 }],
            lerps: 0,
            scratch: Default::default(),
            bounds: SampleBounds::new(&setup.geometry),
            rays: Vec::new(),
            inside: Default::default(),
            placed: None,
            lerped: Default::default(),
        }
    }

    /// Lerps of whole rays done so far.
    pub fn ray_lerps(&self) -> u64 {
        self.lerps
    }

    fn keeps_rays(&self) -> bool {
        matches!(self.reuse, Reuse::Ray | Reuse::Both)
    }

    /// The edges of a held ray: kept, or lerped again.
    fn edges(&mut self, held: &Held, offset: u32, out: &mut Vec<i32>) {
        out.clear();
        if self.keeps_rays() {
            out.extend_from_slice(&held.edges);
        } else {
            out.resize(held.voxels.len(), 0);
            self.arithmetic.ray_along_w(&held.voxels, offset, out);
            self.lerps += 1;
        }
    }

    /// The lerp along u of one plane (0 current, 1 below) between the ray before, of slot `slot`, and the newest.
    fn side(&mut self, setup: &FrameSetup, plane: usize, slot: usize, out: &mut Vec<i32>) {
        let [mut left, mut right, rest] = std::mem::take(&mut self.scratch);
        let (before, newest) = (std::mem::take(&mut self.before[plane]), std::mem::take(&mut self.newest[plane]));
        self.edges(&before, setup.geometry.offset, &mut left);
        self.edges(&newest, setup.geometry.offset, &mut right);
        self.before[plane] = before;
        self.newest[plane] = newest;
        out.clear();
        out.resize(left.len(), 0);
        match &setup.geometry.perspective {
            None => self.arithmetic.ray(&left, &right, &setup.geometry.u.weights, out),
            Some(pass) => self.arithmetic.ray(&left, &right, &of_ray(&pass.u, slot, left.len()), out),
        }
        self.lerps += 1;
        self.scratch = [left, right, rest];
    }

    /// The lerp along u of one plane in the cell that the ray before has for itself: its voxels are those of both columns.
    fn cell_side(&mut self, setup: &FrameSetup, plane: usize, weights: &[u32], out: &mut Vec<i32>) {
        let depths = setup.geometry.size[2];
        let voxels = &self.before[plane].voxels;
        let mut edges = [vec![0; depths], vec![0; depths]];
        for (edge, voxels) in edges.iter_mut().zip(voxels.chunks(depths)) {
            self.arithmetic.ray_along_w(voxels, setup.geometry.offset, edge);
        }
        out.clear();
        out.resize(depths, 0);
        self.arithmetic.ray(&edges[0], &edges[1], weights, out);
        self.lerps += 3;
    }
}

/// The weights of one ray of a fan, by its index, in order of depth.
fn of_ray(fan: &Fan, i: usize, depths: usize) -> Vec<u32> {
    (0..depths).map(|k| fan.weight(i, k)).collect()
}

impl Interpolate for Interpolator {
    type Input = RayVoxels;
    type Output = RaySamples;

    fn take(&mut self, setup: &FrameSetup, pair: &mut RayPair<RayVoxels>) {
        let depths = setup.geometry.size[2];
        std::mem::swap(&mut self.before, &mut self.newest);
        let slot = pair.slot as usize;
        let current_needed = !matches!(self.reuse, Reuse::Plane | Reuse::Both) || pair.plane == 0;
        for (i, ray) in [&pair.data.current, &pair.data.below].into_iter().enumerate() {
            let held = &mut self.newest[i];
            held.voxels.clear();
            for ray in ray.chunks(depths.div_ceil(self.lanes) * self.lanes) {
                for piece in ray_pieces(ray, self.lanes, slot, depths) {
                    held.voxels.extend(piece.iter().map(|&word| i32::from(word) << setup.words.sample_fraction_bits));
                }
            }
            if setup.geometry.doubled() {
                continue;
            }
            if matches!(self.reuse, Reuse::Ray | Reuse::Both) && (i == 1 || current_needed) {
                held.edges.clear();
                held.edges.resize(depths, 0);
                self.arithmetic.ray_along_w(&held.voxels, setup.geometry.offset, &mut held.edges);
                self.lerps += 1;
            }
        }
        if slot == 0 {
            self.first = self.newest.clone();
        }
    }

    fn give(&mut self, setup: &FrameSetup, plane: usize, slot: usize, output: &mut RaySamples) {
        let geometry = &setup.geometry;
        let [slots, _] = geometry.slot_counts();
        if slot + 1 == slots {
            let next = if geometry.closes()[0] {
                self.first.clone()
            } else {
                let nothing = Held { voxels: vec![0; geometry.size[2]], edges: vec![0; geometry.size[2]] };
                [nothing.clone(), nothing]
            };
            // The newest pair is the last of the plane: it becomes the one before.
            self.before = std::mem::replace(&mut self.newest, next);
        }
        let [mut current, mut below] = std::mem::take(&mut self.lerped);
        let keeps_planes = !self.sides.is_empty();
        if let Some(pass) = geometry.perspective.as_ref().filter(|pass| pass.doubled) {
            let weights = of_ray(&pass.u, slot, geometry.size[2]);
            self.cell_side(setup, 0, &weights, &mut current);
            self.cell_side(setup, 1, &weights, &mut below);
        } else {
            if keeps_planes && plane > 0 {
                std::mem::swap(&mut current, &mut self.sides[slot]);
            } else {
                self.side(setup, 0, slot, &mut current);
            }
            self.side(setup, 1, slot, &mut below);
        }
        let mut samples = std::mem::take(&mut self.scratch[2]);
        samples.clear();
        samples.resize(geometry.size[2], 0);
        match &geometry.perspective {
            None => self.arithmetic.ray(&current, &below, &geometry.v.weights, &mut samples),
            Some(pass) => {
                self.arithmetic.ray(&current, &below, &of_ray(&pass.v, plane, geometry.size[2]), &mut samples);
            }
        }
        self.lerps += 1;
        if keeps_planes {
            std::mem::swap(&mut self.sides[slot], &mut below);
        }
        self.lerped = [current, below];
        self.place(geometry, plane, slot, &samples, output);
        self.scratch[2] = samples;
    }
}

impl Interpolator {
    /// Puts samples into lane order, with a mask of those that lie in the volume.
    fn place(&mut self, geometry: &Geometry, plane: usize, slot: usize, samples: &[i32], output: &mut RaySamples) {
        let width = samples.len().div_ceil(self.lanes) * self.lanes;
        if let Some(bounds) = &self.bounds {
            let depths = samples.len();
            if self.placed != Some(plane) {
                geometry.rays_along(1, plane, &mut self.rays);
                self.inside[1].resize(depths, 0);
                bounds.inside(1, &self.rays, 0, 0, &mut self.inside[1]);
                self.placed = Some(plane);
            }
            geometry.rays_along(0, slot, &mut self.rays);
            let [inside_u, inside_v] = &mut self.inside;
            inside_u.resize(depths, 0);
            let rays = &self.rays;
            vectorised(
                #[inline(always)]
                || {
                    bounds.inside(0, rays, 0, 0, inside_u);
                    for (inside, &along_v) in inside_u.iter_mut().zip(&*inside_v) {
                        *inside &= along_v;
                    }
                },
            );
            output.samples.resize(width, 0);
            output.present.resize(width, false);
            let words = output.present.as_raw_mut_slice();
            words.fill(0);
            for (chunk, (samples, inside)) in samples.chunks(self.lanes).zip(inside_u.chunks(self.lanes)).enumerate() {
                let first = chunk * self.lanes;
                let lanes = &mut output.samples[first..first + self.lanes];
                if samples.len() < lanes.len() {
                    lanes.fill(0);
                }
                let mut lane = slot % self.lanes;
                for (&sample, &inside) in samples.iter().zip(inside) {
                    lanes[lane] = sample & inside;
                    let bit = first + lane;
                    words[bit / usize::BITS as usize] |= ((inside & 1) as usize) << (bit % usize::BITS as usize);
                    lane = if lane + 1 == self.lanes { 0 } else { lane + 1 };
                }
            }
            return;
        }
        output.samples.clear();
        output.samples.resize(width, 0);
        output.present.clear();
        output.present.resize(width, false);
        for (k, &sample) in samples.iter().enumerate() {
            if geometry.has_sample(geometry.ray_in_slot(plane, slot, k), k as i64) {
                let lane = ray_lane(self.lanes, slot, k);
                output.samples[lane] = sample;
                output.present.set(lane, true);
            }
        }
    }
}

/// Data sheet of the interpolators for one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrilinSpec {
    /// Cycles of a ray: ⌈n_w / lanes⌉.
    pub ray_cycles: u64,
    /// Ray slots of a plane.
    pub slots: u32,
    /// Planes of the frame.
    pub planes: u32,
}

impl TrilinSpec {
    /// The data sheet for a machine and the geometry of a frame.
    pub fn new(machine: &MachineSpec, geometry: &Geometry) -> TrilinSpec {
        let [slots, planes] = geometry.slot_counts();
        let ray_cycles = geometry.size[2].div_ceil(machine.lanes) as u64;
        TrilinSpec { ray_cycles, slots: slots as u32, planes: planes as u32 }
    }
}

/// The interpolation unit.
#[derive(Clone, Debug)]
pub struct TrilinUnit<I> {
    /// Data sheet and arithmetic of each frame.
    frames: Vec<(TrilinSpec, I)>,
    state: State,
    account: Account,
}

/// Where the unit is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    /// Cycles spent on the pair at the input.
    spent: u64,
    /// Frame and plane whose last ray has been taken and not given.
    closing: Option<[u32; 2]>,
    given: u64,
}

impl<I: Interpolate> TrilinUnit<I> {
    /// The unit's name.
    pub const NAME: &'static str = "trilin";

    /// Interpolators at the start of the first frame: a data sheet and the arithmetic for each.
    pub fn new(parts: impl IntoIterator<Item = (TrilinSpec, I)>) -> TrilinUnit<I> {
        TrilinUnit { frames: parts.into_iter().collect(), state: State::default(), account: Account::default() }
    }

    /// One cycle. `frames` are the registers of all frames.
    #[inline]
    pub fn tick(
        &mut self,
        frames: &[FrameSetup],
        rays: &mut Channel<RayPair<I::Input>>,
        samples: &mut Channel<SampleRay<I::Output>>,
    ) -> Activity {
        let activity = self.step(frames, rays, samples);
        self.account.record(activity)
    }

    #[inline]
    fn step(
        &mut self,
        frames: &[FrameSetup],
        rays: &mut Channel<RayPair<I::Input>>,
        samples: &mut Channel<SampleRay<I::Output>>,
    ) -> Activity {
        let mut activity = Activity::Starved;
        if let Some([frame, plane]) = self.state.closing {
            let Some(output) = samples.push_slot() else {
                return Activity::Blocked;
            };
            self.state.closing = None;
            self.give(frames, [frame, plane, self.frames[frame as usize].0.slots - 1], output);
            activity = Activity::Busy;
        }
        let Some(pair) = rays.front() else {
            return activity;
        };
        let (frame, plane, slot) = (pair.frame, pair.plane, pair.slot);
        let (spec, arithmetic) = &mut self.frames[frame as usize];
        if self.state.spent + 1 < spec.ray_cycles {
            self.state.spent += 1;
            return Activity::Busy;
        }
        if slot > 0 && !samples.can_push() {
            return Activity::Blocked;
        }
        let last = slot + 1 == spec.slots;
        if let Some(pair) = rays.pop_slot() {
            arithmetic.take(&frames[frame as usize], pair);
        }
        self.state.spent = 0;
        if slot > 0
            && let Some(output) = samples.push_slot()
        {
            self.give(frames, [frame, plane, slot - 1], output);
        }
        if last {
            self.state.closing = Some([frame, plane]);
        }
        Activity::Busy
    }

    #[inline]
    fn give(&mut self, frames: &[FrameSetup], [frame, plane, slot]: [u32; 3], output: &mut SampleRay<I::Output>) {
        output.frame = frame;
        output.plane = plane;
        output.slot = slot;
        let (_, arithmetic) = &mut self.frames[frame as usize];
        arithmetic.give(&frames[frame as usize], plane as usize, slot as usize, &mut output.data);
        self.state.given += 1;
    }

    /// Whether every ray of every frame has been given.
    pub fn done(&self) -> bool {
        let rays = |(spec, _): &(TrilinSpec, I)| u64::from(spec.slots) * u64::from(spec.planes);
        self.state.given == self.frames.iter().map(rays).sum::<u64>()
    }

    /// The arithmetic of each frame, to ask what it counted.
    pub fn arithmetic(&self) -> impl Iterator<Item = &I> {
        self.frames.iter().map(|(_, arithmetic)| arithmetic)
    }

    /// What the unit did with its cycles.
    pub fn account(&self) -> &Account {
        &self.account
    }
}

impl Archived for Interpolator {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let Interpolator {
            lanes: _,
            arithmetic: _,
            reuse: _,
            first,
            before,
            newest,
            sides,
            lerps,
            scratch: _,
            bounds: _,
            rays: _,
            inside: _,
            placed: _,
            lerped: _,
        } = self;
        archive.item(first)?;
        archive.item(before)?;
        archive.item(newest)?;
        archive.list(sides)?;
        archive.item(lerps)
    }
}

impl<I: Archived> Archived for TrilinUnit<I> {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let TrilinUnit { frames, state, account } = self;
        archive.item(state)?;
        archive.item(account)?;
        frames.iter_mut().try_for_each(|(_, arithmetic)| arithmetic.archive(archive))
    }
}
