//! Registers for the ends of rays: what [`EndRegisters`] says, made from scene and machine.

use crate::golden::{faces, longest};
use cube3_frame::{EndRegisters, Geometry};
use cube3_machine::{MachineSpec, RayEnds};
use cube3_scene::Scene;

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

#[cfg(test)]
mod tests {
    use crate::golden::{end_tables, whole_step_opacity};
    use cube3_cases::cases;
    use cube3_frame::EndRegisters;
    use cube3_scene::{Mode, corrected_opacity};
    use cube3_word::{Words, quantise_unit, unit_full};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        /// Parts that are composited one after another have the opacity of their length.
        #[test]
        fn tables_of_ends_are_those_of_their_lengths(alpha in 0.0..=1.0_f64, length in 0.5..40.0_f64, bits in 1_u32..=16) {
            let full = unit_full(bits);
            let table = end_tables(&[alpha, 0.0, 1.0], &[0.5, length], Mode::Composite, bits, full);
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
            let table = end_tables(&[alpha], &[1.0], Mode::WeightedSum, bits, whole);
            let most = (depths.max(2) - 1).min(4);
            prop_assert!(most as u32 * whole >= full && (most as u32 * whole) < full + most as u32);
            for (class, &word) in table[..=most << EndRegisters::PART_BITS].iter().enumerate() {
                let exact = (alpha * class as f64 / 32.0 * f64::from(whole)).min(f64::from(full));
                prop_assert!((f64::from(word) - exact).abs() <= 0.5 + 1e-6, "{} {}", word, exact);
            }
        }
    }
}
