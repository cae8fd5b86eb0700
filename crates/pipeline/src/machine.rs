//! The machine put together.
//!
//! ```text
//!   cfb ─[beams]─► bus ─[aligned]─► dsb ─[rays]─► trilin ─[samples]─► abc ─[shaded]─► cone ─[pixels]─► host
//! ```

use crate::fidelity::Fidelity;
use crate::host_port::HostPort;
use crate::links::{RayWords, Traffic};
use crate::token::TokenKind;
use cube3_abc::{AbcUnit, Shade, ShadedRay};
use cube3_cfb::{AcquisitionPort, Beam, CfbUnit, Fetch, PortSpec};
use cube3_channel::{Account, Channel, Deadlock};
use cube3_cone::{ConeUnit, PixelGroup, Reduce};
use cube3_dsb::bus::{Align, BusUnit};
use cube3_dsb::{DsbUnit, RayPair, Store};
use cube3_frame::{FrameSetup, Schedule};
use cube3_trilin::{Interpolate, SampleRay, TrilinUnit};
use std::sync::Arc;

/// Units of a machine, a unit with two ports counted twice.
pub const UNITS: usize = 8;
/// Channels of a machine.
pub const CHANNELS: usize = 6;

/// A channel's place in the machine. [`Machine::JOINTS`] is the one list of them: reports, traces, drawings and the search for a
/// deadlock follow it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Joint {
    /// The channel's name.
    pub channel: &'static str,
    /// The unit that pushes.
    pub from: &'static str,
    /// The unit that pops.
    pub to: &'static str,
    /// What its tokens are.
    pub tokens: TokenKind,
}

/// A machine with the registers of the frames that it is to render, one after another.
pub struct Machine<F: Fidelity> {
    pub(crate) frames: Vec<Arc<FrameSetup>>,
    pub(crate) schedules: Vec<Schedule>,
    /// Ray slots of all frames.
    pub(crate) slots: u64,
    pub(crate) overlap: bool,
    /// Words of the rays of each frame on the links between boards.
    pub(crate) ray_words: Vec<RayWords>,
    /// The links, where there are several boards.
    pub(crate) traffic: Option<Traffic>,
    pub(crate) cfb: CfbUnit<F::Cfb>,
    pub(crate) bus: BusUnit<F::Bus>,
    pub(crate) dsb: DsbUnit<F::Dsb>,
    pub(crate) trilin: TrilinUnit<F::Trilin>,
    pub(crate) abc: AbcUnit<F::Abc>,
    pub(crate) cone: ConeUnit<F::Cone>,
    pub(crate) host: HostPort<F::Host>,
    pub(crate) beams: Channel<Beam<<F::Cfb as Fetch>::Output>>,
    pub(crate) aligned: Channel<Beam<<F::Bus as Align>::Output>>,
    pub(crate) rays: Channel<RayPair<<F::Dsb as Store>::Output>>,
    pub(crate) samples: Channel<SampleRay<<F::Trilin as Interpolate>::Output>>,
    pub(crate) shaded: Channel<ShadedRay<<F::Abc as Shade>::Output>>,
    pub(crate) pixels: Channel<PixelGroup<<F::Cone as Reduce>::Output>>,
    pub(crate) cycle: u64,
    pub(crate) last_move: u64,
    pub(crate) frame_ends: Vec<u64>,
}

impl<F: Fidelity> Machine<F> {
    /// The units' names, in pipeline order.
    pub const UNITS: [&'static str; UNITS] = [
        CfbUnit::<F::Cfb>::NAME,
        BusUnit::<F::Bus>::NAME,
        DsbUnit::<F::Dsb>::WRITE,
        DsbUnit::<F::Dsb>::READ,
        TrilinUnit::<F::Trilin>::NAME,
        AbcUnit::<F::Abc>::NAME,
        ConeUnit::<F::Cone>::NAME,
        HostPort::<F::Host>::NAME,
    ];

    /// The channels, in pipeline order.
    pub const JOINTS: [Joint; CHANNELS] = {
        let [cfb, bus, write, read, trilin, abc, cone, host] = Self::UNITS;
        let (beam, ray) = (TokenKind::Beam, TokenKind::Ray);
        [
            Joint { channel: "beams", from: cfb, to: bus, tokens: beam },
            Joint { channel: "aligned", from: bus, to: write, tokens: beam },
            Joint { channel: "rays", from: read, to: trilin, tokens: ray },
            Joint { channel: "samples", from: trilin, to: abc, tokens: ray },
            Joint { channel: "shaded", from: abc, to: cone, tokens: ray },
            Joint { channel: "pixels", from: cone, to: host, tokens: ray },
        ]
    };

    /// Lets volumes come in through a port while frames are read.
    pub fn acquire(&mut self, port: PortSpec) {
        self.cfb.acquire(port);
    }

    /// Sets the frames that begin a picture, in order, where a picture has several: a double buffer changes roles before these alone.
    pub fn begin_pictures(&mut self, frames: Vec<u32>) {
        self.cfb.begin_pictures(frames);
    }

    /// The port that volumes come in through, where there is one.
    pub fn port(&self) -> Option<&AcquisitionPort> {
        self.cfb.port()
    }

    /// One cycle. Every unit ticks, each with the channels at its ends; then every channel commits. Whether a unit was active.
    #[inline(always)]
    fn tick(&mut self) -> bool {
        let frames = &self.frames;
        let released = if self.overlap { u32::MAX } else { self.host.frames_done() + 1 };
        let host = self.host.tick(frames, &mut self.pixels);
        let cone = self.cone.tick(frames, &mut self.shaded, &mut self.pixels);
        let abc = self.abc.tick(frames, &mut self.samples, &mut self.shaded);
        let trilin = self.trilin.tick(frames, &mut self.rays, &mut self.samples);
        let [write, read] = self.dsb.tick(&mut self.aligned, &mut self.rays);
        let links = self.traffic.as_ref().map(Traffic::links);
        let bus = self.bus.tick(frames, &mut self.beams, &mut self.aligned, links);
        let cfb = self.cfb.tick(frames, released, &mut self.beams);
        self.commit();
        if self.host.frames_done() as usize > self.frame_ends.len() {
            self.frame_ends.push(self.cycle);
        }
        cfb.is_active()
            || bus.is_active()
            || write.is_active()
            || read.is_active()
            || trilin.is_active()
            || abc.is_active()
            || cone.is_active()
            || host.is_active()
    }

    /// Cycles that tokens of each frame take longer in a channel than its latency: those of a cone that turns.
    pub fn extra_latency(&self, joint: Joint) -> Vec<u64> {
        if joint.from != ConeUnit::<F::Cone>::NAME {
            return vec![0; self.frames.len()];
        }
        self.cone.specs().iter().map(|spec| spec.extra_latency()).collect()
    }

    /// Cycles so far.
    pub fn now(&self) -> u64 {
        self.cycle
    }

    #[inline]
    fn commit(&mut self) {
        let Machine { traffic, bus, aligned, rays, samples, shaded, .. } = self;
        if let Some(traffic) = traffic {
            traffic.end_cycle(bus.sent(), aligned, rays, samples, shaded);
        }
        self.beams.commit();
        self.aligned.commit();
        self.rays.commit();
        self.samples.commit();
        self.shaded.commit();
        self.pixels.commit();
        self.cycle += 1;
    }

    /// Ray slots of all frames.
    pub(crate) fn ray_slots(&self) -> u64 {
        self.slots
    }

    /// Runs the frames; `progress(done, all)` is called now and then with the slots at the host.
    ///
    /// # Errors
    /// A machine that cannot move; nothing has been waited for longer than the longest channel latency.
    pub fn run(&mut self, progress: &dyn Fn(u64, u64)) -> Result<(), Deadlock> {
        self.run_until(u64::MAX, progress).map(|_| ())
    }

    /// Runs on to the last pixel, or until `stop` cycles have passed since the start of the run. Whether the last pixel has come.
    ///
    /// # Errors
    /// As [`Machine::run`].
    pub fn run_until(&mut self, stop: u64, progress: &dyn Fn(u64, u64)) -> Result<bool, Deadlock> {
        let all = self.ray_slots();
        while self.host.received() < all {
            if self.cycle >= stop {
                return Ok(false);
            }
            if self.tick() {
                self.last_move = self.cycle;
            } else if !self.in_flight() {
                return Err(self.deadlock());
            }
            if self.cycle.is_multiple_of(8192) {
                progress(self.host.received(), all);
            }
        }
        progress(all, all);
        Ok(true)
    }

    fn in_flight(&self) -> bool {
        self.beams.in_flight()
            || self.aligned.in_flight()
            || self.rays.in_flight()
            || self.samples.in_flight()
            || self.shaded.in_flight()
            || self.pixels.in_flight()
    }

    /// What each unit did with its cycles, in the order of [`Machine::UNITS`].
    #[inline]
    pub fn accounts(&self) -> [&Account; UNITS] {
        let [write, read] = self.dsb.accounts();
        [
            self.cfb.account(),
            self.bus.account(),
            write,
            read,
            self.trilin.account(),
            self.abc.account(),
            self.cone.account(),
            self.host.account(),
        ]
    }
}
