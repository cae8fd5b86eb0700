//! Tests of `cube3-dsb` from outside, one module each.

mod addressing;
mod common;
mod datapath;
mod links;
mod perspective;
mod timing;
