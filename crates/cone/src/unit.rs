//! The cone on its channels: rays of coloured samples in, pixels out.
//!
//! ```text
//!   [shaded] ──► folded tree ──► accumulator over chunks ──► [pixels]
//! ```
//! A slot that several rays share gives several pixels at once.

use crate::golden::{Node, leaf, pixel};
use crate::lanes::{Segment, circle, join};
use cube3_abc::{ShadedRay, ShadedSamples};
use cube3_channel::{Account, Activity, Channel};
use cube3_dsb::golden::ray_lane;
use cube3_host::{DiscreteRay, FrameSetup, MachineSpec};
use serde::{Deserialize, Serialize};

/// A pixel of the base plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixel {
    /// The ray.
    pub ray: DiscreteRay,
    /// Red, green, blue (opacity-weighted) and opacity, unit words of `accumulator_bits`.
    pub rgba: [u32; 4],
}

/// The pixels of a ray slot.
#[derive(Clone, Debug, Default)]
pub struct PixelGroup<D> {
    /// Frame, from 0.
    pub frame: u32,
    /// Plane of ray slots.
    pub plane: u32,
    /// Ray slot.
    pub slot: u32,
    /// The pixels.
    pub data: D,
}

/// The rays of a slot, in order of depth.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pixels(pub Vec<Pixel>);

/// The cone's arithmetic, or nothing where only time counts.
pub trait Reduce {
    /// What rays of coloured samples carry.
    type Input: Default;
    /// What pixel groups carry.
    type Output: Default;

    /// Reduces a slot to the pixels of its rays.
    fn reduce(&mut self, setup: &FrameSetup, plane: usize, slot: usize, input: &Self::Input, output: &mut Self::Output);
}

/// A cone for timing alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoPixels;

impl Reduce for NoPixels {
    type Input = ();
    type Output = ();

    #[inline(always)]
    fn reduce(&mut self, _: &FrameSetup, _: usize, _: usize, _: &(), _: &mut ()) {}
}

/// The cone's nodes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reducer {
    overflows: u64,
}

impl Reducer {
    /// Words saturated so far.
    pub fn overflows(&self) -> u64 {
        self.overflows
    }
}

impl Reduce for Reducer {
    type Input = ShadedSamples;
    type Output = Pixels;

    fn reduce(&mut self, setup: &FrameSetup, plane: usize, slot: usize, input: &ShadedSamples, output: &mut Pixels) {
        let (cone, words, geometry) = (&setup.cone, &setup.words, &setup.geometry);
        let depths = geometry.size[2];
        let mut rays: Vec<Segment> = Vec::new();
        for chunk in (0..depths).step_by(cone.leaves) {
            // Leaf `place` of the circle has the depth that is skewed to it; places beyond the ray have nothing.
            let start = slot % cone.leaves;
            let of = |place: usize| {
                let depth = chunk + (place + cone.leaves - start) % cone.leaves;
                if depth < depths {
                    let shaded = &input.0[ray_lane(cone.leaves, slot, depth)];
                    Segment { ray: geometry.ray_in_slot(plane, slot, depth), node: leaf(shaded, cone, words) }
                } else {
                    let ray = geometry.ray_in_slot(plane, slot, depths - 1);
                    Segment { ray, node: Node::default() }
                }
            };
            let part = circle(cone.leaves, start, of, cone.mode, words);
            if rays.is_empty() {
                rays = part;
            } else {
                join(&mut rays, part, cone.mode, words);
            }
        }
        output.0.clear();
        for segment in rays {
            let counted = pixel(segment.node, cone, words);
            self.overflows += u64::from(counted.overflows);
            output.0.push(Pixel { ray: segment.ray, rgba: counted.value });
        }
    }
}

/// Data sheet of the cone for one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConeSpec {
    /// Cycles of a ray: ⌈n_w / lanes⌉.
    pub ray_cycles: u64,
}

impl ConeSpec {
    /// The data sheet for a machine and the registers of a frame.
    pub fn new(machine: &MachineSpec, setup: &FrameSetup) -> ConeSpec {
        ConeSpec { ray_cycles: setup.geometry.size[2].div_ceil(machine.lanes) as u64 }
    }
}

/// The cone unit.
#[derive(Clone, Debug)]
pub struct ConeUnit<R> {
    /// Data sheet of each frame.
    specs: Vec<ConeSpec>,
    arithmetic: R,
    state: State,
    account: Account,
}

/// Cycles spent on the ray in hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    spent: u64,
}

impl<R: Reduce> ConeUnit<R> {
    /// The unit's name.
    pub const NAME: &'static str = "cone";

    /// An empty cone with a data sheet for each frame.
    pub fn new(specs: Vec<ConeSpec>, arithmetic: R) -> ConeUnit<R> {
        ConeUnit { specs, arithmetic, state: State::default(), account: Account::default() }
    }

    /// One cycle. `frames` are the registers of all frames.
    #[inline]
    pub fn tick(
        &mut self,
        frames: &[FrameSetup],
        shaded: &mut Channel<ShadedRay<R::Input>>,
        pixels: &mut Channel<PixelGroup<R::Output>>,
    ) -> Activity {
        let activity = self.step(frames, shaded, pixels);
        self.account.record(activity)
    }

    #[inline]
    fn step(
        &mut self,
        frames: &[FrameSetup],
        shaded: &mut Channel<ShadedRay<R::Input>>,
        pixels: &mut Channel<PixelGroup<R::Output>>,
    ) -> Activity {
        let Some(ray) = shaded.front() else {
            return Activity::Starved;
        };
        let frame = ray.frame as usize;
        if self.state.spent + 1 < self.specs[frame].ray_cycles {
            self.state.spent += 1;
            return Activity::Busy;
        }
        let Some(output) = pixels.push_slot() else {
            return Activity::Blocked;
        };
        output.frame = ray.frame;
        output.plane = ray.plane;
        output.slot = ray.slot;
        self.arithmetic.reduce(&frames[frame], ray.plane as usize, ray.slot as usize, &ray.data, &mut output.data);
        shaded.pop_slot();
        self.state.spent = 0;
        Activity::Busy
    }

    /// The arithmetic, to ask what it counted.
    pub fn arithmetic(&self) -> &R {
        &self.arithmetic
    }

    /// What the unit did with its cycles.
    pub fn account(&self) -> &Account {
        &self.account
    }
}
