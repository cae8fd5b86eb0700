//! Whole rows of rays, in 32 and in 64 bits, have the golden bits in every mode.

use cube3_abc::golden::Shaded;
use cube3_abc::lanes::ShadedRow;
use cube3_cases::cases;
use cube3_cone::golden::{Node, leaf, pixel, reduce};
use cube3_cone::lanes::{Accumulator, ConeLanes};
use cube3_frame::ConeRegisters;
use cube3_machine::ConeOrder;
use cube3_scene::Mode;
use cube3_word::{Rounding, Words, unit_full, vectorised};
use proptest::prelude::*;

/// A depth: the first ray and the samples from it on; or no samples.
#[derive(Clone, Debug)]
struct Depth {
    row: Option<(i64, Vec<Shaded>)>,
    /// Whether transparent ends are left out of the row's span.
    skip: bool,
}

fn sample(words: &Words, raw: (u8, u32, [u32; 3], i32)) -> Shaded {
    let (kind, opacity, colour, sample) = raw;
    let full = unit_full(words.opacity_bits);
    // A quarter is absent, a quarter transparent, an eighth full.
    let opacity = match kind % 8 {
        0 | 1 => return Shaded { sample, ..Shaded::default() },
        2 | 3 => 0,
        4 => full,
        _ => opacity & full,
    };
    let colour = colour.map(|c| if opacity == 0 { 0 } else { c & unit_full(words.colour_bits) });
    Shaded { present: true, sample, opacity, colour }
}

/// As the shading lanes give it.
fn shaded_row(samples: &[Shaded], skip: bool) -> ShadedRow {
    let first = samples.iter().position(|sample| sample.opacity > 0);
    let last = samples.iter().rposition(|sample| sample.opacity > 0);
    ShadedRow {
        present: samples.iter().map(|sample| u8::from(sample.present)).collect(),
        opacity: samples.iter().map(|sample| sample.opacity).collect(),
        colour: [0, 1, 2].map(|i| samples.iter().map(|sample| sample.colour[i]).collect()),
        span: if skip { first.zip(last).map_or((0, 0), |(a, b)| (a, b + 1)) } else { (0, samples.len()) },
        ..ShadedRow::default()
    }
}

const ORDERS: [ConeOrder; 2] = [ConeOrder::Tree, ConeOrder::FrontToBack];

const RAYS: std::ops::Range<i64> = -8..24;

/// Pixels of the rays and saturated words, ray by ray.
fn expected(depths: &[Depth], cone: &ConeRegisters, words: &Words) -> (Vec<[u32; 4]>, u64) {
    let mut overflows = 0;
    let pixels = RAYS.map(|u| {
        let leaves: Vec<Node> = depths
            .iter()
            .map(|depth| match &depth.row {
                Some((start, samples)) if (*start..start + samples.len() as i64).contains(&u) => {
                    leaf(&samples[(u - start) as usize], cone, words)
                }
                _ => Node::default(),
            })
            .collect();
        let counted = pixel(reduce(&leaves, cone, words), cone, words);
        overflows += u64::from(counted.overflows);
        counted.value
    });
    (pixels.collect(), overflows)
}

fn assert_rows<T: Accumulator>(depths: &[Depth], cone: &ConeRegisters, words: &Words, vectors: bool) {
    let mut lanes = ConeLanes::<T>::new(*cone, *words);
    let (pixels, overflows) = expected(depths, cone, words);
    // Twice: the cone is empty again after a row.
    for _ in 0..2 {
        let mut push = || {
            for depth in depths {
                match &depth.row {
                    Some((start, samples)) => {
                        let row = shaded_row(samples, depth.skip);
                        lanes.push(Some((*start, &row, |lane: usize| samples[lane].sample)));
                    }
                    None => lanes.pass(1),
                }
            }
            let mut got = vec![[0; 4]; (RAYS.end - RAYS.start) as usize];
            let counted = lanes.finish(|u, rgba| got[(u - RAYS.start) as usize] = rgba);
            (got, counted)
        };
        let (got, counted) = if vectors { vectorised(push) } else { push() };
        assert_eq!(got, pixels, "{cone:?}");
        assert_eq!(counted, overflows, "{cone:?}");
    }
}

prop_compose! {
    fn any_words()(
        voxel_bits in 1_u32..=16, colour_bits in 1_u32..=16, opacity_bits in 1_u32..=16, accumulator_bits in 1_u32..=32, truncate: bool,
    ) -> Words {
        let rounding = if truncate { Rounding::Truncate } else { Rounding::Nearest };
        Words { voxel_bits, colour_bits, opacity_bits, accumulator_bits, rounding, ..Words::default() }
    }
}

type RawDepth = (Option<(i64, Vec<(u8, u32, [u32; 3], i32)>)>, bool);

fn any_depth() -> impl Strategy<Value = RawDepth> {
    let sample = (any::<u8>(), any::<u32>(), any::<[u32; 3]>(), prop_oneof![0..4_i32, 0..1 << 24]);
    (prop::option::weighted(0.8, (-8_i64..8, prop::collection::vec(sample, 0..16))), any::<bool>())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(1500) })]

    #[test]
    fn rows_have_the_golden_bits_in_every_mode(
        words in any_words(), depths in prop::collection::vec(any_depth(), 0..24), leaves in 1_usize..28,
        opaque: u32, sum_weight in prop_oneof![0_u64..=1 << 32, Just(1_u64 << 32), Just((1 << 32) / 24)], vectors: bool,
    ) {
        let opaque = opaque & unit_full(words.opacity_bits);
        let depths: Vec<Depth> = depths
            .into_iter()
            .map(|(row, skip)| Depth {
                row: row.map(|(start, raw)| (start, raw.into_iter().map(|raw| sample(&words, raw)).collect())),
                // From 0 on, transparent samples are opaque too, and none may be left out.
                skip: skip && opaque > 0,
            })
            .collect();
        for (mode, order) in Mode::ALL.into_iter().flat_map(|mode| ORDERS.map(|order| (mode, order))) {
            let cone = ConeRegisters { mode, order, leaves, opaque, sum_weight };
            assert_rows::<u64>(&depths, &cone, &words, vectors);
            if words.accumulator_bits <= 16 {
                assert_rows::<u32>(&depths, &cone, &words, vectors);
            }
        }
    }
}

#[test]
fn the_deepest_weighted_sum_fits_the_narrow_words() {
    // 4096 samples, the deepest volume, of full 16-bit words.
    let words = Words { accumulator_bits: 16, opacity_bits: 16, colour_bits: 16, ..Words::default() };
    let full = Shaded { present: true, sample: 1, opacity: 65535, colour: [65535; 3] };
    let depths = vec![Depth { row: Some((0, vec![full; 3])), skip: true }; 4096];
    for sum_weight in [1 << 20, (1 << 20) + 1, 1 << 32] {
        let cone =
            ConeRegisters { mode: Mode::WeightedSum, order: ConeOrder::Tree, leaves: 100, opaque: 1, sum_weight };
        assert_rows::<u32>(&depths, &cone, &words, true);
        assert_rows::<u64>(&depths, &cone, &words, true);
    }
}

#[test]
fn a_ray_without_samples_has_no_pixel_and_one_between_others_a_clear_one() {
    let words = Words::default();
    let cone = ConeRegisters { mode: Mode::Composite, order: ConeOrder::Tree, leaves: 4, opaque: 1, sum_weight: 0 };
    let mut lanes = ConeLanes::<u32>::new(cone, words);
    let white = Shaded { present: true, sample: 9, opacity: 4095, colour: [4095; 3] };
    for start in [3_i64, -2] {
        let row = shaded_row(&[white], true);
        lanes.push(Some((start, &row, |_: usize| 9)));
    }
    let mut pixels = Vec::new();
    lanes.finish(|u, rgba| pixels.push((u, rgba[3])));
    assert_eq!(pixels, [(-2, 65535), (-1, 0), (0, 0), (1, 0), (2, 0), (3, 65535)]);
    pixels.clear();
    lanes.finish(|u, rgba| pixels.push((u, rgba[3])));
    assert_eq!(pixels, []);
}

#[test]
fn depths_without_samples_add_no_ray_to_the_pixels() {
    let words = Words::default();
    let white = Shaded { present: true, sample: 9, opacity: 4095, colour: [4095; 3] };
    let row = shaded_row(&[white, white], true);
    for (mode, order) in Mode::ALL.into_iter().flat_map(|mode| ORDERS.map(|order| (mode, order))) {
        let sum_weight = 1 << ConeRegisters::WEIGHT_BITS;
        let cone = ConeRegisters { mode, order, leaves: 4, opaque: 1, sum_weight };
        for start in [5_i64, -7] {
            // Nothing in front, between, and behind.
            for full in [0_u32, 1, 2, 3, 6, 7] {
                let mut lanes = ConeLanes::<u32>::new(cone, words);
                for depth in 0..8 {
                    match depth == full {
                        true => lanes.push(Some((start, &row, |_: usize| 9))),
                        false => lanes.pass(1),
                    }
                }
                let mut pixels = Vec::new();
                lanes.finish(|u, rgba| pixels.push((u, rgba[3])));
                assert_eq!(pixels, [(start, 65_535), (start + 1, 65_535)], "{mode}, {order:?}, depth {full}");
            }
        }
    }
}
