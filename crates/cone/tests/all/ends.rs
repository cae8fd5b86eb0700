//! Compositing at its ends: an empty sample is the identity and a full one hides everything, to the bit, on both sides;
//! nothing overflows; and how far the tree is from front-to-back order.

use cube3_abc::golden::Shaded;
use cube3_cases::cases;
use cube3_cone::golden::{Node, combine, leaf, pixel, reduce};
use cube3_frame::ConeRegisters;
use cube3_machine::ConeOrder;
use cube3_scene::Mode;
use cube3_word::{Rounding, Words, quantise_unit, unit_full};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

const ROUNDINGS: [Rounding; 2] = [Rounding::Nearest, Rounding::Truncate];

fn words(accumulator_bits: u32, rounding: Rounding) -> Words {
    Words { accumulator_bits, rounding, ..Words::default() }
}

fn node(colour: u32, alpha: u32) -> Node {
    let [c, a] = [u64::from(colour), u64::from(alpha)];
    Node { present: true, sample: 5, rgba: [c, c, c, a] }
}

/// Every node of a word length: colour is weighted, so no more than opacity.
fn nodes(bits: u32) -> impl Iterator<Item = Node> {
    (0..=unit_full(bits)).flat_map(|alpha| (0..=alpha).map(move |colour| node(colour, alpha)))
}

fn over(left: Node, right: Node, words: &Words) -> Node {
    combine(Mode::Composite, left, right, words)
}

fn assert_ends(any: Node, words: &Words) {
    let full = unit_full(words.accumulator_bits);
    let empty = node(0, 0);
    assert_eq!(over(empty, any, words).rgba, any.rgba, "nothing in front");
    assert_eq!(over(any, empty, words).rgba, any.rgba, "nothing behind");
    assert_eq!(over(Node::default(), any, words), any, "no sample in front");
    assert_eq!(over(any, Node::default(), words), any, "no sample behind");
    for colour in [0, full / 2, full] {
        let wall = node(colour, full);
        assert_eq!(over(wall, any, words), wall, "a wall in front");
        assert_eq!(over(any, wall, words).rgba[3], u64::from(full), "a wall behind");
        // Through the wall behind, what comes after changes nothing.
        let hidden = over(any, wall, words);
        assert_eq!(over(hidden, any, words), hidden);
    }
}

#[test]
fn the_ends_are_exact_for_every_small_word() {
    for bits in 1..=7 {
        for rounding in ROUNDINGS {
            nodes(bits).for_each(|any| assert_ends(any, &words(bits, rounding)));
        }
    }
}

#[test]
fn nothing_overflows_for_any_two_small_words() {
    for bits in 1..=5 {
        for rounding in ROUNDINGS {
            let words = words(bits, rounding);
            for left in nodes(bits) {
                for right in nodes(bits) {
                    assert_within(over(left, right, &words), &words);
                }
            }
        }
    }
}

/// Colour ≤ opacity ≤ full.
fn assert_within(node: Node, words: &Words) {
    let [.., alpha] = node.rgba;
    assert!(node.rgba[..3].iter().all(|&colour| colour <= alpha), "{node:?}");
    assert!(alpha <= u64::from(unit_full(words.accumulator_bits)), "{node:?}");
}

#[test]
fn leaves_are_exact_at_their_ends_and_no_brighter_than_opaque() {
    for (opacity_bits, colour_bits, bits) in [(1, 1, 1), (3, 4, 5), (4, 3, 2), (5, 5, 5), (2, 6, 32), (4, 4, 16)] {
        for rounding in ROUNDINGS {
            let words = Words { opacity_bits, colour_bits, ..words(bits, rounding) };
            let cone =
                ConeRegisters { mode: Mode::Composite, order: ConeOrder::Tree, leaves: 1, opaque: 1, sum_weight: 0 };
            for opacity in 0..=unit_full(opacity_bits) {
                for colour in 0..=unit_full(colour_bits) {
                    let shaded =
                        Shaded { present: true, sample: 1, opacity, colour: [colour, 0, unit_full(colour_bits)] };
                    let node = leaf(&shaded, &cone, &words);
                    assert_within(node, &words);
                    assert_eq!(node.rgba[2], node.rgba[3], "white is as bright as it is opaque");
                    assert_eq!(node.rgba[1], 0);
                    if opacity == 0 {
                        assert_eq!(node.rgba, [0; 4]);
                    }
                    if opacity == unit_full(opacity_bits) {
                        assert_eq!(node.rgba[3], u64::from(unit_full(bits)));
                    }
                }
            }
        }
    }
}

#[test]
fn a_weighted_sum_is_the_mean_by_its_weight_and_is_held_at_white() {
    let words = Words { opacity_bits: 8, colour_bits: 8, ..words(8, Rounding::Nearest) };
    let sample = |opacity, red| Shaded { present: true, sample: 1, opacity, colour: [red, 255, 0] };
    let of = |sum_weight, samples: &[Shaded]| {
        let cone = ConeRegisters { mode: Mode::WeightedSum, order: ConeOrder::Tree, leaves: 2, opaque: 1, sum_weight };
        let leaves: Vec<Node> = samples.iter().map(|sample| leaf(sample, &cone, &words)).collect();
        let counted = pixel(reduce(&leaves, &cone, &words), &cone, &words);
        (counted.value, counted.overflows)
    };
    let two = [sample(200, 255), sample(100, 51)];
    assert_eq!(of(1 << 31, &two), ([(200 + 20) / 2, 150, 0, 150], 0));
    assert_eq!(of(1 << 30, &two), ([55, 75, 0, 75], 0));
    // 220 and 300 with a weight of 1: what is above 255 is held and counted.
    assert_eq!(of(1 << 32, &two), ([220, 255, 0, 255], 2));
    // Three samples that take no part count in no sum.
    let absent = Shaded::default();
    assert_eq!(of(1 << 31, &[absent, two[0], absent, two[1], absent]), ([110, 150, 0, 150], 0));
}

#[test]
fn each_mode_picks_its_sample() {
    let words = Words { opacity_bits: 8, colour_bits: 8, ..words(8, Rounding::Nearest) };
    let at = |sample, opacity, red| Shaded { present: true, sample, opacity, colour: [red, 0, 0] };
    // Equal largest and smallest words: the nearer one is shown.
    let ray = [at(4, 10, 255), at(9, 128, 100), at(9, 200, 200), Shaded::default(), at(1, 255, 50), at(1, 100, 25)];
    for (mode, expected) in [
        (Mode::FirstOpaque, [100, 0, 0, 255]),
        (Mode::LastOpaque, [50, 0, 0, 255]),
        (Mode::Maximum, [50, 0, 0, 128]),
        (Mode::Minimum, [50, 0, 0, 255]),
    ] {
        for leaves in 1..8 {
            let cone = ConeRegisters { mode, order: ConeOrder::Tree, leaves, opaque: 128, sum_weight: 0 };
            let nodes: Vec<Node> = ray.iter().map(|sample| leaf(sample, &cone, &words)).collect();
            assert_eq!(pixel(reduce(&nodes, &cone, &words), &cone, &words).value, expected, "{mode}");
        }
    }
}

fn any_node() -> impl Strategy<Value = (u32, u32)> {
    let edge = prop_oneof![Just(0_u32), Just(u32::MAX), Just(u32::MAX - 1), any::<u32>()];
    (edge.clone(), edge)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(256) })]

    #[test]
    fn wide_words_have_exact_ends_and_never_overflow(
        bits in 5_u32..=32, truncate: bool, chain in prop::collection::vec(any_node(), 1..20),
    ) {
        let words = words(bits, ROUNDINGS[usize::from(truncate)]);
        let of = |(a, b): (u32, u32)| {
            let (a, b) = (a >> (32 - bits), b >> (32 - bits));
            node(a.min(b), a.max(b))
        };
        let mut front = Node::default();
        for raw in chain {
            let next = of(raw);
            assert_ends(next, &words);
            front = over(front, next, &words);
            assert_within(front, &words);
        }
        assert_ends(front, &words);
    }

    #[test]
    fn where_a_full_sample_lies_in_front_the_rest_of_the_ray_changes_no_bit(
        bits in 1_u32..=32, truncate: bool, leaves in 1_usize..20, wall in 0_usize..12,
        chain in prop::collection::vec(any_node(), 12..30), other in prop::collection::vec(any_node(), 30),
    ) {
        let words = words(bits, ROUNDINGS[usize::from(truncate)]);
        let cone = ConeRegisters { mode: Mode::Composite, order: ConeOrder::Tree, leaves, opaque: 1, sum_weight: 0 };
        let of = |(a, b): (u32, u32)| {
            let (a, b) = (a >> (32 - bits), b >> (32 - bits));
            node(a.min(b), a.max(b))
        };
        let mut ray: Vec<Node> = chain.into_iter().map(of).collect();
        ray[wall] = node(unit_full(bits) / 3, unit_full(bits));
        let first = reduce(&ray, &cone, &words);
        for (node, raw) in ray[wall + 1..].iter_mut().zip(other) {
            *node = of(raw);
        }
        prop_assert_eq!(reduce(&ray, &cone, &words), first);
        // Transparent samples in front and behind may be left out or put in.
        for node in &mut ray[wall + 1..] {
            *node = Node::default();
        }
        prop_assert_eq!(reduce(&ray, &cone, &words), first);
    }
}

/// Opacity and colour of a sample, and what a ray of them is worth: in reals.
fn real(samples: &[(f64, f64)]) -> f64 {
    samples.iter().rev().fold(0.0, |behind, (alpha, colour)| alpha * colour + (1.0 - alpha) * behind)
}

/// Numbers 0 to 1 that look random.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    move || (generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Mean error of red in 1/255 over rays of 512 samples, opacity uniform from 0 to `thickest` and colour from 0 to 1, against
/// the same ray in reals that were never quantised. One leaf is front-to-back order, 512 are the tree.
fn mean_error(accumulator_bits: u32, table_bits: u32, rounding: Rounding, leaves: usize, thickest: f64) -> f64 {
    let words = Words { opacity_bits: table_bits, colour_bits: table_bits, ..words(accumulator_bits, rounding) };
    let cone = ConeRegisters { mode: Mode::Composite, order: ConeOrder::Tree, leaves, opaque: 1, sum_weight: 0 };
    let mut random = random(1995);
    let rays = 200;
    let error = |_| {
        let samples: Vec<(f64, f64)> = (0..512).map(|_| (thickest * random(), random())).collect();
        let nodes: Vec<Node> = samples
            .iter()
            .map(|&(alpha, colour)| {
                let opacity = quantise_unit(alpha, table_bits);
                let colour = [quantise_unit(colour, table_bits); 3];
                leaf(&Shaded { present: true, sample: 0, opacity, colour }, &cone, &words)
            })
            .collect();
        let got = pixel(reduce(&nodes, &cone, &words), &cone, &words).value[0];
        (f64::from(got) / f64::from(unit_full(accumulator_bits)) - real(&samples)).abs()
    };
    (0..rays).map(error).sum::<f64>() / f64::from(rays) * 255.0
}

/// The design's table, section 5, last row: accumulator and opacity bits; truncated and rounded front to back, and the
/// tree rounded. The prototype's "thin opacity" is not written down; uniform from 0 to 0.013 comes nearest.
#[test]
fn word_lengths_cost_what_the_prototype_found() {
    let mut table = Vec::new();
    for (accumulator, opacity, prototype) in
        [(8, 8, [117.0, 26.0, 3.7]), (12, 12, [12.0, 0.57, 0.33]), (16, 12, [0.79, 0.04, 0.04])]
    {
        let of = |rounding, leaves| mean_error(accumulator, opacity, rounding, leaves, 0.013);
        let got = [of(Rounding::Truncate, 1), of(Rounding::Nearest, 1), of(Rounding::Nearest, 512)];
        println!("{accumulator}/{opacity}: {got:.3?}, prototype {prototype:?}");
        for (got, prototype) in got.into_iter().zip(prototype) {
            assert!((0.6..1.6).contains(&(got / prototype)), "{accumulator}/{opacity}: {got}, not {prototype}");
        }
        table.push(got);
    }
    // Rounding is worth about four bits of accumulator; the tree is at its best where words are short.
    assert!(table[0][1] < 0.4 * table[0][0] && table[1][1] < table[0][1] / 16.0 && table[1][0] > 10.0 * table[1][1]);
    assert!(table[0][2] < 0.2 * table[0][1] && table[1][2] < table[1][1]);
    assert!(table[2][2] < 1.5 * table[2][1]);
}

#[test]
fn truncated_the_tree_is_little_better_than_the_order() {
    // What truncation loses at the leaves, the tree does not bring back.
    for (accumulator, opacity) in [(8, 8), (12, 12)] {
        let [order, tree] = [1, 512].map(|leaves| mean_error(accumulator, opacity, Rounding::Truncate, leaves, 0.013));
        println!("{accumulator}/{opacity} truncated: in order {order:.2}, tree {tree:.2}");
        assert!((0.5..1.1).contains(&(tree / order)));
    }
}
