//! The machine's end of the host link: pixels are taken and put into the base plane.

use cube3_channel::{Account, Activity, Channel};
use cube3_cone::{PixelGroup, Pixels};
use cube3_host::{BasePlane, FrameSetup};

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
    collector: C,
    received: u64,
    account: Account,
}

impl<C: Collect> HostPort<C> {
    /// The port's name.
    pub const NAME: &'static str = "host";

    /// A port at which nothing has arrived.
    pub fn new(collector: C) -> HostPort<C> {
        HostPort { collector, received: 0, account: Account::default() }
    }

    /// One cycle. Returns whether anything moved.
    #[inline]
    pub fn tick(&mut self, setup: &FrameSetup, pixels: &mut Channel<PixelGroup<C::Input>>) -> bool {
        let activity = match pixels.pop_slot() {
            Some(group) => {
                self.collector.collect(setup, &group.data);
                self.received += 1;
                Activity::Busy
            }
            None => Activity::Starved,
        };
        self.account.record(activity)
    }

    /// Slots received.
    pub fn received(&self) -> u64 {
        self.received
    }

    /// What the port did with its cycles.
    pub fn account(&self) -> &Account {
        &self.account
    }

    /// What has been collected.
    pub fn into_collector(self) -> C {
        self.collector
    }
}
