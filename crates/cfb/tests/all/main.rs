//! Tests of `cube3-cfb` from outside, one module each.

mod incoming;
mod memory;
mod mini_blocks;
mod timing;
