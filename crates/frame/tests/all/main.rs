//! Tests of `cube3-frame` from outside, one module each.

mod golden;
