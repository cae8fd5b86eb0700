//! The machine's end of the host link: pixels are taken and put into the base plane.
//!
//! ```text
//!   [pixels] ──► link, so many bytes a cycle ──► base plane
//! ```
//! The channel is the link's pixel FIFO: while its pixels wait, it fills, and the units before it stop one after another.

use cube3_channel::{Account, Activity, Archive, ArchiveError, Archived, Channel, ClockDomain, Reason, TokenTransfer};
use cube3_cone::{PixelCounts, PixelGroup, Pixels};
use cube3_frame::{BasePlane, FrameSetup, Schedule};
use cube3_machine::MachineSpec;
use serde::{Deserialize, Serialize};
use std::borrow::Borrow;

/// What the host does with pixels.
pub trait Collect: Archived {
    /// What pixel groups carry.
    type Input: Default;

    /// Takes the pixels of a slot.
    fn collect(&mut self, setup: &FrameSetup, pixels: &Self::Input);
}

/// A host for timing alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoHost;

impl Collect for NoHost {
    type Input = ();

    #[inline(always)]
    fn collect(&mut self, _: &FrameSetup, _: &()) {}
}

impl Archived for NoHost {
    fn archive(&mut self, _: &mut Archive<'_>) -> Result<(), ArchiveError> {
        Ok(())
    }
}

/// A host that keeps the base plane.
#[derive(Clone, Debug)]
pub struct Collector {
    /// The base plane so far.
    pub base: BasePlane,
}

impl Collect for Collector {
    type Input = Pixels;

    fn collect(&mut self, setup: &FrameSetup, pixels: &Pixels) {
        for pixel in &pixels.0 {
            let [column, row] = setup.geometry.pixel(pixel.ray);
            self.base.pixels[row * self.base.width + column] = pixel.rgba;
        }
    }
}

/// The host's port.
#[derive(Clone, Debug)]
pub struct HostPort<C> {
    frames: Vec<HostFrame<C>>,
    state: State,
    account: Account,
}

/// A frame at the host.
#[derive(Clone, Debug)]
struct HostFrame<C> {
    collector: C,
    schedule: Schedule,
    /// Pixels of each slot.
    pixels: PixelCounts,
    /// Bytes of a pixel.
    pixel_bytes: u64,
}

/// Components of a pixel: red, green, blue, opacity.
const COMPONENTS: u64 = 4;

/// What has gone to the host in the frames that it has received whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct HostCounters {
    /// Pixels.
    pub pixels: u64,
    /// Bytes.
    pub bytes: u64,
}

/// What has arrived.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    /// Frame that is arriving.
    frame: u32,
    /// Slots of that frame.
    arrived: u64,
    /// Slots of all frames.
    total: u64,
    /// Cycles spent on the group in hand.
    spent: u64,
    /// The link, where it has a rate.
    link: Option<TokenTransfer>,
}

impl<C: Collect> HostPort<C> {
    /// The port's name.
    pub const NAME: &'static str = "host";

    /// A port at which nothing has arrived: for each frame, its registers, its schedule and what takes its pixels.
    pub fn new<'a>(
        machine: &MachineSpec,
        frames: impl IntoIterator<Item = (&'a FrameSetup, Schedule, C)>,
    ) -> HostPort<C> {
        let frame = |(setup, schedule, collector): (&FrameSetup, Schedule, C)| HostFrame {
            collector,
            schedule,
            pixels: PixelCounts::new(&setup.geometry, schedule),
            pixel_bytes: COMPONENTS * u64::from(setup.words.accumulator_bits.div_ceil(8)),
        };
        let link = machine.host_link.bytes_per_cycle.map(|rate| TokenTransfer::new(ClockDomain::from_rate(rate)));
        HostPort {
            frames: frames.into_iter().map(frame).collect(),
            state: State { link, ..State::default() },
            account: Account::default(),
        }
    }

    /// One cycle. `frames` are the registers of all frames.
    #[inline]
    pub fn tick(&mut self, frames: &[impl Borrow<FrameSetup>], pixels: &mut Channel<PixelGroup<C::Input>>) -> Activity {
        let activity = self.step(frames, pixels);
        self.account.record(activity)
    }

    #[inline]
    fn step(&mut self, frames: &[impl Borrow<FrameSetup>], pixels: &mut Channel<PixelGroup<C::Input>>) -> Activity {
        let Some(group) = pixels.front() else {
            if let Some(link) = &mut self.state.link {
                link.rest();
            }
            return Activity::Starved;
        };
        let frame = &mut self.frames[group.frame as usize];
        let activity = if self.state.spent == 0 { Activity::Busy } else { Activity::Waiting(Reason::Host) };
        if let Some(link) = &mut self.state.link {
            let bytes = frame.pixels.of(group.plane as usize, group.slot as usize) * frame.pixel_bytes;
            if !link.completes(bytes) {
                link.carry();
                self.state.spent += 1;
                return activity;
            }
            link.finish(bytes);
            self.state.spent = 0;
        }
        frame.collector.collect(frames[group.frame as usize].borrow(), &group.data);
        pixels.pop_slot();
        self.state.arrived += 1;
        self.state.total += 1;
        if self.state.arrived == frame.schedule.ray_slots() {
            self.state.arrived = 0;
            self.state.frame += 1;
        }
        activity
    }

    /// What has gone to the host.
    pub fn counters(&self) -> HostCounters {
        let mut counters = HostCounters::default();
        for frame in &self.frames[..self.state.frame as usize] {
            let pixels = frame.pixels.total();
            counters.pixels += pixels;
            counters.bytes += pixels * frame.pixel_bytes;
        }
        counters
    }

    /// Frames received whole.
    #[inline]
    pub fn frames_done(&self) -> u32 {
        self.state.frame
    }

    /// Slots received, over all frames.
    pub fn received(&self) -> u64 {
        self.state.total
    }

    /// What the port did with its cycles.
    pub fn account(&self) -> &Account {
        &self.account
    }

    /// What has been collected, frame by frame.
    pub fn into_collectors(self) -> impl Iterator<Item = C> {
        self.frames.into_iter().map(|frame| frame.collector)
    }
}

impl Archived for Collector {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let BasePlane { width: _, height: _, bits: _, pixels } = &mut self.base;
        archive.list(pixels)
    }
}

impl<C: Archived> Archived for HostPort<C> {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let HostPort { frames, state, account } = self;
        archive.item(state)?;
        archive.item(account)?;
        frames
            .iter_mut()
            .try_for_each(|HostFrame { collector, schedule: _, pixels: _, pixel_bytes: _ }| collector.archive(archive))
    }
}
