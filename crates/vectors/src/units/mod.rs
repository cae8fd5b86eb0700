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
        Box::new(cfb::CfbSheet),
        Box::new(bus::BusSheet),
        Box::new(dsb::DsbSheet),
        Box::new(lerp::LerpSheet),
        Box::new(trilin::TrilinSheet),
        Box::new(clip::ClipSheet),
    ];
    units.extend(gradient::GradientSheet::all());
    let behind: [Box<dyn Unit>; 11] = [
        Box::new(normalise::NormaliseSheet),
        Box::new(classify::ClassifySheet),
        Box::new(phong::PhongSheet),
        Box::new(reflectance::ReflectanceSheet),
        Box::new(lit::LitSheet),
        Box::new(cue::CueSheet),
        Box::new(leaf::LeafSheet),
        Box::new(node::NodeSheet),
        Box::new(cone::ConeSheet),
        Box::new(pixel::PixelSheet),
        Box::new(channel::ChannelSheet),
    ];
    units.extend(behind);
    units
}
