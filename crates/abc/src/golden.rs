//! Gradient, classification and shading of one sample. The definition.

use cube3_frame::{
    Classification, DiscreteRay, EndRegisters, FrameSetup, GradientRegisters, GradientRows, GradientScale,
    LinearFactor, Normaliser, Phong, PhongLight, RayRegisters, ReflectanceTable, Shading,
};

use cube3_machine::{Differences, GradientMethod};
use cube3_word::{Probe, Words, lerp_wires, saturate, unit_full};
use serde::{Deserialize, Serialize};

/// The sample and its 26 neighbours, `[w][v][u]` with the sample itself at `[1][1][1]`: w along the ray, v from
/// plane to plane, u from ray to ray, in near frames [`FrameSetup::reach`] of them away. Samples beyond the volume are the border word.
pub type Neighbourhood = [[[i32; 3]; 3]; 3];

/// Something with the number of words that overflowed and were saturated on the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted<T> {
    /// The value.
    pub value: T,
    /// Saturated words.
    pub overflows: u32,
}

/// Counts the words that were saturated.
fn counted<T>(words: [(T, bool); 3]) -> Counted<[T; 3]> {
    let overflows = words.iter().map(|(_, saturated)| u32::from(*saturated)).sum();
    Counted { value: words.map(|(word, _)| word), overflows }
}

/// Shows a row of wires.
fn show<T: Into<i128>>(probe: &mut impl Probe, name: &'static str, values: impl IntoIterator<Item = T>) {
    for (place, value) in values.into_iter().enumerate() {
        probe.wire(name, place, value.into());
    }
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
    counted(local_gradient_wires(s, registers, local, words, &mut ()))
}

/// [`local_gradient`], whether each word was saturated, and what its wires carry: components u and v are the part `across`,
/// w is `along`.
pub fn local_gradient_wires(
    s: &Neighbourhood,
    registers: &GradientRegisters,
    local: &Local,
    words: &Words,
    probe: &mut impl Probe,
) -> [(i32, bool); 3] {
    let turn = |i: usize, mirrored: bool| if mirrored { 2 - i } else { i };
    let [mirror_u, mirror_v] = local.mirrored;
    let s = [0, 1, 2].map(|w| [0, 1, 2].map(|v| [0, 1, 2].map(|u| s[w][turn(v, mirror_v)][turn(u, mirror_u)])));
    let (differences, extra) = differences(&s, registers.method, local, words, probe);
    let kept = registers.scale.map_or(0, |scale| scale.kept_bits);
    [0, 1, 2].map(|i| {
        let (part, place) = [("across", 0), ("across", 1), ("along", 0)][i];
        probe.within(part, place, |probe| {
            let mirrored = local.mirrored.get(i) == Some(&true);
            let turned = if mirrored { -differences[i] } else { differences[i] };
            let scaled = match local.factors {
                Some(factors) => {
                    let product = turned * i64::from(factors[i]);
                    probe.wire("product", 0, product.into());
                    words.rounding.shift_right(product, GradientScale::FACTOR_BITS - kept)
                }
                None => turned,
            };
            let dropped = words.rounding.shift_right(scaled, words.gradient_drop() + extra);
            let (word, saturated) = saturate(dropped, words.gradient_bits + kept);
            probe.wire("difference", 0, differences[i].into());
            if i < 2 {
                probe.wire("turned", 0, turned.into());
            }
            probe.wire("scaled", 0, scaled.into());
            probe.wire("dropped", 0, dropped.into());
            probe.wire("word", 0, word.into());
            (word, saturated)
        })
    })
}

/// Differences along u, v and w, and the bits by which their weights exceed 1.
fn differences(
    s: &Neighbourhood,
    method: GradientMethod,
    local: &Local,
    words: &Words,
    probe: &mut impl Probe,
) -> ([i64; 3], u32) {
    let [du, dv] = local.here;
    let between = |far: i32, near: i32| i64::from(far) - i64::from(near);
    let straight =
        || [between(s[1][1][2], s[1][1][0]), between(s[1][2][1], s[1][0][1]), between(s[2][1][1], s[0][1][1])];
    let row = method.row();
    let differences = match row.differences {
        Differences::Central => straight(),
        Differences::Weighted => weighted(s, probe),
        Differences::Feet => {
            let mut foot = |place, side: i32, on_ray: i32, weight| {
                probe.within("foot", place, |probe| {
                    lerp_wires(side, on_ray, weight, words.weight_bits, words.rounding, probe)
                })
            };
            // The foot of the perpendicular from a side ray lies towards the eye on the right, away on the left.
            let right = foot(0, s[1][1][2], s[0][1][2], du);
            let left = foot(1, s[1][1][0], s[2][1][0], du);
            let below = foot(2, s[1][2][1], s[0][2][1], dv);
            let above = foot(3, s[1][0][1], s[2][0][1], dv);
            let [_, _, ray] = straight();
            [between(right, left), between(below, above), ray]
        }
        Differences::Bilinear => {
            // Straight behind the sample on slice k+1 lies between rays u−1 and u, v−1 and v; before it, the mirror image.
            let mut bilinear = |number: usize, slice: &[[i32; 3]; 3], v: usize, u: usize, [du, dv]: [u32; 2]| {
                let mut lerp = |part, place, near, far, weight| {
                    probe.within(part, place, |probe| {
                        lerp_wires(near, far, weight, words.weight_bits, words.rounding, probe)
                    })
                };
                let near = lerp("along_u", 2 * number, slice[1][1], slice[1][u], du);
                let far = lerp("along_u", 2 * number + 1, slice[v][1], slice[v][u], du);
                lerp("along_v", number, near, far, dv)
            };
            let behind = bilinear(0, &s[2], 0, 0, local.behind);
            let before = bilinear(1, &s[0], 2, 2, local.before);
            let [u, v, _] = straight();
            [u, v, between(behind, before)]
        }
    };
    let differences = near(differences, local, words, probe);
    let differences = if row.sheared { shear(differences, local, words, probe) } else { differences };
    (differences, row.extra_bits())
}

/// Where neighbours are less than a voxel away, u and v are relative to their distance, and so is the ray.
fn near([u, v, ray]: [i64; 3], local: &Local, words: &Words, probe: &mut impl Probe) -> [i64; 3] {
    let Some(nearness) = local.nearness else {
        return [u, v, ray];
    };
    let product = ray * i64::from(nearness);
    let near = words.rounding.shift_right(product, GradientScale::FACTOR_BITS);
    probe.within("along", 0, |probe| {
        probe.wire("straight", 0, ray.into());
        probe.wire("near_product", 0, product.into());
        probe.wire("near", 0, near.into());
    });
    [u, v, near]
}

/// What the ray's difference has of u and v is taken away.
fn shear([u, v, ray]: [i64; 3], local: &Local, words: &Words, probe: &mut impl Probe) -> [i64; 3] {
    let [du, dv] = local.here;
    let products = [u * i64::from(du), v * i64::from(dv)];
    let sum = products[0] + products[1];
    let shear = words.rounding.shift_right(sum, words.weight_bits);
    probe.within("along", 0, |probe| {
        show(probe, "shear_product", products);
        probe.wire("shear_sum", 0, sum.into());
        probe.wire("shear", 0, shear.into());
    });
    [u, v, ray - shear]
}

/// Differences of the 26-neighbourhood with weights 4, 2, 1 by Manhattan distance: sixteen times those of one pair.
fn weighted(s: &Neighbourhood, probe: &mut impl Probe) -> [i64; 3] {
    let mut sums = [0; 3];
    for (a, first) in [1, 2, 1].into_iter().enumerate() {
        for (b, second) in [1, 2, 1].into_iter().enumerate() {
            let pairs = [[s[a][b][2], s[a][b][0]], [s[a][2][b], s[a][0][b]], [s[2][a][b], s[0][a][b]]];
            for (axis, [far, near]) in pairs.into_iter().enumerate() {
                let pair = i64::from(far) - i64::from(near);
                probe.wire("pair", 9 * axis + 3 * a + b, pair.into());
                sums[axis] += first * second * pair;
            }
        }
    }
    sums
}

/// A normalised gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Normal {
    /// Direction, fractions of `normal_bits − 1`, −1 to 1 inclusive; all 0 where the gradient is.
    pub direction: [i32; 3],
    /// Length of the gradient, in its own words.
    pub magnitude: u32,
}

/// Normalises a gradient: a block shift brings its largest component to `normal_bits` B, and a table of reciprocal
/// roots over the squared length, `2^(2B−2)` to `3·2^(2B)`, does the rest. Odd in every component.
pub fn normalise(gradient: [i32; 3], table: &Normaliser, words: &Words) -> Normal {
    normalise_wires(gradient, table, words, &mut ())
}

/// [`normalise`], and what its wires carry.
pub fn normalise_wires(gradient: [i32; 3], table: &Normaliser, words: &Words, probe: &mut impl Probe) -> Normal {
    let bits = words.normal_bits;
    let sizes = gradient.map(i32::unsigned_abs);
    let largest = sizes[0] | sizes[1] | sizes[2];
    show(probe, "size", sizes);
    if largest == 0 {
        return Normal { direction: [0; 3], magnitude: 0 };
    }
    let zeros = largest.leading_zeros();
    let block = sizes.map(|size| (size << zeros) >> (32 - bits));
    let square: u32 = block.iter().map(|a| a * a).sum();
    let index = (square >> (2 * bits - 2 - table.root_bits)) - (1 << table.root_bits);
    let reciprocal = table.root[index as usize];
    let one = 1 << (bits - 1);
    let products = block.map(|a| a * reciprocal);
    let rounded = products.map(|product| (product + (1 << (bits - 1))) >> bits);
    let unit = rounded.map(|component| component.min(one));
    let direction = [0, 1, 2].map(|i| if gradient[i] < 0 { -(unit[i] as i32) } else { unit[i] as i32 });
    let length: u64 = (0..3).map(|i| u64::from(block[i]) * u64::from(unit[i])).sum();
    let magnitude = magnitude(length, zeros, bits);
    probe.wire("highest", 0, (31 - zeros).into());
    show(probe, "block", block);
    probe.wire("square", 0, square.into());
    probe.wire("index", 0, index.into());
    probe.wire("reciprocal", 0, reciprocal.into());
    show(probe, "product", products);
    show(probe, "rounded", rounded);
    show(probe, "unit", unit);
    show(probe, "direction", direction);
    probe.wire("length", 0, length.into());
    probe.wire("aligned", 0, (length << (31 - zeros)).into());
    probe.wire("magnitude", 0, magnitude.into());
    Normal { direction, magnitude }
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
pub struct ReflectedLight {
    /// Multiplies.
    pub diffuse: [u32; 3],
    /// Is added.
    pub specular: [u32; 3],
}

/// Phong's formula in integers, with lights that are the same for all samples.
pub fn phong(normal: [i32; 3], phong: &Phong, words: &Words) -> ReflectedLight {
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
pub fn phong_from(
    normal: [i32; 3],
    phong: &Phong,
    towards: impl Fn(usize) -> [[i32; 3]; 2],
    words: &Words,
) -> ReflectedLight {
    phong_wires(normal, phong, towards, words, &mut ())
}

/// [`phong_from`], and what its wires carry.
pub fn phong_wires(
    normal: [i32; 3],
    phong: &Phong,
    towards: impl Fn(usize) -> [[i32; 3]; 2],
    words: &Words,
    probe: &mut impl Probe,
) -> ReflectedLight {
    let one_bits = words.normal_bits - 1;
    let mut light = ReflectedLight { diffuse: [phong.ambient; 3], specular: [0; 3] };
    for (number, source) in phong.lights.iter().enumerate() {
        let [direction, halfway] = towards(number);
        let towards = probe.within("towards", number, |probe| cosine(normal, direction, phong.two_sided, words, probe));
        let lit = phong.two_sided || towards > 0;
        let power = probe.within("half", number, |probe| {
            let half = cosine(normal, halfway, phong.two_sided, words, probe);
            let index = words.rounding.shift_right(half, one_bits - phong.power_bits);
            let power = if lit { i64::from(phong.power[index as usize]) } else { 0 };
            probe.wire("index", 0, index.into());
            probe.wire("power", 0, power.into());
            power
        });
        let diffuse_products = source.diffuse.map(|intensity| i64::from(intensity) * towards);
        let specular_products = source.specular.map(|intensity| i64::from(intensity) * power);
        let diffuse = diffuse_products.map(|product| words.rounding.shift_right(product, one_bits) as u32);
        let specular = specular_products.map(|product| words.rounding.shift_right(product, words.colour_bits) as u32);
        for i in 0..3 {
            light.diffuse[i] += diffuse[i];
            light.specular[i] += specular[i];
        }
        probe.within("light", 3 * number, |probe| {
            show(probe, "diffuse_product", diffuse_products);
            show(probe, "diffuse", diffuse);
            show(probe, "specular_product", specular_products);
            show(probe, "specular", specular);
        });
    }
    show(probe, "diffuse", light.diffuse);
    show(probe, "specular", light.specular);
    light
}

/// The cosine between a normal and a direction, a fraction of `normal_bits − 1`, at most 1; from behind, none or the same.
fn cosine(normal: [i32; 3], direction: [i32; 3], two_sided: bool, words: &Words, probe: &mut impl Probe) -> i64 {
    let one_bits = words.normal_bits - 1;
    let dot: i64 = (0..3).map(|i| i64::from(normal[i]) * i64::from(direction[i])).sum();
    // The back is lit as the front, to the bit: the magnitude is taken before it is rounded.
    let positive = if two_sided { dot.abs() } else { dot.max(0) };
    let rounded = words.rounding.shift_right(positive, one_bits);
    let cosine = rounded.min(1 << one_bits);
    probe.wire("dot", 0, dot.into());
    probe.wire("positive", 0, positive.into());
    probe.wire("rounded", 0, rounded.into());
    probe.wire("cosine", 0, cosine.into());
    cosine
}

/// The entry of a reflectance table for a gradient's direction: the face of its largest component (u before v before w
/// where equal), and the others divided by that one. None where there is no direction.
pub fn direction_index(gradient: [i32; 3], bits: u32) -> Option<usize> {
    direction_index_wires(gradient, bits, &mut ())
}

/// [`direction_index`], and what its wires carry.
pub fn direction_index_wires(gradient: [i32; 3], bits: u32, probe: &mut impl Probe) -> Option<usize> {
    let sizes = gradient.map(i32::unsigned_abs);
    let largest = sizes[0].max(sizes[1]).max(sizes[2]);
    show(probe, "size", sizes);
    probe.wire("largest", 0, largest.into());
    if largest == 0 {
        return None;
    }
    let axis = sizes.iter().position(|&size| size == largest)?;
    let half = 1_u32 << (bits - 1);
    let others = [(axis + 1) % 3, (axis + 2) % 3];
    let dividends = others.map(|axis| u64::from(sizes[axis]) << (bits - 1));
    let quotients = dividends.map(|dividend| (dividend / u64::from(largest)) as u32);
    let held = quotients.map(|quotient| quotient.min(half - 1));
    let coordinate = |held: u32, axis: usize| if gradient[axis] < 0 { half - 1 - held } else { half + held };
    let [first, second] = [0, 1].map(|i| coordinate(held[i], others[i]));
    let face = 2 * axis as u32 + u32::from(gradient[axis] < 0);
    let entry = (face << bits | second) << bits | first;
    probe.wire("face", 0, face.into());
    show(probe, "dividend", dividends);
    show(probe, "quotient", quotients);
    show(probe, "held", held);
    show(probe, "coordinate", [first, second]);
    probe.wire("entry", 0, entry.into());
    Some(entry as usize)
}

/// Light on a sample by table.
pub fn reflectance(gradient: [i32; 3], table: &ReflectanceTable) -> ReflectedLight {
    reflectance_wires(gradient, table, &mut ())
}

/// [`reflectance`], and what its wires carry.
pub fn reflectance_wires(gradient: [i32; 3], table: &ReflectanceTable, probe: &mut impl Probe) -> ReflectedLight {
    match direction_index_wires(gradient, table.bits, probe) {
        Some(index) => ReflectedLight { diffuse: table.diffuse[index], specular: table.specular[index] },
        None => ReflectedLight { diffuse: [table.flat; 3], specular: [0; 3] },
    }
}

/// The colour of a lit sample, saturated at 1.
pub fn lit(colour: [u32; 3], light: ReflectedLight, words: &Words) -> Counted<[u32; 3]> {
    counted(lit_wires(colour, light, words, &mut ()))
}

/// [`lit`], whether each word was saturated, and what its wires carry.
pub fn lit_wires(colour: [u32; 3], light: ReflectedLight, words: &Words, probe: &mut impl Probe) -> [(u32, bool); 3] {
    let full = i64::from(unit_full(words.colour_bits));
    [0, 1, 2].map(|i| {
        let product = i64::from(colour[i]) * i64::from(light.diffuse[i]);
        let scaled = words.rounding.shift_right(product, words.colour_bits);
        let sum = scaled + i64::from(light.specular[i]);
        let value = sum.min(full);
        probe.wire("product", i, product.into());
        probe.wire("scaled", i, scaled.into());
        probe.wire("sum", i, sum.into());
        probe.wire("value", i, value.into());
        (value as u32, sum > full)
    })
}

/// Whether sample k of a ray takes part by its place alone: it is in the volume, and within every clip.
pub fn in_place(ray: DiscreteRay, k: i64, setup: &FrameSetup) -> bool {
    let at = [ray.u, ray.v, k];
    setup.geometry.has_sample(ray, k) && setup.clips.iter().all(|clip| setup.geometry.evaluate(&clip.distance, at) >= 0)
}

/// The class of the opacity table of sample k of ray (u, v), which is in the volume and within every clip: that of the ray's step length;
/// for the first and the last of such samples of a ray, where ends have parts, that of the part of a step that it stands for.
pub fn opacity_class(at: [i64; 3], setup: &FrameSetup) -> u32 {
    let ray = DiscreteRay { u: at[0], v: at[1] };
    let none_of = |mut depths: std::ops::Range<i64>| setup.ends.is_some() && !depths.any(|k| in_place(ray, k, setup));
    let ends = [none_of(0..at[2]), none_of(at[2] + 1..setup.geometry.size[2] as i64)];
    class_of(ends, at, setup)
}

/// The same for a sample that is known to be the `first` or the `last` of its ray, both or neither.
pub fn class_of([first, last]: [bool; 2], at: [i64; 3], setup: &FrameSetup) -> u32 {
    let step = setup.rays.as_ref().map_or(0, |rays| {
        let [row, column] = setup.geometry.slot_of(DiscreteRay { u: at[0], v: at[1] });
        rays.length_class(row, column)
    });
    match &setup.ends {
        Some(ends) if first || last => {
            let half = 1 << (EndRegisters::REACH_BITS - 1);
            let before = if first { reach(at, true, setup, ends) } else { half };
            let behind = if last { reach(at, false, setup, ends) } else { half };
            end_class(before + behind, last, step, ends)
        }
        _ => step,
    }
}

/// How far a ray reaches from its sample k, towards the eye or away from it, before it is outside of the volume or a clip: steps, a
/// fraction of [`EndRegisters::REACH_BITS`], at most [`EndRegisters::MOST_REACH`].
pub fn reach(at: [i64; 3], towards_eye: bool, setup: &FrameSetup, ends: &EndRegisters) -> u32 {
    let half_spaces = setup.clips.iter().chain(&ends.faces);
    let reaches = half_spaces.map(|half_space| {
        let distance = setup.geometry.evaluate(&half_space.distance, at);
        let step = setup.geometry.step(&half_space.distance, [at[0], at[1]]);
        steps_to(distance, if towards_eye { step } else { -step })
    });
    reaches.min().unwrap_or(EndRegisters::MOST_REACH << EndRegisters::REACH_BITS)
}

/// The steps in which a distance is used up, rounded to nearest; the most there are where it never is. A sample that rounded weights
/// have let out of the volume has none.
pub fn steps_to(distance: i64, step: i64) -> u32 {
    let most = i64::from(EndRegisters::MOST_REACH);
    if step <= 0 || distance >= most * step {
        return EndRegisters::MOST_REACH << EndRegisters::REACH_BITS;
    }
    let twice = (distance.max(0) << (EndRegisters::REACH_BITS + 1)) + step;
    (twice / (2 * step)) as u32
}

/// The table for a part of a step, a fraction of [`EndRegisters::REACH_BITS`], of a ray of a class of step lengths: to the nearest part of
/// the longest step. Between two, the last sample of a ray takes the lower one and another the higher, so that the two ends of a ray
/// which share a step have all of it.
pub fn end_class(part: u32, last: bool, step_class: u32, ends: &EndRegisters) -> u32 {
    let length = part * ends.steps[step_class as usize];
    let bits = EndRegisters::REACH_BITS + EndRegisters::STEP_BITS - EndRegisters::PART_BITS;
    let rounded = (length + (1 << (bits - 1)) - u32::from(last)) >> bits;
    ends.first_class + rounded
}

/// Opacity and colour of a sample word by the tables of a parallel frame; a sample outside of the threshold has none.
pub fn classify(sample: i32, magnitude: u32, table: &Classification) -> Option<(u32, [u32; 3])> {
    classify_in(0, sample, magnitude, table)
}

/// The same with the opacity table of a class of step lengths or of an end.
pub fn classify_in(class: u32, sample: i32, magnitude: u32, table: &Classification) -> Option<(u32, [u32; 3])> {
    classify_wires(class, sample, magnitude, table, &mut ())
}

/// [`classify_in`], and what its wires carry.
pub fn classify_wires(
    class: u32,
    sample: i32,
    magnitude: u32,
    table: &Classification,
    probe: &mut impl Probe,
) -> Option<(u32, [u32; 3])> {
    let [opacity, colour] = TableAddresses::of(table).find(class, sample, magnitude, probe)?;
    Some((table.opacity[opacity], table.colour[colour]))
}

/// Where the classification tables hold what becomes of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableAddresses {
    /// See [`Classification::threshold`].
    pub threshold: [u32; 2],
    /// See [`Classification::index_shift`].
    pub index_shift: u32,
    /// One row where opacity does not depend on the gradient.
    pub rows: GradientRows,
    /// Entries of a row.
    pub entries: usize,
}

impl TableAddresses {
    /// Those of a table.
    pub fn of(table: &Classification) -> TableAddresses {
        TableAddresses {
            threshold: table.threshold,
            index_shift: table.index_shift,
            rows: table.gradient_rows.unwrap_or(GradientRows { shift: 0, rows: 1 }),
            entries: table.colour.len(),
        }
    }

    /// The entries of opacity and of colour; none for a sample outside of the threshold.
    pub fn find(&self, class: u32, sample: i32, magnitude: u32, probe: &mut impl Probe) -> Option<[usize; 2]> {
        let word = sample as u32;
        let visible = (self.threshold[0]..=self.threshold[1]).contains(&word);
        probe.wire("visible", 0, visible.into());
        if !visible {
            return None;
        }
        let index = (word >> self.index_shift) as usize;
        let shifted = magnitude >> self.rows.shift;
        let row = shifted.min(self.rows.rows - 1);
        let entry = (class * self.rows.rows + row) as usize * self.entries + index;
        probe.wire("index", 0, index as i128);
        probe.wire("shifted", 0, shifted.into());
        probe.wire("row", 0, row.into());
        probe.wire("entry", 0, entry as i128);
        Some([entry, index])
    }
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

/// A colour behind the depth cue's factor.
pub fn cued(colour: [u32; 3], factor: u32, words: &Words) -> [u32; 3] {
    cued_wires(colour, factor, words, &mut ())
}

/// [`cued`], and what its wires carry.
pub fn cued_wires(colour: [u32; 3], factor: u32, words: &Words, probe: &mut impl Probe) -> [u32; 3] {
    let products = colour.map(|c| i64::from(c) * i64::from(factor));
    let values = products.map(|product| words.rounding.shift_right(product, LinearFactor::WORD_BITS) as u32);
    show(probe, "product", products);
    show(probe, "value", values);
    values
}
