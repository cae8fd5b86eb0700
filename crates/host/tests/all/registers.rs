//! Registers and tables of a frame against what the scene says, each computed here again from positions, vectors and data values.

use cube3_cases::cases;
use cube3_frame::{DiscreteRay, FrameSetup, Geometry, HalfSpace, LinearFactor, PLACE_BITS, RayRegisters, Shading};
use cube3_host::{Basis, VolumeInfo, frame_setup, picture_setup};
use cube3_machine::{GradientMethod, MachineSpec, RayEnds, Rays, TemplateRule};
use cube3_scene::{Crop, Cut, DepthCue, Layer, Light, Mode, Perspective, Scene, Threshold, View};
use cube3_word::Words;
use glam::DVec3;
use proptest::prelude::*;
use std::sync::Arc;

fn volume(dims: [usize; 3], spacing: [f64; 3]) -> VolumeInfo {
    VolumeInfo { dims, spacing, window: [0.0, 255.0] }
}

fn machine(rule: TemplateRule) -> MachineSpec {
    let rays = Rays { template: rule, ..Rays::default() };
    MachineSpec { rays, words: Words { weight_bits: 12, ..Words::default() }, ..MachineSpec::default() }
}

/// Every sample of a frame, with its place in voxels x, y, z.
fn samples(geometry: &Geometry) -> Vec<([i64; 3], [f64; 3])> {
    let (first, [width, height]) = (geometry.first_ray(), geometry.base_plane_size());
    let mut all = Vec::new();
    for v in first.v..first.v + height as i64 {
        for u in first.u..first.u + width as i64 {
            for k in 0..geometry.size[2] {
                let ray = DiscreteRay { u, v };
                if geometry.has_sample(ray, k as i64) {
                    let at = geometry.axes.voxel_position(geometry.size, geometry.sample_position(ray, k));
                    all.push(([u, v, k as i64], at));
                }
            }
        }
    }
    all
}

fn kept(setup: &FrameSetup, clip: &HalfSpace, at: [i64; 3]) -> bool {
    setup.geometry.evaluate(&clip.distance, at) >= 0
}

fn directions() -> impl Strategy<Value = [f64; 3]> {
    let part = || prop_oneof![4 => -1.0..1.0_f64, 1 => (-1_i32..=1).prop_map(f64::from)];
    [part(), part(), part()].prop_filter("a direction", |d| d.iter().map(|x| x.abs()).sum::<f64>() > 0.1)
}

fn views() -> impl Strategy<Value = View> {
    (directions(), prop::option::weighted(0.5, [-3.0..8.0_f64, -3.0..8.0_f64, -3.0..8.0_f64])).prop_map(
        |(direction, eye_voxel)| {
            // So wide that some pictures need passes along several axes.
            let perspective = eye_voxel.map(|eye| Perspective { eye_voxel: Some(eye), ..Perspective::new(110.0) });
            View { perspective, ..View::from_direction(direction, None) }
        },
    )
}

fn spacings() -> impl Strategy<Value = [f64; 3]> {
    [0.3..3.0_f64, 0.3..3.0_f64, 0.3..3.0_f64]
}

fn sizes() -> impl Strategy<Value = [usize; 3]> {
    [1_usize..6, 1_usize..6, 1_usize..6]
}

/// The setup of a parallel frame, on a machine that a file could describe.
fn parallel(scene: &Scene, machine: &MachineSpec, volume: &VolumeInfo) -> FrameSetup {
    machine.check("machine").unwrap();
    frame_setup(scene, machine, volume, true).unwrap().setup
}

fn setups(scene: &Scene, machine: &MachineSpec, volume: &VolumeInfo) -> Vec<Arc<FrameSetup>> {
    machine.check("machine").unwrap();
    picture_setup(scene, machine, volume, true).unwrap().setups
}

/// Nearer to a face, in voxels, rounding and the rule of whole steps decide.
const NEAR: f64 = 1e-3;

proptest! {
    #![proptest_config(cases(48))]

    /// A cut removes what its normal points at.
    #[test]
    fn a_cut_keeps_what_is_behind_its_plane(
        view in views(), dims in sizes(), spacing in spacings(), normal in directions(), through in [0.0..5.0_f64, 0.0..5.0_f64, 0.0..5.0_f64],
        plane: bool, maximum: bool,
    ) {
        let cut = Cut { normal, through_voxel: through };
        let mode = if maximum { Mode::Maximum } else { Mode::Composite };
        let scene = Scene { view, cuts: vec![cut.clone()], mode, ..Scene::default() };
        let rule = if plane { TemplateRule::PlaneFloor } else { TemplateRule::SampleFloor };
        let largest = normal.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        for setup in setups(&scene, &machine(rule), &volume(dims, spacing)) {
            prop_assert_eq!(setup.clips.len(), 1);
            for (at, position) in samples(&setup.geometry) {
                let beyond: f64 = (0..3).map(|i| normal[i] / largest * (position[i] - through[i])).sum();
                if beyond.abs() > NEAR {
                    prop_assert_eq!(kept(&setup, &setup.clips[0], at), !cut.removes(position), "{:?}", position);
                }
            }
        }
    }

    /// A crop box keeps what is within it, along each axis from the least to the most.
    #[test]
    fn a_crop_box_keeps_what_is_in_it(
        view in views(), dims in sizes(), spacing in spacings(), corners in [[0.0..5.0_f64, 0.0..5.0_f64], [0.0..5.0_f64, 0.0..5.0_f64], [0.0..5.0_f64, 0.0..5.0_f64]],
    ) {
        let least = corners.map(|[a, b]| a.min(b));
        let most = corners.map(|[a, b]| a.max(b));
        let crop = Crop { min_voxel: least, max_voxel: most };
        let scene = Scene { view, crop: Some(crop.clone()), ..Scene::default() };
        for setup in setups(&scene, &machine(TemplateRule::PlaneFloor), &volume(dims, spacing)) {
            prop_assert_eq!(setup.clips.len(), 6);
            for (at, position) in samples(&setup.geometry) {
                let far = (0..3).all(|i| (position[i] - least[i]).abs() > NEAR && (position[i] - most[i]).abs() > NEAR);
                if far {
                    let inside = setup.clips.iter().all(|clip| kept(&setup, clip, at));
                    prop_assert_eq!(inside, !crop.removes(position), "{:?}", position);
                }
            }
        }
    }

    /// The cue goes from the nearest corner to the farthest, linear in the distance along the view, in the lengths of the spacing.
    #[test]
    fn the_cue_is_linear_in_depth_along_the_view(
        view in views(), dims in [2_usize..6, 2_usize..6, 2_usize..6], spacing in spacings(), front in 0.0..=1.0_f64, back in 0.0..=1.0_f64,
    ) {
        let scene = Scene { view, depth_cue: Some(DepthCue { front, back }), ..Scene::default() };
        let direction = scene.view.frame().unwrap().direction;
        let depth = |voxel: [f64; 3]| (0..3).map(|i| direction[i] * voxel[i] * spacing[i]).sum::<f64>();
        let corner = |c: usize| depth([0, 1, 2].map(|i| if c >> i & 1 == 1 { (dims[i] - 1) as f64 } else { 0.0 }));
        let [near, far] = [f64::min, f64::max].map(|pick| (0..8).map(corner).fold(corner(0), pick));
        for setup in setups(&scene, &machine(TemplateRule::PlaneFloor), &volume(dims, spacing)) {
            let cue = setup.depth_cue.unwrap();
            for (at, position) in samples(&setup.geometry) {
                let value = setup.geometry.evaluate(&cue.factor, at) as f64 / f64::from(1_u32 << LinearFactor::FRACTION_BITS);
                let expected = front + (back - front) * (depth(position) - near) / (far - near);
                // Places in perspective are rounded to their bits.
                let slack = 3e-7 + 40.0 / f64::from(1_u32 << PLACE_BITS);
                let slack = if setup.geometry.perspective.is_some() { slack } else { 3e-7 };
                prop_assert!((value - expected).abs() < slack, "{} for {}", value, expected);
            }
        }
    }

    /// Of all sample words those are shown whose value is within the threshold, both ends included.
    #[test]
    fn a_threshold_shows_the_words_within_it(low in prop::option::of(0_u32..=2050), high in prop::option::of(0_u32..=2050)) {
        let words = Words { voxel_bits: 8, sample_fraction_bits: 2, gradient_bits: 10, table_bits: 10, ..Words::default() };
        let machine = MachineSpec { words, ..MachineSpec::default() };
        // Sample word w is the value w/4; bounds are on eighths.
        let bound = |x: Option<u32>| x.map(|x| f64::from(x) / 8.0);
        let threshold = Threshold { low: bound(low), high: bound(high) };
        let scene = Scene { threshold: Some(threshold.clone()), ..Scene::default() };
        let setup = parallel(&scene, &machine, &volume([4; 3], [1.0; 3]));
        let [from, to] = setup.classification.threshold;
        for word in 0..=255_u32 * 4 {
            let shown = (from..=to).contains(&word);
            prop_assert_eq!(shown, !threshold.removes(f64::from(word) / 4.0), "word {}", word);
        }
    }

    /// The last row holds the largest gradient of the transfer function, and half of its width would not.
    #[test]
    fn rows_reach_to_the_largest_gradient(
        largest in 0.5..300.0_f64, row_bits in 1_u32..=6, spacing in spacings(), direction in directions(), cubes: bool,
    ) {
        let spacing = if cubes { [1.0; 3] } else { spacing };
        let words = Words { table_gradient_bits: row_bits, ..Words::default() };
        let machine = MachineSpec { words, ..MachineSpec::default() };
        let layer = |gradient| Layer { gradient, opacity: vec![[0.0, 0.0], [255.0, 0.5]] };
        let mut scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
        scene.transfer.layers = vec![layer(0.0), layer(largest)];
        let setup = parallel(&scene, &machine, &volume([5; 3], spacing));
        let rows = setup.classification.gradient_rows.unwrap();
        prop_assert_eq!(rows.rows, 1 << row_bits);
        // The difference of two samples on both sides, along the axis of the shortest spacing, whose factor is 1.
        let kept = setup.gradient.unwrap().scale.map_or(0, |scale| scale.kept_bits);
        let full = f64::from((1_u32 << words.voxel_bits) - 1);
        let difference = 2.0 * largest / 255.0 * full * f64::from(1_u32 << words.sample_fraction_bits);
        let magnitude = difference * f64::from(1_u32 << kept) / f64::from(1_u32 << words.gradient_drop());
        let reach = |shift: u32| f64::from(rows.rows) * f64::from(1_u32 << shift);
        // A shift has 30 bits at most, which hold every difference that samples can have.
        prop_assert!(rows.shift == 30 || reach(rows.shift) >= magnitude * (1.0 - 1e-9));
        prop_assert!(rows.shift == 0 || reach(rows.shift - 1) < magnitude * (1.0 + 1e-9));
    }

    /// Estimator 10 takes its differences along the ray and along two vectors across it, from the feet of perpendiculars.
    #[test]
    fn side_vectors_of_ten_neighbours_are_across_the_ray(direction in directions(), spacing in spacings()) {
        let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
        let mut machine = machine(TemplateRule::PlaneFloor);
        machine.abc.gradient = GradientMethod::TenNormalised;
        let setup = parallel(&scene, &machine, &volume([5; 3], spacing));
        let geometry = &setup.geometry;
        let basis = Basis::new(geometry, spacing, GradientMethod::TenNormalised);
        let world = DVec3::from(direction).normalize();
        let ray = geometry.axes.to_world(basis.vectors[2]);
        // Slopes are registers of 30 bits.
        prop_assert!((ray - world).length() < 1e-8, "{} for {}", ray, world);
        let s = geometry.axes.permute(spacing);
        let steepest = geometry.real_slopes();
        let step = DVec3::new(s[0] * steepest[0], s[1] * steepest[1], s[2]);
        prop_assert!((basis.lengths[2] / step.length() - 1.0).abs() < 1e-12);
        for axis in 0..2 {
            let mut to_ray = DVec3::ZERO;
            to_ray[axis] = s[axis];
            let foot = to_ray.dot(step) / step.length_squared();
            let weight = f64::from(setup.gradient.unwrap().weights[axis]) / 4096.0;
            prop_assert!((weight - foot.min(1.0)).abs() <= 0.5 / 4096.0 + 1e-12);
            let side = to_ray - step * foot.min(1.0);
            prop_assert!((basis.lengths[axis] / side.length() - 1.0).abs() < 1e-9);
            if foot <= 1.0 {
                prop_assert!(DVec3::from(basis.vectors[axis]).dot(step).abs() < 1e-9 * step.length());
            }
        }
        // The factors make differences relative to the shortest of the lengths.
        let shortest = basis.lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let factors = setup.gradient.unwrap().scale.map_or([1 << 16; 3], |scale| scale.factors);
        for (factor, length) in factors.into_iter().zip(basis.lengths) {
            prop_assert!((f64::from(factor) / 65536.0 - shortest / length).abs() <= 0.5 / 65536.0 + 1e-12);
        }
    }

    /// Each entry of the opacity table is that of its value, over the length of a step in units of the smallest spacing.
    #[test]
    fn opacity_is_that_of_the_value_over_a_step(direction in directions(), spacing in spacings(), alpha in 0.0..=1.0_f64, corrects: bool) {
        let mut scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
        scene.transfer.opacity = vec![[0.0, 0.0], [255.0, alpha]];
        scene.transfer.opacity_correction = corrects;
        let words =
            Words { voxel_bits: 8, sample_fraction_bits: 0, gradient_bits: 8, table_bits: 8, opacity_bits: 16, ..Words::default() };
        let machine = MachineSpec { words, ..MachineSpec::default() };
        let setup = parallel(&scene, &machine, &volume([5; 3], spacing));
        let along = DVec3::from(direction) / DVec3::from(spacing);
        let per_plane = DVec3::from(direction) / along.abs().max_element();
        let smallest = spacing.into_iter().fold(f64::INFINITY, f64::min);
        let length = if corrects { per_plane.length() / smallest } else { 1.0 };
        for (value, &word) in setup.classification.opacity.iter().enumerate() {
            let unit = alpha * value as f64 / 255.0;
            let expected = (1.0 - (1.0 - unit).powf(length)) * 65535.0;
            prop_assert!((f64::from(word) - expected).abs() <= 0.5 + 1e-3, "{} for {}", word, expected);
        }
    }

    /// A light's register points away from it: the surface's normal is against the gradient.
    #[test]
    fn lights_are_measured_against_the_gradient(direction in directions(), towards in directions()) {
        let mut scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
        scene.lights = vec![Light { direction: Some(towards), colour: [1.0; 3] }];
        let setup = parallel(&scene, &machine(TemplateRule::SampleFloor), &volume([5; 3], [1.0; 3]));
        let Some(Shading::Phong(phong)) = &setup.shading else { panic!("lit by Phong") };
        let one = f64::from(1_u32 << (setup.words.normal_bits - 1));
        let light = setup.geometry.axes.to_canonical(DVec3::from(towards).normalize());
        for (register, towards) in phong.lights[0].direction.into_iter().zip(light) {
            prop_assert!((f64::from(register) + towards * one).abs() <= 0.5 + 1e-6);
        }
    }

    /// In perspective: slopes to the nearest, at most 2; and how near the neighbours are.
    #[test]
    fn slopes_and_distances_of_an_eye(eye in [-9.0..15.0_f64, -9.0..15.0_f64, -9.0..15.0_f64], direction in directions()) {
        let perspective = Perspective { eye_voxel: Some(eye), ..Perspective::new(60.0) };
        let scene = Scene { view: View { perspective: Some(perspective), ..View::from_direction(direction, None) }, ..Scene::default() };
        for setup in setups(&scene, &machine(TemplateRule::PlaneFloor), &volume([6; 3], [1.0; 3])) {
            let (rays, pass) = (setup.rays.as_ref().unwrap(), setup.geometry.perspective.as_ref().unwrap());
            let one = f64::from(1_u32 << RayRegisters::SLOPE_BITS);
            for (slopes, sizes) in [(&pass.u.slopes, &rays.slope_u), (&pass.v.slopes, &rays.slope_v)] {
                for (&slope, &size) in slopes.iter().zip(sizes) {
                    let exact = (slope as f64 / f64::from(1_u32 << 30)).abs().min(2.0);
                    prop_assert!((f64::from(size) / one - exact).abs() <= 0.5 / one + 1e-9);
                }
            }
            for (k, &closeness) in rays.closeness.iter().enumerate() {
                let reach = rays.reach.as_ref().map_or(1, |reach| reach[k]);
                let apart = pass.spacing_at(k as i64, setup.geometry.offset, setup.geometry.weight_bits) * f64::from(reach);
                prop_assert!((f64::from(closeness) / one - 1.0 / apart.max(1.0)).abs() <= 0.5 / one + 1e-12);
                let factor = f64::from(rays.factors[k][0]) / 65536.0;
                prop_assert!((factor - 1.0 / apart.max(1.0)).abs() <= 0.5 / 65536.0 + 1e-12 || setup.gradient.is_none());
            }
        }
    }
}

/// Between two faces along the rays, 3 voxels apart, there are three whole steps; where a value is chosen, a sample on either face counts.
#[test]
fn a_sample_on_the_face_that_a_ray_enters_counts_and_one_on_the_other_does_not() {
    // Along z and against it, on which the box begins two planes after the first.
    for direction in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]] {
        for (mode, expected) in [(Mode::Composite, 3), (Mode::WeightedSum, 3), (Mode::Maximum, 4)] {
            let crop = Crop { min_voxel: [0.0, 0.0, 2.0], max_voxel: [7.0, 7.0, 5.0] };
            let scene =
                Scene { view: View::from_direction(direction, None), crop: Some(crop), mode, ..Scene::default() };
            let mut machine = MachineSpec::default();
            machine.rays.offset = 0.0;
            let setup = parallel(&scene, &machine, &volume([8; 3], [1.0; 3]));
            let depths: Vec<i64> =
                (0..8).filter(|&k| setup.clips.iter().all(|clip| kept(&setup, clip, [3, 3, k]))).collect();
            assert_eq!(depths, (2..2 + expected).collect::<Vec<_>>(), "{mode:?}, {direction:?}");
            machine.rays.ends = RayEnds::Exact;
            let setup = parallel(&scene, &machine, &volume([8; 3], [1.0; 3]));
            let count = (0..8).filter(|&k| setup.clips.iter().all(|clip| kept(&setup, clip, [3, 3, k]))).count();
            assert_eq!(count, 4, "parts of a step need no rule");
        }
    }
}

/// Opacity 1 on every sample of a ray through all planes is a weighted sum of 1.
#[test]
fn a_weighted_sum_weighs_each_plane_alike() {
    for depth in [1_usize, 3, 8, 512] {
        let scene =
            Scene { view: View::from_direction([0.0, 0.0, 1.0], None), mode: Mode::WeightedSum, ..Scene::default() };
        let setup = parallel(&scene, &MachineSpec::default(), &volume([4, 4, depth], [1.0; 3]));
        assert_eq!(setup.cone.sum_weight, (1_u64 << 32) / depth as u64);
    }
}

/// Where a table is coarser than the samples, an entry stands for the value in the middle of those that share it; a label's for the label.
#[test]
fn entries_are_in_the_middle_of_the_samples_that_share_them() {
    let words = Words { voxel_bits: 8, sample_fraction_bits: 2, gradient_bits: 10, table_bits: 6, ..Words::default() };
    let machine = MachineSpec { words, ..MachineSpec::default() };
    let mut scene = Scene::default();
    scene.transfer.opacity = vec![[0.0, 0.0], [255.0, 1.0]];
    scene.transfer.opacity_correction = false;
    let tables = |scene: &Scene| parallel(scene, &machine, &volume([5; 3], [1.0; 3])).classification;
    let full = f64::from((1_u32 << words.opacity_bits) - 1);
    let table = tables(&scene);
    assert_eq!(table.index_shift, 4);
    for (entry, &word) in table.opacity.iter().enumerate() {
        // Samples 16·entry to 16·entry + 15, quarters of a value.
        let middle = (16.0 * entry as f64 + 7.5) / 4.0;
        assert_eq!(f64::from(word), (middle.min(255.0) / 255.0 * full).round());
    }
    scene.volume.labels = true;
    for (entry, &word) in tables(&scene).opacity.iter().enumerate() {
        assert_eq!(f64::from(word), (4.0 * entry as f64 / 255.0 * full).round());
    }
}
