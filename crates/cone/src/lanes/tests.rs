//! Lanes of a slot beside the definition.

use super::slot::SlotLanes;
use crate::golden::{Node, leaf, pixel, reduce};
use cube3_abc::ShadedSamples;
use cube3_abc::golden::Shaded;
use cube3_cases::cases;
use cube3_frame::ConeRegisters;
use cube3_machine::ConeOrder;
use cube3_scene::Mode;
use cube3_word::{Rounding, Words, unit_full};
use proptest::prelude::*;
use std::ops::Range;

/// Samples of a slot: stretches that are absent, transparent, or anything.
fn samples(bits: [u32; 2]) -> impl Strategy<Value = Vec<Shaded>> {
    let [colour, opacity] = bits.map(unit_full);
    let any = (0..=opacity, [0..=colour, 0..=colour, 0..=colour]).prop_map(|(opacity, colour)| Shaded {
        present: true,
        sample: 1,
        opacity,
        colour: if opacity == 0 { [0; 3] } else { colour },
    });
    let clear = Shaded { present: true, ..Shaded::default() };
    let one = |kind: u8| match kind {
        0 => Just(Shaded::default()).boxed(),
        1 => Just(clear).boxed(),
        _ => any.clone().boxed(),
    };
    let one = [one(0), one(1), one(2)];
    let stretch = (0..3_usize, 1..20_usize).prop_flat_map(move |(kind, n)| prop::collection::vec(one[kind].clone(), n));
    prop::collection::vec(stretch, 1..6).prop_map(|stretches| stretches.concat())
}

fn case() -> impl Strategy<Value = (ConeRegisters, Words, Vec<Shaded>, Vec<Range<usize>>)> {
    let mode = prop::sample::select(vec![Mode::Composite, Mode::WeightedSum]);
    let leaves = prop_oneof![1_usize..=64, Just(16_usize), Just(32_usize)];
    let bits = (1_u32..=16, 1_u32..=16, 1_u32..=16, any::<bool>());
    (mode, leaves, bits).prop_flat_map(|(mode, leaves, (colour_bits, opacity_bits, accumulator_bits, truncate))| {
        let rounding = if truncate { Rounding::Truncate } else { Rounding::Nearest };
        let words = Words { colour_bits, opacity_bits, accumulator_bits, rounding, ..Words::default() };
        samples([colour_bits, opacity_bits]).prop_flat_map(move |samples| {
            let n = samples.len();
            let cone = ConeRegisters {
                mode,
                order: ConeOrder::Tree,
                leaves,
                sum_weight: (1_u64 << ConeRegisters::WEIGHT_BITS) / n as u64,
                opaque: 1,
            };
            let range = (0..n).prop_flat_map(move |start| (Just(start), start + 1..=n));
            let ranges = prop::collection::vec(range.prop_map(|(start, end)| start..end), 1..8);
            (Just(cone), Just(words), Just(samples), ranges)
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(2000) })]

    #[test]
    fn rays_of_a_slot_have_the_golden_bits((cone, words, samples, ranges) in case()) {
        let mut lanes = SlotLanes::new(&cone, &words).unwrap();
        // What the slot before left must not show.
        lanes.leaves(&ShadedSamples::new(&samples.iter().rev().copied().collect::<Vec<_>>()));
        lanes.leaves(&ShadedSamples::new(&samples));
        for range in ranges {
            let leaf = |depth: usize| {
                if range.contains(&depth) { leaf(&samples[depth], &cone, &words) } else { Node::default() }
            };
            let leaves: Vec<Node> = (0..samples.len()).map(leaf).collect();
            let expected = pixel(reduce(&leaves, &cone, &words), &cone, &words);
            prop_assert_eq!(pixel(lanes.ray(range.clone()), &cone, &words), expected, "{:?}", range);
        }
    }
}
