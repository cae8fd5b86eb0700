//! The machine as data: everything that an architect may change, with units, ranges and sources.
//!
//! A [`MachineSpec`] is read from a machine file or taken from [`PRESETS`]. It says nothing about a frame: what a scene makes of a
//! machine is in the registers of a frame.

mod choices;
mod controller;
mod error;
mod estimators;
mod file;
mod memory;
mod names;
pub mod operators;
mod parameters;
mod presets;
mod printed;
mod relations;
mod spec;

pub use choices::{
    AcquisitionMode, BusKind, ConeKind, ConeOrder, GradientMethod, Layout, MemoryType, RayEnds, RaySlots, Reuse,
    ShadingUnit, TemplateRule,
};
pub use controller::{BankHash, BankHashRow, BurstOrder, ControllerKind, LookAheadFreed, LookAheadUnit};
pub use error::MachineError;
pub use estimators::{Differences, ESTIMATORS, Estimator};
pub use memory::{Command, Constraint, MemoryModel, Rows, Scope, Span};
pub use operators::OperatorCounts;
pub use parameters::{PARAMETERS, SECTIONS};
pub use presets::{PRESETS, about};
pub use relations::Conflict;
pub use spec::{
    Abc, Acquisition, Boards, Bus, Cfb, ChannelSize, Channels, Cone, Dsb, Frames, HostLink, MachineSpec, Rays, Trilin,
};
