//! Rows of perspective frames have the golden bits, along a plane and along a ray; and a gradient in the mirror is the mirrored one.

use crate::registers::{Dice, machine, neighbourhood, normaliser, scene, words};
use cube3_abc::ends::End;
use cube3_abc::golden::{Local, Neighbourhood, Shaded, halfway, local_gradient, opacity_class, shade, view_vector};
use cube3_abc::lanes::{AbcLanes, ShadedRow};
use cube3_cases::cases;
use cube3_frame::{FrameSetup, GradientRegisters, GradientScale, RayRegisters};
use cube3_host::{VolumeInfo, picture_setup};
use cube3_machine::{Abc, Bus, BusKind, GradientMethod, MachineSpec, ShadingUnit};
use cube3_scene::{Image, Mode, Perspective, Scene, View};
use cube3_word::{Words, unit_full};
use proptest::prelude::*;
use std::sync::Arc;

const METHODS: [GradientMethod; 5] = [
    GradientMethod::Six,
    GradientMethod::SixSheared,
    GradientMethod::Twelve,
    GradientMethod::TwentySix,
    GradientMethod::TwentySixSheared,
];

/// The passes of a picture that an eye near the volume, or in it, has of any scene on any machine.
fn frames(dice: &mut Dice) -> Vec<Arc<FrameSetup>> {
    let words = words(dice);
    let words = Words { table_gradient_bits: words.table_gradient_bits.min(3), ..words };
    let machine = machine(dice, words);
    let abc = Abc { gradient: METHODS[dice.within(0, 4) as usize], shading: ShadingUnit::Phong, ..machine.abc };
    let bus = Bus { kind: BusKind::Gather, ..machine.bus };
    let machine = MachineSpec { abc, bus, ..machine };
    let dims = [0; 3].map(|_| dice.within(2, 7) as usize);
    let scene = scene(dice, dims);
    let eye = [0; 3].map(|_| dice.real(-6.0, 13.0));
    let field_of_view_deg = dice.real(20.0, 120.0);
    let perspective = Perspective { eye_voxel: Some(eye), distance_voxel: None, field_of_view_deg };
    let view = View { perspective: Some(perspective), ..scene.view.clone() };
    // The modes that are lit have most to compare.
    let mode = if dice.one_in(4) { scene.mode } else { Mode::Composite };
    let image = Image { width_px: 9, height_px: 9, ..scene.image.clone() };
    let scene = Scene { view, image, mode, ..scene };
    let volume = VolumeInfo { dims, spacing: [0; 3].map(|_| dice.real(0.5, 2.0)), window: [0.0, 255.0] };
    picture_setup(&scene, &machine, &volume, dice.one_in(2)).unwrap().setups
}

/// Shades samples with the lanes, and each alone by the definition.
fn assert_golden(setup: &FrameSetup, samples: &[Neighbourhood], at: &[[i64; 3]], skip: bool, lanes: &mut AbcLanes) {
    let n = at.len();
    let rows: Vec<Vec<i32>> =
        (0..27).map(|place| samples.iter().map(|s| s[place / 9][place / 3 % 3][place % 3]).collect()).collect();
    let rows = rows.as_slice();
    let clear = |at: &[i64; 3]| setup.clips.iter().all(|clip| setup.geometry.evaluate(&clip.distance, *at) >= 0);
    let mut out = ShadedRow { present: at.iter().map(|at| u8::from(clear(at))).collect(), ..ShadedRow::default() };
    if let Some(ends) = &setup.ends {
        let end = |lane: usize| End { lane, class: opacity_class(at[lane], setup) };
        out.ends.extend((0..n).map(end).filter(|end| end.class >= ends.first_class));
    }
    let neighbour = |w: usize, v: usize, u: usize| rows[w * 9 + v * 3 + u].as_slice();
    lanes.shade(n, neighbour, |lane| at[lane], &setup.geometry, &mut out);
    let mut overflows = 0;
    for lane in 0..n {
        let counted = shade(&samples[lane], at[lane], setup);
        overflows += u64::from(counted.overflows);
        let got = Shaded {
            present: out.present[lane] != 0,
            sample: counted.value.sample,
            opacity: out.opacity[lane],
            colour: [0, 1, 2].map(|i| out.colour[i][lane]),
        };
        assert_eq!(got, counted.value, "{:?} of {:?}, skip {skip}", at[lane], setup.geometry.size);
    }
    assert_eq!(out.overflows, overflows);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(400) })]

    #[test]
    fn rows_and_rays_have_the_golden_bits(seed: u64, skip: bool) {
        let mut dice = Dice::new(seed);
        for setup in frames(&mut dice) {
            let pass = setup.geometry.perspective.as_ref().unwrap();
            let us = pass.u.first..pass.u.first + pass.u.count() as i64;
            let vs = pass.v.first..pass.v.first + pass.v.count() as i64;
            let depths = setup.geometry.fan_shape().first_depth as i64..setup.geometry.size[2] as i64;
            if depths.is_empty() {
                continue;
            }
            let mut lanes = AbcLanes::new(&setup, skip);
            for _ in 0..3 {
                let [u, v, k] = [&us, &vs, &depths].map(|range| dice.within(range.start, range.end - 1));
                // A part of a plane's rays at one depth, all depths of a ray, and none: no lane is asked for then.
                let from = dice.within(us.start, u);
                let row: Vec<[i64; 3]> = (from..us.end).map(|u| [u, v, k]).collect();
                let ray: Vec<[i64; 3]> = depths.clone().map(|k| [u, v, k]).collect();
                for (at, aimed) in [(row, from..us.end), (ray, u..u + 1), (Vec::new(), u..u)] {
                    let samples: Vec<Neighbourhood> =
                        at.iter().map(|_| neighbourhood(&mut dice, setup.words.sample_bits())).collect();
                    lanes.aim(v, aimed);
                    assert_golden(&setup, &samples, &at, skip, &mut lanes);
                }
            }
        }
    }

    #[test]
    fn view_vectors_and_halfway_vectors_have_length_one_and_the_direction_of_their_sum(
        light in prop::array::uniform3(-2048_i32..=2048), view in prop::array::uniform3(-2048_i32..=2048),
    ) {
        let words = Words { normal_bits: 12, ..Words::default() };
        let table = normaliser(12, 10);
        let near = |got: [i32; 3], vector: [i32; 3]| {
            let length = vector.iter().map(|&x| f64::from(x) * f64::from(x)).sum::<f64>().sqrt();
            // The block has 12 bits, and so have the components.
            got.iter().zip(vector).all(|(&got, x)| (f64::from(got) - 2048.0 * f64::from(x) / length).abs() < 3.0)
        };
        let sum = [0, 1, 2].map(|i| light[i] + view[i]);
        prop_assume!(sum != [0; 3] && view != [0; 3]);
        let half = halfway(light, view, &table, &words);
        prop_assert!(near(half, sum), "{:?} of {:?}", half, sum);
        prop_assert_eq!(halfway(view, light, &table, &words), half);
        prop_assert_eq!(halfway(view, view.map(|x| -x), &table, &words), [0; 3]);
        // Components of other rays lie beside those of the ray.
        let rays = RayRegisters {
            reach: None,
            view_u: vec![-7, view[0], 999],
            view_v: vec![view[1], 5],
            view_w: view[2],
            at_eye: Vec::new(),
            length_u: Vec::new(),
            length_v: Vec::new(),
            length_classes: 1,
            slope_u: Vec::new(),
            slope_v: Vec::new(),
            closeness: Vec::new(),
            factors: Vec::new(),
            nearness: None,
        };
        let seen = view_vector(0, 1, &rays, &table, &words);
        prop_assert!(near(seen, view), "{:?} of {:?}", seen, view);
    }

    #[test]
    fn a_gradient_in_the_mirror_is_the_mirrored_gradient(seed: u64, mirror_u: bool, mirror_v: bool) {
        let mut dice = Dice::new(seed);
        // Without a bit to drop, as rounding has a side.
        let voxel_bits = dice.word(1, 16);
        let words = Words { voxel_bits, sample_fraction_bits: 0, gradient_bits: voxel_bits + 1, weight_bits: 6, ..words(&mut dice) };
        let s = neighbourhood(&mut dice, voxel_bits);
        let mut weights = || [dice.word(0, 64), dice.word(0, 64)];
        let (here, behind, before) = (weights(), weights(), weights());
        let one = 1 << GradientScale::FACTOR_BITS;
        let local = Local { mirrored: [false; 2], here, behind, before, factors: Some([one; 3]), nearness: Some(dice.word(0, one)) };
        let mirrored = Local { mirrored: [mirror_u, mirror_v], ..local };
        let place = |i: usize, mirror: bool| if mirror { 2 - i } else { i };
        let in_mirror: Neighbourhood = [0, 1, 2]
            .map(|w| [0, 1, 2].map(|v| [0, 1, 2].map(|u| s[w][place(v, mirror_v)][place(u, mirror_u)])));
        for method in [GradientMethod::Six, GradientMethod::SixSheared, GradientMethod::Twelve] {
            let registers = GradientRegisters { method, weights: here, scale: None, border: 0 };
            let [u, v, w] = local_gradient(&in_mirror, &registers, &local, &words).value;
            let sign = |mirror: bool| if mirror { -1 } else { 1 };
            // The lowest word has no counterpart.
            prop_assert!(u.unsigned_abs() <= unit_full(voxel_bits) && v.unsigned_abs() <= unit_full(voxel_bits));
            let expected = [sign(mirror_u) * u, sign(mirror_v) * v, w];
            prop_assert_eq!(local_gradient(&s, &registers, &mirrored, &words).value, expected, "{:?}", method);
        }
    }
}
