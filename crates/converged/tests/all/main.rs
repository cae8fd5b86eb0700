//! Tests of `cube3-converged` from outside, one module each.

mod bound;
mod calibration;
mod closed_forms;
mod enclosure;
mod exact;
mod fields;
mod fifty_digits;
mod metamorphic;
mod nasty;
mod rounding;
mod scenes;
