//! The units, each a sheet and a way to evaluate its definition.

mod classify;
mod clip;
mod contents;
mod cue;
mod frame;
mod gradient;
mod lerp;
mod lit;
mod normalise;
mod phong;
mod reflectance;
mod trilin;

use crate::Unit;

pub(crate) use lerp::lerp_wires;

/// Every unit, in the order of the pipeline.
pub fn units() -> Vec<Box<dyn Unit>> {
    let mut units: Vec<Box<dyn Unit>> = vec![Box::new(lerp::Lerp), Box::new(trilin::Trilin)];
    units.extend(gradient::Gradient::all());
    units.push(Box::new(normalise::Normalise));
    units.push(Box::new(classify::Classify));
    units.push(Box::new(phong::Phong));
    units.push(Box::new(reflectance::Reflectance));
    units.push(Box::new(lit::Lit));
    units.push(Box::new(cue::Cue));
    units.push(Box::new(clip::Clip));
    units
}
