//! Perspective against closed forms, the parallel view, the symmetries of the cube, and the reference ray caster.

use cube3::{RunOptions, Runs};
use cube3_cases::cases;
use cube3_frame::{BasePlane, FrameSetup, Geometry};
use cube3_function::{CanonicalVolume, render};
use cube3_host::{PictureFrames, VolumeInfo, frame_setup, picture_setup, warp_passes};
use cube3_inputs as inputs;
use cube3_machine::{GradientMethod, MachineSpec, RayEnds, RaySlots, Rays};
use cube3_method::Choice;
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_scene::{Image, Layer, Light, Material, Perspective, Scene, View, VolumeSource};
use cube3_tests::{SmallVolume, for_perspective, machines, scenes, volumes};
use cube3_volume::{Phantom, PhantomParams, ReadOptions, WordConversion};
use cube3_word::Words;
use proptest::prelude::*;
use std::sync::Arc;

fn bases(frames: &PictureFrames, dims: [usize; 3], words: &[u16]) -> Vec<BasePlane> {
    let base = |setup: &Arc<FrameSetup>| {
        render(setup, &CanonicalVolume::new(&setup.geometry.axes, dims, words), true, &|_, _| {}).base
    };
    frames.setups.iter().map(base).collect()
}

fn picture(frames: &PictureFrames, bases: &[BasePlane], spacing: [f64; 3]) -> Vec<[f64; 3]> {
    let passes: Vec<(&BasePlane, &Geometry)> =
        bases.iter().zip(frames.setups.iter().map(|setup| &setup.geometry)).collect();
    warp_passes(&passes, &frames.plane, spacing, [0.0; 3])
}

fn with_eye(scene: &Scene, perspective: Perspective, side: u32) -> Scene {
    Scene {
        view: View { perspective: Some(perspective), ..scene.view.clone() },
        image: Image { width_px: side, height_px: side, ..scene.image.clone() },
        ..scene.clone()
    }
}

proptest! {
    #![proptest_config(cases(200))]

    /// At 10¹² voxels the slopes of all rays round to the parallel ones, and an unlit picture is the padded parallel one, bit for bit.
    #[test]
    fn an_eye_far_away_sees_the_parallel_picture(
        (machine, mut scene, volume) in (machines(), scenes()).prop_flat_map(|(machine, scene)| {
            let bits = machine.words.voxel_bits;
            (Just(machine), Just(scene), volumes(9, bits))
        }),
    ) {
        let mut machine = for_perspective(&machine);
        machine.rays.slots = RaySlots::Padded;
        // Exact ends take distances from places, which have 16 fraction bits in perspective: half way between two tables it may be the other.
        machine.rays.ends = RayEnds::Published;
        scene.material.shaded = false;
        (scene.cuts, scene.crop, scene.depth_cue) = (Vec::new(), None, None);
        let one_dimensional = Scene { transfer: cube3_scene::Transfer { layers: Vec::new(), ..scene.transfer.clone() }, ..scene };
        let far = Perspective { distance_voxel: Some(1e12), ..Perspective::new(10.0) };
        let frames = picture_setup(&with_eye(&one_dimensional, far, 9), &machine, &volume.info(), true).unwrap();
        let parallel = frame_setup(&one_dimensional, &machine, &volume.info(), true).unwrap().setup;
        let Some(main) = frames.setups.first() else {
            // The picture's few rays pass the volume by.
            return Ok(());
        };
        let pass = main.geometry.perspective.as_ref().unwrap();
        let [du, dv] = parallel.geometry.slopes.map(i64::from);
        // At 45° the picture is split between two passes, however far the eye is.
        prop_assume!(du < 1 << 30);
        prop_assume!(pass.u.slopes.iter().all(|&s| s == du) && pass.v.slopes.iter().all(|&s| s == dv));
        let turned = CanonicalVolume::new(&parallel.geometry.axes, volume.dims, &volume.words);
        let expected = render(&parallel, &turned, true, &|_, _| {}).base;
        prop_assert_eq!(&bases(&frames, volume.dims, &volume.words)[0], &expected);
    }
}

/// Lit, the directions come from registers of their own and through the normaliser, and gradients keep more bits: the picture is the
/// same to a few parts in a thousand.
#[test]
fn lit_the_far_picture_is_the_parallel_one_within_a_tolerance() {
    let scene = head(48);
    let from_the_side = Light { direction: Some([-1.0, 0.3, 0.8]), colour: [1.0, 0.5, 0.25] };
    let one_sided = Material { two_sided: false, specular: 0.6, ..Material::default() };
    let [eye, side] = [vec![Light::default()], vec![from_the_side, Light::default()]];
    for lights in [eye, side] {
        compare_far_with_parallel(Scene { lights: lights.clone(), ..scene.clone() });
        compare_far_with_parallel(Scene { lights, material: one_sided.clone(), ..scene.clone() });
    }
}

fn compare_far_with_parallel(scene: Scene) {
    let volume = inputs::load_volume(&head(48), &MachineSpec::default(), &ReadOptions::default(), false).unwrap();
    let mut machine = MachineSpec::default();
    machine.rays.slots = RaySlots::Padded;
    let far = Perspective { distance_voxel: Some(1e12), ..Perspective::new(1e-2) };
    let words = &volume.words;
    let mut frames = picture_setup(
        &with_eye(&scene, Perspective { field_of_view_deg: 179.0, ..far }, 65),
        &machine,
        &volume.info(),
        true,
    )
    .unwrap();
    frames.setups.truncate(1);
    let parallel = frame_setup(&scene, &machine, &volume.info(), true).unwrap().setup;
    let expected =
        render(&parallel, &CanonicalVolume::new(&parallel.geometry.axes, words.dims, &words.words), true, &|_, _| {})
            .base;
    let got = &bases(&frames, words.dims, &words.words)[0];
    assert_eq!((got.width, got.height), (expected.width, expected.height));
    let difference =
        |a: &[u32; 4], b: &[u32; 4]| (0..4).map(|i| f64::from(a[i].abs_diff(b[i])) / 65535.0).fold(0.0, f64::max);
    let differences: Vec<f64> = got.pixels.iter().zip(&expected.pixels).map(|(a, b)| difference(a, b)).collect();
    let largest = differences.iter().copied().fold(0.0, f64::max);
    let mean = differences.iter().sum::<f64>() / differences.len() as f64;
    println!("lit at 1e12: largest difference {largest:.5}, mean {mean:.6}");
    assert!(got.pixels.iter().any(|pixel| pixel[3] > 30000));
    assert!(largest < 0.02 && mean < 0.001, "{largest} {mean}");
}

fn head(size: usize) -> Scene {
    Scene { volume: VolumeSource::from_phantom("head", size), ..Scene::default() }
}

/// The pass along +z of an eye before the middle of a cube.
fn central(n: usize, distance: f64) -> Geometry {
    let middle = (n as f64 - 1.0) * 0.5;
    let scene = Scene { view: View { direction: Some([0.0, 0.0, 1.0]), ..View::default() }, ..Scene::default() };
    let eye = Perspective { eye_voxel: Some([middle, middle, -distance]), ..Perspective::new(90.0) };
    let info = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let frames = picture_setup(&with_eye(&scene, eye, 33), &MachineSpec::default(), &info, true).unwrap();
    frames.setups[0].geometry.clone()
}

#[test]
fn rays_are_one_voxel_apart_in_front_and_one_and_n_over_d_behind() {
    let n = 64;
    for distance in [1.0e6, 256.0, 128.0, 64.0, 32.0] {
        let geometry = central(n, distance);
        let pass = geometry.perspective.as_ref().unwrap();
        let expected = 1.0 + n as f64 / distance;
        assert!((geometry.coverage().unwrap().back_spacing - expected).abs() < 1e-7, "{distance}");
        let one = f64::from(1_u32 << cube3_frame::SLOPE_FRACTION_BITS);
        let behind = |i: usize| (pass.u.starts[i] + n as i64 * pass.u.slopes[i]) as f64 / one;
        let last = pass.u.count() - 1;
        assert!(((behind(last) - behind(0)) / last as f64 - expected).abs() < 1e-7, "{distance}");
        assert!(pass.u.starts.windows(2).all(|pair| pair[1] - pair[0] == 1 << cube3_frame::SLOPE_FRACTION_BITS));
        assert!(!pass.doubled);
    }
}

/// The mean of 1/m over the depth: D/n · ln(1 + n/D), that is 89, 81, 69 and 55 %.
#[test]
fn the_fraction_of_columns_on_a_ray_is_the_closed_form() {
    let n = 256;
    for (ratio, percent) in [(4.0_f64, 89.0), (2.0, 81.0), (1.0, 69.0), (0.5, 55.0)] {
        let geometry = central(n, ratio * n as f64);
        let fan = &geometry.perspective.as_ref().unwrap().u;
        let met = |k: usize| {
            let mut columns: Vec<i32> = fan.near_row(k).iter().copied().filter(|x| (0..n as i32).contains(x)).collect();
            columns.dedup();
            columns.len() as f64 / n as f64
        };
        let mean = (0..n).map(met).sum::<f64>() / n as f64;
        let closed = ratio * (1.0 + 1.0 / ratio).ln();
        assert!((mean - closed).abs() < 0.01, "{ratio}: {mean}, not {closed}");
        assert!((closed * 100.0 - percent).abs() < 0.6);
        let unused = geometry.coverage().unwrap().unused;
        let square = 1.0 - (0..n).map(|k| met(k).powi(2)).sum::<f64>() / (n as f64);
        assert!((unused - square).abs() < 0.02, "{ratio}: {unused}, not {square}");
    }
}

/// One of the 48: new axis i is old axis `axis[i]`, reversed or not.
#[derive(Clone, Copy, Debug)]
struct Symmetry {
    axis: [usize; 3],
    reversed: [bool; 3],
}

impl Symmetry {
    fn vector(&self, v: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| if self.reversed[i] { -v[self.axis[i]] } else { v[self.axis[i]] })
    }

    fn position(&self, dims: [usize; 3], p: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| {
            let at = p[self.axis[i]];
            if self.reversed[i] { (dims[self.axis[i]] - 1) as f64 - at } else { at }
        })
    }

    fn volume(&self, volume: &SmallVolume) -> SmallVolume {
        let dims = self.axis.map(|a| volume.dims[a]);
        let mut words = vec![0; volume.words.len()];
        for (i, &word) in volume.words.iter().enumerate() {
            let [nx, ny, _] = volume.dims;
            let to =
                self.position(volume.dims, [i % nx, i / nx % ny, i / nx / ny].map(|c| c as f64)).map(|c| c as usize);
            words[to[0] + dims[0] * (to[1] + dims[1] * to[2])] = word;
        }
        SmallVolume { dims, spacing: self.axis.map(|a| volume.spacing[a]), words }
    }
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn all_48_symmetries_give_the_same_base_planes_and_pictures(
        (machine, mut scene, volume) in (machines(), scenes()).prop_flat_map(|(machine, scene)| {
            let bits = machine.words.voxel_bits;
            (Just(machine), Just(scene), volumes(6, bits))
        }),
        direction in [0.05..1.0_f64, 0.05..1.0_f64, 0.05..1.0_f64],
        eye in [-40_i32..60, -40_i32..60, -40_i32..60],
        field in 20.0..120.0_f64,
    ) {
        let in_voxels = [0, 1, 2].map(|i| direction[i] / volume.spacing[i]);
        prop_assume!((0..3).all(|i| (in_voxels[i] - in_voxels[(i + 1) % 3]).abs() > 1e-6));
        let mut machine = for_perspective(&machine);
        // The tables of a hundred passes and more are made.
        machine.words.table_gradient_bits = machine.words.table_gradient_bits.min(2);
        (scene.cuts, scene.crop) = (Vec::new(), None);
        // On quarters of a voxel, which mirror exactly.
        let eye = eye.map(|x| f64::from(x) * 0.25);
        let up = [0.3, 0.1, 1.0];
        let look = |direction, up, eye| View {
            direction: Some(direction),
            up: Some(up),
            perspective: Some(Perspective { eye_voxel: Some(eye), ..Perspective::new(field) }),
            ..View::default()
        };
        scene.image = Image { width_px: 11, height_px: 8, ..Image::default() };
        scene.view = look(direction, up, eye);
        let run = |scene: &Scene, volume: &SmallVolume| {
            let frames = picture_setup(scene, &machine, &volume.info(), true).unwrap();
            let bases = bases(&frames, volume.dims, &volume.words);
            let picture = picture(&frames, &bases, volume.spacing);
            (bases, picture)
        };
        let (expected, expected_picture) = run(&scene, &volume);
        for (number, axis) in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]].into_iter().enumerate() {
            for bits in 0..8_u32 {
                let symmetry = Symmetry { axis, reversed: [bits & 1 != 0, bits & 2 != 0, bits & 4 != 0] };
                let mut turned = scene.clone();
                let eye = symmetry.position(volume.dims, eye);
                turned.view = look(symmetry.vector(direction), symmetry.vector(up), eye);
                for light in &mut turned.lights {
                    light.direction = light.direction.map(|d| symmetry.vector(d));
                }
                let (got, picture) = run(&turned, &symmetry.volume(&volume));
                prop_assert_eq!(got.len(), expected.len());
                for base in &expected {
                    prop_assert!(got.contains(base), "{:?}", symmetry);
                }
                // A mirror image of the volume is seen in the mirror.
                let odd = [1, 2, 5].contains(&number) != (bits.count_ones() % 2 == 1);
                for (row, line) in picture.chunks(11).enumerate() {
                    for (column, pixel) in line.iter().enumerate() {
                        let at = row * 11 + if odd { 10 - column } else { column };
                        for i in 0..3 {
                            prop_assert!((pixel[i] - expected_picture[at][i]).abs() < 1e-6, "{:?}", symmetry);
                        }
                    }
                }
            }
        }
    }
}

/// Between two base planes the machine's picture is as near to the reference as beside the joint.
#[test]
fn no_seam_where_three_base_planes_join() {
    let (n, side) = (64, 240);
    let params = PhantomParams { ramp: Some(6.0), ..PhantomParams::default() };
    let volume = Phantom::Sphere.generate(n, &params).unwrap();
    let (words, _) = volume.to_words(16, &WordConversion::identity(16)).unwrap();
    let mut scene = Scene { view: View { direction: Some([0.9, 1.0, 1.1]), ..View::default() }, ..Scene::default() };
    scene.transfer.opacity = vec![[0.0, 0.0], [65535.0, 0.08]];
    scene.transfer.colour.iter_mut().for_each(|point| point.rgb = [1.0; 3]);
    scene.background = [0.0; 3];
    let scene = with_eye(&scene, Perspective { distance_voxel: Some(90.0), ..Perspective::new(40.0) }, side);
    let machine = MachineSpec {
        rays: Rays { template: cube3_machine::TemplateRule::PlaneFloor, ..Rays::default() },
        ..MachineSpec::default()
    };
    let info = VolumeInfo { dims: words.dims, spacing: words.spacing, window: words.window };
    let frames = picture_setup(&scene, &machine, &info, true).unwrap();
    assert_eq!(frames.setups.len(), 3);
    let bases = bases(&frames, words.dims, &words.words);
    let got = picture(&frames, &bases, words.spacing);
    let reference = image_order(&volume, &scene, &ImageOrderOptions::default(), None).unwrap().picture.pixels;
    let side = side as usize;
    let axis: Vec<usize> = (0..side * side)
        .map(|i| {
            let (_, d) = frames.plane.ray((i % side) as f64, (i / side) as f64);
            (0..3).fold(0, |best, axis| if d[axis].abs() > d[best].abs() { axis } else { best })
        })
        .collect();
    let joint = |column: usize, row: usize, within: usize| {
        let all = |c: usize| c.saturating_sub(within)..=(c + within).min(side - 1);
        all(row).any(|r| all(column).any(|c| axis[r * side + c] != axis[row * side + column]))
    };
    let (mut near, mut beside) = ((0.0, 0), (0.0, 0));
    for row in 0..side {
        for column in 0..side {
            let i = row * side + column;
            if reference[i][0] < 0.05 {
                continue;
            }
            let error = (0..3).map(|c| (got[i][c] - reference[i][c]).abs()).sum::<f64>() / 3.0;
            let sum = if joint(column, row, 2) {
                &mut near
            } else if joint(column, row, 12) {
                &mut beside
            } else {
                continue;
            };
            *sum = (sum.0 + error, sum.1 + 1);
        }
    }
    let [near, beside] = [near, beside].map(|(sum, count)| sum / f64::from(count));
    println!("mean error at the joints {near:.5}, beside them {beside:.5}");
    assert!(near < beside * 1.15, "{near} against {beside}");
    assert!(beside < 0.04, "{beside}");
}

#[test]
fn the_runs_of_a_picture_of_several_base_planes_agree() {
    let scene = Scene { view: View::from_angles(40.0, 35.0), ..head(32) };
    let scene = with_eye(&scene, Perspective { distance_voxel: Some(30.0), ..Perspective::new(60.0) }, 96);
    let machine = MachineSpec::default();
    let volume = inputs::load_volume(&scene, &machine, &ReadOptions::default(), false).unwrap();
    let run = |runs, reference| {
        cube3::run(&scene, &machine, &volume, &RunOptions { runs, reference, ..RunOptions::default() }).unwrap().report
    };
    let both = run(Runs::Both, Some(Choice::of(&cube3_method::IMAGE_ORDER)));
    let cycle = run(Runs::Cycle, None);
    assert_eq!(both.digest.base_plane, cycle.digest.base_plane);
    assert_eq!(both.digest.image, cycle.digest.image);
    assert_eq!(both.units, cycle.units);
    assert_eq!(both.timing.as_ref().map(|timing| timing.cycles), cycle.timing.as_ref().map(|timing| timing.cycles));
    let passes = both.view.perspective.unwrap().passes;
    assert_eq!(passes.len(), 3);
    let gradient = if passes[0].back_spacing_voxel <= 2.0 { "26d" } else { "6d" };
    assert_eq!(passes[0].gradient.as_deref(), Some(gradient), "12 is not for rays that share columns");
    // The twin has the same rays and samples in all three: what is left is words.
    let distance = |reference: &'static cube3_method::Method| {
        let report = run(Runs::Function, Some(Choice::of(reference)));
        report.error.unwrap().footprint.error.unwrap().mean_relative
    };
    assert!(distance(&cube3_method::SHEARED) * 10.0 < distance(&cube3_method::IMAGE_ORDER));
}

/// The head as the default view sees it, from where it fits a field of 30°: as near to the reference as in parallel.
#[test]
fn the_head_is_as_near_to_the_reference_as_in_parallel() {
    let error = |perspective: Option<Perspective>| {
        let mut scene = head(64);
        scene.view.perspective = perspective;
        scene.image = Image { width_px: 256, height_px: 256, ..Image::default() };
        let machine = MachineSpec::default();
        let volume = inputs::load_volume(&scene, &machine, &ReadOptions::default(), false).unwrap();
        let options = RunOptions { runs: Runs::Function, ..RunOptions::default() };
        let error = cube3::run(&scene, &machine, &volume, &options).unwrap().report.error.unwrap();
        error.footprint.error.unwrap().mean_relative
    };
    let (parallel, perspective) = (error(None), error(Some(Perspective::new(30.0))));
    println!("mean relative distance over the object: parallel {parallel:.4}, perspective {perspective:.4}");
    assert!(perspective < parallel * 1.4, "{perspective} against {parallel}");
}

#[test]
fn eyes_anywhere_see_finite_pictures() {
    let scene = head(24);
    let machine = MachineSpec::default();
    let volume = inputs::load_volume(&scene, &machine, &ReadOptions::default(), false).unwrap();
    let words = &volume.words;
    let eyes = [
        [11.5, 11.5, 11.5],
        [12.0, 12.0, 12.0],
        [0.0, 0.0, 0.0],
        [11.5, 0.0, 11.5],
        [11.5, -1e-9, 11.5],
        [23.0, 23.0, 23.0],
        [11.5, -1e9, 11.5],
        [1e12, -1e12, 11.5],
        [11.5, 500.0, 11.5],
    ];
    for eye in eyes {
        for field in [0.01, 60.0, 150.0] {
            for template in [cube3_machine::TemplateRule::SampleFloor, cube3_machine::TemplateRule::PlaneFloor] {
                let machine = MachineSpec { rays: Rays { template, ..Rays::default() }, ..machine.clone() };
                let mut scene = Scene { view: View::from_angles(0.0, 0.0), ..scene.clone() };
                scene = with_eye(&scene, Perspective { eye_voxel: Some(eye), ..Perspective::new(field) }, 40);
                let frames = picture_setup(&scene, &machine, &volume.info(), true).unwrap();
                assert!(frames.setups.len() <= 6);
                let bases = bases(&frames, words.dims, &words.words);
                let pixels = picture(&frames, &bases, words.spacing);
                assert!(pixels.iter().flatten().all(|x| (0.0..=1.0).contains(x)), "{eye:?} {field}");
                let before = eye[1] <= 12.0 && eye[0] == 11.5;
                if before && field == 60.0 && eye[1] > -100.0 {
                    assert!(pixels.iter().flatten().any(|&x| x > 0.1), "{eye:?} sees nothing");
                }
                if eye[1] == 500.0 {
                    assert!(frames.setups.is_empty(), "the volume is behind the eye");
                }
            }
        }
    }
}

#[test]
fn what_needs_parallel_rays_is_refused_with_a_remedy() {
    let scene = with_eye(&head(16), Perspective::new(30.0), 16);
    let info = VolumeInfo { dims: [16; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    for gradient in [GradientMethod::Ten, GradientMethod::TenNormalised] {
        let mut machine = MachineSpec::default();
        machine.abc.gradient = gradient;
        let error = picture_setup(&scene, &machine, &info, true).unwrap_err().to_string();
        assert!(error.contains("abc.gradient") && error.contains("give \"12\""), "{error}");
    }
    let mut machine = MachineSpec::default();
    machine.abc.shading = cube3_machine::ShadingUnit::ReflectanceTable;
    let error = picture_setup(&scene, &machine, &info, true).unwrap_err().to_string();
    assert!(error.contains("abc.shading") && error.contains("give \"phong\""), "{error}");
}

/// 2^16 samples, 2^7 gradients and 2^4 step lengths would be half a gigabyte for each pass.
#[test]
fn tables_that_would_fill_the_memory_are_refused_before_they_are_made() {
    let mut scene = with_eye(&head(16), Perspective::new(30.0), 16);
    scene.transfer.layers = vec![
        Layer { gradient: 0.0, opacity: vec![[0.0, 0.0], [255.0, 0.5]] },
        Layer { gradient: 50.0, opacity: std::mem::take(&mut scene.transfer.opacity) },
    ];
    let info = VolumeInfo { dims: [16; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let machine = |table_bits, table_gradient_bits| {
        let words = Words { voxel_bits: 16, table_bits, table_gradient_bits, ..Words::default() };
        MachineSpec { words, ..MachineSpec::default() }
    };
    let error = picture_setup(&scene, &machine(16, 7), &info, true).unwrap_err().to_string();
    assert!(error.contains("2^27 entries") && error.contains("lower words.table_bits"), "{error}");
    assert!(picture_setup(&scene, &machine(4, 8), &info, true).is_ok());
    scene.transfer.opacity_correction = false;
    assert!(picture_setup(&scene, &machine(16, 7), &info, true).is_ok());
}
