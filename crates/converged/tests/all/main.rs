//! Tests of `cube3-converged` from outside, one module each.

mod bound;
mod calibration;
mod closed_forms;
mod exact;
mod fields;
mod metamorphic;
mod rounding;
mod scenes;
