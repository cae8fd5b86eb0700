//! Tests of `cube3-abc` from outside, one module each.

mod absent;
mod datapath;
mod ends;
mod gradients;
mod lanes;
mod light;
mod normals;
mod perspective;
mod registers;
mod timing;
mod wires;
