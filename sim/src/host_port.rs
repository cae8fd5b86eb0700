//! The machine's end of the host link: pixels are taken and put into the base plane.

use cube3_channel::{Account, Activity, Channel};
use cube3_cone::{PixelGroup, Pixels};
use cube3_host::{BasePlane, FrameSetup};
use serde::{Deserialize, Serialize};

/// What the host does with pixels.
pub trait Collect {
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
    /// Slots of the frame.
    slots: u64,
}

/// What has arrived.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    /// Frame that is arriving.
    frame: u32,
    /// Slots of that frame.
    received: u64,
    /// Slots of all frames.
    total: u64,
}

impl<C: Collect> HostPort<C> {
    /// The port's name.
    pub const NAME: &'static str = "host";

    /// A port at which nothing has arrived: for each frame, its slots and what takes them.
    pub fn new(frames: impl IntoIterator<Item = (u64, C)>) -> HostPort<C> {
        let frames = frames.into_iter().map(|(slots, collector)| HostFrame { collector, slots }).collect();
        HostPort { frames, state: State::default(), account: Account::default() }
    }

    /// One cycle. `frames` are the registers of all frames.
    #[inline]
    pub fn tick(&mut self, frames: &[FrameSetup], pixels: &mut Channel<PixelGroup<C::Input>>) -> Activity {
        let activity = match pixels.pop_slot() {
            Some(group) => {
                let frame = &mut self.frames[group.frame as usize];
                frame.collector.collect(&frames[group.frame as usize], &group.data);
                self.state.received += 1;
                self.state.total += 1;
                if self.state.received == frame.slots {
                    self.state.received = 0;
                    self.state.frame += 1;
                }
                Activity::Busy
            }
            None => Activity::Starved,
        };
        self.account.record(activity)
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
