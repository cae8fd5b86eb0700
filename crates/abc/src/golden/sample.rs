//! Everything that is done to one sample.

use super::counted::{Counted, Neighbourhood, counted};
use super::gradient::{Local, local_gradient_wires};
use super::light::{ReflectedLight, cued_wires, halfway, lit_wires, phong_wires, reflectance_wires, view_vector};
use super::normal::{Normal, normalise_wires};
use super::tables::{classify_wires, opacity_class};
use cube3_frame::{DiscreteRay, FrameSetup, LinearFactor, Phong, PhongLight, Shading};
use cube3_word::Probe;
use serde::{Deserialize, Serialize};

/// A sample as it goes into the cone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shaded {
    /// Whether the sample takes part: it is in the volume, within every clip and the threshold.
    pub present: bool,
    /// The sample word.
    pub sample: i32,
    /// Unit word of `opacity_bits`.
    pub opacity: u32,
    /// Unit words of `colour_bits`, not yet weighted with the opacity; 0 where that is 0.
    pub colour: [u32; 3],
}

/// A neighbourhood as the gradient takes it. No ray goes on before its eye: in front of the first plane behind an eye in the volume there is
/// the sample itself, and not the border, which would light the eye's surroundings as a face of the volume.
pub fn behind_the_eye(s: &Neighbourhood, at: [i64; 3], setup: &FrameSetup) -> Neighbourhood {
    let first = setup.geometry.perspective.as_ref().map_or(0, |pass| pass.first_depth as i64);
    let mut seen = *s;
    if first > 0 && at[2] == first {
        seen[0] = [[s[1][1][1]; 3]; 3];
    }
    seen
}

/// A sample on its way through an ABC unit: what each stage gives to the next. Behind a stage that lets nothing through there is nothing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stages {
    /// Whether the sample is outside of a clip.
    pub outside: bool,
    /// What the gradient is taken from, where the frame has one.
    pub around: Option<(Neighbourhood, Local)>,
    /// The gradient.
    pub gradient: [i32; 3],
    /// Its direction and length.
    pub normal: Normal,
    /// The class of the opacity table.
    pub class: u32,
    /// Opacity and colour by the tables.
    pub classified: Option<(u32, [u32; 3])>,
    /// Of each light of Phong's formula the direction, and what is halfway between it and the eye.
    pub towards: Vec<[[i32; 3]; 2]>,
    /// Light on the sample, where colours are lit.
    pub light: Option<ReflectedLight>,
    /// The colour in that light.
    pub lit: [u32; 3],
    /// The depth cue's factor.
    pub cue: Option<u32>,
    /// What goes into the cone. Overflows are counted where the sample is not transparent.
    pub shaded: Counted<Shaded>,
}

/// Everything that an ABC unit does to sample k of ray (u, v), which is in the volume. Overflows are counted where the
/// sample is not transparent.
pub fn shade(s: &Neighbourhood, at: [i64; 3], setup: &FrameSetup) -> Counted<Shaded> {
    shade_wires(s, at, setup, &mut ()).shaded
}

/// [`shade`] stage by stage, and what the wires of each carry: each stage is a part, by the name of its unit in vectors.
pub fn shade_wires(s: &Neighbourhood, at: [i64; 3], setup: &FrameSetup, probe: &mut impl Probe) -> Stages {
    let (words, geometry) = (&setup.words, &setup.geometry);
    let sample = s[1][1][1];
    let mut stages = Stages::default();
    stages.shaded.value.sample = sample;
    for (number, clip) in setup.clips.iter().enumerate() {
        stages.outside |= probe.within("clip", number, |probe| geometry.evaluate_wires(&clip.distance, at, probe)) < 0;
    }
    if stages.outside {
        return stages;
    }
    let mut overflows = 0;
    if let Some(registers) = &setup.gradient {
        let (around, local) = (behind_the_eye(s, at, setup), Local::new(at, registers, setup));
        let components =
            probe.within("gradient", 0, |probe| local_gradient_wires(&around, registers, &local, words, probe));
        let gradient = counted(components);
        (stages.gradient, overflows) = (gradient.value, gradient.overflows);
        stages.around = Some((around, local));
    }
    let gradient = stages.gradient;
    if let Some(table) = &setup.normaliser {
        stages.normal = probe.within("normalise", 0, |probe| normalise_wires(gradient, table, words, probe));
    }
    let Normal { direction, magnitude } = stages.normal;
    let (class, table) = (opacity_class(at, setup), &setup.classification);
    stages.class = class;
    stages.classified = probe.within("classify", 0, |probe| classify_wires(class, sample, magnitude, table, probe));
    let Some((opacity, colour)) = stages.classified else {
        return stages;
    };
    stages.shaded.value = Shaded { present: true, sample, opacity, colour: [0; 3] };
    if opacity == 0 {
        return stages;
    }
    stages.light = match &setup.shading {
        Some(Shading::Phong(phong)) => {
            let towards = towards(phong, at, setup);
            let of = |light: usize| towards[light];
            let light = probe.within("phong", 0, |probe| phong_wires(direction, phong, of, words, probe));
            stages.towards = towards;
            Some(light)
        }
        Some(Shading::Table(table)) => {
            Some(probe.within("reflectance", 0, |probe| reflectance_wires(gradient, table, probe)))
        }
        None => None,
    };
    stages.lit = colour;
    if let Some(light) = stages.light {
        let lit = counted(probe.within("lit", 0, |probe| lit_wires(colour, light, words, probe)));
        stages.lit = lit.value;
        overflows += lit.overflows;
    }
    let mut coloured = stages.lit;
    if let Some(cue) = &setup.depth_cue {
        let factor = LinearFactor::word(geometry.evaluate(&cue.factor, at));
        stages.cue = Some(factor);
        coloured = probe.within("cue", 0, |probe| cued_wires(coloured, factor, words, probe));
    }
    stages.shaded = Counted { value: Shaded { present: true, sample, opacity, colour: coloured }, overflows };
    stages
}

/// The direction of each light and what is halfway between it and the eye, for a sample: in perspective those of its ray.
fn towards(phong: &Phong, at: [i64; 3], setup: &FrameSetup) -> Vec<[[i32; 3]; 2]> {
    let (Some(rays), Some(table)) = (&setup.rays, &setup.normaliser) else {
        return phong.lights.iter().map(|light| [light.direction, light.halfway]).collect();
    };
    let [row, column] = setup.geometry.slot_of(DiscreteRay { u: at[0], v: at[1] });
    let view = view_vector(row, column, rays, table, &setup.words);
    let of_light = |(light, &at_eye): (&PhongLight, &bool)| {
        if at_eye { [view; 2] } else { [light.direction, halfway(light.direction, view, table, &setup.words)] }
    };
    phong.lights.iter().zip(&rays.at_eye).map(of_light).collect()
}
