//! The normaliser and the direction index, over every small gradient.

use crate::registers::normaliser;
use cube3_abc::golden::{direction_index, normalise};
use cube3_cases::cases;
use cube3_word::Words;
use proptest::prelude::*;

/// Every gradient of components −`most` to `most`.
fn gradients(most: i32) -> impl Iterator<Item = [i32; 3]> {
    let side = -most..=most;
    side.clone().flat_map(move |u| {
        side.clone().flat_map({
            let side = side.clone();
            move |v| side.clone().map(move |w| [u, v, w])
        })
    })
}

fn with(normal_bits: u32) -> Words {
    Words { normal_bits, ..Words::default() }
}

/// Length off by: half a bin of the table, 2^−root_bits of the square at most and so a quarter of it in length;
/// the entry's rounding, half in 0.289·2^B at least; half a unit in each component, √3/2 together. A gradient of
/// fewer bits than the normal loses none in the block shift.
fn length_bound(bits: u32, root_bits: u32) -> f64 {
    let unit = f64::from(1 - bits as i32).exp2();
    let bin = if root_bits == 2 * bits - 2 { root_bits } else { root_bits + 2 };
    f64::from(-(bin as i32)).exp2() + (0.87 + 0.87) * unit
}

#[test]
fn every_gradient_of_five_bits_gets_unit_length() {
    for bits in 6..=15 {
        for root_bits in [4, 8, 10] {
            let (words, table) = (with(bits), normaliser(bits, root_bits));
            let one = f64::from(1_u32 << (bits - 1));
            let bound = length_bound(bits, table.root_bits);
            for gradient in gradients(15) {
                let normal = normalise(gradient, &table, &words);
                let length = normal.direction.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>().sqrt() / one;
                if gradient == [0; 3] {
                    assert_eq!((normal.direction, normal.magnitude), ([0; 3], 0));
                    continue;
                }
                assert!((length - 1.0).abs() <= bound, "{gradient:?} in {bits} bits: {length}, within {bound}");
                assert!(normal.direction.iter().all(|x| x.abs() <= 1 << (bits - 1)));
                let real = gradient.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>().sqrt();
                let error = (f64::from(normal.magnitude) - real).abs();
                assert!(error <= 0.5 + real * bound, "{gradient:?} in {bits} bits has length {real}: {normal:?}");
                // Straight: each component is the gradient's, times the length, within the half unit that it is rounded by.
                for axis in 0..3 {
                    let straight = f64::from(gradient[axis]) / real * length;
                    let off = (f64::from(normal.direction[axis]) / one - straight).abs();
                    assert!(off <= 2.0 / one, "{gradient:?} in {bits} bits: {normal:?}");
                }
            }
        }
    }
}

#[test]
fn the_normal_follows_every_mirror_and_exchange_of_the_axes() {
    for bits in [4, 5, 8, 12, 15] {
        let (words, table) = (with(bits), normaliser(bits, 8));
        let of = |gradient| normalise(gradient, &table, &words);
        for gradient in gradients(15) {
            let [u, v, w] = gradient;
            let normal = of(gradient);
            let [nu, nv, nw] = normal.direction;
            assert_eq!(of([-u, v, w]).direction, [-nu, nv, nw]);
            assert_eq!(of([-u, -v, -w]).direction, [-nu, -nv, -nw]);
            assert_eq!(of([v, u, w]).direction, [nv, nu, nw]);
            assert_eq!(of([w, u, v]).direction, [nw, nu, nv]);
            assert_eq!(of([-w, u, -v]).magnitude, normal.magnitude);
        }
    }
}

#[test]
fn along_an_axis_the_normal_is_one_and_the_magnitude_exact() {
    for bits in 4..=15 {
        for root_bits in 4..=10 {
            let (words, table) = (with(bits), normaliser(bits, root_bits));
            for gradient_bits in 2..=24 {
                for size in [1_i32, (1 << (gradient_bits - 1)) - 1, 1 << (gradient_bits - 1)] {
                    let normal = normalise([0, -size, 0], &table, &words);
                    let one = f64::from(1_u32 << (bits - 1));
                    let length = -f64::from(normal.direction[1]) / one;
                    let block_cut = f64::from(1 - bits as i32).exp2();
                    let bound = length_bound(bits, table.root_bits) + block_cut;
                    assert!((length - 1.0).abs() <= bound, "{size} in {bits} bits: {length}");
                    let magnitude = f64::from(normal.magnitude);
                    assert!(
                        (magnitude - f64::from(size)).abs() <= 0.5 + f64::from(size) * bound,
                        "{size}: {magnitude}"
                    );
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(256) })]

    /// Block shift, reciprocal and rounding, of gradients as wide as they come: the block loses less than one of its units.
    #[test]
    fn wide_gradients_keep_length_and_direction(
        gradient in prop::array::uniform3(-(1_i32 << 23)..1 << 23), bits in 4_u32..=15, root_bits in 4_u32..=10, narrow in 0_u32..23,
    ) {
        let gradient = gradient.map(|x| x >> narrow);
        prop_assume!(gradient != [0; 3]);
        let table = normaliser(bits, root_bits);
        let normal = normalise(gradient, &table, &with(bits));
        let real = gradient.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>().sqrt();
        let one = f64::from(1_u32 << (bits - 1));
        let bound = length_bound(bits, table.root_bits) + 3.5 / one;
        for axis in 0..3 {
            let off = f64::from(normal.direction[axis]) / one - f64::from(gradient[axis]) / real;
            prop_assert!(off.abs() <= bound, "{:?} for {:?}", normal, gradient);
        }
        prop_assert!((f64::from(normal.magnitude) - real).abs() <= 0.5 + real * bound);
    }
}

#[test]
fn the_direction_index_names_the_cell_that_the_direction_points_at() {
    for bits in 2..=8 {
        let side = 1_usize << bits;
        for gradient in gradients(12) {
            let Some(index) = direction_index(gradient, bits) else {
                assert_eq!(gradient, [0; 3]);
                continue;
            };
            let (face, second, first) = (index >> (2 * bits), index >> bits & (side - 1), index & (side - 1));
            assert!(face < 6);
            let (axis, sign) = (face / 2, if face % 2 == 0 { 1 } else { -1 });
            let largest = gradient[axis] * sign;
            assert!(gradient.iter().all(|x| x.abs() <= largest), "{gradient:?} on face {face}");
            assert!(gradient[..axis].iter().all(|x| x.abs() < largest), "u before v before w: {gradient:?}");
            for (cell, other) in [(first, (axis + 1) % 3), (second, (axis + 2) % 3)] {
                let real = (f64::from(gradient[other]) / f64::from(largest) + 1.0) / 2.0 * side as f64;
                assert!((cell as f64..=cell as f64 + 1.0).contains(&real), "{gradient:?}: cell {cell}, not {real}");
            }
        }
    }
}

#[test]
fn opposite_directions_are_in_opposite_cells() {
    for bits in 2..=6 {
        let last = (1_usize << bits) - 1;
        for gradient in gradients(9).filter(|gradient| !gradient.contains(&0)) {
            let index = direction_index(gradient, bits).unwrap();
            let (face, second, first) = (index >> (2 * bits), index >> bits & last, index & last);
            let opposite = ((face ^ 1) << bits | (last - second)) << bits | (last - first);
            assert_eq!(direction_index(gradient.map(|x| -x), bits), Some(opposite));
        }
    }
}

#[test]
fn every_cell_of_a_small_table_is_reached() {
    let mut seen = vec![false; 6 << 6];
    gradients(15).filter_map(|gradient| direction_index(gradient, 3)).for_each(|index| seen[index] = true);
    assert!(seen.iter().all(|&seen| seen));
}

#[test]
fn rows_of_gradients_are_normalised_as_each_alone() {
    let (words, table) = (Words { normal_bits: 9, ..Words::default() }, normaliser(9, 6));
    let gradients: Vec<[i32; 3]> = (0..343_i32).map(|i| [i % 7, i / 7 % 7, i / 49].map(|x| (x - 3).pow(5))).collect();
    let rows = [0, 1, 2].map(|axis| gradients.iter().map(|gradient| gradient[axis]).collect());
    let (direction, magnitude) = cube3_abc::lanes::normalise_rows(rows, &table, &words);
    for (lane, &gradient) in gradients.iter().enumerate() {
        let alone = normalise(gradient, &table, &words);
        assert_eq!(direction.each_ref().map(|row| row[lane]), alone.direction, "{gradient:?}");
        assert_eq!(magnitude[lane], alone.magnitude, "{gradient:?}");
    }
}
