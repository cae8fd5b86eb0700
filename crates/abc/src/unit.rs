//! The ABC units on their channels: rays of samples in, rays of coloured samples out, a plane and a ray later.
//!
//! ```text
//!   [samples] ──► ring of planes (and the first two) ──► 3 × 3 rays ──► gradient, table, light ──► [shaded]
//! ```
//! A ray is shaded when its neighbours in the planes above and below have come, in near frames several planes away. Where slots are shared, the last
//! plane's neighbour is the first, so the first is shaded last; rays of a plane likewise. Without a gradient,
//! rays pass straight through.
//!
//! Where the slots of a plane are taken in sections, planes of the ring are those of one section. The last two rays of a section, which the
//! next one needs beside its own, go to an overlap buffer with two for every plane; so do the first two of the plane where slots are shared.

use crate::lanes::reads;
use cube3_channel::{Account, Activity, Archive, ArchiveError, Archived, Channel, Payload, PortState, Wait};
use cube3_frame::{FrameSetup, Schedule, ShadingOrder};
use cube3_machine::{GradientMethod, MachineSpec};
use cube3_trilin::SampleRay;
use serde::{Deserialize, Serialize};
use std::borrow::Borrow;
use std::ops::Range;

/// A slot of coloured samples.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ShadedRay<D> {
    /// Frame, from 0.
    pub frame: u32,
    /// Plane of ray slots.
    pub plane: u32,
    /// Ray slot.
    pub slot: u32,
    /// The samples.
    pub data: D,
}

/// The ABC units' arithmetic, or nothing where only time counts.
pub trait Shade: Archived {
    /// What rays of samples carry.
    type Input: Default;
    /// What rays of coloured samples carry.
    type Output: Payload;

    /// An empty ray with memory for the coloured samples of one.
    fn blank(&self) -> Self::Output;

    /// Takes the next ray of a plane.
    fn take(&mut self, setup: &FrameSetup, ray: &mut SampleRay<Self::Input>);

    /// Shades a slot whose neighbours have all been taken.
    fn give(&mut self, setup: &FrameSetup, plane: usize, slot: usize, output: &mut Self::Output);
}

/// ABC units for timing alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoShading;

impl Shade for NoShading {
    type Input = ();
    type Output = ();

    fn blank(&self) {}

    #[inline(always)]
    fn take(&mut self, _: &FrameSetup, _: &mut SampleRay<()>) {}

    #[inline(always)]
    fn give(&mut self, _: &FrameSetup, _: usize, _: usize, _: &mut ()) {}
}

impl Archived for NoShading {
    fn archive(&mut self, _: &mut Archive<'_>) -> Result<(), ArchiveError> {
        Ok(())
    }
}

/// How many lanes away the samples are that a gradient method reads where neighbours are `rays` rays away: a ray along u and a step along w are a
/// lane each. `against` is whether the ray runs against u, so that it is shaded in the mirror.
pub fn reach(method: GradientMethod, rays: usize, against: bool) -> usize {
    let steps = [-1_i64, 0, 1];
    let all = steps.into_iter().flat_map(|u| steps.into_iter().flat_map(move |v| steps.map(|w| [u, v, w])));
    let along = if against { -(rays as i64) } else { rays as i64 };
    all.filter(|by| reads(method, *by)).map(|by| (by[0] * along + by[2]).unsigned_abs() as usize).max().unwrap_or(0)
}

/// The farthest of them for any ray of a frame; 0 where it needs no gradient.
pub fn frame_reach(setup: &FrameSetup) -> usize {
    let Some(registers) = &setup.gradient else {
        return 0;
    };
    let slopes = setup.geometry.perspective.as_ref().map_or(&[0][..], |pass| &pass.u.slopes);
    let runs = [false, true].into_iter().filter(|&against| slopes.iter().any(|&slope| (slope < 0) == against));
    runs.map(|against| reach(registers.method, setup.most_reach(), against)).max().unwrap_or(0)
}

/// Data sheet of the ABC units for one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AbcSpec {
    /// The order of the rays that come and of those that are shaded, and what these wait for.
    pub order: ShadingOrder,
    /// Planes of samples in the ring: above, current, below, and those that come in.
    pub ring: u64,
}

impl AbcSpec {
    /// The data sheet for a machine and the registers of a frame, which has this schedule there.
    pub fn new(machine: &MachineSpec, setup: &FrameSetup, schedule: &Schedule) -> AbcSpec {
        AbcSpec { order: setup.shading_order(schedule), ring: setup.ring(machine.abc.planes) as u64 }
    }
}

/// The ABC unit.
#[derive(Clone, Debug)]
pub struct AbcUnit<A> {
    frames: Vec<(AbcSpec, A)>,
    passes: Vec<Pass>,
    state: State,
    /// Planes of the pass that is taken for which the ring has a buffer, as `state` says.
    room: u64,
    account: Account,
}

/// A section of a frame with rays in it.
#[derive(Clone, Debug)]
struct Pass {
    frame: u32,
    /// Slots that come, and that are shaded in the order in which they are.
    taken: Range<u64>,
    given: Range<u64>,
    /// Rays and planes of the passes before.
    rays: u64,
    planes: u64,
}

/// Where the two ports are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    /// Rays taken, over all frames, and the pass of the next.
    taken: u64,
    taking: u32,
    /// Pass that is being given.
    giving: u32,
    /// Plane and slot of the next given of that pass, counted in the order in which they are.
    next: [u64; 2],
    take_spent: u64,
    give_spent: u64,
}

impl<A> AbcUnit<A> {
    /// Finds for which planes of the pass that is being taken the ring has a buffer: the plane above the one being shaded is still needed. The
    /// buffers of first planes serve two passes, the one being shaded and the next.
    fn look(&mut self) {
        let State { taking, giving, next, .. } = self.state;
        self.room = match (self.passes.get(giving as usize), self.passes.get(taking as usize)) {
            (None, _) => u64::MAX,
            (_, None) => 0,
            _ if taking > giving + 1 => 0,
            (Some(giving), Some(taking)) => {
                let spec = &self.frames[giving.frame as usize].0;
                let behind = giving.planes + spec.order.oldest(next[0]) + spec.ring;
                let room = behind.saturating_sub(taking.planes);
                // The next frame's ring may be the smaller one: its neighbours may be nearer.
                let other = taking.frame != giving.frame;
                if other { room.min(self.frames[taking.frame as usize].0.ring) } else { room }
            }
        };
    }
}

impl<A: Shade> AbcUnit<A> {
    /// The unit's name.
    pub const NAME: &'static str = "abc";

    /// Units at the start of the first frame: a data sheet and the arithmetic for each.
    pub fn new(parts: impl IntoIterator<Item = (AbcSpec, A)>) -> AbcUnit<A> {
        let frames: Vec<(AbcSpec, A)> = parts.into_iter().collect();
        let (mut passes, mut rays, mut planes) = (Vec::new(), 0, 0);
        for (frame, (AbcSpec { order, .. }, _)) in (0..).zip(&frames) {
            for section in 0..order.sections().count() {
                let taken = order.taken(section);
                let width = taken.end - taken.start;
                if width > 0 {
                    passes.push(Pass { frame, taken, given: order.given(section), rays, planes });
                    rays += width * order.planes();
                    planes += order.planes();
                }
            }
        }
        let mut unit = AbcUnit { frames, passes, state: State::default(), room: 0, account: Account::default() };
        unit.aim();
        unit
    }

    /// Goes on to the next pass in which slots are shaded: narrow sections at a frame's start have none yet.
    fn aim(&mut self) {
        while let Some(pass) = self.passes.get(self.state.giving as usize) {
            self.state.next = [0, pass.given.start];
            if !pass.given.is_empty() {
                break;
            }
            self.state.giving += 1;
        }
        self.look();
    }

    /// One cycle: a ray is taken and a ray is given, at most. `frames` are the registers of all frames.
    #[inline]
    pub fn tick(
        &mut self,
        frames: &[impl Borrow<FrameSetup>],
        samples: &mut Channel<SampleRay<A::Input>>,
        shaded: &mut Channel<ShadedRay<A::Output>>,
    ) -> Activity {
        let taken = self.take(frames, samples);
        let given = self.give(frames, shaded);
        let activity = match (taken, given) {
            (Activity::Busy, _) | (_, Activity::Busy) => Activity::Busy,
            (Activity::Blocked, _) | (_, Activity::Blocked) => Activity::Blocked,
            (Activity::Starved, given) => given,
            (taken, _) => taken,
        };
        self.account.record(activity)
    }

    #[inline]
    fn take(&mut self, frames: &[impl Borrow<FrameSetup>], samples: &mut Channel<SampleRay<A::Input>>) -> Activity {
        let Some(ray) = samples.front() else {
            return samples.lack();
        };
        if u64::from(ray.plane) >= self.room {
            return Activity::Blocked;
        }
        let frame = ray.frame as usize;
        let (spec, arithmetic) = &mut self.frames[frame];
        if self.state.take_spent + 1 < spec.order.schedule().ray_cycles() {
            self.state.take_spent += 1;
            return Activity::Busy;
        }
        if let Some(ray) = samples.pop_slot() {
            arithmetic.take(frames[frame].borrow(), ray);
        }
        self.state.take_spent = 0;
        self.state.taken += 1;
        let behind = self.passes.get(self.state.taking as usize + 1);
        if behind.is_some_and(|behind| behind.rays == self.state.taken) {
            self.state.taking += 1;
            self.look();
        }
        Activity::Busy
    }

    #[inline]
    fn give(&mut self, frames: &[impl Borrow<FrameSetup>], shaded: &mut Channel<ShadedRay<A::Output>>) -> Activity {
        let Some(pass) = self.passes.get(self.state.giving as usize) else {
            return Activity::Starved;
        };
        let (spec, arithmetic) = &mut self.frames[pass.frame as usize];
        let order = &spec.order;
        let [plane, slot] = order.turned(self.state.next);
        let last = order.last([plane, slot]);
        if self.state.taken <= pass.rays + order.rays_before(&pass.taken, last) {
            return Activity::Starved;
        }
        if self.state.give_spent + 1 < order.schedule().ray_cycles() {
            self.state.give_spent += 1;
            return Activity::Busy;
        }
        let Some(output) = shaded.push_slot() else {
            return shaded.refusal();
        };
        output.frame = pass.frame;
        output.plane = plane as u32;
        output.slot = slot as u32;
        let setup = frames[pass.frame as usize].borrow();
        arithmetic.give(setup, plane as usize, slot as usize, &mut output.data);
        self.state.give_spent = 0;
        let [plane, slot] = &mut self.state.next;
        *slot += 1;
        if *slot == pass.given.end {
            (*plane, *slot) = (*plane + 1, pass.given.start);
            if *plane == order.planes() {
                self.state.giving += 1;
                self.aim();
            } else {
                self.look();
            }
        }
        Activity::Busy
    }

    /// Whether every ray of every frame has been given.
    pub fn done(&self) -> bool {
        self.state.giving as usize == self.passes.len()
    }

    /// What stops the unit inside, when nothing moves.
    pub fn inner_wait(&self, samples: &Channel<SampleRay<A::Input>>) -> Option<Wait> {
        let ray = samples.front()?;
        if u64::from(ray.plane) < self.room {
            return None;
        }
        let pass = self.passes.get(self.state.giving as usize)?;
        let AbcSpec { order, ring, .. } = &self.frames[pass.frame as usize].0;
        let last = order.last(order.turned(self.state.next));
        // Where the next ray to be given still lacks a neighbour, the unit waits for itself: the ring is too small.
        let lacks = self.state.taken <= pass.rays + order.rays_before(&pass.taken, last);
        Some(Wait {
            unit: Self::NAME,
            port: "sample planes".into(),
            state: PortState::Full,
            occupancy: *ring as usize,
            capacity: *ring as usize,
            upon: if lacks { Self::NAME } else { "cone" },
        })
    }

    /// The arithmetic of each frame, to ask what it counted.
    pub fn arithmetic(&self) -> impl Iterator<Item = &A> {
        self.frames.iter().map(|(_, arithmetic)| arithmetic)
    }

    /// What the unit did with its cycles.
    pub fn account(&self) -> &Account {
        &self.account
    }
}

impl<A: Archived> Archived for AbcUnit<A> {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let AbcUnit { frames, passes: _, state, room: _, account } = self;
        archive.item(state)?;
        archive.item(account)?;
        frames.iter_mut().try_for_each(|(_, arithmetic)| arithmetic.archive(archive))?;
        self.look();
        Ok(())
    }
}
