//! The units, each a sheet and a way to evaluate its definition.

mod lerp;
mod trilin;

use crate::Unit;

pub(crate) use lerp::lerp_wires;

/// Every unit, in the order of the pipeline.
pub fn units() -> Vec<Box<dyn Unit>> {
    vec![Box::new(lerp::Lerp), Box::new(trilin::Trilin)]
}
