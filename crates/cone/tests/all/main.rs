//! Tests of `cube3-cone` from outside, one module each.

mod circle;
mod datapath;
mod ends;
mod kinds;
mod rows;
mod timing;
mod wires;
