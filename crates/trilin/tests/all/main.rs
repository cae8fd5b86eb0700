//! Tests of `cube3-trilin` from outside, one module each.

mod datapath;
mod timing;
mod wires;
