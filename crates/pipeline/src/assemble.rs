//! A machine put together from its spec and the registers of its frames.

use crate::error::RunError;
use crate::fidelity::{Cycle, Fidelity, Timing};
use crate::host_port::{Collector, HostPort, NoHost};
use crate::links::{RayWords, Traffic, channels};
use crate::machine::Machine;
use cube3_abc::{AbcSpec, AbcUnit, NoShading, Shade, ShadedRay, ShadedSamples, Shader};
use cube3_cfb::golden::Skew;
use cube3_cfb::memory::Supply;
use cube3_cfb::{CfbSpec, CfbUnit, FrameBuffer, NoVoxels, PortSpec};
use cube3_channel::{Channel, ChannelError};
use cube3_cone::{ConeSpec, ConeUnit, NoPixels, PixelGroup, Pixels, Reducer};
use cube3_dsb::bus::{BusUnit, NoBus};
use cube3_dsb::{DsbSpec, DsbUnit, NoPlanes, PlaneStore, Rotator};
use cube3_frame::{BasePlane, FrameSetup, Overflows, Schedule};
use cube3_machine::{AcquisitionMode, ChannelSize, MachineSpec};
use cube3_trilin::{Interpolate, Interpolator, NoSamples, RaySamples, SampleRay, TrilinUnit};
use std::sync::Arc;

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
}
