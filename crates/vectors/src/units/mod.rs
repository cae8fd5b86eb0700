//! The units, each a sheet and a way to evaluate its definition.

mod bus;
mod cfb;
mod channel;
mod cone;
mod dsb;
mod leaf;
mod lerp;
mod modes;
mod node;
mod pixel;
mod trilin;

use crate::Unit;

pub(crate) use lerp::lerp_wires;

/// Every unit, in the order of the pipeline.
pub fn units() -> Vec<Box<dyn Unit>> {
    vec![
        Box::new(cfb::Cfb),
        Box::new(bus::Bus),
        Box::new(dsb::Dsb),
        Box::new(lerp::Lerp),
        Box::new(trilin::Trilin),
        Box::new(leaf::Leaf),
        Box::new(node::Node),
        Box::new(cone::Cone),
        Box::new(pixel::Pixel),
        Box::new(channel::Channel),
    ]
}
