//! What tokens carry: voxels and pixels, or nothing.

use crate::host_port::{Collect, Collector, NoHost};
use cube3_abc::{NoShading, Shade, Shader};
use cube3_cfb::{Fetch, FrameBuffer, NoVoxels};
use cube3_cone::{NoPixels, Reduce, Reducer};
use cube3_dsb::bus::{Align, NoBus};
use cube3_dsb::{NoPlanes, PlaneStore, Rotator, Store};
use cube3_trilin::{Interpolate, Interpolator, NoSamples};

/// The arithmetic in each unit. The units, channels and ticks are the same whichever it is.
pub trait Fidelity {
    /// Frame buffer.
    type Cfb: Fetch;
    /// Fast bus.
    type Bus: Align<Input = <Self::Cfb as Fetch>::Output>;
    /// Skewed buffers.
    type Dsb: Store<Input = <Self::Bus as Align>::Output>;
    /// Interpolation.
    type Trilin: Interpolate<Input = <Self::Dsb as Store>::Output>;
    /// Gradient and shading.
    type Abc: Shade<Input = <Self::Trilin as Interpolate>::Output>;
    /// Cone.
    type Cone: Reduce<Input = <Self::Abc as Shade>::Output>;
    /// Host.
    type Host: Collect<Input = <Self::Cone as Reduce>::Output>;
}

/// Real data in every token: the truth, for traces and verification.
#[derive(Clone, Copy, Debug)]
pub struct Cycle;

impl Fidelity for Cycle {
    type Cfb = FrameBuffer;
    type Bus = Rotator;
    type Dsb = PlaneStore;
    type Trilin = Interpolator;
    type Abc = Shader;
    type Cone = Reducer;
    type Host = Collector;
}

/// Empty tokens: cycles, stalls and occupancy only.
#[derive(Clone, Copy, Debug)]
pub struct Timing;

impl Fidelity for Timing {
    type Cfb = NoVoxels;
    type Bus = NoBus;
    type Dsb = NoPlanes;
    type Trilin = NoSamples;
    type Abc = NoShading;
    type Cone = NoPixels;
    type Host = NoHost;
}
