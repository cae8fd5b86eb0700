//! What each estimator must give on an affine field: the known gradient, to the bit where no bit is dropped.

use crate::registers::{Dice, normaliser};
use cube3_abc::golden::{Neighbourhood, gradient, normalise};
use cube3_frame::GradientRegisters;
use cube3_host::{Basis, VolumeInfo, frame_setup};
use cube3_machine::{GradientMethod, MachineSpec};
use cube3_scene::{Scene, View};
use cube3_word::{Rounding, Words};

/// 16-bit samples whose differences keep every bit.
fn words(weight_bits: u32, rounding: Rounding) -> Words {
    Words { weight_bits, rounding, gradient_bits: 17, ..Words::default() }
}

/// The samples of `g · p` around one in the middle of the range: a neighbour is at (a + c·du, b + c·dv, c), and rounded as
/// the interpolators round.
fn affine(g: [f64; 3], slopes: [f64; 2], rounding: Rounding) -> Neighbourhood {
    let mut s = [[[0; 3]; 3]; 3];
    for (w, plane) in s.iter_mut().enumerate() {
        for (v, line) in plane.iter_mut().enumerate() {
            for (u, sample) in line.iter_mut().enumerate() {
                let [a, b, c] = [u, v, w].map(|i| i as f64 - 1.0);
                let value = 32768.0 + g[0] * (a + c * slopes[0]) + g[1] * (b + c * slopes[1]) + g[2] * c;
                *sample = match rounding {
                    Rounding::Nearest => (value + 0.5).floor() as i32,
                    Rounding::Truncate => value.floor() as i32,
                };
            }
        }
    }
    s
}

fn reals(slopes: [u32; 2], weight_bits: u32) -> [f64; 2] {
    slopes.map(|slope| f64::from(slope) / f64::from(1_u32 << weight_bits))
}

/// What a method's differences stand for: twice the gradient along u, v and its third axis.
fn truth(method: GradientMethod, g: [f64; 3], slopes: [f64; 2], feet: [f64; 2]) -> [f64; 3] {
    let along_ray = g[2] + slopes[0] * g[0] + slopes[1] * g[1];
    match method {
        GradientMethod::Six | GradientMethod::TwentySix => [2.0 * g[0], 2.0 * g[1], 2.0 * along_ray],
        GradientMethod::Ten | GradientMethod::TenNormalised => {
            [2.0 * (g[0] - feet[0] * along_ray), 2.0 * (g[1] - feet[1] * along_ray), 2.0 * along_ray]
        }
        _ => g.map(|x| 2.0 * x),
    }
}

#[test]
fn affine_fields_whose_products_are_whole_come_out_to_the_bit() {
    let weight_bits = 4;
    let one = 1_i64 << weight_bits;
    let mut dice = Dice::new(1);
    for case in 0..4000 {
        let rounding = if case % 2 == 0 { Rounding::Nearest } else { Rounding::Truncate };
        let slopes = [dice.within(0, one), dice.within(0, one)].map(|slope| slope as u32);
        // Multiples of 16² in u and v: the field is whole at every sample, at the feet, and bilinearly between.
        let g = [0; 3].map(|_| (one * one * dice.within(-9, 9)) as f64);
        let real = reals(slopes, weight_bits);
        let s = affine(g, real, rounding);
        for (method, name) in GradientMethod::ALL {
            let registers = GradientRegisters { method, weights: slopes, scale: None, border: 0 };
            let got = gradient(&s, &registers, &words(weight_bits, rounding));
            let expected = truth(method, g, real, real);
            assert_eq!(got.value.map(f64::from), expected, "{name}: {g:?} along {real:?}");
            assert_eq!(got.overflows, 0);
        }
    }
}

/// A sample is off by ±½ (nearest) or 0 to −1 (truncated), and so is every rounding after it; a difference of two words, each
/// rounded r times in a row, is off by r in either mode: 1 for 6, 2 for 10, 3 for 12. The 26 add the shift by their
/// weights. The shear of 6d and 26d takes two such differences off the third, and is rounded itself: 4.
#[test]
fn any_affine_field_comes_out_within_the_roundings() {
    let mut dice = Dice::new(2);
    let mut worst = [[0.0_f64; 2]; 7];
    for case in 0..20_000 {
        let rounding = if case % 2 == 0 { Rounding::Nearest } else { Rounding::Truncate };
        let slopes = [dice.within(0, 4096), dice.within(0, 4096)].map(|slope| slope as u32);
        let g = [0; 3].map(|_| dice.real(-4000.0, 4000.0));
        let real = reals(slopes, 12);
        let s = affine(g, real, rounding);
        for (i, (method, name)) in GradientMethod::ALL.into_iter().enumerate() {
            let registers = GradientRegisters { method, weights: slopes, scale: None, border: 0 };
            let got = gradient(&s, &registers, &words(12, rounding)).value;
            let expected = truth(method, g, real, real);
            let bound = match method {
                GradientMethod::Six => 1.0,
                GradientMethod::TwentySix | GradientMethod::Ten | GradientMethod::TenNormalised => 2.0,
                GradientMethod::Twelve => 3.0,
                GradientMethod::SixSheared | GradientMethod::TwentySixSheared => 4.0,
            };
            for axis in 0..3 {
                let error = (f64::from(got[axis]) - expected[axis]).abs();
                let seen = &mut worst[i][case % 2];
                *seen = seen.max(error);
                assert!(error <= bound, "{name}[{axis}], {rounding:?}: off by {error}, {g:?} along {real:?}");
            }
        }
    }
    println!("largest errors, nearest and truncated, in words: {worst:.2?}");
}

#[test]
fn along_an_axis_every_estimator_is_the_central_difference() {
    let g = [300.0, -70.0, 41.0];
    let s = affine(g, [0.0; 2], Rounding::Nearest);
    for (method, name) in GradientMethod::ALL {
        for weight_bits in [0, 8] {
            let registers = GradientRegisters { method, weights: [0; 2], scale: None, border: 0 };
            let got = gradient(&s, &registers, &words(weight_bits, Rounding::Nearest)).value;
            assert_eq!(got, [600, -140, 82], "{name}");
        }
    }
}

#[test]
fn the_hosts_registers_point_every_orthogonal_estimator_along_the_gradient() {
    // Views with two slopes and voxels that are not cubes. 10 normalised has a frame of its own, orthogonal while one
    // slope is 0 and the foot of the perpendicular is no more than a step away.
    let mut dice = Dice::new(3);
    let mut worst = 0.0_f64;
    for _ in 0..200 {
        let spacing = [0; 3].map(|_| dice.real(0.5, 2.0));
        let tilted = dice.one_in(2);
        let direction = [dice.real(-1.0, 1.0), if tilted { dice.real(-1.0, 1.0) } else { 0.0 }, dice.real(0.2, 1.0)];
        let methods = [GradientMethod::TenNormalised, GradientMethod::Twelve, GradientMethod::SixSheared];
        for method in methods.into_iter().chain([GradientMethod::TwentySixSheared]) {
            let mut machine = MachineSpec::default();
            machine.words.weight_bits = 12;
            machine.words.normal_bits = 15;
            machine.abc.gradient = method;
            machine.abc.root_bits = 10;
            let volume = VolumeInfo { dims: [9; 3], spacing, window: [0.0, 65535.0] };
            let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
            let setup = frame_setup(&scene, &machine, &volume, true).unwrap().setup;
            let basis = Basis::new(&setup.geometry, spacing, method);
            if method == GradientMethod::TenNormalised && (tilted || basis.feet[0] == 1.0) {
                continue;
            }
            // A gradient in the world, and what it is for each voxel of u, v, w.
            let world = [0; 3].map(|_| dice.real(-4000.0, 4000.0));
            let canonical = setup.geometry.axes.to_canonical(world.into());
            let lengths = setup.geometry.axes.permute(spacing);
            let per_voxel = [0, 1, 2].map(|i| canonical[i] * lengths[i]);
            let s = affine(per_voxel, setup.geometry.real_slopes(), Rounding::Nearest);
            let got = gradient(&s, &setup.gradient.unwrap(), &setup.words);
            assert_eq!(got.overflows, 0);
            let normal = normalise(got.value, &normaliser(15, 10), &setup.words);
            let back = basis.world(&setup.geometry.axes, normal.direction.map(f64::from));
            let expected = basis.world(&setup.geometry.axes, basis.components(&setup.geometry.axes, world.into()));
            worst = worst.max(back.angle_between(expected).to_degrees());
            let kept = setup.gradient.and_then(|registers| registers.scale).map_or(0, |scale| scale.kept_bits);
            let length = f64::from(normal.magnitude) / f64::from(1_u32 << kept) / (2.0 * basis.scale(method).1);
            let true_length = expected.length();
            assert!((length - true_length).abs() < 0.004 * true_length + 4.0, "{length}, not {true_length}");
            assert!(
                worst < 0.25 || expected.length() < 500.0,
                "{method:?}: {worst}° off, {world:?} along {direction:?}"
            );
        }
    }
    println!("largest angle {worst:.3} degrees");
}

#[test]
fn an_overflow_is_held_at_the_end_and_counted() {
    let mut s = [[[0; 3]; 3]; 3];
    s[1][1][2] = 65535;
    s[1][0][1] = 65535;
    let registers = GradientRegisters { method: GradientMethod::Six, weights: [0; 2], scale: None, border: 0 };
    for gradient_bits in 2..=17 {
        let top = (1 << (gradient_bits - 1)) - 1;
        let dropped = f64::from(1_u32 << (17 - gradient_bits));
        let down = |half: f64| (-65535.0 / dropped + half).floor() as i32;
        let words = Words { gradient_bits, rounding: Rounding::Nearest, ..Words::default() };
        let got = gradient(&s, &registers, &words);
        // The largest difference rounds up to one more than the word has, unless it drops nothing.
        assert_eq!((got.value, got.overflows), ([top, down(0.5), 0], u32::from(gradient_bits < 17)));
        let words = Words { rounding: Rounding::Truncate, ..words };
        let got = gradient(&s, &registers, &words);
        assert_eq!((got.value, got.overflows), ([top, down(0.0), 0], 0));
    }
}

#[test]
fn one_voxel_shows_the_weights_of_the_twenty_six() {
    // 4, 2, 1 of 16 by Manhattan distance; what is level with the sample counts nothing.
    let registers = GradientRegisters { method: GradientMethod::TwentySix, weights: [0; 2], scale: None, border: 0 };
    let words = words(8, Rounding::Nearest);
    for place in 0..27_usize {
        let at = [place % 3, place / 3 % 3, place / 9];
        let mut s = [[[0; 3]; 3]; 3];
        s[at[2]][at[1]][at[0]] = 16;
        let offset = at.map(|i| i as i32 - 1);
        let weight = 8 >> offset.iter().map(|x| x.abs()).sum::<i32>();
        assert_eq!(gradient(&s, &registers, &words).value, offset.map(|sign| sign * weight), "{offset:?}");
    }
}

#[test]
fn twelve_and_ten_read_on_the_sides_of_the_papers_figures() {
    // With slopes of 1 the point straight behind is on ray (u−1, v−1), and the one in front on (u+1, v+1).
    let at = |w: usize, v: usize, u: usize| {
        let mut s = [[[0; 3]; 3]; 3];
        s[w][v][u] = 5;
        s
    };
    let of = |method, weights, s: &Neighbourhood| {
        let registers = GradientRegisters { method, weights, scale: None, border: 0 };
        gradient(s, &registers, &words(0, Rounding::Nearest)).value
    };
    assert_eq!(of(GradientMethod::Twelve, [1, 1], &at(2, 0, 0)), [0, 0, 5]);
    assert_eq!(of(GradientMethod::Twelve, [1, 1], &at(0, 2, 2)), [0, 0, -5]);
    assert_eq!(of(GradientMethod::Twelve, [1, 0], &at(2, 1, 0)), [0, 0, 5]);
    assert_eq!(of(GradientMethod::Twelve, [0, 1], &at(0, 2, 1)), [0, 0, -5]);
    // The foot of the perpendicular on the right ray lies towards the eye, on the left one away from it.
    assert_eq!(of(GradientMethod::Ten, [1, 0], &at(0, 1, 2)), [5, 0, 0]);
    assert_eq!(of(GradientMethod::Ten, [1, 0], &at(2, 1, 0)), [-5, 0, 0]);
    assert_eq!(of(GradientMethod::Ten, [0, 1], &at(0, 2, 1)), [0, 5, 0]);
    assert_eq!(of(GradientMethod::Ten, [0, 1], &at(2, 0, 1)), [0, -5, 0]);
}
