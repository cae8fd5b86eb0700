//! Tests of `cube3-machine` from outside, one module each.

mod parameters;
