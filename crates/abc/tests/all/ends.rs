//! The ends of rays: the parts of a step that samples stand for add up to the length of their ray.

use crate::registers::{Dice, direction};
use cube3_abc::ends::ray_ends;
use cube3_abc::golden::{class_of, end_class, in_place, opacity_class, reach, steps_to};
use cube3_cases::cases;
use cube3_frame::{DiscreteRay, EndRegisters, FrameSetup, SLOPE_FRACTION_BITS};
use cube3_host::{VolumeInfo, frame_setup, picture_setup};
use cube3_machine::{MachineSpec, RayEnds, Rays, TemplateRule};
use cube3_scene::{Crop, Cut, Image, Perspective, Scene, View};
use cube3_word::Words;
use proptest::prelude::*;
use std::sync::Arc;

const ONE: f64 = (1 << EndRegisters::REACH_BITS) as f64;
const PARTS: f64 = (1 << EndRegisters::PART_BITS) as f64;

fn scene(dice: &mut Dice, dims: [usize; 3]) -> Scene {
    let voxel = |dice: &mut Dice| dims.map(|side| dice.real(0.0, side as f64));
    let crop = dice.one_in(2).then(|| {
        let (a, b) = (voxel(dice), voxel(dice));
        Crop { min_voxel: [0, 1, 2].map(|i| a[i].min(b[i])), max_voxel: [0, 1, 2].map(|i| a[i].max(b[i]) + 0.01) }
    });
    let cuts = (0..dice.within(0, 2)).map(|_| Cut { normal: direction(dice), through_voxel: voxel(dice) }).collect();
    let mut scene = Scene { view: View::from_direction(direction(dice), None), crop, cuts, ..Scene::default() };
    scene.transfer.opacity_correction = !dice.one_in(4);
    scene
}

fn machine(dice: &mut Dice) -> MachineSpec {
    let words = Words { table_bits: 2, weight_bits: dice.word(4, 12), ..Words::default() };
    let rays = Rays {
        template: if dice.one_in(2) { TemplateRule::SampleFloor } else { TemplateRule::PlaneFloor },
        offset: dice.real(0.0, 1.0),
        ends: RayEnds::Exact,
        ..Rays::default()
    };
    MachineSpec { words, rays, ..MachineSpec::default() }
}

/// Frames of any view with exact ends, and their scene.
fn frames(dice: &mut Dice) -> (Scene, Vec<Arc<FrameSetup>>) {
    let dims = [0; 3].map(|_| dice.within(2, 9) as usize);
    let (mut scene, machine) = (scene(dice, dims), machine(dice));
    let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
    if dice.one_in(2) {
        let eye_voxel = Some(dims.map(|side| dice.real(-6.0, side as f64 + 6.0)));
        scene.view.perspective = Some(Perspective { field_of_view_deg: 80.0, eye_voxel, distance_voxel: None });
        scene.image = Image { width_px: 9, height_px: 9, ..scene.image };
    }
    let setups = picture_setup(&scene, &machine, &volume, true).unwrap().setups;
    (scene, setups)
}

/// A ray in reals: its place at depth 0 of its samples, and its step; canonical voxels.
fn line(setup: &FrameSetup, ray: DiscreteRay) -> [[f64; 3]; 2] {
    let geometry = &setup.geometry;
    let step = match &geometry.perspective {
        None => [geometry.real_slopes()[0], geometry.real_slopes()[1], 1.0],
        Some(pass) => {
            let [row, column] = geometry.slot_of(ray);
            let real = |slope: i64| slope as f64 / f64::from(1_u32 << SLOPE_FRACTION_BITS);
            [real(pass.u.slopes[column]), real(pass.v.slopes[row]), 1.0]
        }
    };
    let k = geometry.size[2] - 1;
    let at = geometry.sample_position(ray, k);
    [[0, 1, 2].map(|i| at[i] - k as f64 * step[i]), step]
}

/// What bounds a ray, from the scene: a value at depth 0 of its samples and the change from one to the next; inside it is not negative.
fn bounds(scene: &Scene, setup: &FrameSetup, ray: DiscreteRay) -> Vec<[f64; 2]> {
    let geometry = &setup.geometry;
    let [start, step] = line(setup, ray);
    let mut bounds = Vec::new();
    for axis in 0..3 {
        bounds.push([start[axis], step[axis]]);
        bounds.push([(geometry.size[axis] - 1) as f64 - start[axis], -step[axis]]);
    }
    if let Some(pass) = &geometry.perspective
        && pass.first_depth > 0
    {
        let eye = pass.first_depth as f64 - pass.spacing[0] as f64 / pass.spacing[1] as f64;
        bounds.push([start[2] - eye, 1.0]);
    }
    let voxel = |depth: f64| geometry.axes.voxel_position(geometry.size, [0, 1, 2].map(|i| start[i] + depth * step[i]));
    let [from, to] = [voxel(0.0), voxel(1.0)];
    let mut add = |value: &dyn Fn([f64; 3]) -> f64| bounds.push([value(from), value(to) - value(from)]);
    for cut in &scene.cuts {
        let largest = cut.normal.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        add(&|p| -(0..3).map(|i| cut.normal[i] / largest * (p[i] - cut.through_voxel[i])).sum::<f64>());
    }
    if let Some(crop) = &scene.crop {
        for axis in 0..3 {
            add(&|p| p[axis] - crop.min_voxel[axis]);
            add(&|p| crop.max_voxel[axis] - p[axis]);
        }
    }
    bounds
}

/// How far a ray goes on beyond a sample, by its bounds: steps, none where the sample is outside; and how much the registers' rounding
/// of places may change that.
fn beyond(bounds: &[[f64; 2]], k: usize, forwards: bool, rounding: f64) -> (f64, f64) {
    let sign = if forwards { -1.0 } else { 1.0 };
    let mut least = (f64::from(EndRegisters::MOST_REACH), 0.0_f64);
    for [start, step] in bounds {
        let (distance, step) = ((start + k as f64 * step).max(0.0), sign * step);
        let slack = rounding / step.abs().max(1e-12);
        if step > 0.0 && distance / step - slack < 2.0 {
            least = (least.0.min(distance / step), least.1.max(slack));
        }
    }
    least
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(1500) })]

    /// The parts that a ray's samples stand for, before they are rounded to classes and after, against the length between the depths at
    /// which it enters and leaves, which comes from the scene in reals. Samples that rounded weights leave out between the first and the
    /// last have no part.
    #[test]
    fn the_parts_of_a_rays_samples_are_its_length(seed: u64) {
        let (scene, setups) = frames(&mut Dice::new(seed));
        for setup in &setups {
            let ends = setup.ends.as_ref().unwrap();
            let rounding = if setup.rays.is_some() { 1e-4 } else { 1e-8 };
            let first = setup.geometry.first_ray();
            let [width, height] = setup.geometry.base_plane_size();
            for i in 0..(width * height) as i64 {
                let ray = DiscreteRay { u: first.u + i % width as i64, v: first.v + i / width as i64 };
                let there: Vec<usize> =
                    (0..setup.geometry.size[2]).filter(|&k| in_place(ray, k as i64, setup)).collect();
                let (Some(&from), Some(&to)) = (there.first(), there.last()) else {
                    prop_assert_eq!(ray_ends(ray, 0..setup.geometry.size[2], setup).count(), 0);
                    continue;
                };
                let at = |k: usize| [ray.u, ray.v, k as i64];
                let bounds = bounds(&scene, setup, ray);
                let [(before, slack), (behind, other)] =
                    [beyond(&bounds, from, false, rounding), beyond(&bounds, to, true, rounding)];
                let length = (there.len() - 1) as f64 + before + behind;
                let parts = [(from, true), (to, false)].map(|(k, eye)| f64::from(reach(at(k), eye, setup, ends)) / ONE);
                let sum = (there.len() - 1) as f64 + parts[0] + parts[1];
                let slack = slack + other + 1.01 / ONE;
                prop_assert!((sum - length).abs() <= slack, "{:?}: {} {} {:?}", ray, sum, length, [slack, other]);

                let whole = class_of([false; 2], at(from), setup);
                let unit = f64::from(1_u32 << EndRegisters::STEP_BITS) / f64::from(ends.steps[whole as usize]);
                let part = |k: usize| match opacity_class(at(k), setup) {
                    class if class < ends.first_class => {
                        assert_eq!(class, whole);
                        1.0
                    }
                    class => f64::from(class - ends.first_class) / PARTS * unit,
                };
                let rounded: f64 = there.iter().map(|&k| part(k)).sum();
                prop_assert!((rounded - length).abs() <= slack + unit / PARTS + 4.0 * unit / ONE, "{:?}: {} {}", ray, rounded, length);
                for &k in &there {
                    let is_end = [k == from, k == to];
                    prop_assert_eq!(opacity_class(at(k), setup), class_of(is_end, at(k), setup), "{:?} {}", ray, k);
                }
                let found: Vec<(usize, u32)> =
                    ray_ends(ray, 0..setup.geometry.size[2], setup).map(|end| (end.lane, end.class)).collect();
                let mut expected = vec![(from, opacity_class(at(from), setup)), (to, opacity_class(at(to), setup))];
                expected.dedup();
                prop_assert_eq!(found, expected);
            }
        }
    }

    /// A parallel ray enters and leaves within two steps of its first and last sample: no length is lost at the faces of the volume.
    #[test]
    fn a_parallel_ray_is_never_longer_than_its_samples_reach(seed: u64) {
        let mut dice = Dice::new(seed);
        let dims = [0; 3].map(|_| dice.within(2, 9) as usize);
        let scene = Scene { view: View::from_direction(direction(&mut dice), None), ..Scene::default() };
        let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
        let setup = frame_setup(&scene, &machine(&mut dice), &volume, true).unwrap().setup;
        let first = setup.geometry.first_ray();
        let [width, height] = setup.geometry.base_plane_size();
        for i in 0..(width * height) as i64 {
            let ray = DiscreteRay { u: first.u + i % width as i64, v: first.v + i / width as i64 };
            let there: Vec<usize> = (0..dims.into_iter().max().unwrap()).filter(|&k| in_place(ray, k as i64, &setup)).collect();
            let (Some(&from), Some(&to)) = (there.first(), there.last()) else { continue };
            let bounds = bounds(&scene, &setup, ray);
            for (k, towards) in [(from as f64 - 2.0 - 1e-6, 1.0), (to as f64 + 2.0 + 1e-6, -1.0)] {
                let outside = bounds.iter().any(|[start, step]| towards * step > 0.0 && start + k * step < 0.0);
                prop_assert!(outside, "{:?} at {}", ray, k);
            }
        }
    }
}

/// Along an axis n voxels are n − 1 steps at every offset, and not a part less when parts are rounded.
#[test]
fn along_an_axis_the_rounded_parts_are_the_steps_between_the_faces() {
    let volume = VolumeInfo { dims: [3, 3, 33], spacing: [1.0; 3], window: [0.0, 255.0] };
    let scene = Scene { view: View::from_direction([0.0, 0.0, 1.0], None), ..Scene::default() };
    for offset in 0..256 {
        let rays = Rays { offset: f64::from(offset) / 256.0, ends: RayEnds::Exact, ..Rays::default() };
        let machine = MachineSpec { rays, ..MachineSpec::default() };
        let setup = frame_setup(&scene, &machine, &volume, true).unwrap().setup;
        assert_eq!(setup.geometry.offset, offset);
        let classes: Vec<u32> = (0..33)
            .filter(|&k| in_place(DiscreteRay { u: 1, v: 1 }, k, &setup))
            .map(|k| opacity_class([1, 1, k], &setup))
            .collect();
        let parts: Vec<u32> = classes.iter().map(|&class| if class == 0 { 32 } else { class - 1 }).collect();
        assert_eq!(parts.iter().sum::<u32>(), 32 * 32, "{offset}: {parts:?}");
        assert_eq!(parts.len(), if offset == 0 { 33 } else { 32 });
        let exact = (f64::from(offset) / 256.0 + 0.5) * 32.0;
        assert!((f64::from(parts[0]) - exact).abs() <= 0.5, "{offset}: {parts:?}");
        assert!(parts[1..parts.len() - 1].iter().all(|&part| part == 32));
    }
}

#[test]
fn a_distance_is_used_up_in_its_steps_to_the_nearest_part_and_two_at_most() {
    let one = 1_u32 << EndRegisters::REACH_BITS;
    assert_eq!([steps_to(-7, 10), steps_to(0, 10), steps_to(10, 10), steps_to(5, 10)], [0, 0, one, one / 2]);
    assert_eq!([steps_to(20, 10), steps_to(1 << 60, 10), steps_to(1, 0), steps_to(1, -3)], [2 * one; 4]);
    let third = f64::from(one) / 3.0;
    assert_eq!([steps_to(1, 3), steps_to(2, 3)], [third.round() as u32, (2.0 * third).round() as u32]);
    assert_eq!(steps_to((1 << 47) - 1, 1 << 46), 2 * one);
}

/// The nearest table; half way, the last sample of a ray takes the lower one. Shorter steps have their part of the longest.
#[test]
fn an_end_takes_the_nearest_table() {
    let ends = |steps: Vec<u32>| {
        let face = cube3_frame::HalfSpace { distance: cube3_frame::Linear { u: 0, v: 0, k: 0, constant: 0 } };
        EndRegisters { faces: [face; 6], first_class: steps.len() as u32, steps }
    };
    let one = 1 << EndRegisters::REACH_BITS;
    let [parallel, eye] = [ends(vec![4096]), ends(vec![2048, 4096])];
    let part = one / 32;
    assert_eq!([0, 1, 32, 128].map(|parts| end_class(parts * part, false, 0, &parallel)), [1, 2, 33, 129]);
    assert_eq!([false, true].map(|last| end_class(3 * part / 2, last, 0, &parallel)), [3, 2]);
    assert_eq!([false, true].map(|last| end_class(3 * part / 2 + 1, last, 0, &parallel)), [3, 3]);
    assert_eq!([0, 1].map(|class| end_class(one, false, class, &eye)), [2 + 16, 2 + 32]);
}
