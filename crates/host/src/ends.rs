//! Registers and tables for the ends of rays: what [`EndRegisters`] says, made from scene and machine.

use crate::setup::linear;
use cube3_frame::{EndRegisters, Geometry, HalfSpace};
use cube3_machine::{MachineSpec, RayEnds};
use cube3_scene::{Mode, Scene, corrected_opacity};
use cube3_word::{Words, unit_full};

/// The registers for a geometry and the lengths of its steps, where the machine and the mode have use for them.
pub(crate) fn registers(
    scene: &Scene,
    machine: &MachineSpec,
    geometry: &Geometry,
    lengths: &[f64],
) -> Option<EndRegisters> {
    let longest = longest(lengths);
    has_ends(scene, machine).then(|| EndRegisters {
        faces: faces(geometry),
        first_class: lengths.len() as u32,
        steps: lengths
            .iter()
            .map(|length| (length / longest * f64::from(1_u32 << EndRegisters::STEP_BITS)).round() as u32)
            .collect(),
    })
}

/// Whether the ends of rays have parts of their own: in modes that add up along a ray.
pub(crate) fn has_ends(scene: &Scene, machine: &MachineSpec) -> bool {
    machine.rays.ends == RayEnds::Exact && scene.mode.adds_up()
}

fn longest(lengths: &[f64]) -> f64 {
    lengths.iter().copied().fold(0.0, f64::max)
}

/// Inside of the box of voxel centres, or of whole voxels: behind its front faces and before its back ones.
fn faces(geometry: &Geometry) -> [HalfSpace; 6] {
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
    match pass.first_depth {
        0 if margin == 0.0 => 0.0,
        0 => eye.max(-margin),
        _ => eye,
    }
}

/// The opacity word that stands for opacity 1 over a whole step, where the ends of rays have parts. In a weighted sum an end may weigh as
/// much as several whole steps, at most as all between the first plane and the last.
pub fn whole_step_opacity(mode: Mode, words: &Words, depths: usize) -> u32 {
    let full = unit_full(words.opacity_bits);
    let most = (depths as u32).saturating_sub(1).clamp(1, 2 * EndRegisters::MOST_REACH);
    if mode == Mode::WeightedSum { full.div_ceil(most) } else { full }
}

/// Opacity tables of the ends, for opacities of unit length: class j is for j of the 2^[`EndRegisters::PART_BITS`] parts of the longest
/// step. One part after the other is composited, which takes one power for all; a weighted sum weighs by the part instead.
pub(crate) fn tables(alphas: &[f64], lengths: &[f64], mode: Mode, opacity_bits: u32, whole: u32) -> Vec<u32> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_word::quantise_unit;
    use proptest::prelude::*;

    proptest! {
        /// Parts that are composited one after another have the opacity of their length.
        #[test]
        fn tables_of_ends_are_those_of_their_lengths(alpha in 0.0..=1.0_f64, length in 0.5..40.0_f64, bits in 1_u32..=16) {
            let full = unit_full(bits);
            let table = tables(&[alpha, 0.0, 1.0], &[0.5, length], Mode::Composite, bits, full);
            prop_assert_eq!(table.len(), 3 * EndRegisters::CLASSES as usize);
            for (class, entries) in table.chunks(3).enumerate() {
                let part = length * class as f64 / 32.0;
                let exact = corrected_opacity(alpha, part);
                let near = |by: f64| quantise_unit((exact * f64::from(full) + by) / f64::from(full), bits);
                prop_assert!((near(-1e-9)..=near(1e-9)).contains(&entries[0]), "class {}", class);
                prop_assert_eq!(&entries[1..], &[0, if class == 0 { 0 } else { full }]);
            }
        }

        /// In a weighted sum a word is worth its part of a whole step, and the word has room for the largest part that a frame can have.
        #[test]
        fn words_of_a_weighted_sum_have_room_for_the_largest_part(alpha in 0.0..=1.0_f64, bits in 4_u32..=16, depths in 1_usize..12) {
            let words = Words { opacity_bits: bits, ..Words::default() };
            let (full, whole) = (unit_full(bits), whole_step_opacity(Mode::WeightedSum, &words, depths));
            let table = tables(&[alpha], &[1.0], Mode::WeightedSum, bits, whole);
            let most = (depths.max(2) - 1).min(4);
            prop_assert!(most as u32 * whole >= full && (most as u32 * whole) < full + most as u32);
            for (class, &word) in table[..=most << EndRegisters::PART_BITS].iter().enumerate() {
                let exact = (alpha * class as f64 / 32.0 * f64::from(whole)).min(f64::from(full));
                prop_assert!((f64::from(word) - exact).abs() <= 0.5 + 1e-6, "{} {}", word, exact);
            }
        }
    }
}
