//! A frame of the machine: what a driver writes into its registers and tables, and the geometry and the schedule that
//! follow from them.
//!
//! Everything that enters the machine is a [`FrameSetup`]. The host makes it from a scene and a machine; units, golden vectors and RTL test
//! benches read it. The machine answers with a [`BasePlane`]. Pfister et al. 1995, sections 2, 3.

mod axes;
mod base_plane;
mod bits;
mod check;
mod coverage;
mod ends;
mod fan;
mod geometry;
mod golden;
mod linear;
mod overflows;
mod pass_geometry;
mod perspective;
mod registers;
mod sample_bounds;
mod schedule;
mod template;

pub use axes::Axes;
pub use base_plane::BasePlane;
pub use bits::{LARGEST_SIDE, PLACE_BITS, SLOPE_FRACTION_BITS};
pub use check::{SetupError, SetupFileError};
pub use coverage::RayCoverage;
pub use ends::EndRegisters;
pub use fan::{Fan, FanShape};
pub use geometry::{DiscreteRay, Geometry};
pub use golden::largest_offset;
pub use linear::{HalfSpace, Linear, LinearFactor};
pub use overflows::Overflows;
pub use perspective::{PassShape, PerspectivePass};
pub use registers::{
    Classification, ConeRegisters, FrameSetup, GradientRegisters, GradientRows, GradientScale, Normaliser, Phong,
    PhongLight, RayRegisters, ReflectanceTable, Shading,
};
pub use sample_bounds::{BESIDE, RayStretches, SampleBounds};
pub use schedule::{Bands, BeamPlace, FrameShape, RayPlace, Schedule, Sections, ShadingOrder};
pub use template::{Template, slope_register};
