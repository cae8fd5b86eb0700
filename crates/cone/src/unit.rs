//! The cone on its channels: rays of coloured samples in, pixels out.
//!
//! ```text
//!   [shaded] ──► folded tree ──► accumulator over chunks ──► [pixels]
//!            or  shifter ──► tree ──► accumulator, a chain, an accumulator alone
//! ```
//! A slot that several rays share gives several pixels at once.

use crate::ConeSpec;
use crate::golden::{Node, Segment, circle_by, combine, leaf, pixel};
use crate::lanes::{SlotLanes, in_order, in_order_by, join_by, tree_of_ray};
use cube3_abc::{ShadedRay, ShadedSamples};
use cube3_channel::{Account, Activity, Archive, ArchiveError, Archived, Channel, Payload};
use cube3_frame::{DiscreteRay, FrameSetup, RayStretches};
use cube3_machine::ConeOrder;
use serde::{Deserialize, Serialize};
use std::borrow::Borrow;
use std::ops::Range;

/// A pixel of the base plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Pixel {
    /// The ray.
    pub ray: DiscreteRay,
    /// Red, green, blue (opacity-weighted) and opacity, unit words of `accumulator_bits`.
    pub rgba: [u32; 4],
}

/// The pixels of a ray slot.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
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
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Pixels(pub Vec<Pixel>);

/// The cone's arithmetic, or nothing where only time counts.
pub trait Reduce: Archived {
    /// What rays of coloured samples carry.
    type Input: Default;
    /// What pixel groups carry.
    type Output: Payload;

    /// Reduces a slot, its frame, plane and number, to the pixels of its rays.
    fn reduce(&mut self, setup: &FrameSetup, slot: [u32; 3], input: &Self::Input, output: &mut Self::Output);
}

/// A cone for timing alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoPixels;

impl Reduce for NoPixels {
    type Input = ();
    type Output = ();

    #[inline(always)]
    fn reduce(&mut self, _: &FrameSetup, _: [u32; 3], _: &(), _: &mut ()) {}
}

impl Archived for NoPixels {
    fn archive(&mut self, _: &mut Archive<'_>) -> Result<(), ArchiveError> {
        Ok(())
    }
}

/// The cone's nodes.
#[derive(Clone, Debug, Default)]
pub struct Reducer {
    overflows: u64,
    /// The leaves of a ray: their memory.
    leaves: Vec<Node>,
    /// What the frame in hand is reduced with.
    frame: Option<FrameLanes>,
}

/// What a frame's registers make.
#[derive(Clone, Debug)]
struct FrameLanes {
    number: u32,
    rays: RayStretches,
    /// What reduces a slot at once, where mode and words let it.
    slot: Option<SlotLanes>,
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

    fn reduce(
        &mut self,
        setup: &FrameSetup,
        [frame, plane, slot]: [u32; 3],
        input: &ShadedSamples,
        output: &mut Pixels,
    ) {
        let (cone, words, geometry) = (&setup.cone, &setup.words, &setup.geometry);
        let (plane, slot) = (plane as usize, slot as usize);
        if self.frame.as_ref().is_none_or(|lanes| lanes.number != frame) {
            let (rays, slot) = (RayStretches::new(geometry), SlotLanes::new(cone, words));
            self.frame = Some(FrameLanes { number: frame, rays, slot });
        }
        let Reducer { overflows, leaves, frame: Some(lanes) } = self else {
            return;
        };
        output.0.clear();
        let mut send = |ray: DiscreteRay, node: Node| {
            let counted = pixel(node, cone, words);
            *overflows += u64::from(counted.overflows);
            output.0.push(Pixel { ray, rgba: counted.value });
        };
        if cone.order == ConeOrder::FrontToBack {
            let at = |depth: usize| Segment {
                ray: geometry.ray_in_slot(plane, slot, depth),
                node: leaf(&input.at(depth), cone, words),
            };
            let rays = in_order(geometry.size[2], at, cone.mode, words);
            rays.into_iter().for_each(|Segment { ray, node }| send(ray, node));
        } else if let Some(lanes_of_slot) = &mut lanes.slot {
            lanes_of_slot.leaves(input);
            lanes.rays.of(plane, slot).for_each(|(ray, depths)| send(ray, lanes_of_slot.ray(depths)));
        } else {
            lanes.rays.of(plane, slot).for_each(|(ray, depths)| send(ray, tree(setup, depths, input, leaves)));
        }
    }
}

/// A ray, the samples of a slot from `range`, through the circle of leaves chunk by chunk; the chunks are combined in order.
fn tree(setup: &FrameSetup, range: Range<usize>, input: &ShadedSamples, leaves: &mut Vec<Node>) -> Node {
    let (cone, words) = (&setup.cone, &setup.words);
    let mut sum = Node::default();
    for chunk in range.start / cone.leaves..range.end.div_ceil(cone.leaves) {
        let start = chunk * cone.leaves;
        let depths = range.start.max(start)..range.end.min(start + cone.leaves);
        let first = depths.start - start;
        leaves.clear();
        leaves.extend(depths.map(|depth| leaf(&input.at(depth), cone, words)));
        sum = combine(cone.mode, sum, tree_of_ray(leaves, first, cone.mode, words), words);
    }
    sum
}

/// The rays of a slot, in order of depth, from the node of the leaf `at(depth)` at each depth: `node(left, right)` is what a node makes
/// of two stretches of a ray, called in the order of the cone's nodes.
#[inline]
pub fn segments(
    setup: &FrameSetup,
    plane: usize,
    slot: usize,
    at: impl Fn(usize) -> Node,
    node: &mut impl FnMut(Node, Node) -> Node,
) -> Vec<Segment> {
    let (cone, geometry) = (&setup.cone, &setup.geometry);
    let at = |depth: usize| Segment { ray: geometry.ray_in_slot(plane, slot, depth), node: at(depth) };
    if cone.order == ConeOrder::FrontToBack {
        return in_order_by(geometry.size[2], at, node);
    }
    let mut rays: Vec<Segment> = Vec::new();
    for chunk in (0..geometry.size[2]).step_by(cone.leaves) {
        let of = |place: usize| place_of_circle(setup, [plane, slot, chunk], place, at);
        let part = circle_by(cone.leaves, slot % cone.leaves, of, node);
        if rays.is_empty() {
            rays = part;
        } else {
            join_by(&mut rays, part, node);
        }
    }
    rays
}

/// What leaf `place` of the circle has of the chunk from depth `chunk` on: the depth that is skewed to it; places beyond the ray have
/// nothing, of the ray at the slot's last depth.
#[inline]
pub fn place_of_circle(
    setup: &FrameSetup,
    [plane, slot, chunk]: [usize; 3],
    place: usize,
    at: impl Fn(usize) -> Segment,
) -> Segment {
    let (leaves, depths) = (setup.cone.leaves, setup.geometry.size[2]);
    let depth = chunk + (place + leaves - slot % leaves) % leaves;
    if depth < depths {
        at(depth)
    } else {
        Segment { ray: setup.geometry.ray_in_slot(plane, slot, depths - 1), node: Node::default() }
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
        frames: &[impl Borrow<FrameSetup>],
        shaded: &mut Channel<ShadedRay<R::Input>>,
        pixels: &mut Channel<PixelGroup<R::Output>>,
    ) -> Activity {
        let activity = self.step(frames, shaded, pixels);
        self.account.record(activity)
    }

    #[inline]
    fn step(
        &mut self,
        frames: &[impl Borrow<FrameSetup>],
        shaded: &mut Channel<ShadedRay<R::Input>>,
        pixels: &mut Channel<PixelGroup<R::Output>>,
    ) -> Activity {
        let Some(ray) = shaded.front() else {
            return shaded.lack();
        };
        let frame = ray.frame as usize;
        if self.state.spent + 1 < self.specs[frame].ray_cycles {
            self.state.spent += 1;
            return Activity::Busy;
        }
        let Some(output) = pixels.push_slot_later(self.specs[frame].extra_latency()) else {
            return Activity::Blocked;
        };
        output.frame = ray.frame;
        output.plane = ray.plane;
        output.slot = ray.slot;
        self.arithmetic.reduce(frames[frame].borrow(), [ray.frame, ray.plane, ray.slot], &ray.data, &mut output.data);
        shaded.pop_slot();
        self.state.spent = 0;
        Activity::Busy
    }

    /// The data sheet of each frame.
    pub fn specs(&self) -> &[ConeSpec] {
        &self.specs
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

impl Archived for Reducer {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let Reducer { overflows, leaves: _, frame: _ } = self;
        archive.item(overflows)
    }
}

impl<R: Archived> Archived for ConeUnit<R> {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let ConeUnit { specs: _, arithmetic, state, account } = self;
        archive.item(state)?;
        archive.item(account)?;
        arithmetic.archive(archive)
    }
}
