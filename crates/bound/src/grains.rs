//! How far each word of a frame may be from the real that it stands for.

use cube3_frame::{
    EndRegisters, FrameSetup, GradientScale, HalfSpace, LinearFactor, PLACE_BITS, RayRegisters, Shading,
};
use cube3_scene::Mode;
use cube3_word::{Rounding, Words, unit_full};

/// The grains of a frame's words. All are 0 in [`Grains::none`], and a walk then gives reals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grains {
    /// A weight of a lerp, 0 to 1.
    pub weight: f64,
    /// The result of a lerp of samples, in data values.
    pub sample: f64,
    /// A slope relative to its neighbours' distance, of an eye's rays.
    pub shear: f64,
    /// A factor of a gradient's component, 0 to 1.
    pub factor: f64,
    /// A component of the gradient, in data values as the difference of two samples, beside the errors of those.
    pub component: f64,
    /// The same where rows are weighed and a multiple of the word is kept: what a rounded shear takes away.
    pub sheared: f64,
    /// Where a component saturates, in the same.
    pub largest_component: f64,
    /// The direction of a gradient that is a word: length of the difference of two unit vectors.
    pub direction: f64,
    /// The length of a gradient, as a part of it.
    pub magnitude: f64,
    /// Half of the samples that share an entry of the tables, in data values.
    pub entry: f64,
    /// Half of the magnitudes that share a row, and the rounding of a magnitude, in words of it.
    pub row: f64,
    /// The largest magnitude that a row stands for, in words.
    pub last_row: f64,
    /// An opacity.
    pub opacity: f64,
    /// The opacity of [`cube3_scene::Transfer::opaque_alpha`], below which a sample may still count as opaque.
    pub opaque: f64,
    /// A colour by table.
    pub colour: f64,
    /// A product or sum of light, on the scale of a unit colour.
    pub light: f64,
    /// An intensity in a register.
    pub intensity: f64,
    /// A component of a light's direction.
    pub towards: f64,
    /// A cosine.
    pub cosine: f64,
    /// The largest of its words.
    pub largest_cosine: f64,
    /// The cosine that the table of powers takes, and an entry of it.
    pub power: [f64; 2],
    /// The factor of the depth cue, downwards.
    pub cue: f64,
    /// A coefficient of the depth cue.
    pub cue_rate: f64,
    /// A distance from a clip, in voxels for each voxel of the place, and what samples on a face are moved by.
    pub clip: [f64; 2],
    /// A component of a place, in voxels, where clips and cue take it.
    pub place: f64,
    /// The reach of an end of a ray, and the part of a step that an end stands for, in steps.
    pub end: [f64; 2],
    /// Part of the squared range of step lengths by which a ray's class is off.
    pub length: f64,
    /// A node of the cone.
    pub node: f64,
    /// The weight of a weighted sum, as a part of it.
    pub sum: f64,
}

impl Grains {
    /// Reals.
    pub const fn none() -> Grains {
        Grains {
            weight: 0.0,
            sample: 0.0,
            shear: 0.0,
            factor: 0.0,
            component: 0.0,
            sheared: 0.0,
            largest_component: f64::INFINITY,
            direction: 0.0,
            magnitude: 0.0,
            entry: 0.0,
            row: 0.0,
            last_row: f64::INFINITY,
            opacity: 0.0,
            opaque: 0.0,
            colour: 0.0,
            light: 0.0,
            intensity: 0.0,
            towards: 0.0,
            cosine: 0.0,
            largest_cosine: f64::INFINITY,
            power: [0.0; 2],
            cue: 0.0,
            cue_rate: 0.0,
            clip: [0.0; 2],
            place: 0.0,
            end: [0.0; 2],
            length: 0.0,
            node: 0.0,
            sum: 0.0,
        }
    }

    /// Those of a frame whose data has a `window` of values.
    pub fn of(setup: &FrameSetup, window: [f64; 2]) -> Grains {
        let words = &setup.words;
        let half = match words.rounding {
            Rounding::Nearest => 0.5,
            Rounding::Truncate => 1.0,
        };
        let bit = |bits: u32| 0.5_f64.powi(bits as i32);
        let sample = sample_value(words, window);
        let full = |bits: u32| f64::from(unit_full(bits));
        let light = half / full(words.colour_bits);
        let class = &setup.classification;
        let steps = f64::from(1_u32 << EndRegisters::PART_BITS);
        let rows = class.gradient_rows.map(|rows| f64::from(1_u32 << rows.shift));
        // In a weighted sum with exact ends opacity 1 over a step is at least a word of a part of the full one.
        let wide = setup.ends.is_some() && setup.cone.mode == Mode::WeightedSum;
        let opacities = full(words.opacity_bits) / if wide { f64::from(2 * EndRegisters::MOST_REACH) } else { 1.0 };
        Grains {
            weight: 0.5 * bit(words.weight_bits),
            sample: half * sample,
            shear: 2.0 * bit(RayRegisters::SLOPE_BITS) + 0.5 * bit(words.weight_bits),
            factor: 0.5 * bit(GradientScale::FACTOR_BITS),
            entry: 0.5 * (f64::from(1_u32 << class.index_shift) - 1.0) * sample,
            row: rows.map_or(0.0, |width| 0.5 * width),
            last_row: class
                .gradient_rows
                .map_or(f64::INFINITY, |rows| (f64::from(rows.rows) - 0.5) * f64::from(1_u32 << rows.shift) - 0.5),
            opacity: 0.5 / opacities,
            opaque: 1.0 / full(words.opacity_bits),
            colour: 0.5 / full(words.colour_bits),
            light,
            intensity: 0.5 * bit(words.colour_bits),
            clip: [bit(HalfSpace::FRACTION_BITS), 1.0 / 65536.0],
            place: if setup.rays.is_some() { bit(PLACE_BITS) } else { 0.0 },
            cue: bit(LinearFactor::WORD_BITS),
            cue_rate: bit(LinearFactor::FRACTION_BITS),
            end: [0.5 * bit(EndRegisters::REACH_BITS), 0.5 / steps + 2.0 * bit(EndRegisters::STEP_BITS)],
            length: 0.51 / f64::from(RayRegisters::MOST_CLASSES - 1),
            node: half / full(words.accumulator_bits),
            sum: setup.geometry.size[2] as f64 * bit(31),
            ..Grains::of_gradient(setup, half, sample)
        }
    }

    /// What is of gradients and of light on them.
    fn of_gradient(setup: &FrameSetup, half: f64, sample: f64) -> Grains {
        let words = &setup.words;
        let bit = |bits: u32| 0.5_f64.powi(bits as i32);
        let mut grains = Grains::none();
        if let Some(gradient) = &setup.gradient {
            let kept = gradient.scale.map_or(0, |scale| scale.kept_bits);
            let extra = gradient.method.row().extra_bits();
            let word = f64::from(1_u32 << words.gradient_drop()) * bit(kept) * sample;
            let scaled =
                if gradient.scale.is_some() || setup.rays.is_some() { bit(kept + extra) * sample } else { 0.0 };
            let near = if setup.rays.is_some() { bit(extra) * sample } else { 0.0 };
            let drops = words.gradient_drop() + extra > 0;
            grains.component = half * (scaled + if drops { word } else { 0.0 });
            grains.sheared = half * (bit(extra) * sample + near);
            grains.largest_component = (f64::from(1_u32 << (words.gradient_bits + kept - 1)) - 1.0) * word;
        }
        let (one, root) = (bit(words.normal_bits - 1), 3_f64.sqrt());
        if let Some(table) = &setup.normaliser {
            // The block's components are cut off below their last bit, and the largest of them has its first one set.
            let block = 2.0 * root * one;
            let reciprocal = 0.25 * bit(table.root_bits) * (1.0 + bit(table.root_bits)) + root * one;
            grains.magnitude = block + reciprocal + root * one;
            grains.direction = block + reciprocal + 0.5 * root * one;
        }
        match &setup.shading {
            Some(Shading::Table(table)) => grains.direction = 2_f64.sqrt() * bit(table.bits),
            Some(Shading::Phong(phong)) => {
                grains.towards = if setup.rays.is_some() { one + grains.direction } else { 0.5 * one };
                (grains.cosine, grains.largest_cosine) = (half * one, 1.0);
                let index = if phong.power_bits + 1 < words.normal_bits { half * bit(phong.power_bits) } else { 0.0 };
                grains.power = [index, 0.5 * bit(words.colour_bits)];
            }
            None => {}
        }
        grains
    }
}

/// The data value that a step of a sample word is.
pub fn sample_value(words: &Words, window: [f64; 2]) -> f64 {
    (window[1] - window[0]) / f64::from(unit_full(words.voxel_bits) << words.sample_fraction_bits)
}

/// The difference of two samples, in data values, that a gradient component's word of 1 is.
pub fn component_value(setup: &FrameSetup, window: [f64; 2]) -> f64 {
    let kept = setup.gradient.and_then(|gradient| gradient.scale).map_or(0, |scale| scale.kept_bits);
    sample_value(&setup.words, window) * f64::from(1_u32 << setup.words.gradient_drop()) * 0.5_f64.powi(kept as i32)
}
