//! What a frame derives from its registers, against exact integers and reals.

use cube3_cases::cases;
use cube3_frame::{
    Axes, DiscreteRay, Geometry, HalfSpace, Linear, LinearFactor, PLACE_BITS, RayRegisters, SLOPE_FRACTION_BITS,
    Template, largest_offset, slope_register,
};
use cube3_machine::{RaySlots, TemplateRule};
use proptest::prelude::*;

fn linears() -> impl Strategy<Value = Linear> {
    let step = || prop_oneof![4 => -(1_i64 << 34)..1 << 34, 1 => -3_i64..4];
    (step(), step(), step(), -(1_i64 << 46)..1 << 46).prop_map(|(u, v, k, constant)| Linear { u, v, k, constant })
}

proptest! {
    #![proptest_config(cases(256))]

    /// `a·u + b·v + c·k + d`, without a rounding.
    #[test]
    fn linear_functions_are_exact_over_rays_and_depths(
        function in linears(), u in -8191_i64..8192, v in -8191_i64..8192, k in 0_i64..4096,
    ) {
        let exact = i128::from(function.u) * i128::from(u)
            + i128::from(function.v) * i128::from(v)
            + i128::from(function.k) * i128::from(k)
            + i128::from(function.constant);
        prop_assert_eq!(i128::from(function.at(u, v, k)), exact);
        // Places are fractions: the products are rounded down together.
        let place = [u, v, k].map(|x| (x << PLACE_BITS) / 3);
        let sum: i128 = [function.u, function.v, function.k].iter().zip(place).map(|(&a, x)| i128::from(a) * i128::from(x)).sum();
        let steep = [function.u, function.v, function.k].iter().any(|a| a.abs() > 1 << 32);
        if !steep {
            prop_assert_eq!(i128::from(function.at_place(place)), (sum >> PLACE_BITS) + i128::from(function.constant));
        }
    }

    /// A row's interval has exactly the rays at which the distance is 0 or more.
    #[test]
    fn an_interval_has_the_rays_that_are_inside(
        function in linears(), v in -40_i64..40, k in 0_i64..40, from in -30_i64..30, count in 0_i64..40, near: bool,
    ) {
        // With small steps the edge lies among the rays.
        let small = Linear { u: function.u % 5, v: function.v % 5, k: function.k % 5, constant: function.constant % 97 };
        let half = HalfSpace { distance: if near { small } else { function } };
        let [start, end] = half.interval(v, k, [from, from + count]);
        for u in from..from + count {
            prop_assert_eq!((start..end).contains(&u), half.distance.at(u, v, k) >= 0, "ray {}", u);
        }
    }

    /// The leading bits of the factor, held to 0 and 1.
    #[test]
    fn a_factor_is_held_to_the_unit_interval_and_cut(value in -(1_i64 << 30)..1 << 30) {
        let one = f64::from(1_u32 << LinearFactor::FRACTION_BITS);
        let exact = (value as f64 / one).clamp(0.0, 1.0) * f64::from(1_u32 << LinearFactor::WORD_BITS);
        prop_assert_eq!(LinearFactor::word(value), exact.floor() as u32);
    }

    /// Slope over the distance to the neighbours, rounded to nearest, at most 1.
    #[test]
    fn a_shear_is_the_slope_in_units_of_the_neighbours_distance(
        slope in 0_u32..=2 << 15, closeness in 0_u32..=1 << 15, weight_bits in 0_u32..=12,
    ) {
        let exact = f64::from(slope) * f64::from(closeness) / f64::from(1_u32 << 30);
        let one = f64::from(1_u32 << weight_bits);
        let expected = ((exact * one + 0.5).floor()).min(one);
        prop_assert_eq!(f64::from(RayRegisters::shear(slope, closeness, weight_bits)), expected);
    }

    /// A slope's register is its size to the nearest, halves up, at most 2; the neighbours' registers are 1 over their distance, and it.
    #[test]
    fn registers_of_slopes_and_distances_are_the_nearest(slope in -(1_i64 << 32)..1 << 32, spacing in 0.0..9.0_f64) {
        let exact = slope.unsigned_abs() as f64 / f64::from(1_u32 << (SLOPE_FRACTION_BITS - RayRegisters::SLOPE_BITS));
        let register = f64::from(RayRegisters::slope_register(slope));
        prop_assert!((register - exact.min(65536.0)).abs() <= 0.5, "{} for {}", register, exact);
        let [closeness, nearness] = RayRegisters::closeness_registers(spacing).map(f64::from);
        prop_assert!((closeness / 32768.0 - 1.0 / spacing.max(1.0)).abs() <= 0.5 / 32768.0 + 1e-12);
        prop_assert!((nearness / 65536.0 - spacing.min(1.0)).abs() <= 0.5 / 65536.0 + 1e-12);
    }

    /// Columns and weights of a template against the ray's place in reals: `X(k) = ⌊…⌋`, `w = p − lerp(X(k), X(k+1), o)`.
    #[test]
    fn a_template_is_the_ray_it_stands_for(
        slope in 0.0..=1.0_f64, offset in 0.0..1.0_f64, weight_bits in 1_u32..=12, rule in 0_usize..3,
    ) {
        let rule = [TemplateRule::SampleFloor, TemplateRule::PlaneFloor, TemplateRule::Nearest][rule];
        let register = slope_register(slope);
        let bound = largest_offset(rule, [register, register / 2], weight_bits);
        let one = f64::from(1_u32 << weight_bits);
        let offset = ((offset * one) as u32).min(bound);
        let template = Template::new(rule, register, offset, weight_bits, 40);
        let slope = f64::from(register) / f64::from(1_u32 << SLOPE_FRACTION_BITS);
        let o = f64::from(offset) / one;
        for k in 0..=40_usize {
            let exact = match rule {
                TemplateRule::SampleFloor => (k as f64 + o) * slope,
                TemplateRule::PlaneFloor => k as f64 * slope,
                TemplateRule::Nearest => k as f64 * slope + 0.5,
            };
            // Registers have 30 bits and offsets 12 at most: the product is exact in a real.
            prop_assert_eq!(f64::from(template.columns[k]), exact.floor());
        }
        for k in 0..40 {
            let [near, far] = [template.columns[k], template.columns[k + 1]].map(f64::from);
            let exact = (k as f64 + o) * slope - (near + (far - near) * o);
            let weight = f64::from(template.weights[k]) / one;
            let expected = if rule == TemplateRule::Nearest { 0.0 } else { exact };
            prop_assert!((weight - expected).abs() <= 0.5 / one + 1e-12, "{} for {}", weight, expected);
        }
    }

    /// The paper's bound, equation (3): the largest offset is the largest with which the steepest slope stays in its cell.
    #[test]
    fn the_largest_offset_is_one_less_the_steepest_slope(
        slopes in prop_oneof![1 => Just([0.0; 2]), 4 => [0.0..=1.0_f64, 0.0..=1.0_f64]], weight_bits in 1_u32..=12,
    ) {
        let registers = slopes.map(slope_register);
        let steepest = f64::from(registers[0].max(registers[1])) / f64::from(1_u32 << SLOPE_FRACTION_BITS);
        let one = f64::from(1_u32 << weight_bits);
        let bound = largest_offset(TemplateRule::SampleFloor, registers, weight_bits);
        prop_assert_eq!(f64::from(bound), ((1.0 - steepest) * one).floor().min(one - 1.0));
        prop_assert_eq!(largest_offset(TemplateRule::PlaneFloor, registers, weight_bits), (1 << weight_bits) - 1);
        prop_assert_eq!(largest_offset(TemplateRule::Nearest, registers, weight_bits), 0);
    }

    /// The ray in a slot has the slot's voxel: its number and the column of its depth.
    #[test]
    fn the_ray_in_a_slot_has_the_slots_voxel(size in [1_usize..9, 1_usize..9, 1_usize..9], slopes in [0.0..=1.0_f64, 0.0..=1.0_f64], padded: bool) {
        let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
        let registers = slopes.map(slope_register);
        let axes = Axes { axis: [0, 1, 2], reversed: [false; 3] };
        let geometry = Geometry::new(size, axes, registers, 0, 8, TemplateRule::PlaneFloor, slots);
        let [count, planes] = geometry.slot_counts();
        for k in 0..size[2] {
            for i in 0..planes {
                for j in 0..count {
                    let DiscreteRay { u, v } = geometry.ray_in_slot(i, j, k);
                    if padded {
                        prop_assert_eq!([u, v], [j as i64 - geometry.shear_u() as i64, i as i64 - geometry.shear_v() as i64]);
                    } else {
                        // The one ray of a slot whose voxel is in the volume.
                        let voxel = [u + i64::from(geometry.u.columns[k]), v + i64::from(geometry.v.columns[k])];
                        prop_assert!((0..size[0] as i64).contains(&voxel[0]) && (0..size[1] as i64).contains(&voxel[1]));
                        prop_assert_eq!([u.rem_euclid(size[0] as i64), v.rem_euclid(size[1] as i64)], [j as i64, i as i64]);
                    }
                }
            }
        }
    }
}

/// A half-space whose edge runs along a row keeps the row on the edge.
#[test]
fn a_row_on_the_edge_is_inside() {
    for (constant, rays) in [(-1, 0), (0, 9), (1, 9)] {
        let half = HalfSpace { distance: Linear { u: 0, v: 3, k: -1, constant } };
        // 3·1 − 3 and the constant.
        let [start, end] = half.interval(1, 3, [-4, 5]);
        assert_eq!((end - start).max(0), rays, "{constant}");
    }
}

/// A step's class is the sum of the parts of its squared length along u and v.
#[test]
fn a_class_is_the_sum_of_two_parts() {
    let table = |parts: &[u32]| parts.to_vec();
    let rays = RayRegisters {
        view_u: vec![0; 3],
        view_v: vec![0; 2],
        view_w: 1,
        at_eye: Vec::new(),
        length_u: table(&[0, 4095, 4096]),
        length_v: table(&[0, 8193]),
        length_classes: 4,
        slope_u: vec![0; 3],
        slope_v: vec![0; 2],
        closeness: vec![1 << 15],
        factors: vec![[1 << 16; 3]],
        reach: None,
        nearness: None,
    };
    let classes: Vec<u32> = (0..2)
        .flat_map(|row| (0..3).map(move |column| (row, column)))
        .map(|(row, column)| rays.length_class(row, column))
        .collect();
    assert_eq!(classes, [0, 0, 1, 2, 3, 3]);
}
