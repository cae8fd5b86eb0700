//! The machine as data: everything that an architect may change, with units, ranges and sources.
//!
//! A [`MachineSpec`] is read from a machine file or taken from [`PRESETS`]. It says nothing about a frame: what a scene makes of a
//! machine is in the registers of a frame.

mod choices;
mod controller;
mod estimators;
mod memory;
pub mod operators;
mod presets;
mod spec;

pub use choices::{
    AcquisitionMode, BusKind, ConeKind, ConeOrder, GradientMethod, Layout, MemoryType, RayEnds, RaySlots, Reuse,
    ShadingUnit, TemplateRule,
};
pub use controller::{BankHash, BankHashRow, BurstOrder, ControllerKind, LookAheadFreed, LookAheadUnit};
pub use estimators::{Differences, ESTIMATORS, Estimator};
pub use memory::{Command, Constraint, MemoryModel, Rows, Scope, Span};
pub use operators::OperatorCounts;
pub use presets::PRESETS;
pub use spec::{
    Abc, Acquisition, Boards, Bus, Cfb, ChannelSize, Channels, Cone, Dsb, Frames, HostLink, MachineError, MachineSpec,
    Rays, Trilin,
};
