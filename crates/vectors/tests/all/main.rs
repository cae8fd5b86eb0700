//! Tests of `cube3-vectors` from outside, one module each.

mod files;
mod kept;
mod units;
