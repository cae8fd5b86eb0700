//! The host computer of Cube-3: it picks the base plane, makes templates and tables, and warps the picture.
//!
//! Everything that enters the machine is a [`FrameSetup`], what a driver would write into registers and
//! tables; [`frame_setup`] makes it from a scene, a [`MachineSpec`] and what is known of the volume. The
//! machine answers with a [`BasePlane`], which [`warp`] brings to the picture. Pfister et al. 1995, sections 2, 3.

mod axes;
mod classification;
mod controller;
mod ends;
mod fan;
mod geometry;
mod image_plane;
mod machine;
mod memory;
mod perspective;
mod picture;
mod registers;
mod sample_bounds;
mod sections;
mod setup;
mod shading;
mod template;
mod warp;

pub use axes::{Axes, CanonicalView, canonical};
pub use classification::OpacityEntries;
pub use controller::{BankHash, BankHashRow, BurstOrder, ControllerKind, LookAheadFreed, LookAheadUnit};
pub use ends::{EndRegisters, whole_step_opacity};
pub use fan::{Fan, FanShape};
pub use geometry::{DiscreteRay, Geometry, RaySlots};
pub use image_plane::{ImagePlane, eye};
pub use machine::{
    Abc, Acquisition, AcquisitionMode, Boards, Bus, BusKind, Cfb, ChannelSize, Channels, Cone, ConeKind, Dsb, Frames,
    GradientMethod, HostLink, Layout, MachineError, MachineSpec, MemoryType, RayEnds, Rays, Reuse, ShadingUnit, Trilin,
};
pub use memory::{Command, Constraint, MemoryModel, Rows, Scope, Span};
pub use perspective::{PLACE_BITS, PassShape, Perspective};
pub use picture::{Coverage, PictureFrames, picture_setup};
pub use registers::{
    Classification, ConeOrder, ConeRegisters, FrameSetup, GradientRegisters, GradientRows, GradientScale, HalfSpace,
    Linear, LinearFactor, Normaliser, Phong, PhongLight, RayRegisters, ReflectanceTable, Shading,
};
pub use sample_bounds::{BESIDE, RayStretches, SampleBounds};
pub use sections::Sections;
pub(crate) use setup::gradient_scale;
pub use setup::{
    Basis, Frame, HostError, LARGEST_RATIO, LARGEST_SIDE, LeftOut, SPACING_RANGE, VolumeInfo, check_bus, depth_range,
    frame_setup, step_length,
};
pub use template::{SLOPE_FRACTION_BITS, Template, TemplateRule, largest_offset, slope_register};
pub use warp::{BasePlane, over, warp, warp_passes, warp_reals};
