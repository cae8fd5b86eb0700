//! Tests of `cube3-report` from outside, one module each.

mod check;
mod json;
mod no_object;
mod page;
mod png;
mod sample;
mod sequence;
mod text;
