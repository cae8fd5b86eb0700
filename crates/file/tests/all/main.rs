//! Tests of `cube3-file` from outside, one module each.

mod whole;
