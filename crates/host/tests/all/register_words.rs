//! Words of single registers and tables, each against what it stands for: windows that do not begin at 0, faces, factors, weights, intensities.

use cube3_cases::cases;
use cube3_frame::{DiscreteRay, FrameSetup, Geometry, HalfSpace, Linear, LinearFactor, Shading};
use cube3_host::{Basis, OpacityEntries, VolumeInfo, frame_setup, picture_setup, whole_step_opacity};
use cube3_machine::{GradientMethod, MachineSpec, RayEnds};
use cube3_scene::{Crop, Cut, DepthCue, Layer, Light, Mode, Perspective, Scene, Threshold, View};
use cube3_word::{Words, unit_full, unit_resize};
use glam::DVec3;
use proptest::prelude::*;
use std::sync::Arc;

/// A window of data values of which neither end is 0.
const WINDOW: [f64; 2] = [-1000.0, 3095.0];

fn volume(dims: [usize; 3], spacing: [f64; 3]) -> VolumeInfo {
    VolumeInfo { dims, spacing, window: WINDOW }
}

/// A parallel frame, without (`leaves_out` false) or with the plan.
fn setup(scene: &Scene, machine: &MachineSpec, volume: &VolumeInfo, leaves_out: bool) -> FrameSetup {
    machine.check("machine").unwrap();
    frame_setup(scene, machine, volume, leaves_out).unwrap().setup
}

fn along(direction: [f64; 3]) -> Scene {
    Scene { view: View::from_direction(direction, None), ..Scene::default() }
}

/// A view along z from an eye in voxels.
fn from_eye(eye: [f64; 3]) -> Scene {
    let perspective = Perspective { eye_voxel: Some(eye), ..Perspective::new(40.0) };
    Scene {
        view: View { perspective: Some(perspective), ..View::from_direction([0.0, 0.0, 1.0], None) },
        ..Scene::default()
    }
}

/// The setup of the pass along z.
fn along_z(scene: &Scene, machine: &MachineSpec, volume: &VolumeInfo) -> Arc<FrameSetup> {
    machine.check("machine").unwrap();
    let setups = picture_setup(scene, machine, volume, true).unwrap().setups;
    setups.into_iter().find(|setup| setup.geometry.axes.axis[2] == 2).unwrap()
}

/// The half-spaces of a view along z: normal in x, y, z, and constant, in voxels.
fn half_spaces(setup: &FrameSetup) -> Vec<[f64; 4]> {
    let one = (1_u64 << HalfSpace::FRACTION_BITS) as f64;
    let axis = setup.geometry.axes.axis;
    let voxels = |half: &HalfSpace| {
        let Linear { u, v, k, constant } = half.distance;
        let mut voxels = [0, 0, 0, constant];
        for (axis, x) in axis.into_iter().zip([u, v, k]) {
            voxels[axis] = x;
        }
        voxels.map(|x| x as f64 / one)
    };
    setup.clips.iter().map(voxels).collect()
}

/// What a sample on a face is moved by where it stands for a whole step.
const ON_FACE: f64 = 1.0 / 65536.0;

fn crop() -> Crop {
    Crop { min_voxel: [1.0, 2.0, 3.0], max_voxel: [4.0, 5.0, 6.0] }
}

#[test]
fn half_spaces_of_a_crop_box_are_the_least_and_the_most_of_each_axis() {
    let scene = Scene { crop: Some(crop()), mode: Mode::Maximum, ..along([0.0, 0.0, 1.0]) };
    let setup = setup(&scene, &MachineSpec::default(), &volume([8; 3], [1.0; 3]), true);
    let expected = [
        [1.0, 0.0, 0.0, -1.0],
        [-1.0, 0.0, 0.0, 4.0],
        [0.0, 1.0, 0.0, -2.0],
        [0.0, -1.0, 0.0, 5.0],
        [0.0, 0.0, 1.0, -3.0],
        [0.0, 0.0, -1.0, 6.0],
    ];
    assert_eq!(half_spaces(&setup), expected);
}

/// All rays of an eye enter a face across them, or leave it; another face is entered by some and left by others, and has no rule.
#[test]
fn faces_across_the_rays_of_an_eye_have_the_rule_of_whole_steps() {
    for (mode, on_face) in [(Mode::Composite, ON_FACE), (Mode::Maximum, 0.0)] {
        let scene = Scene { crop: Some(crop()), mode, ..from_eye([3.5, 3.5, -20.0]) };
        let setup = along_z(&scene, &MachineSpec::default(), &volume([8; 3], [1.0; 3]));
        let constants: Vec<f64> = half_spaces(&setup).iter().map(|half| half[3]).collect();
        assert_eq!(constants, [-1.0, 4.0, -2.0, 5.0, -3.0 + on_face, 6.0 - on_face], "{mode:?}");
    }
}

/// The register holds the normal over its largest component, and keeps what the normal does not point at.
#[test]
fn the_normal_of_a_cut_may_have_any_length() {
    let cut = Cut { normal: [0.5, -1.0, 4.0], through_voxel: [2.0, 3.0, 4.0] };
    let scene = Scene { cuts: vec![cut], mode: Mode::Maximum, ..along([0.0, 0.0, 1.0]) };
    let setup = setup(&scene, &MachineSpec::default(), &volume([8; 3], [1.0; 3]), true);
    assert_eq!(half_spaces(&setup), [[-0.125, 0.25, -1.0, 0.25 - 0.75 + 4.0]]);
}

#[test]
fn a_cue_that_nothing_asks_for_is_a_factor_of_one() {
    let cue = setup(&along([0.3, 0.2, 1.0]), &MachineSpec::default(), &volume([4; 3], [1.0; 3]), false).depth_cue;
    assert_eq!(cue.unwrap().factor, Linear { u: 0, v: 0, k: 0, constant: 1 << LinearFactor::FRACTION_BITS });
}

/// A single voxel has no depth: it is at the front.
#[test]
fn the_cue_of_a_single_voxel_is_the_front() {
    let scene = Scene { depth_cue: Some(DepthCue { front: 0.75, back: 0.25 }), ..along([0.3, 0.2, 1.0]) };
    let cue = setup(&scene, &MachineSpec::default(), &volume([1; 3], [1.0; 3]), true).depth_cue.unwrap().factor;
    assert_eq!(cue, Linear { u: 0, v: 0, k: 0, constant: 3 << (LinearFactor::FRACTION_BITS - 2) });
}

/// A vector is the sum of its components times the frame's vectors.
#[test]
fn a_world_vector_is_the_sum_of_its_components() {
    for direction in [[0.4, 0.3, 1.0], [-1.0, 0.2, -0.6]] {
        let volume = volume([5; 3], [1.0, 2.0, 1.5]);
        let setup = setup(&along(direction), &MachineSpec::default(), &volume, true);
        let axes = &setup.geometry.axes;
        for method in [GradientMethod::Six, GradientMethod::TenNormalised] {
            let basis = Basis::new(&setup.geometry, volume.spacing, method);
            let parts = [2.0, -3.0, 5.0];
            let sum: DVec3 = basis.vectors.iter().zip(parts).map(|(&vector, x)| axes.to_world(vector) * x).sum();
            assert!((basis.world(axes, parts) - sum).length() < 1e-12, "{method:?}");
            assert_eq!(basis.world(axes, [0.0, 1.0, 0.0]), axes.to_world(basis.vectors[1]));
            if method == GradientMethod::Six {
                let world = DVec3::new(1.0, 7.0, -2.0);
                assert_eq!(basis.world(axes, basis.components(axes, world)), world);
            }
        }
    }
}

/// Where all factors are 1 at every depth a gradient keeps no bits below its word; else as many as a factor has, or there is room for.
#[test]
fn bits_below_the_gradient_are_kept_where_a_factor_is_not_one() {
    let cube = [1.0; 3];
    let long = [1.0, 1.0, 2.0];
    let narrow = Words { voxel_bits: 8, gradient_bits: 9, table_bits: 8, ..Words::default() };
    let machine = |words| {
        let mut machine = MachineSpec { words, ..MachineSpec::default() };
        machine.abc.gradient = GradientMethod::Six;
        machine
    };
    // A difference of samples has a bit more than they, its sign: of 31 bits 14 and 22 are left.
    for (words, room) in [(Words::default(), 14), (narrow, 16)] {
        let machine = machine(words);
        let scale = |spacing, leaves_out| {
            let setup = setup(&along([0.0, 0.0, 1.0]), &machine, &volume([5; 3], spacing), leaves_out);
            setup.gradient.unwrap().scale.map(|scale| (scale.factors, scale.kept_bits))
        };
        assert_eq!(scale(cube, true), None);
        assert_eq!(scale(cube, false), Some(([1 << 16; 3], 0)));
        assert_eq!(scale(long, true), Some(([1 << 16, 1 << 16, 1 << 15], room)));
        let eye = along_z(&from_eye([2.0, 2.0, -20.0]), &machine, &volume([5; 3], cube));
        let scale = eye.gradient.unwrap().scale.unwrap();
        assert_eq!((scale.factors, scale.kept_bits), ([1 << 16; 3], room));
    }
}

fn entries(scene: &Scene, machine: &MachineSpec, volume: &VolumeInfo) -> (FrameSetup, OpacityEntries) {
    let setup = setup(scene, machine, volume, true);
    let entries = OpacityEntries::of(scene, machine, volume, &setup);
    (setup, entries)
}

/// With 12 bits over 4,096 values, word w is w − 1,000; with 2 fraction bits a sample is a quarter of that.
#[test]
fn entries_of_the_tables_are_data_values_of_the_window() {
    let words =
        Words { voxel_bits: 12, sample_fraction_bits: 2, gradient_bits: 14, table_bits: 10, ..Words::default() };
    let machine = MachineSpec { words, ..MachineSpec::default() };
    let volume = volume([5; 3], [1.0; 3]);
    let mut scene = along([0.0, 0.0, 1.0]);
    for (index, value) in entries(&scene, &machine, &volume).1.values.into_iter().enumerate() {
        // The mean of the 16 samples that share the entry.
        let mean = (0..16).map(|low| f64::from(16 * index as u32 + low) / 4.0 - 1000.0).sum::<f64>() / 16.0;
        assert!((value - mean).abs() < 1e-9, "entry {index}: {value} for {mean}");
    }
    scene.volume.labels = true;
    for (index, value) in entries(&scene, &machine, &volume).1.values.into_iter().enumerate() {
        assert_eq!(value, 4.0 * index as f64 - 1000.0);
    }
}

/// A row stands for the mean of the magnitudes that share it: half-differences over the shortest spacing, in data values.
#[test]
fn rows_are_means_of_the_magnitudes_that_share_them() {
    let layer = |gradient| Layer { gradient, opacity: vec![[-1000.0, 0.0], [3095.0, 0.5]] };
    for (spacing, largest, gradient_bits, sample_fraction_bits) in
        [([1.0; 3], 900.0, 13, 0), ([1.0; 3], 900.0, 11, 0), ([2.0, 1.0, 3.0], 700.0, 14, 2), ([0.5; 3], 20.0, 13, 0)]
    {
        let words =
            Words { voxel_bits: 12, sample_fraction_bits, gradient_bits, table_gradient_bits: 4, ..Words::default() };
        let mut machine = MachineSpec { words, ..MachineSpec::default() };
        machine.abc.gradient = GradientMethod::Six;
        let mut scene = along([0.0, 0.0, 1.0]);
        scene.transfer.layers = vec![layer(0.0), layer(largest)];
        let (setup, entries) = entries(&scene, &machine, &volume([5; 3], spacing));
        let kept = setup.gradient.unwrap().scale.map_or(0, |scale| scale.kept_bits);
        let dropped = 12 + sample_fraction_bits + 1 - gradient_bits;
        let rows = setup.classification.gradient_rows.unwrap();
        assert!(largest < 100.0 || rows.shift > 0);
        // A word is so many of the differences between the samples on both sides, which are two spacings apart.
        let gradient = |word: u32| f64::from(word << dropped) / f64::from(1_u32 << (kept + sample_fraction_bits)) / 2.0;
        for (row, magnitude) in entries.magnitudes.into_iter().enumerate() {
            let first = (row as u32) << rows.shift;
            let mean = (gradient(first) + gradient(first + (1 << rows.shift) - 1)) / 2.0;
            assert!((magnitude - mean).abs() < 1e-9, "row {row}: {magnitude} for {mean}");
        }
    }
    let flat = entries(&along([0.0, 0.0, 1.0]), &MachineSpec::default(), &volume([5; 3], [1.0; 3])).1;
    assert_eq!(flat.magnitudes, [0.0]);
}

#[test]
fn a_threshold_is_in_data_values_of_the_window() {
    let words = Words { voxel_bits: 12, sample_fraction_bits: 1, gradient_bits: 14, ..Words::default() };
    let machine = MachineSpec { words, ..MachineSpec::default() };
    let last = (1 << 13) - 1;
    for (low, high, expected) in [
        (Some(-900.0), Some(2000.25), [200, 6000]),
        (Some(-0.25), None, [2000, last]),
        (Some(-5000.0), Some(9000.0), [0, last]),
        (None, Some(-5000.0), [0, 0]),
    ] {
        let scene = Scene { threshold: Some(Threshold { low, high }), ..along([0.0, 0.0, 1.0]) };
        let setup = setup(&scene, &machine, &volume([4; 3], [1.0; 3]), true);
        assert_eq!(setup.classification.threshold, expected);
    }
}

proptest! {
    #![proptest_config(cases(64))]

    /// The largest weight with which all steps from the front face to the back one, at opacity 1, do not weigh more than 1.
    #[test]
    fn whole_steps_of_opacity_one_add_up_to_one(depth in 1_usize..40, opacity_bits in 1_u32..=16, wider in 0_u32..=16, labels: bool) {
        let words = Words { opacity_bits, accumulator_bits: (opacity_bits + wider).min(32), ..Words::default() };
        let mut machine = MachineSpec { words, ..MachineSpec::default() };
        machine.rays.ends = RayEnds::Exact;
        let mut scene = Scene { mode: Mode::WeightedSum, ..along([0.0, 0.0, 1.0]) };
        scene.volume.labels = labels;
        let weight = u128::from(setup(&scene, &machine, &volume([3, 3, depth], [1.0; 3]), true).cone.sum_weight);
        // Between n voxel centres are n − 1 steps; n boxes are n steps deep.
        let planes = depth + usize::from(labels);
        let steps = (planes - 1).max(1) as u128;
        let word = whole_step_opacity(Mode::WeightedSum, &words, planes);
        let step = u128::from(unit_resize(word, words.opacity_bits, words.accumulator_bits));
        let full = u128::from(unit_full(words.accumulator_bits));
        let one = 1_u128 << 32;
        prop_assert!(weight <= one && weight * step * steps <= one * full);
        prop_assert!(weight == one || (weight + 1) * step * steps > one * full);
    }

    /// Each face's register is the distance of a sample to it: of voxel centres, or of voxels as boxes; before an eye that is in the volume
    /// nothing begins.
    #[test]
    fn faces_of_the_volume_are_where_rays_begin_and_end(
        dims in [2_usize..6, 2_usize..6, 2_usize..6], labels: bool, eye in prop::option::of(-9.0..3.0_f64), back: bool,
    ) {
        // Against an axis the eye is as far before the other face.
        let [ahead, eye] = [if back { -1.0 } else { 1.0 }, eye.map_or(f64::NAN, |eye| if back { (dims[2] - 1) as f64 - eye } else { eye })];
        let perspective = Perspective { eye_voxel: Some([1.2, 0.9, eye]), ..Perspective::new(40.0) };
        let perspective = eye.is_finite().then_some(perspective);
        let mut scene = Scene { view: View { perspective, ..View::from_direction([0.1, 0.05, ahead], None) }, ..Scene::default() };
        scene.volume.labels = labels;
        let mut machine = MachineSpec::default();
        machine.rays.ends = RayEnds::Exact;
        let margin = if labels { 0.5 } else { 0.0 };
        let setups = picture_setup(&scene, &machine, &volume(dims, [1.0; 3]), true).unwrap().setups;
        for setup in setups.iter().filter(|setup| setup.geometry.axes.axis[2] == 2) {
            let (geometry, faces) = (&setup.geometry, setup.ends.as_ref().unwrap().faces);
            let one = (1_u64 << HalfSpace::FRACTION_BITS) as f64;
            for (at, position) in samples(geometry) {
                for (face, half) in faces.iter().enumerate() {
                    let (axis, last) = (face / 2, (geometry.size[face / 2] - 1) as f64);
                    let mut front = -margin;
                    if axis == 2 && eye.is_finite() {
                        let eye = if geometry.axes.reversed[2] { last - eye } else { eye };
                        front = if eye < -margin { -margin } else { eye };
                    }
                    let expected = if face % 2 == 1 { last + margin - position[axis] } else { position[axis] - front };
                    let distance = geometry.evaluate(&half.distance, at) as f64 / one;
                    // Places in perspective are rounded to 16 bits.
                    prop_assert!((distance - expected).abs() < 1e-4, "face {} at {:?}: {} for {}", face, position, distance, expected);
                }
            }
        }
    }
}

/// Every sample of a frame, with its canonical place.
fn samples(geometry: &Geometry) -> Vec<([i64; 3], [f64; 3])> {
    let (first, [width, height]) = (geometry.first_ray(), geometry.base_plane_size());
    let columns = first.u..first.u + width as i64;
    let rays = (first.v..first.v + height as i64).flat_map(|v| columns.clone().map(move |u| DiscreteRay { u, v }));
    rays.flat_map(|ray| (0..geometry.size[2]).map(move |k| (ray, k)))
        .filter(|&(ray, k)| geometry.has_sample(ray, k as i64))
        .map(|(ray, k)| ([ray.u, ray.v, k as i64], geometry.sample_position(ray, k)))
        .collect()
}

/// Ambient and diffuse are fractions of the colour bits, what is mirrored is added on the scale of a colour word.
#[test]
fn intensities_of_the_material_are_words() {
    let mut scene = along([0.0, 0.0, 1.0]);
    scene.lights = vec![Light { direction: Some([0.0, 0.0, -1.0]), colour: [1.0, 0.5, 0.25] }];
    (scene.material.ambient, scene.material.diffuse, scene.material.specular) = (0.5, 0.7, 0.3);
    let words = Words { colour_bits: 8, ..Words::default() };
    let setup = setup(&scene, &MachineSpec { words, ..MachineSpec::default() }, &volume([4; 3], [1.0; 3]), true);
    let Some(Shading::Phong(phong)) = setup.shading else { panic!("lit by Phong") };
    assert_eq!(phong.ambient, 128);
    // 0.7, 0.35 and 0.175 of 256; 0.3, 0.15 and 0.075 of 255.
    assert_eq!(phong.lights[0].diffuse, [179, 90, 45]);
    assert_eq!(phong.lights[0].specular, [77, 38, 19]);
}
