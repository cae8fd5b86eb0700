//! The folded tree: from any leaf of the circle, for one ray or for several, the golden bits.

use cube3_cases::cases;
use cube3_cone::golden::{Node, Segment, circle, reduce};
use cube3_cone::lanes::{join, tree_of_ray};
use cube3_frame::{ConeRegisters, DiscreteRay};
use cube3_machine::ConeOrder;
use cube3_scene::Mode;
use cube3_word::{Rounding, Words, unit_full, unit_mul};
use proptest::prelude::*;

/// A node of a sample, or of nothing.
fn node(words: &Words, raw: (bool, u32, [u32; 3], i32)) -> Node {
    let bits = words.accumulator_bits;
    let (present, alpha, colour, sample) = raw;
    if !present {
        return Node::default();
    }
    let alpha = alpha & unit_full(bits);
    let [r, g, b] = colour.map(|c| u64::from(unit_mul(c & unit_full(bits), alpha, bits, words.rounding)));
    Node { present, sample, rgba: [r, g, b, u64::from(alpha)] }
}

fn ray(u: usize) -> DiscreteRay {
    DiscreteRay { u: -(u as i64), v: 7 }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(1500) })]

    #[test]
    fn every_start_leaf_and_every_seam_gives_the_golden_bits(
        accumulator_bits in 1_u32..=32, truncate: bool,
        raw in prop::collection::vec((any::<bool>(), any::<u32>(), any::<[u32; 3]>(), 0..9_i32), 1..24),
        seams in prop::collection::vec(0_usize..24, 0..3),
    ) {
        let rounding = if truncate { Rounding::Truncate } else { Rounding::Nearest };
        let words = Words { accumulator_bits, rounding, ..Words::default() };
        let depths: Vec<Node> = raw.into_iter().map(|raw| node(&words, raw)).collect();
        let count = depths.len();
        // The ray of a depth: one more behind each seam.
        let of = |depth: usize| seams.iter().filter(|&&seam| seam <= depth).count();
        for mode in Mode::ALL {
            let cone = ConeRegisters { mode, order: ConeOrder::Tree, leaves: count, opaque: 1, sum_weight: 0 };
            let rays: std::collections::BTreeSet<usize> = (0..count).map(of).collect();
            let expected: Vec<Segment> = rays
                .into_iter()
                .map(|u| {
                    let alone: Vec<Node> =
                        (0..count).map(|d| if of(d) == u { depths[d] } else { Node::default() }).collect();
                    Segment { ray: ray(u), node: reduce(&alone, &cone, &words) }
                })
                .collect();
            for Segment { ray: of_segment, node } in &expected {
                let mut leaves: Vec<Node> = (0..count).filter(|&d| ray(of(d)) == *of_segment).map(|d| depths[d]).collect();
                let first = (0..count).take_while(|&d| ray(of(d)) != *of_segment).count();
                prop_assert_eq!(tree_of_ray(&mut leaves, first, mode, &words), *node, "{:?} alone", mode);
            }
            for start in 0..count {
                let leaf = |place: usize| {
                    assert!(place < count, "{place} is no place of the circle");
                    let depth = (place + count - start) % count;
                    Segment { ray: ray(of(depth)), node: depths[depth] }
                };
                prop_assert_eq!(&circle(count, start, leaf, mode, &words), &expected, "{:?} from leaf {}", mode, start);
            }
        }
    }
}

#[test]
fn joining_loses_no_ray() {
    let words = Words::default();
    let segment = |u, alpha| Segment { ray: ray(u), node: Node { present: true, sample: 0, rgba: [0, 0, 0, alpha] } };
    let all = |left: &[Segment], right: &[Segment]| {
        let mut left = left.to_vec();
        join(&mut left, right.to_vec(), Mode::WeightedSum, &words);
        left
    };
    let (a, b, c) = (segment(0, 1), segment(1, 2), segment(2, 4));
    assert_eq!(all(&[a, b], &[c]), [a, b, c]);
    assert_eq!(all(&[a, b], &[b, c]), [a, segment(1, 4), c]);
    assert_eq!(all(&[a], &[]), [a]);
    assert_eq!(all(&[], &[a, b]), [a, b]);
    assert_eq!(circle(0, 0, |_| a, Mode::Composite, &words), []);
}
