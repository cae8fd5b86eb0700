//! The machine put together.
//!
//! ```text
//!   cfb ─[beams]─► bus ─[aligned]─► dsb ─[rays]─► trilin ─[samples]─► abc ─[shaded]─► cone ─[pixels]─► host
//! ```

use crate::fidelity::{Cycle, Fidelity, Timing};
use crate::host_port::{Collector, HostCounters, HostPort, NoHost};
use crate::links::{RayWords, Traffic, channels};
use crate::token::{Token, TokenKind};
use cube3_abc::{AbcSpec, AbcUnit, NoShading, Shade, ShadedRay, ShadedSamples, Shader};
use cube3_cfb::golden::Skew;
use cube3_cfb::memory::{MemoryCounters, ReorderCounters, ReorderError, Supply};
use cube3_cfb::{AcquisitionPort, Beam, CfbSpec, CfbUnit, Fetch, FrameBuffer, FrameBufferError, NoVoxels, PortSpec};
use cube3_channel::{
    Account, Archive, ArchiveError, Archived, Channel, ChannelCounters, ChannelError, Deadlock, PortState, Wait,
    diagnose,
};
use cube3_cone::{ConeSpec, ConeUnit, NoPixels, PixelGroup, Pixels, Reduce, Reducer};
use cube3_dsb::bus::{Align, BusCounters, BusUnit, NoBus};
use cube3_dsb::{DsbSpec, DsbUnit, LinkReading, NoPlanes, PlaneStore, RayPair, Rotator, Store};
use cube3_frame::{BasePlane, FrameSetup, Overflows, Schedule};
use cube3_machine::{AcquisitionMode, ChannelSize, MachineSpec};
use cube3_trilin::{Interpolate, Interpolator, NoSamples, RaySamples, SampleRay, TrilinUnit};
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
    frames: Vec<Arc<FrameSetup>>,
    schedules: Vec<Schedule>,
    /// Ray slots of all frames.
    slots: u64,
    overlap: bool,
    /// Words of the rays of each frame on the links between boards.
    ray_words: Vec<RayWords>,
    /// The links, where there are several boards.
    traffic: Option<Traffic>,
    cfb: CfbUnit<F::Cfb>,
    bus: BusUnit<F::Bus>,
    dsb: DsbUnit<F::Dsb>,
    trilin: TrilinUnit<F::Trilin>,
    abc: AbcUnit<F::Abc>,
    cone: ConeUnit<F::Cone>,
    host: HostPort<F::Host>,
    beams: Channel<Beam<<F::Cfb as Fetch>::Output>>,
    aligned: Channel<Beam<<F::Bus as Align>::Output>>,
    rays: Channel<RayPair<<F::Dsb as Store>::Output>>,
    samples: Channel<SampleRay<<F::Trilin as Interpolate>::Output>>,
    shaded: Channel<ShadedRay<<F::Abc as Shade>::Output>>,
    pixels: Channel<PixelGroup<<F::Cone as Reduce>::Output>>,
    cycle: u64,
    last_move: u64,
    frame_ends: Vec<u64>,
}

/// Why a machine cannot be built or run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A channel of the machine file.
    #[error(transparent)]
    Channel(#[from] ChannelError),
    /// The frame buffer.
    #[error(transparent)]
    FrameBuffer(#[from] FrameBufferError),
    /// A reorder buffer that is too small.
    #[error(transparent)]
    Reorder(#[from] ReorderError),
    /// Nothing can move.
    #[error(transparent)]
    Deadlock(#[from] Deadlock),
}

/// What a run has counted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunCounters {
    /// Cycles from the first fetch to the last pixel.
    pub cycles: u64,
    /// Cycles from the first fetch to the last pixel of each frame.
    pub frame_ends: Vec<u64>,
    /// Beams read from the modules.
    pub beams: u64,
    /// Ray slots that went through the pipeline.
    pub ray_slots: u64,
    /// Cycles that the busier of the two sides needs for its tokens alone: beams in, or rays out.
    pub steady_cycles: u64,
    /// Each unit's name and account.
    pub units: Vec<(&'static str, Account)>,
    /// Each channel.
    pub channels: Vec<ChannelReading>,
    /// What the memory modules have done, by frame; nothing where they give any word in any cycle.
    pub memory: Vec<MemoryCounters>,
    /// What the reorder buffer behind them has done; nothing where they are read by beams.
    pub reorder: Option<ReorderCounters>,
    /// Words on the bus and on the links between boards.
    pub bus: BusCounters,
    /// Words of rays on those links, in the frames that the host has received whole.
    pub ray_words: RayWords,
    /// Each link between boards, forwards and backwards; nothing on one board.
    pub links: Vec<LinkReading>,
    /// Pixels and bytes to the host.
    pub host: HostCounters,
}

/// A channel at the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChannelReading {
    /// Name.
    pub name: &'static str,
    /// Its place.
    pub joint: Joint,
    /// Tokens that fit.
    pub capacity: usize,
    /// Cycles from push to pop.
    pub latency: u64,
    /// Tokens still there.
    pub occupancy: usize,
    /// Counters.
    pub counters: ChannelCounters,
}

/// A channel as it stands between two cycles.
struct Standing {
    reading: ChannelReading,
    /// Whether a token can be popped.
    arrived: bool,
    /// Whether a token can be pushed.
    room: bool,
}

impl Standing {
    fn of<T>(channel: &Channel<T>, joint: Joint) -> Standing {
        let reading = ChannelReading {
            name: channel.name(),
            joint,
            capacity: channel.capacity(),
            latency: channel.latency(),
            occupancy: channel.occupancy(),
            counters: channel.counters(),
        };
        Standing { reading, arrived: channel.front().is_some(), room: channel.can_push() }
    }

    /// Who waits for whom: a channel between two units is empty, full, or neither.
    fn wait(&self) -> Option<Wait> {
        let ChannelReading { name, joint, occupancy, capacity, .. } = self.reading;
        let (unit, state, upon) = match (self.arrived, self.room) {
            (false, _) => (joint.to, PortState::Empty, joint.from),
            (true, false) => (joint.from, PortState::Full, joint.to),
            (true, true) => return None,
        };
        Some(Wait { unit, port: name.to_owned(), state, occupancy, capacity, upon })
    }
}

/// The identity of a channel's token, of frames of these schedules.
trait Identified {
    fn token(&self, schedules: &[Schedule]) -> Token;
}

impl<D> Identified for Beam<D> {
    fn token(&self, schedules: &[Schedule]) -> Token {
        // Pieces of a beam come with their sections.
        let number = |schedule: &Schedule| schedule.plane_number(self.section, self.plane) as u32;
        let plane = schedules.get(self.frame as usize).map_or(self.plane, number);
        Token { frame: self.frame, plane, place: self.depth }
    }
}

macro_rules! ray_identity {
    ($($token:ident),*) => {
        $(impl<D> Identified for $token<D> {
            fn token(&self, _: &[Schedule]) -> Token {
                Token { frame: self.frame, plane: self.plane, place: self.slot }
            }
        })*
    };
}

ray_identity!(RayPair, SampleRay, ShadedRay, PixelGroup);

/// What a function says of each channel and the schedules, in the order of [`Machine::JOINTS`]. The channels are of six types.
macro_rules! of_channels {
    ($machine:expr, $of:ident) => {{
        let Machine { schedules, beams, aligned, rays, samples, shaded, pixels, .. } = $machine;
        [
            $of(beams, schedules),
            $of(aligned, schedules),
            $of(rays, schedules),
            $of(samples, schedules),
            $of(shaded, schedules),
            $of(pixels, schedules),
        ]
    }};
}

/// The arithmetic of a frame in each unit that keeps some between tokens, in pipeline order.
struct Parts<F: Fidelity> {
    dsb: F::Dsb,
    trilin: F::Trilin,
    abc: F::Abc,
    host: F::Host,
}

fn channel<T: Default>(name: &'static str, size: ChannelSize) -> Result<Channel<T>, ChannelError> {
    Channel::new(name, size.capacity, size.latency)
}

impl Machine<Timing> {
    /// A machine without data.
    ///
    /// # Errors
    /// A channel that cannot be built, a reorder buffer that is too small.
    pub fn timing(machine: &MachineSpec, frames: Vec<impl Into<Arc<FrameSetup>>>) -> Result<Machine<Timing>, RunError> {
        let parts =
            |_: &FrameSetup, _: Schedule| Parts { dsb: NoPlanes, trilin: NoSamples, abc: NoShading, host: NoHost };
        Machine::assemble(machine, frames, NoVoxels, NoBus, NoPixels, parts)
    }
}

impl Machine<Cycle> {
    /// A machine with a volume of voxel words (x fastest) in its frame buffer.
    ///
    /// # Errors
    /// A channel that cannot be built, a reorder buffer that is too small, and a skew that needs too much memory.
    pub fn cycle(
        machine: &MachineSpec,
        frames: Vec<impl Into<Arc<FrameSetup>>>,
        dims: [usize; 3],
        voxels: &[u16],
    ) -> Result<Machine<Cycle>, RunError> {
        let lanes = machine.lanes;
        let skew = Skew { coefficients: machine.cfb.skew, lanes };
        let memory = FrameBuffer::with_layout(skew, machine.cfb.layout, dims, voxels)?;
        let parts = |setup: &FrameSetup, schedule: Schedule| {
            let geometry = &setup.geometry;
            Parts {
                dsb: PlaneStore::new(schedule, machine.dsb.planes),
                trilin: Interpolator::new(setup, schedule),
                abc: Shader::new(setup, &schedule, machine.abc.planes, true),
                host: Collector { base: BasePlane::empty(geometry, setup.words.accumulator_bits) },
            }
        };
        Machine::assemble(machine, frames, memory, Rotator { lanes }, Reducer::default(), parts)
    }

    /// Lets these volumes of voxel words (x fastest) come in through a port while frames are read.
    pub fn acquire_volumes(&mut self, port: PortSpec, volumes: Vec<Vec<u16>>) {
        self.cfb.memory_mut().receive(volumes, port.mode == AcquisitionMode::DoubleBuffer);
        self.acquire(port);
    }

    /// The channels of samples, of coloured samples and of pixels, for a look at their tokens between two cycles.
    pub fn data(&self) -> Data<'_> {
        Data { samples: &self.samples, shaded: &self.shaded, pixels: &self.pixels }
    }

    /// Words that were saturated, by wire, over all frames.
    pub fn overflows(&self) -> Overflows {
        let shading = self.abc.arithmetic().map(Shader::overflows).sum();
        Overflows { shading, pixel: self.cone.arithmetic().overflows() }
    }

    /// The base planes, frame by frame.
    pub fn into_base_planes(self) -> Vec<BasePlane> {
        self.host.into_collectors().map(|collector| collector.base).collect()
    }
}

/// Channels whose tokens carry what the arithmetic made.
#[derive(Clone, Copy, Debug)]
pub struct Data<'a> {
    /// From TRILIN to the ABC units.
    pub samples: &'a Channel<SampleRay<RaySamples>>,
    /// From the ABC units to the cone.
    pub shaded: &'a Channel<ShadedRay<ShadedSamples>>,
    /// From the cone to the host.
    pub pixels: &'a Channel<PixelGroup<Pixels>>,
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

    fn assemble(
        machine: &MachineSpec,
        frames: Vec<impl Into<Arc<FrameSetup>>>,
        memory: F::Cfb,
        wires: F::Bus,
        nodes: F::Cone,
        parts: impl Fn(&FrameSetup, Schedule) -> Parts<F>,
    ) -> Result<Machine<F>, RunError> {
        let frames: Vec<Arc<FrameSetup>> = frames.into_iter().map(Into::into).collect();
        let sizes = channels(machine, &frames);
        let [beams, aligned, rays, samples, shaded, pixels] = Self::JOINTS.map(|joint| joint.channel);
        let mut dsb = Vec::new();
        let mut trilin = Vec::new();
        let mut abc = Vec::new();
        let mut host = Vec::new();
        let mut samples = channel(samples, sizes.samples)?;
        let mut shaded = channel(shaded, sizes.shaded)?;
        let schedules: Vec<Schedule> = frames.iter().map(|setup| Schedule::new(machine, &setup.geometry)).collect();
        let planned = || frames.iter().map(Arc::as_ref).zip(schedules.iter().copied());
        for (setup, schedule) in planned() {
            let parts = parts(setup, schedule);
            if dsb.is_empty() {
                samples.furnish(|| SampleRay { data: parts.trilin.blank(), ..SampleRay::default() });
                shaded.furnish(|| ShadedRay { data: parts.abc.blank(), ..ShadedRay::default() });
            }
            dsb.push((DsbSpec::new(machine, schedule), parts.dsb));
            trilin.push((schedule, parts.trilin));
            abc.push((AbcSpec::new(machine, setup, &schedule), parts.abc));
            host.push((setup, schedule, parts.host));
        }
        let specs = planned().map(|(setup, schedule)| CfbSpec::new(machine, &setup.geometry, schedule)).collect();
        let modules = Supply::new(machine, &frames)?;
        Ok(Machine {
            cfb: CfbUnit::new(specs, memory).with_modules(modules),
            bus: BusUnit::new(machine, schedules.iter().copied(), wires),
            dsb: DsbUnit::new(dsb),
            trilin: TrilinUnit::new(trilin),
            abc: AbcUnit::new(abc),
            cone: ConeUnit::new(schedules.iter().map(|schedule| ConeSpec::new(machine, schedule)).collect(), nodes),
            host: HostPort::new(machine, host),
            ray_words: planned().map(|(setup, schedule)| RayWords::new(machine, setup, &schedule)).collect(),
            traffic: Traffic::new(machine, planned()),
            beams: channel(beams, sizes.beams)?,
            aligned: channel(aligned, sizes.aligned)?,
            rays: channel(rays, sizes.rays)?,
            samples,
            shaded,
            pixels: channel(pixels, sizes.pixels)?,
            cycle: 0,
            last_move: 0,
            frame_ends: Vec::with_capacity(frames.len()),
            slots: schedules.iter().map(Schedule::ray_slots).sum(),
            overlap: machine.frames.overlap,
            frames,
            schedules,
        })
    }

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

    /// What each channel has counted, and the token that it was given last, where it holds it, with the cycles that its words on links
    /// make it later; in the order of [`Machine::JOINTS`].
    #[inline]
    pub fn newest(&self) -> [(ChannelCounters, Option<(Token, u64)>); CHANNELS] {
        #[inline]
        fn of<T: Identified>(channel: &Channel<T>, schedules: &[Schedule]) -> (ChannelCounters, Option<(Token, u64)>) {
            (channel.counters(), channel.newest().map(|token| (token.token(schedules), channel.newest_late())))
        }
        of_channels!(self, of)
    }

    /// The tokens in each channel, oldest first, each with the cycles until it can be popped.
    pub fn held(&self) -> [Vec<(Token, u64)>; CHANNELS] {
        fn of<T: Identified>(channel: &Channel<T>, schedules: &[Schedule]) -> Vec<(Token, u64)> {
            channel.held().map(|(token, cycles)| (token.token(schedules), cycles)).collect()
        }
        of_channels!(self, of)
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
    fn ray_slots(&self) -> u64 {
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

    /// Each channel, in the order of [`Machine::JOINTS`].
    fn standings(&self) -> [Standing; CHANNELS] {
        let [beams, aligned, rays, samples, shaded, pixels] = Self::JOINTS;
        [
            Standing::of(&self.beams, beams),
            Standing::of(&self.aligned, aligned),
            Standing::of(&self.rays, rays),
            Standing::of(&self.samples, samples),
            Standing::of(&self.shaded, shaded),
            Standing::of(&self.pixels, pixels),
        ]
    }

    /// Who waits for whom, inside of the units and between them.
    fn deadlock(&self) -> Deadlock {
        let mut waits = self.dsb.inner_waits(&self.aligned);
        waits.extend(self.abc.inner_wait(&self.samples));
        waits.extend(self.standings().iter().filter_map(Standing::wait));
        diagnose(self.last_move, &waits)
    }

    /// Words of the rays of the frames that the host has received whole.
    fn ray_words_received(&self) -> RayWords {
        let frames = self.ray_words.iter().take(self.host.frames_done() as usize);
        frames.copied().fold(RayWords::default(), RayWords::plus)
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

    /// The counters so far.
    pub fn counters(&self) -> RunCounters {
        let units = Self::UNITS.into_iter().zip(self.accounts().map(|account| *account)).collect();
        let channels = self.standings().map(|standing| standing.reading).into();
        RunCounters {
            cycles: self.cycle,
            frame_ends: self.frame_ends.clone(),
            beams: self.cfb.fetched(),
            ray_slots: self.ray_slots(),
            steady_cycles: self.cfb.account().active().max(self.dsb.accounts()[1].active()),
            units,
            channels,
            memory: self.cfb.memory_counters().to_vec(),
            reorder: self.cfb.reorder_counters(),
            bus: self.bus.counters(),
            ray_words: self.ray_words_received(),
            links: self.traffic.as_ref().map(Traffic::readings).unwrap_or_default(),
            host: self.host.counters(),
        }
    }
}

impl<F: Fidelity> Archived for Machine<F> {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let Machine {
            frames: _,
            schedules: _,
            slots: _,
            overlap: _,
            ray_words: _,
            traffic,
            cfb,
            bus,
            dsb,
            trilin,
            abc,
            cone,
            host,
            beams,
            aligned,
            rays,
            samples,
            shaded,
            pixels,
            cycle,
            last_move,
            frame_ends,
        } = self;
        cfb.archive(archive)?;
        bus.archive(archive)?;
        dsb.archive(archive)?;
        trilin.archive(archive)?;
        abc.archive(archive)?;
        cone.archive(archive)?;
        host.archive(archive)?;
        if let Some(traffic) = traffic {
            traffic.archive(archive)?;
        }
        beams.archive(archive)?;
        aligned.archive(archive)?;
        rays.archive(archive)?;
        samples.archive(archive)?;
        shaded.archive(archive)?;
        pixels.archive(archive)?;
        archive.item(cycle)?;
        archive.item(last_move)?;
        archive.item(frame_ends)
    }
}
