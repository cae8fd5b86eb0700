//! The units, each a sheet and a way to evaluate its definition.

mod bus;
mod cfb;
mod channel;
mod classify;
mod clip;
mod cone;
mod contents;
mod cue;
mod dsb;
mod frame;
mod gradient;
mod leaf;
mod lerp;
mod lit;
mod modes;
mod node;
mod normalise;
mod phong;
mod pixel;
mod reflectance;
mod trilin;

use crate::Unit;

pub(crate) use lerp::lerp_wires;

/// Every unit, in the order of the pipeline.
pub fn units() -> Vec<Box<dyn Unit>> {
    let mut units: Vec<Box<dyn Unit>> = vec![
        Box::new(cfb::Cfb),
        Box::new(bus::Bus),
        Box::new(dsb::Dsb),
        Box::new(lerp::Lerp),
        Box::new(trilin::Trilin),
        Box::new(clip::Clip),
    ];
    units.extend(gradient::Gradient::all());
    let behind: [Box<dyn Unit>; 11] = [
        Box::new(normalise::Normalise),
        Box::new(classify::Classify),
        Box::new(phong::Phong),
        Box::new(reflectance::Reflectance),
        Box::new(lit::Lit),
        Box::new(cue::Cue),
        Box::new(leaf::Leaf),
        Box::new(node::Node),
        Box::new(cone::Cone),
        Box::new(pixel::Pixel),
        Box::new(channel::Channel),
    ];
    units.extend(behind);
    units
}
