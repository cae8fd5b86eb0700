//! Tests of `cube3` from outside, one module each.

mod examples;
mod labels;
mod lengths;
mod opacity_tables;
mod sequence;
