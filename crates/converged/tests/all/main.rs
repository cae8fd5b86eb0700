//! Tests of `cube3-converged` from outside, one module each.

mod bound;
mod closed_forms;
mod exact;
mod scenes;
