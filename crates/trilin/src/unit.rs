//! The interpolators on their channels: a pair of discrete rays in, a ray of samples out.
//!
//! ```text
//!   [rays] ──► ray j of planes i, i+1 ──► with ray j−1 ──► [samples] of ray j−1
//! ```
//! Ray j of a plane is finished by ray j+1. The last ray of a plane is finished by the first where slots are
//! shared, which is kept for it, and by nothing where they are not; it leaves while the next plane begins.
//!
//! Where the slots of a plane are taken in sections, the ray before a section's first is the last of the section before in the same plane:
//! it comes from an overlap buffer, which has one for every plane, and so does the first ray of each plane where slots are shared.

use cube3_channel::{Account, Activity, Archive, ArchiveError, Archived, Channel, Payload};
use cube3_dsb::RayPair;
use cube3_frame::{FrameSetup, Schedule};
use serde::{Deserialize, Serialize};
use std::borrow::Borrow;

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

/// The interpolators' arithmetic, or nothing where only time counts.
pub trait Interpolate: Archived {
    /// What ray pairs carry.
    type Input: Default;
    /// What rays of samples carry.
    type Output: Payload;

    /// An empty ray with memory for the samples of one.
    fn blank(&self) -> Self::Output;

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

    fn blank(&self) {}

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

/// The interpolation unit.
#[derive(Clone, Debug)]
pub struct TrilinUnit<I> {
    /// Schedule and arithmetic of each frame.
    frames: Vec<(Schedule, I)>,
    state: State,
    account: Account,
}

/// Where the unit is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    /// Cycles spent on the last ray of a plane, or on the pair at the input.
    spent: u64,
    /// Frame and plane whose last ray has been taken and not given.
    closing: Option<[u32; 2]>,
    given: u64,
}

impl<I: Interpolate> TrilinUnit<I> {
    /// The unit's name.
    pub const NAME: &'static str = "trilin";

    /// Interpolators at the start of the first frame: the schedule and the arithmetic for each.
    pub fn new(parts: impl IntoIterator<Item = (Schedule, I)>) -> TrilinUnit<I> {
        TrilinUnit { frames: parts.into_iter().collect(), state: State::default(), account: Account::default() }
    }

    /// One cycle. `frames` are the registers of all frames.
    #[inline]
    pub fn tick(
        &mut self,
        frames: &[impl Borrow<FrameSetup>],
        rays: &mut Channel<RayPair<I::Input>>,
        samples: &mut Channel<SampleRay<I::Output>>,
    ) -> Activity {
        let activity = self.step(frames, rays, samples);
        self.account.record(activity)
    }

    #[inline]
    fn step(
        &mut self,
        frames: &[impl Borrow<FrameSetup>],
        rays: &mut Channel<RayPair<I::Input>>,
        samples: &mut Channel<SampleRay<I::Output>>,
    ) -> Activity {
        let mut activity = Activity::Starved;
        if let Some([frame, plane]) = self.state.closing {
            let (schedule, _) = &self.frames[frame as usize];
            // Where there are sections, the section's first pair of the next plane finishes a ray, too: the last ray of a plane then takes the
            // cycles of a ray for itself.
            let whole = schedule.sections().is_whole();
            if !whole && self.state.spent + 1 < schedule.ray_cycles() {
                self.state.spent += 1;
                return Activity::Busy;
            }
            let Some(output) = samples.push_slot() else {
                return samples.refusal();
            };
            self.state.closing = None;
            let last = schedule.shape().slots as u32 - 1;
            self.give(frames, [frame, plane, last], output);
            activity = Activity::Busy;
            if !whole {
                self.state.spent = 0;
                return activity;
            }
        }
        let Some(pair) = rays.front() else {
            return if activity == Activity::Starved { rays.lack() } else { activity };
        };
        let (frame, plane, slot) = (pair.frame, pair.plane, pair.slot);
        let (schedule, arithmetic) = &mut self.frames[frame as usize];
        if self.state.spent + 1 < schedule.ray_cycles() {
            self.state.spent += 1;
            return Activity::Busy;
        }
        if slot > 0 && !samples.can_push() {
            return samples.refusal();
        }
        let last = schedule.is_last_slot(slot);
        if let Some(pair) = rays.pop_slot() {
            arithmetic.take(frames[frame as usize].borrow(), pair);
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

    #[inline(always)]
    fn give(
        &mut self,
        frames: &[impl Borrow<FrameSetup>],
        [frame, plane, slot]: [u32; 3],
        output: &mut SampleRay<I::Output>,
    ) {
        output.frame = frame;
        output.plane = plane;
        output.slot = slot;
        let (_, arithmetic) = &mut self.frames[frame as usize];
        arithmetic.give(frames[frame as usize].borrow(), plane as usize, slot as usize, &mut output.data);
        self.state.given += 1;
    }

    /// Whether every ray of every frame has been given.
    pub fn done(&self) -> bool {
        self.state.given == self.frames.iter().map(|(schedule, _)| schedule.ray_slots()).sum::<u64>()
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

impl<I: Archived> Archived for TrilinUnit<I> {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let TrilinUnit { frames, state, account } = self;
        archive.item(state)?;
        archive.item(account)?;
        frames.iter_mut().try_for_each(|(_, arithmetic)| arithmetic.archive(archive))
    }
}
