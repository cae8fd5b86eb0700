//! Whole rows have the golden bits: over all words, registers and tables, with and without what transparent samples do
//! not need, in vectors and without.

use crate::registers::{Dice, bright, frame, hosted_frame, neighbourhood, normaliser};
use cube3_abc::ends::End;
use cube3_abc::golden::{Neighbourhood, Shaded, opacity_class, shade};
use cube3_abc::lanes::{AbcLanes, Around, Neighbours, ShadedBlock, ShadedRow};
use cube3_cases::cases;
use cube3_frame::{FrameSetup, GradientRegisters, Shading};
use cube3_machine::GradientMethod;
use cube3_word::{BLOCK_LANES, Rounding, Words, unit_full, vectorised};
use proptest::prelude::*;
use std::cell::Cell;

/// A row as it comes to the unit: neighbourhoods, rays and depths, and which lanes hold a sample of the volume.
struct Row {
    samples: Vec<Neighbourhood>,
    at: Vec<[i64; 3]>,
    inside: Vec<bool>,
}

fn row(dice: &mut Dice, setup: &FrameSetup, n: usize) -> Row {
    let inside_all = dice.one_in(2);
    let geometry = &setup.geometry;
    // At times rays of the frame, of which some samples are ends; others are the only one of their ray that is in its place.
    let of_frame = setup.ends.is_some() && dice.one_in(2);
    let first = geometry.first_ray();
    let [us, vs] = [[first.u, geometry.size[0] as i64 - 1], [first.v, geometry.size[1] as i64 - 1]];
    let depths = [0, if setup.ends.is_some() { geometry.size[2] as i64 - 1 } else { 4095 }];
    let [us, vs] = if of_frame { [us, vs] } else { [[-4096, 4095]; 2] };
    let mut within = |[low, high]: [i64; 2]| dice.within(low, high);
    let at = (0..n).map(|_| [within(us), within(vs), within(depths)]).collect();
    Row {
        at,
        samples: (0..n).map(|_| neighbourhood(dice, setup.words.sample_bits())).collect(),
        inside: (0..n).map(|_| inside_all || !dice.one_in(4)).collect(),
    }
}

/// What the definition says of a row: samples and overflows.
fn expected(row: &Row, setup: &FrameSetup) -> (Vec<Shaded>, u64) {
    let mut overflows = 0;
    let samples = (0..row.samples.len())
        .map(|lane| {
            let sample = row.samples[lane][1][1][1];
            if !row.inside[lane] {
                return Shaded { sample, ..Shaded::default() };
            }
            let counted = shade(&row.samples[lane], row.at[lane], setup);
            overflows += u64::from(counted.overflows);
            counted.value
        })
        .collect();
    (samples, overflows)
}

fn run(lanes: &mut AbcLanes, row: &Row, setup: &FrameSetup, vectors: bool, out: &mut ShadedRow) {
    let n = row.samples.len();
    let rows: Vec<Vec<i32>> =
        (0..27).map(|place| row.samples.iter().map(|s| s[place / 9][place / 3 % 3][place % 3]).collect()).collect();
    out.present.clear();
    out.present.extend((0..n).map(|lane| {
        let [u, v, k] = row.at[lane];
        u8::from(row.inside[lane] && setup.clips.iter().all(|clip| clip.distance.at(u, v, k) >= 0))
    }));
    out.ends.clear();
    if let Some(ends) = &setup.ends {
        let end = |lane: usize| End { lane, class: opacity_class(row.at[lane], setup) };
        out.ends.extend((0..n).map(end).filter(|end| end.class >= ends.first_class));
    }
    let (rows, at) = (rows.as_slice(), row.at.as_slice());
    let neighbour = |w: usize, v: usize, u: usize| rows[w * 9 + v * 3 + u].as_slice();
    if vectors {
        vectorised(
            #[inline(always)]
            || lanes.shade(n, neighbour, |lane| at[lane], &setup.geometry, out),
        );
    } else {
        lanes.shade(n, neighbour, |lane| at[lane], &setup.geometry, out);
    }
}

/// The lanes on rows of several lengths, one after the other, against the definition.
fn assert_golden(setup: &FrameSetup, rows: &[Row]) {
    for (skip, vectors) in [(false, false), (false, true), (true, false), (true, true)] {
        let mut lanes = AbcLanes::new(setup, skip);
        let mut out = ShadedRow::default();
        for row in rows {
            let (samples, overflows) = expected(row, setup);
            run(&mut lanes, row, setup, vectors, &mut out);
            for (lane, sample) in samples.iter().enumerate() {
                let got = Shaded {
                    present: out.present[lane] != 0,
                    sample: sample.sample,
                    opacity: out.opacity[lane],
                    colour: [0, 1, 2].map(|i| out.colour[i][lane]),
                };
                assert_eq!(got, *sample, "lane {lane}, {:?}, skip {skip}, vectors {vectors}", row.samples[lane]);
            }
            assert_eq!(out.overflows, overflows, "skip {skip}, vectors {vectors}");
            let first = samples.iter().position(|sample| sample.opacity > 0);
            let last = samples.iter().rposition(|sample| sample.opacity > 0);
            let opaque = first.zip(last).map_or((0, 0), |(first, last)| (first, last + 1));
            assert_eq!(out.span, if skip { opaque } else { (0, samples.len()) });
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(3000) })]

    #[test]
    fn rows_have_the_golden_bits_for_any_registers(seed: u64) {
        let mut dice = Dice::new(seed);
        let setup = frame(&mut dice);
        let rows: Vec<Row> = [17, 70, 0, 5].into_iter().map(|n| row(&mut dice, &setup, n)).collect();
        assert_golden(&setup, &rows);
    }

    #[test]
    fn rows_have_the_golden_bits_for_the_hosts_registers(seed: u64) {
        let mut dice = Dice::new(seed);
        let setup = hosted_frame(&mut dice);
        let rows: Vec<Row> = [33, 9].into_iter().map(|n| row(&mut dice, &setup, n)).collect();
        assert_golden(&setup, &rows);
    }
}

/// The widest sums of the light unit, where 32 bits end: scattered light alone in red, highlights alone in blue.
#[test]
fn bright_lights_on_wide_colours() {
    let mut dice = Dice::new(5);
    for (colour_bits, normal_bits, lights) in (11..=16)
        .flat_map(|colour| [4, 9, 12, 15].map(|normal| (colour, normal)))
        .flat_map(|(colour, normal)| [0, 1, 2, 8].map(|lights| (colour, normal, lights)))
    {
        for _ in 0..8 {
            let mut setup = frame(&mut dice);
            setup.words = Words { colour_bits, normal_bits, ..setup.words };
            setup.depth_cue = None;
            setup.normaliser = Some(normaliser(normal_bits, 8));
            setup.shading = Some(Shading::Phong(bright(&mut dice, &setup.words, lights)));
            let any = GradientRegisters { method: GradientMethod::Six, weights: [0; 2], scale: None, border: 0 };
            setup.gradient = setup.gradient.or(Some(any));
            let full = unit_full(colour_bits);
            for colour in &mut setup.classification.colour {
                *colour = [dice.word(0, full), dice.word(0, full), dice.word(0, 1)];
            }
            let rows = [row(&mut dice, &setup, 40)];
            assert_golden(&setup, &rows);
        }
    }
}

/// With `skip`, a block without any opacity is left before its neighbours are asked for; any opacity brings them.
#[test]
fn a_transparent_block_is_left_out() {
    let mut dice = Dice::new(11);
    let mut seen = [0; 2];
    while seen[0] < 20 || seen[1] < 20 {
        let mut setup = frame(&mut dice);
        if setup.gradient.is_none() || setup.classification.gradient_rows.is_some() {
            continue;
        }
        let transparent = seen[0] <= seen[1];
        setup.classification.opacity.fill(u32::from(!transparent));
        setup.classification.threshold = [0, u32::MAX];
        let samples = row(&mut dice, &setup, BLOCK_LANES).samples;
        for skip in [false, true] {
            let mut lanes = AbcLanes::new(&setup, skip);
            let filled = Cell::new(false);
            let begin = |block: &mut ShadedBlock| {
                block.present = [1; BLOCK_LANES];
                block.samples = std::array::from_fn(|lane| samples[lane][1][1][1]);
            };
            let fill = |_: &[Neighbours], _: &mut Around| filled.set(true);
            let mut out = ShadedBlock::default();
            let saturated = lanes.shade_block(begin, fill, BLOCK_LANES, |_| [0; 3], &setup.geometry, &mut out);
            let left_out = skip && transparent;
            assert_eq!((saturated.is_none(), filled.get()), (left_out, !left_out), "skip {skip}, {setup:?}");
        }
        seen[usize::from(!transparent)] += 1;
    }
}

#[test]
fn every_neighbourhood_of_one_bit_voxels() {
    // The six neighbours and the sample itself take all 2^7 values; the corners follow them.
    let all: Vec<Neighbourhood> = (0..128)
        .map(|bits| {
            let bit = |i: usize| bits >> i & 1;
            let mut s = [[[bit(6); 3]; 3]; 3];
            for (w, v, u, i) in [(1, 1, 0, 0), (1, 1, 2, 1), (1, 0, 1, 2), (1, 2, 1, 3), (0, 1, 1, 4), (2, 1, 1, 5)] {
                s[w][v][u] = bit(i);
            }
            for (w, v, u) in [(2, 0, 0), (0, 2, 2), (2, 0, 1), (2, 1, 0), (0, 1, 2), (0, 2, 1)] {
                s[w][v][u] = bit((w + v + u) % 7);
            }
            s
        })
        .collect();
    let row = Row { at: vec![[0; 3]; 128], inside: vec![true; 128], samples: all };
    for (method, _) in GradientMethod::ALL {
        for rounding in [Rounding::Nearest, Rounding::Truncate] {
            for weight_bits in 0..=2 {
                for weights in 0..(1_u32 << weight_bits) + 1 {
                    let mut dice = Dice::new(u64::from(weights));
                    let lit = loop {
                        let setup = frame(&mut dice);
                        if setup.shading.is_some() && setup.clips.is_empty() && setup.words.voxel_bits == 1 {
                            break setup;
                        }
                    };
                    let words = Words { sample_fraction_bits: 0, weight_bits, rounding, table_bits: 1, ..lit.words };
                    let words = Words { gradient_bits: 2, ..words };
                    words.check().unwrap();
                    let weights = [weights, (1 << weight_bits) - weights];
                    let gradient = Some(GradientRegisters { method, weights, scale: None, border: 0 });
                    let mut setup = FrameSetup { words, gradient, ..lit };
                    setup.classification.index_shift = 0;
                    setup.classification.colour.resize(2, [0; 3]);
                    let rows = setup.classification.gradient_rows.map_or(1, |rows| rows.rows);
                    setup.classification.opacity.resize(2 * rows as usize, 1);
                    assert_golden(&setup, std::slice::from_ref(&row));
                }
            }
        }
    }
}
