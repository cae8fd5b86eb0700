//! Tests of `cube3-metrics` from outside, one module each.

mod angles;
mod fronts;
mod pictures;
