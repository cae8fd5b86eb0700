//! Tests of `cube3-word` from outside, one module each.

mod quantising;
