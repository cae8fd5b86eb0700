//! Gradient, classification and shading of one sample. The definition.

use cube3_host::{
    Classification, DiscreteRay, FrameSetup, GradientMethod, GradientRegisters, GradientScale, LinearFactor,
    Normaliser, Phong, RayRegisters, ReflectanceTable, Shading,
};
use cube3_word::{Words, lerp, saturate, unit_full};
use serde::{Deserialize, Serialize};

/// The sample and its 26 neighbours, `[w][v][u]` with the sample itself at `[1][1][1]`: w along the ray, v from
/// plane to plane, u from ray to ray. Samples beyond the volume are the border word.
pub type Neighbourhood = [[[i32; 3]; 3]; 3];

/// Something with the number of words that overflowed and were saturated on the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counted<T> {
    /// The value.
    pub value: T,
    /// Saturated words.
    pub overflows: u32,
}

/// What the gradient of a sample is weighted with: in a parallel frame the same for all, in perspective of its own ray and depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Local {
    /// Whether the ray runs against u and against v: the neighbourhood is then taken in the mirror.
    pub mirrored: [bool; 2],
    /// How far the ray moves along u and v to the next plane, in rays, fractions of the weight bits: at the sample's own slice.
    pub here: [u32; 2],
    /// The same in rays of slice k + 1.
    pub behind: [u32; 2],
    /// And of slice k − 1.
    pub before: [u32; 2],
    /// Factors of the components.
    pub factors: Option<[u32; 3]>,
    /// Factor of the difference along the ray, a fraction of [`GradientScale::FACTOR_BITS`].
    pub nearness: Option<u32>,
}

impl Local {
    /// Every sample of a parallel frame.
    pub fn parallel(registers: &GradientRegisters) -> Local {
        let weights = registers.weights;
        let factors = registers.scale.map(|scale| scale.factors);
        Local { mirrored: [false; 2], here: weights, behind: weights, before: weights, factors, nearness: None }
    }

    /// Sample k of ray (u, v), `at`, of a frame.
    pub fn new(at: [i64; 3], registers: &GradientRegisters, setup: &FrameSetup) -> Local {
        let (Some(pass), Some(rays)) = (&setup.geometry.perspective, &setup.rays) else {
            return Local::parallel(registers);
        };
        let [i, j, k] = [(at[0] - pass.u.first) as usize, (at[1] - pass.v.first) as usize, at[2] as usize];
        let last = rays.closeness.len() - 1;
        let shear = |k: usize| {
            [rays.slope_u[i], rays.slope_v[j]]
                .map(|slope| RayRegisters::shear(slope, rays.closeness[k], setup.words.weight_bits))
        };
        Local {
            mirrored: setup.geometry.mirrored(DiscreteRay { u: at[0], v: at[1] }),
            here: shear(k),
            behind: shear((k + 1).min(last)),
            before: shear(k.saturating_sub(1)),
            factors: Some(rays.factors[k]),
            nearness: rays.nearness.as_ref().map(|nearness| nearness[k]),
        }
    }
}

/// The gradient of a sample of a parallel frame, three signed words of `gradient_bits` and what the scale keeps below them.
///
/// Each component stands for the difference of two samples that are two voxels (or two steps) apart, without
/// the low bits that the word has no room for.
pub fn gradient(s: &Neighbourhood, registers: &GradientRegisters, words: &Words) -> Counted<[i32; 3]> {
    local_gradient(s, registers, &Local::parallel(registers), words)
}

/// The gradient of a sample of any frame.
pub fn local_gradient(
    s: &Neighbourhood,
    registers: &GradientRegisters,
    local: &Local,
    words: &Words,
) -> Counted<[i32; 3]> {
    let turn = |i: usize, mirrored: bool| if mirrored { 2 - i } else { i };
    let [mirror_u, mirror_v] = local.mirrored;
    let s = [0, 1, 2].map(|w| [0, 1, 2].map(|v| [0, 1, 2].map(|u| s[w][turn(v, mirror_v)][turn(u, mirror_u)])));
    let (mut differences, extra) = differences(&s, registers.method, local, words);
    for (difference, mirrored) in differences.iter_mut().zip(local.mirrored) {
        *difference = if mirrored { -*difference } else { *difference };
    }
    let kept = registers.scale.map_or(0, |scale| scale.kept_bits);
    let mut overflows = 0;
    let value = [0, 1, 2].map(|i| {
        let scaled = match local.factors {
            Some(factors) => {
                let product = differences[i] * i64::from(factors[i]);
                words.rounding.shift_right(product, GradientScale::FACTOR_BITS - kept)
            }
            None => differences[i],
        };
        let (word, saturated) =
            saturate(words.rounding.shift_right(scaled, words.gradient_drop() + extra), words.gradient_bits + kept);
        overflows += u32::from(saturated);
        word
    });
    Counted { value, overflows }
}

/// Differences along u, v and w, and the bits by which their weights exceed 1.
fn differences(s: &Neighbourhood, method: GradientMethod, local: &Local, words: &Words) -> ([i64; 3], u32) {
    let [du, dv] = local.here;
    let lerp = |near: i32, far: i32, weight: u32| i64::from(lerp(near, far, weight, words.weight_bits, words.rounding));
    let between = |far: i32, near: i32| i64::from(far) - i64::from(near);
    let u = between(s[1][1][2], s[1][1][0]);
    let v = between(s[1][2][1], s[1][0][1]);
    // Where rays are less than a voxel apart, u and v are relative to their distance m, and so is the ray.
    let near = |difference: i64| match local.nearness {
        Some(nearness) => words.rounding.shift_right(difference * i64::from(nearness), GradientScale::FACTOR_BITS),
        None => difference,
    };
    let ray = near(between(s[2][1][1], s[0][1][1]));
    let shear = |d: [i64; 3]| {
        let along = d[0] * i64::from(du) + d[1] * i64::from(dv);
        [d[0], d[1], d[2] - words.rounding.shift_right(along, words.weight_bits)]
    };
    let weighted = || {
        let [u, v, ray] = weighted(s);
        [u, v, near(ray)]
    };
    match method {
        GradientMethod::Six => ([u, v, ray], 0),
        GradientMethod::SixSheared => (shear([u, v, ray]), 0),
        GradientMethod::TwentySix => (weighted(), 4),
        GradientMethod::TwentySixSheared => (shear(weighted()), 4),
        GradientMethod::Ten | GradientMethod::TenNormalised => {
            // The foot of the perpendicular from a side ray lies towards the eye on the right, away on the left.
            let right = lerp(s[1][1][2], s[0][1][2], du);
            let left = lerp(s[1][1][0], s[2][1][0], du);
            let below = lerp(s[1][2][1], s[0][2][1], dv);
            let above = lerp(s[1][0][1], s[2][0][1], dv);
            ([right - left, below - above, ray], 0)
        }
        GradientMethod::Twelve => {
            // Straight behind the sample on slice k+1 lies between rays u−1 and u, v−1 and v; before it, the mirror image.
            let bilinear = |slice: &[[i32; 3]; 3], v: usize, u: usize, [du, dv]: [u32; 2]| {
                let near = lerp(slice[1][1], slice[1][u], du);
                let far = lerp(slice[v][1], slice[v][u], du);
                lerp(near as i32, far as i32, dv)
            };
            ([u, v, near(bilinear(&s[2], 0, 0, local.behind) - bilinear(&s[0], 2, 2, local.before))], 0)
        }
    }
}

/// Differences of the 26-neighbourhood with weights 4, 2, 1 by Manhattan distance: sixteen times those of one pair.
fn weighted(s: &Neighbourhood) -> [i64; 3] {
    let mut sums = [0; 3];
    for (a, first) in [1, 2, 1].into_iter().enumerate() {
        for (b, second) in [1, 2, 1].into_iter().enumerate() {
            let weight = first * second;
            sums[0] += weight * (i64::from(s[a][b][2]) - i64::from(s[a][b][0]));
            sums[1] += weight * (i64::from(s[a][2][b]) - i64::from(s[a][0][b]));
            sums[2] += weight * (i64::from(s[2][a][b]) - i64::from(s[0][a][b]));
        }
    }
    sums
}

/// A normalised gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Normal {
    /// Direction, fractions of `normal_bits − 1`, −1 to 1 inclusive; all 0 where the gradient is.
    pub direction: [i32; 3],
    /// Length of the gradient, in its own words.
    pub magnitude: u32,
}

/// Normalises a gradient: a block shift brings its largest component to `normal_bits` B, and a table of reciprocal
/// roots over the squared length, `2^(2B−2)` to `3·2^(2B)`, does the rest. Odd in every component.
pub fn normalise(gradient: [i32; 3], table: &Normaliser, words: &Words) -> Normal {
    let bits = words.normal_bits;
    let sizes = gradient.map(i32::unsigned_abs);
    let largest = sizes[0] | sizes[1] | sizes[2];
    if largest == 0 {
        return Normal { direction: [0; 3], magnitude: 0 };
    }
    let zeros = largest.leading_zeros();
    let block = sizes.map(|size| (size << zeros) >> (32 - bits));
    let square: u32 = block.iter().map(|a| a * a).sum();
    let reciprocal = table.root[(square >> (2 * bits - 2 - table.root_bits)) as usize - (1 << table.root_bits)];
    let one = 1 << (bits - 1);
    let unit = block.map(|a| ((a * reciprocal + (1 << (bits - 1))) >> bits).min(one));
    let direction = [0, 1, 2].map(|i| if gradient[i] < 0 { -(unit[i] as i32) } else { unit[i] as i32 });
    let length: u64 = (0..3).map(|i| u64::from(block[i]) * u64::from(unit[i])).sum();
    Normal { direction, magnitude: magnitude(length, zeros, bits) }
}

/// The product of block and direction in the gradient's words: the block was shifted left by `zeros + bits − 32`, and the
/// direction has a fraction of `bits − 1`. A gradient of 31 bits has 1 zero; with 4 `bits` that is 24 bits to the left.
#[inline(always)]
pub(crate) fn magnitude(length: u64, zeros: u32, bits: u32) -> u32 {
    let back = zeros + 2 * bits - 9;
    (((length << 24) + (1 << back >> 1)) >> back) as u32
}

/// Diffuse and specular light on a sample: what multiplies its colour (fractions of `colour_bits`) and what is added
/// to it (on the scale of a unit colour word).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Light {
    /// Multiplies.
    pub diffuse: [u32; 3],
    /// Is added.
    pub specular: [u32; 3],
}

/// Phong's formula in integers, with lights that are the same for all samples.
pub fn phong(normal: [i32; 3], phong: &Phong, words: &Words) -> Light {
    phong_from(normal, phong, |light| [phong.lights[light].direction, phong.lights[light].halfway], words)
}

/// The view vector of the ray in a slot of a perspective frame: what the gradient has towards the eye, fractions of `normal_bits − 1`.
pub fn view_vector(row: usize, column: usize, rays: &RayRegisters, table: &Normaliser, words: &Words) -> [i32; 3] {
    normalise([rays.view_u[column], rays.view_v[row], rays.view_w], table, words).direction
}

/// The vector halfway between a light and the eye, by the unit's own normaliser; 0 where they are opposite.
pub fn halfway(light: [i32; 3], view: [i32; 3], table: &Normaliser, words: &Words) -> [i32; 3] {
    normalise([0, 1, 2].map(|i| light[i] + view[i]), table, words).direction
}

/// Phong's formula with the direction of each light and what is halfway between it and the eye, as `towards(light)` gives them.
pub fn phong_from(normal: [i32; 3], phong: &Phong, towards: impl Fn(usize) -> [[i32; 3]; 2], words: &Words) -> Light {
    let one_bits = words.normal_bits - 1;
    let one = 1_i64 << one_bits;
    let cosine = |direction: [i32; 3]| {
        let dot: i64 = (0..3).map(|i| i64::from(normal[i]) * i64::from(direction[i])).sum();
        // The back is lit as the front, to the bit: the magnitude is taken before it is rounded.
        let dot = if phong.two_sided { dot.abs() } else { dot.max(0) };
        words.rounding.shift_right(dot, one_bits).min(one)
    };
    let mut light = Light { diffuse: [phong.ambient; 3], specular: [0; 3] };
    for (number, source) in phong.lights.iter().enumerate() {
        let [towards, half] = towards(number).map(cosine);
        let index = words.rounding.shift_right(half, one_bits - phong.power_bits) as usize;
        let lit = phong.two_sided || towards > 0;
        let power = if lit { i64::from(phong.power[index]) } else { 0 };
        for i in 0..3 {
            light.diffuse[i] += words.rounding.shift_right(i64::from(source.diffuse[i]) * towards, one_bits) as u32;
            light.specular[i] +=
                words.rounding.shift_right(i64::from(source.specular[i]) * power, words.colour_bits) as u32;
        }
    }
    light
}

/// The entry of a reflectance table for a gradient's direction: the face of its largest component (u before v before w
/// where equal), and the others divided by that one. None where there is no direction.
pub fn direction_index(gradient: [i32; 3], bits: u32) -> Option<usize> {
    let sizes = gradient.map(i32::unsigned_abs);
    let largest = sizes[0].max(sizes[1]).max(sizes[2]);
    if largest == 0 {
        return None;
    }
    let axis = sizes.iter().position(|&size| size == largest)?;
    let half = 1_u32 << (bits - 1);
    let coordinate = |axis: usize| {
        let quotient = ((u64::from(sizes[axis]) << (bits - 1)) / u64::from(largest)) as u32;
        let quotient = quotient.min(half - 1);
        if gradient[axis] < 0 { half - 1 - quotient } else { half + quotient }
    };
    let face = 2 * axis as u32 + u32::from(gradient[axis] < 0);
    let (first, second) = (coordinate((axis + 1) % 3), coordinate((axis + 2) % 3));
    Some(((face << bits | second) << bits | first) as usize)
}

/// Light on a sample by table.
pub fn reflectance(gradient: [i32; 3], table: &ReflectanceTable) -> Light {
    match direction_index(gradient, table.bits) {
        Some(index) => Light { diffuse: table.diffuse[index], specular: table.specular[index] },
        None => Light { diffuse: [table.flat; 3], specular: [0; 3] },
    }
}

/// The colour of a lit sample, saturated at 1.
pub fn lit(colour: [u32; 3], light: Light, words: &Words) -> Counted<[u32; 3]> {
    let full = i64::from(unit_full(words.colour_bits));
    let mut overflows = 0;
    let value = [0, 1, 2].map(|i| {
        let product = i64::from(colour[i]) * i64::from(light.diffuse[i]);
        let sum = words.rounding.shift_right(product, words.colour_bits) + i64::from(light.specular[i]);
        overflows += u32::from(sum > full);
        sum.min(full) as u32
    });
    Counted { value, overflows }
}

/// Opacity and colour of a sample word by the tables of a parallel frame; a sample outside of the threshold has none.
pub fn classify(sample: i32, magnitude: u32, table: &Classification) -> Option<(u32, [u32; 3])> {
    classify_in(0, sample, magnitude, table)
}

/// The same with the opacity table of a class of step lengths.
pub fn classify_in(class: u32, sample: i32, magnitude: u32, table: &Classification) -> Option<(u32, [u32; 3])> {
    let word = sample as u32;
    if word < table.threshold[0] || word > table.threshold[1] {
        return None;
    }
    let index = (word >> table.index_shift) as usize;
    let (row, rows) =
        table.gradient_rows.map_or((0, 1), |rows| ((magnitude >> rows.shift).min(rows.rows - 1), rows.rows));
    let row = (class * rows + row) as usize;
    Some((table.opacity[row * table.colour.len() + index], table.colour[index]))
}

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

/// Everything that an ABC unit does to sample k of ray (u, v), which is in the volume. Overflows are counted where the
/// sample is not transparent.
pub fn shade(s: &Neighbourhood, at: [i64; 3], setup: &FrameSetup) -> Counted<Shaded> {
    let words = &setup.words;
    let sample = s[1][1][1];
    let nothing = Counted { value: Shaded { sample, ..Shaded::default() }, overflows: 0 };
    if setup.clips.iter().any(|clip| setup.geometry.evaluate(&clip.distance, at) < 0) {
        return nothing;
    }
    let gradient = match &setup.gradient {
        Some(registers) => local_gradient(s, registers, &Local::new(at, registers, setup), words),
        None => Counted { value: [0; 3], overflows: 0 },
    };
    let [row, column] = match &setup.rays {
        Some(_) => setup.geometry.slot_of(DiscreteRay { u: at[0], v: at[1] }),
        None => [0; 2],
    };
    let class = setup.rays.as_ref().map_or(0, |rays| rays.length_class(row, column));
    let normal = match &setup.normaliser {
        Some(normaliser) => normalise(gradient.value, normaliser, words),
        None => Normal { direction: [0; 3], magnitude: 0 },
    };
    let Some((opacity, colour)) = classify_in(class, sample, normal.magnitude, &setup.classification) else {
        return nothing;
    };
    if opacity == 0 {
        return Counted { value: Shaded { present: true, sample, opacity, colour: [0; 3] }, overflows: 0 };
    }
    let mut coloured = match &setup.shading {
        Some(Shading::Phong(registers)) => {
            let light = match (&setup.rays, &setup.normaliser) {
                (Some(rays), Some(table)) => {
                    let view = view_vector(row, column, rays, table, words);
                    let towards = |light: usize| match rays.at_eye[light] {
                        true => [view; 2],
                        false => {
                            let direction = registers.lights[light].direction;
                            [direction, halfway(direction, view, table, words)]
                        }
                    };
                    phong_from(normal.direction, registers, towards, words)
                }
                _ => phong(normal.direction, registers, words),
            };
            lit(colour, light, words)
        }
        Some(Shading::Table(table)) => lit(colour, reflectance(gradient.value, table), words),
        None => Counted { value: colour, overflows: 0 },
    };
    if let Some(cue) = &setup.depth_cue {
        coloured.value = cued(coloured.value, LinearFactor::word(setup.geometry.evaluate(&cue.factor, at)), words);
    }
    let shaded = Shaded { present: true, sample, opacity, colour: coloured.value };
    Counted { value: shaded, overflows: coloured.overflows + gradient.overflows }
}

/// A colour behind the depth cue's factor.
pub fn cued(colour: [u32; 3], factor: u32, words: &Words) -> [u32; 3] {
    colour.map(|c| words.rounding.shift_right(i64::from(c) * i64::from(factor), LinearFactor::WORD_BITS) as u32)
}
