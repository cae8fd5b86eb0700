//! What the registers and tables of a frame hold: numbers of scene, volume and view as words. The definition.

use crate::VolumeInfo;
use cube3_frame::{
    Axes, ConeRegisters, EndRegisters, Geometry, GradientRows, GradientScale, HalfSpace, Linear, LinearFactor, Phong,
    RayRegisters, SLOPE_FRACTION_BITS,
};
use cube3_machine::{Differences, GradientMethod, MachineSpec};
use cube3_scene::{Crop, Cut, DepthCue, Mode, Threshold, ViewFrame, corrected_opacity, smallest_spacing};
use cube3_word::{Words, quantise_fraction, unit_full, unit_resize};

/// A function `normal · p + constant` of the voxel position, over rays and depths, or over places in perspective.
pub(crate) fn linear(geometry: &Geometry, normal: [f64; 3], constant: f64, fraction_bits: u32) -> Linear {
    let one = (1_u64 << fraction_bits) as f64;
    let quantise = |x: f64, most: i64| (x * one).clamp(-(most as f64), most as f64).round() as i64;
    if geometry.perspective.is_some() {
        let [u, v, k] = normal.map(|x| quantise(x, Linear::STEEPEST_BY_PLACE));
        return Linear { u, v, k, constant: quantise(constant, Linear::FARTHEST) };
    }
    let [du, dv] = geometry.real_slopes();
    let along = normal[0] * du + normal[1] * dv + normal[2];
    Linear {
        u: quantise(normal[0], Linear::STEEPEST),
        v: quantise(normal[1], Linear::STEEPEST),
        k: quantise(along, Linear::STEEPEST),
        constant: quantise(constant + geometry.real_offset() * along, Linear::FARTHEST),
    }
}

/// `normal · (p − through)` of voxel positions x, y, z, in canonical coordinates: normal and constant.
fn canonical_plane(geometry: &Geometry, normal: [f64; 3], through: [f64; 3]) -> ([f64; 3], f64) {
    let mut constant = 0.0;
    let normal = [0, 1, 2].map(|i| {
        let axis = geometry.axes.axis[i];
        let last = (geometry.size[i] - 1) as f64;
        if geometry.axes.reversed[i] {
            constant += normal[axis] * (last - through[axis]);
            -normal[axis]
        } else {
            constant -= normal[axis] * through[axis];
            normal[axis]
        }
    });
    (normal, constant)
}

/// How far beside a face, in voxels, a sample counts as on it: more than the registers round by.
const ON_FACE: f64 = 1.0 / 65536.0;

/// The half-space before a plane through a point, whose normal points `outward`, both in voxels.
///
/// Where samples stand for whole steps and are added up, a sample on a face through which the ray enters is kept, and one on a face through
/// which it leaves is not: its step lies behind. So between two faces there are as many samples at every offset.
fn half_space(geometry: &Geometry, outward: [f64; 3], through: [f64; 3], whole_steps: bool) -> HalfSpace {
    let (normal, constant) = canonical_plane(geometry, outward.map(|x| -x), through);
    let along = match &geometry.perspective {
        None => linear(geometry, normal, 0.0, HalfSpace::FRACTION_BITS).k,
        // A face across the rays alone is entered or left by all of them.
        Some(_) if normal[0] == 0.0 && normal[1] == 0.0 => normal[2].signum() as i64,
        Some(_) => 0,
    };
    let kept = if whole_steps { along.signum() as f64 * ON_FACE } else { 0.0 };
    HalfSpace { distance: linear(geometry, normal, constant + kept, HalfSpace::FRACTION_BITS) }
}

/// The half-space of a cut.
pub(crate) fn cut(geometry: &Geometry, cut: &Cut, whole_steps: bool) -> HalfSpace {
    let largest = cut.normal.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    half_space(geometry, cut.normal.map(|x| x / largest), cut.through_voxel, whole_steps)
}

/// The half-spaces of a crop box: of x, y and z the least and the most.
pub(crate) fn crop(geometry: &Geometry, crop: &Crop, whole_steps: bool) -> [HalfSpace; 6] {
    std::array::from_fn(|face| {
        let mut outward = [0.0; 3];
        let (axis, most) = (face / 2, face % 2 == 1);
        outward[axis] = if most { 1.0 } else { -1.0 };
        half_space(geometry, outward, if most { crop.max_voxel } else { crop.min_voxel }, whole_steps)
    })
}

/// A factor of 1 everywhere.
pub(crate) fn neutral_cue() -> LinearFactor {
    LinearFactor { factor: Linear { u: 0, v: 0, k: 0, constant: 1 << LinearFactor::FRACTION_BITS } }
}

/// The cue along the view, from the nearest corner voxel, which is canonical (0, 0, 0) in a parallel view, to the farthest.
pub(crate) fn depth_cue(cue: &DepthCue, geometry: &Geometry, spacing: [f64; 3], view: &ViewFrame) -> LinearFactor {
    let direction = geometry.axes.to_canonical(view.direction);
    let spacing = geometry.axes.permute(spacing);
    let steps = [0, 1, 2].map(|i| direction[i] * spacing[i]);
    let reach = [0, 1, 2].map(|i| steps[i] * (geometry.size[i] - 1) as f64);
    let nearest: f64 = reach.iter().map(|x| x.min(0.0)).sum();
    let depth = reach.iter().map(|x| x.max(0.0)).sum::<f64>() - nearest;
    let rate = if depth > 0.0 { (cue.back - cue.front) / depth } else { 0.0 };
    let normal = steps.map(|step| step * rate);
    let at_origin = cue.front - nearest * rate;
    LinearFactor { factor: linear(geometry, normal, at_origin, LinearFactor::FRACTION_BITS) }
}

/// Length of a ray's step in units of the smallest voxel spacing: what opacity is corrected to.
pub fn step_length(geometry: &Geometry, spacing: [f64; 3]) -> f64 {
    let s = geometry.axes.permute(spacing);
    let [du, dv] = geometry.real_slopes();
    let smallest = smallest_spacing(spacing);
    let square = (s[0] * du).powi(2) + (s[1] * dv).powi(2) + s[2].powi(2);
    square.sqrt() / smallest
}

pub(crate) fn real_slope(register: i64) -> f64 {
    register as f64 / f64::from(1_u32 << SLOPE_FRACTION_BITS)
}

/// Step lengths that opacity is corrected to, in units of the smallest spacing: one in a parallel frame, in perspective the
/// middles of classes, and the parts of the squared length that put a ray into its class.
pub(crate) struct StepLengths {
    /// In units of the smallest spacing.
    pub lengths: Vec<f64>,
    /// Part of the squared length of each ray, by its place along u and along v.
    pub along_u: Vec<u32>,
    /// Along v.
    pub along_v: Vec<u32>,
}

/// Squared lengths that differ by less, relative to the shortest, share one class: the opacity is then off by less than a 16-bit word.
const SAME_LENGTH: f64 = 1e-6;

impl StepLengths {
    /// Those of a frame, where opacity is corrected to them; else one of 1.
    pub(crate) fn new(corrects: bool, geometry: &Geometry, spacing: [f64; 3]) -> StepLengths {
        let Some(pass) = &geometry.perspective else {
            let length = if corrects { step_length(geometry, spacing) } else { 1.0 };
            return StepLengths { lengths: vec![length], along_u: Vec::new(), along_v: Vec::new() };
        };
        let s = geometry.axes.permute(spacing);
        let squares = |slopes: &[i64], s: f64| -> Vec<f64> {
            slopes.iter().map(|&slope| (s * real_slope(slope)).powi(2)).collect()
        };
        let [along_u, along_v] = [squares(&pass.u.slopes, s[0]), squares(&pass.v.slopes, s[1])];
        let least = |squares: &[f64]| squares.iter().copied().fold(f64::INFINITY, f64::min);
        let most = |squares: &[f64]| squares.iter().copied().fold(0.0, f64::max);
        let [least_u, least_v] = [least(&along_u), least(&along_v)];
        let shortest = least_u + least_v + s[2].powi(2);
        let range = most(&along_u) - least_u + (most(&along_v) - least_v);
        let smallest = smallest_spacing(spacing);
        let classes = match corrects {
            true if range > shortest * SAME_LENGTH => RayRegisters::MOST_CLASSES,
            _ => 1,
        };
        // Classes from the shortest step to the longest; a ray is in the nearest. So the ray straight ahead has its own length.
        let lengths = (0..classes).map(|class| {
            let middle = f64::from(class) / f64::from((classes - 1).max(1));
            if corrects { (shortest + range * middle).sqrt() / smallest } else { 1.0 }
        });
        let top = f64::from((classes - 1) << RayRegisters::CLASS_SHIFT);
        let part = |squares: &[f64], least: f64, half: u32| -> Vec<u32> {
            let part =
                |square: &f64| if classes == 1 { 0 } else { ((square - least) / range * top).round() as u32 + half };
            squares.iter().map(part).collect()
        };
        let half = 1 << (RayRegisters::CLASS_SHIFT - 1);
        StepLengths {
            lengths: lengths.collect(),
            along_u: part(&along_u, least_u, half),
            along_v: part(&along_v, least_v, 0),
        }
    }
}

/// The frame that a gradient's components are in, treated as orthonormal by the shading unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    /// Unit vectors of the components, in canonical world lengths.
    pub vectors: [[f64; 3]; 3],
    /// Length that half of each difference is taken over, in the unit of the spacing.
    pub lengths: [f64; 3],
    /// Along-ray parts of the feet of the perpendiculars from the side rays, 0 to 1 (method 10).
    pub feet: [f64; 2],
    /// Whether the factors of the components differ from depth to depth: in perspective.
    pub varies: bool,
}

impl Basis {
    /// The frame of an estimator for a geometry and voxel `spacing` (x, y, z).
    pub fn new(geometry: &Geometry, spacing: [f64; 3], method: GradientMethod) -> Basis {
        let s = geometry.axes.permute(spacing);
        let [du, dv] = geometry.real_slopes();
        let ray = [s[0] * du, s[1] * dv, s[2]];
        let square: f64 = ray.iter().map(|x| x * x).sum();
        let feet = [(s[0] * ray[0] / square).min(1.0), (s[1] * ray[1] / square).min(1.0)];
        let (vectors, lengths) = match method.row().differences {
            Differences::Feet => {
                let side = |axis: usize| {
                    let mut vector = ray.map(|x| -feet[axis] * x);
                    vector[axis] += s[axis];
                    vector
                };
                let vectors = [side(0), side(1), ray];
                let lengths = vectors.map(|v| v.iter().map(|x| x * x).sum::<f64>().sqrt());
                ([0, 1, 2].map(|i| vectors[i].map(|x| x / lengths[i])), lengths)
            }
            _ => ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], s),
        };
        Basis { vectors, lengths, feet, varies: geometry.perspective.is_some() }
    }

    /// Factors that the components are multiplied with, the largest 1; and the length that the
    /// differences are then relative to.
    pub fn scale(&self, method: GradientMethod) -> ([f64; 3], f64) {
        let shortest = self.lengths.iter().copied().fold(f64::INFINITY, f64::min);
        if !method.row().normalised {
            return ([1.0; 3], shortest);
        }
        (self.lengths.map(|length| shortest / length), shortest)
    }

    /// A world vector in the frame's components.
    pub fn components(&self, axes: &Axes, world: glam::DVec3) -> [f64; 3] {
        let canonical = axes.to_canonical(world);
        self.vectors.map(|v| v[0] * canonical[0] + v[1] * canonical[1] + v[2] * canonical[2])
    }

    /// A gradient in the frame's components as a world vector.
    pub fn world(&self, axes: &Axes, components: [f64; 3]) -> glam::DVec3 {
        let canonical = [0, 1, 2].map(|i| (0..3).map(|j| components[j] * self.vectors[j][i]).sum());
        axes.to_world(canonical)
    }
}

/// The factors of a frame, in perspective where rays are a voxel apart; where all are 1 at every depth, nothing is kept below
/// the gradient's word.
pub(crate) fn gradient_scale(machine: &MachineSpec, basis: &Basis) -> GradientScale {
    let method = machine.abc.gradient;
    let (factors, _) = basis.scale(method);
    let factors = factors.map(factor);
    let scale = GradientScale { factors, kept_bits: 0 };
    let kept_bits = GradientScale::FACTOR_BITS.min(GradientScale::room(method, &machine.words));
    if is_unity(&scale) && !basis.varies { scale } else { GradientScale { kept_bits, ..scale } }
}

pub(crate) fn is_unity(scale: &GradientScale) -> bool {
    scale.factors.iter().all(|&factor| factor == 1 << GradientScale::FACTOR_BITS)
}

/// A factor of a gradient's component, 0 to 1.
pub(crate) fn factor(x: f64) -> u32 {
    quantise_fraction(x, GradientScale::FACTOR_BITS)
}

/// The data value of a sample word, on a scale on which whole words are voxel words; also between words.
fn value_of(sample: f64, words: &Words, [low, high]: [f64; 2]) -> f64 {
    let (full, fraction) = (f64::from(unit_full(words.voxel_bits)), f64::from(1_u32 << words.sample_fraction_bits));
    low + sample / fraction / full * (high - low)
}

/// The data value that entry `index` of the tables stands for: that in the middle of the samples that share it; of labels the first, which is
/// the only one where the table is wide enough.
pub(crate) fn entry_value(index: u32, labels: bool, words: &Words, window: [f64; 2]) -> f64 {
    let wide = f64::from(1_u32 << (words.sample_bits() - words.table_bits));
    let [low, high] = window;
    if labels {
        let (full, fraction) = (f64::from(unit_full(words.voxel_bits)), f64::from(1_u32 << words.sample_fraction_bits));
        // The product comes before the quotient: whole multiples come out exact.
        return (low + f64::from(index) * wide / fraction * (high - low) / full).floor();
    }
    value_of((f64::from(index) + 0.5) * wide - 0.5, words, window)
}

/// The gradient's magnitude in the middle of a row, in words; 0 where there is one row.
pub(crate) fn row_magnitude(row: u32, rows: Option<GradientRows>) -> f64 {
    let width = rows.map_or(0.0, |rows| f64::from(1_u32 << rows.shift));
    ((f64::from(row) + 0.5) * width - 0.5).max(0.0)
}

/// The rows of a table in whose last one the largest gradient is at most, with magnitudes of `unit`.
pub(crate) fn gradient_rows(largest: f64, unit: f64, row_bits: u32) -> GradientRows {
    let rows = 1_u32 << row_bits;
    let reaches = |shift: &u32| f64::from(rows) * f64::from(1_u32 << shift) * unit >= largest;
    GradientRows { shift: (0..=30).find(reaches).unwrap_or(30), rows }
}

/// The opacity word for an opacity of unit length, over a step of so many; `one` is the word of opacity 1.
pub(crate) fn opacity_word(alpha: f64, length: f64, one: u32) -> u32 {
    (corrected_opacity(alpha, length) * f64::from(one)).round() as u32
}

/// The gradient, in data values for each smallest voxel spacing, that a magnitude word of 1 stands for.
pub(crate) fn magnitude_unit(machine: &MachineSpec, volume: &VolumeInfo, basis: &Basis) -> f64 {
    let words = &machine.words;
    let smallest = smallest_spacing(volume.spacing);
    let (_, length) = basis.scale(machine.abc.gradient);
    let kept = gradient_scale(machine, basis).kept_bits;
    let dropped = f64::from(1_u32 << words.gradient_drop()) / f64::from(1_u32 << (words.sample_fraction_bits + kept));
    let value = (volume.window[1] - volume.window[0]) / f64::from(unit_full(words.voxel_bits));
    value * dropped * 0.5 * smallest / length
}

/// The scene's threshold as sample words, inclusive.
pub(crate) fn threshold(threshold: Option<&Threshold>, words: &Words, window: [f64; 2]) -> [u32; 2] {
    let top = unit_full(words.voxel_bits) << words.sample_fraction_bits;
    let [low, high] = window;
    let word_of = |value: f64| (value - low) / (high - low) * f64::from(top);
    let bounds = threshold.map_or((None, None), |threshold| (threshold.low, threshold.high));
    let last = unit_full(words.sample_bits());
    [
        bounds.0.map_or(0, |value| word_of(value).ceil().clamp(0.0, f64::from(last)) as u32),
        bounds.1.map_or(last, |value| word_of(value).floor().clamp(0.0, f64::from(last)) as u32),
    ]
}

/// The weight of a weighted sum: one of the samples of a ray through all planes, or one step of those from the front face to the back one,
/// where opacity 1 over a `whole` step has a word of its own.
pub(crate) fn sum_weight(words: &Words, geometry: &Geometry, whole: Option<u32>) -> u64 {
    let one = 1_u64 << ConeRegisters::WEIGHT_BITS;
    let Some(whole) = whole else {
        return one / geometry.size[2] as u64;
    };
    let bits = words.accumulator_bits;
    let whole = unit_resize(whole, words.opacity_bits, bits).max(1);
    let steps = geometry.bounding_planes().saturating_sub(1).max(1) as u128;
    (u128::from(one) * u128::from(unit_full(bits)) / (u128::from(whole) * steps)).min(one.into()) as u64
}

/// The opacity word that stands for opacity 1 over a whole step, where the ends of rays have parts. In a weighted sum an end may weigh as
/// much as several whole steps, at most as all between the first plane and the last.
pub fn whole_step_opacity(mode: Mode, words: &Words, depths: usize) -> u32 {
    let full = unit_full(words.opacity_bits);
    let most = (depths as u32).saturating_sub(1).clamp(1, 2 * EndRegisters::MOST_REACH);
    if mode == Mode::WeightedSum { full.div_ceil(most) } else { full }
}

pub(crate) fn longest(lengths: &[f64]) -> f64 {
    lengths.iter().copied().fold(0.0, f64::max)
}

/// Inside of the box of voxel centres, or of whole voxels: behind its front faces and before its back ones.
pub(crate) fn faces(geometry: &Geometry) -> [HalfSpace; 6] {
    let side = |axis: usize, sign: f64, at: f64| {
        let mut normal = [0.0; 3];
        normal[axis] = sign;
        HalfSpace { distance: linear(geometry, normal, -sign * at, HalfSpace::FRACTION_BITS) }
    };
    let margin = if geometry.nearest() { 0.5 } else { 0.0 };
    let last = geometry.size.map(|n| (n - 1) as f64 + margin);
    let front = [-margin, -margin, front_depth(geometry, margin)];
    std::array::from_fn(|face| {
        let (axis, back) = (face / 2, face % 2 == 1);
        if back { side(axis, -1.0, last[axis]) } else { side(axis, 1.0, front[axis]) }
    })
}

/// The depth of the front face, or of the eye behind it, where rays begin.
fn front_depth(geometry: &Geometry, margin: f64) -> f64 {
    let Some(pass) = &geometry.perspective else {
        return -margin;
    };
    let eye = pass.first_depth as f64 - pass.spacing[0] as f64 / pass.spacing[1] as f64;
    if pass.first_depth == 0 { eye.clamp(-margin, 0.0) } else { eye }
}

/// Opacity tables of the ends, for opacities of unit length: class j is for j of the 2^[`EndRegisters::PART_BITS`] parts of the longest
/// step. One part after the other is composited, which takes one power for all; a weighted sum weighs by the part instead.
pub(crate) fn end_tables(alphas: &[f64], lengths: &[f64], mode: Mode, opacity_bits: u32, whole: u32) -> Vec<u32> {
    let (full, whole) = (f64::from(unit_full(opacity_bits)), f64::from(whole));
    let part = 1.0 / f64::from(1_u32 << EndRegisters::PART_BITS);
    let composites = mode == Mode::Composite;
    let length = longest(lengths) * part;
    let each: Vec<f64> =
        alphas.iter().map(|&alpha| if composites { corrected_opacity(alpha, length) } else { alpha * part }).collect();
    let mut sum = vec![0.0; alphas.len()];
    let mut words = Vec::with_capacity(alphas.len() * EndRegisters::CLASSES as usize);
    for _ in 0..EndRegisters::CLASSES {
        words.extend(sum.iter().map(|&sum| (sum * whole).round().min(full) as u32));
        for (sum, each) in sum.iter_mut().zip(&each) {
            *sum += if composites { (1.0 - *sum) * each } else { *each };
        }
    }
    words
}

/// An intensity 0 to [`Phong::MOST_INTENSITY`] as a fraction of the colour bits.
pub(crate) fn intensity(value: f64, colour_bits: u32) -> u32 {
    let one = f64::from(1_u32 << colour_bits);
    (value.clamp(0.0, f64::from(Phong::MOST_INTENSITY)) * one).round() as u32
}

/// An added intensity on the scale of a unit colour word.
pub(crate) fn added(value: f64, colour_bits: u32) -> u32 {
    (value.clamp(0.0, f64::from(Phong::MOST_INTENSITY)) * f64::from(cube3_word::unit_full(colour_bits))).round() as u32
}
