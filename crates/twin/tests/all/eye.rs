//! Pixels from an eye: lengths by geometry, the modes by their definitions, the parallel picture as the limit, symmetries and threads.

use crate::common::brute_force::{Gathered, brute_force, scenes};
use crate::common::passes::{along, eye_depth, frames, geometries, line, rays, seen_from};
use crate::common::turn::all_turns;
use crate::common::{ball, ball_scene, constant, fog, largest_difference, noise, one_voxel_a_pixel, stretch};
use cube3_cases::cases;
use cube3_frame::Geometry;
use cube3_machine::{GradientMethod, TemplateRule};
use cube3_scene::{Crop, Cut, Image, Mode, Perspective, Scene, View, resolve_lights, turn_lights};
use cube3_twin::{BaseRendering, DiscreteOptions, RealSamples, SampleCell, discrete, sheared, true_3d, warp_passes};
use cube3_volume::Volume;
use glam::DVec3;
use proptest::prelude::*;

const CELLS: [SampleCell; 2] = [SampleCell::Exact, SampleCell::Sheared];

fn options(gradient: GradientMethod) -> DiscreteOptions {
    DiscreteOptions { gradient, ..DiscreteOptions::default() }
}

/// The picture of a scene by the twin, over its background.
fn picture(volume: &Volume, scene: &Scene, cell: SampleCell, template: TemplateRule) -> Vec<[f64; 3]> {
    let frames = frames(volume, scene, GradientMethod::SixSheared, template);
    let geometries = geometries(&frames);
    let cast = |geometry: &&Geometry| {
        discrete(volume, scene, geometry, cell, &options(GradientMethod::SixSheared), None).unwrap()
    };
    let bases: Vec<BaseRendering> = geometries.iter().map(cast).collect();
    if scene.view.perspective.is_none() {
        return bases[0].warp(geometries[0], &frames.plane, volume.spacing, scene.background);
    }
    let passes: Vec<_> = bases.iter().zip(geometries).collect();
    warp_passes(&passes, &frames.plane, volume.spacing, scene.background)
}

#[test]
fn an_eye_far_away_sees_the_parallel_picture_half_as_far_off_from_twice_the_distance() {
    // Nearer, a sheared cell is another one where a ray is a hair beside a column.
    let volume = ball(24);
    let parallel = ball_scene(24, Mode::Composite);
    for cell in CELLS {
        let expected = picture(&volume, &parallel, cell, TemplateRule::PlaneFloor);
        let errors = [2e4, 4e4, 8e4, 1e6].map(|distance: f64| {
            // Pixels are as large in the volume's middle.
            let field = 2.0 * (12.0 / distance).atan().to_degrees();
            let perspective = Perspective { distance_voxel: Some(distance), ..Perspective::new(field) };
            let image = Image { pixel_size_voxel: None, ..parallel.image.clone() };
            let view = View { perspective: Some(perspective), ..parallel.view.clone() };
            let seen = Scene { view, image, ..parallel.clone() };
            largest_difference(&picture(&volume, &seen, cell, TemplateRule::PlaneFloor), &expected)
        });
        println!("{cell:?}: {errors:?}");
        for pair in errors[..3].windows(2) {
            assert!((1.8..2.2).contains(&(pair[0] / pair[1])), "{cell:?}: {errors:?}");
        }
        assert!(errors[0] < 1e-4 && errors[3] < 0.022 * errors[0], "{cell:?}: {errors:?}");
    }
}

/// Eyes before a volume, near it and in it; on voxels and between them.
fn eyes(dims: [usize; 3]) -> impl Strategy<Value = [f64; 3]> {
    let near = || -12.0..20.0_f64;
    let inside = prop::array::uniform3(0.0..1.0_f64);
    let inside = inside.prop_map(move |part| [0, 1, 2].map(|i| part[i] * (dims[i] - 1) as f64));
    let voxel = || (0_u8..9).prop_map(f64::from);
    prop_oneof![
        2 => [near(), near(), near()],
        2 => inside,
        1 => [voxel(), voxel(), voxel()],
        1 => [-200.0..200.0_f64, -200.0..200.0_f64, -200.0..200.0_f64],
    ]
}

proptest! {
    #![proptest_config(cases(64))]

    /// 1 − (1 − α)^length, the length of each ray by geometry: in the box, the crop box and the cuts, and behind the eye.
    #[test]
    fn fog_is_as_deep_as_each_ray_is_long(
        (dims, eye) in [2_usize..9, 2_usize..9, 2_usize..9].prop_flat_map(|dims| (Just(dims), eyes(dims))), spacing in [0.5..2.0_f64, 0.5..2.0, 0.5..2.0],
        low in prop::array::uniform3(-2.0..3.0_f64), size in prop::array::uniform3(2.0..9.0_f64),
        normal in prop::array::uniform3(-1.0..1.0_f64), plane: bool,
    ) {
        prop_assume!(normal.iter().any(|n| n.abs() > 1e-3));
        let volume = Volume { spacing, ..constant(dims) };
        let mut scene = seen_from(&fog(0.3), dims, eye, 80.0);
        (scene.image.width_px, scene.image.height_px) = (9, 7);
        scene.crop = Some(Crop { min_voxel: low, max_voxel: [0, 1, 2].map(|i| low[i] + size[i]) });
        scene.cuts = vec![Cut { normal, through_voxel: dims.map(|n| 0.4 * n as f64) }];
        let template = if plane { TemplateRule::PlaneFloor } else { TemplateRule::SampleFloor };
        let density = -(0.7_f64).ln();
        for geometry in geometries(&frames(&volume, &scene, GradientMethod::SixSheared, template)) {
            let front = eye_depth(&scene, &volume, geometry).max(0.0);
            let planes = [front, (geometry.size[2] - 1) as f64];
            for cell in CELLS {
                let base = discrete(&volume, &scene, geometry, cell, &options(GradientMethod::SixSheared), None).unwrap();
                for (ray, pixel) in rays(geometry).zip(&base.pixels) {
                    let place = line(geometry, ray);
                    let span = stretch(&scene, dims, place(0.0), place(1.0) - place(0.0), planes);
                    let steps = span.map_or(0.0, |[enter, leave]| leave - enter);
                    let (_, step) = along(geometry, ray, spacing);
                    let expected = -(-density * steps * step).exp_m1();
                    // A stretch without a sample has no pixel.
                    prop_assert!(pixel[3] == 0.0 || (pixel[3] - expected).abs() < 1e-6, "{pixel:?}, not {expected}");
                    let drawn = |k: usize| {
                        let [from, to] = span.unwrap_or([0.0, -1.0]);
                        let depth = k as f64 + geometry.real_offset();
                        geometry.has_sample(ray, k as i64) && from + 1e-6 < depth && depth < to - 1e-6
                    };
                    prop_assert!(pixel[3] > 0.0 || !(0..geometry.size[2]).any(drawn), "a ray with samples is clear");
                }
            }
        }
    }
}

fn base_plane_by_force(volume: &Volume, scene: &Scene, geometry: &Geometry, cell: SampleCell) -> Vec<[f64; 4]> {
    let method = GradientMethod::SixSheared;
    let samples = RealSamples::new(volume, geometry, cell, 3.0).unwrap();
    let planes = [eye_depth(scene, volume, geometry).max(0.0), (geometry.size[2] - 1) as f64];
    let pixel = |ray| {
        let (direction, length) = along(geometry, ray, volume.spacing);
        let mut lights = resolve_lights(scene, &scene.view.frame().unwrap());
        turn_lights(scene, direction, &mut lights);
        let gather = |k: usize| {
            Some(Gathered {
                value: samples.sample(ray, k as i64)?,
                position: geometry.axes.voxel_position(geometry.size, geometry.sample_position(ray, k)),
                gradient: samples.world_gradient(ray, k as i64, method),
                part: k as f64 + geometry.real_offset(),
            })
        };
        let mut seen: Vec<Gathered> = (0..geometry.size[2]).filter_map(gather).collect();
        let place = line(geometry, ray);
        let drawn = stretch(scene, volume.dims, place(0.0), place(1.0) - place(0.0), planes);
        let [enter, leave] = drawn.unwrap_or([0.0, -1.0]);
        seen.retain(|sample| enter - 1e-9 <= sample.part && sample.part <= leave + 1e-9);
        let depths: Vec<f64> = seen.iter().map(|sample| sample.part).collect();
        for (i, sample) in seen.iter_mut().enumerate() {
            let from = if i == 0 { enter } else { f64::midpoint(depths[i - 1], depths[i]) };
            sample.part = depths.get(i + 1).map_or(leave, |next| f64::midpoint(depths[i], *next)) - from;
        }
        brute_force(scene, volume, &lights, &seen, length, 1.0 / (geometry.size[2] - 1) as f64)
    };
    rays(geometry).map(pixel).collect()
}

#[test]
fn every_mode_from_an_eye_is_its_definition() {
    let dims = [6, 5, 7];
    for (spacing, eye) in [
        ([1.0; 3], [2.3, -9.1, 4.2]),
        ([1.0, 0.7, 1.9], [-3.3, -2.4, 9.1]),
        ([1.0; 3], [2.7, 1.9, 3.3]),
        ([0.8, 1.3, 1.0], [3.6, 6.1, 2.6]),
    ] {
        let volume = noise(dims, spacing, 11);
        for scene in scenes() {
            let scene = seen_from(&Scene { image: one_voxel_a_pixel(12, 11), ..scene }, dims, eye, 70.0);
            let frames = frames(&volume, &scene, GradientMethod::SixSheared, TemplateRule::PlaneFloor);
            let mut seen = 0;
            for geometry in geometries(&frames) {
                for cell in CELLS {
                    let options = DiscreteOptions { border: 3.0, ..options(GradientMethod::SixSheared) };
                    let got = discrete(&volume, &scene, geometry, cell, &options, None).unwrap();
                    let error = largest_difference(&got.pixels, &base_plane_by_force(&volume, &scene, geometry, cell));
                    assert!(error < 1e-7, "{} {cell:?} from {eye:?}: {error:e}", scene.mode);
                    seen += got.pixels.iter().filter(|pixel| pixel[3] > 0.0).count();
                }
            }
            assert!(seen > 4, "{} from {eye:?} shows nothing", scene.mode);
        }
    }
}

#[test]
fn the_48_symmetries_of_the_cube_hold_to_the_bit() {
    let dims = [9, 8, 7];
    let volume = noise(dims, [1.0, 1.25, 0.75], 21);
    for eye in [[-2.5, -14.25, 0.75], [3.5, 5.25, 1.75]] {
        let middle = dims.map(|n| (n - 1) as f64 / 2.0);
        let from_middle = [0, 1, 2].map(|i| eye[i] - middle[i]);
        let pictures = all_turns().into_iter().map(|turn| {
            let volume = turn.volume(&volume);
            let by = turn.direction(from_middle);
            let place = [0, 1, 2].map(|i| (volume.dims[i] - 1) as f64 / 2.0 + by[i]);
            let scene = seen_from(&Scene::default(), volume.dims, place, 40.0);
            let frames = frames(&volume, &scene, GradientMethod::TwentySixSheared, TemplateRule::SampleFloor);
            let geometry = &frames.setups[0].geometry;
            CELLS.map(|cell| {
                let options = options(GradientMethod::TwentySixSheared);
                discrete(&volume, &scene, geometry, cell, &options, None).unwrap()
            })
        });
        let pictures: Vec<[BaseRendering; 2]> = pictures.collect();
        assert_eq!(pictures.len(), 48);
        let seen = pictures[0][0].pixels.iter().filter(|pixel| pixel[3] > 0.3).count();
        assert!(seen > 20, "{seen}");
        for turned in &pictures {
            assert_eq!(turned, &pictures[0], "from {eye:?}");
        }
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let dims = [40, 41, 42];
    let volume = noise(dims, [1.0; 3], 5);
    let scene = seen_from(&Scene::default(), dims, [12.0, 17.5, 21.25], 70.0);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| picture(&volume, &scene, SampleCell::Sheared, TemplateRule::PlaneFloor))
    };
    let alone = on(1);
    assert_eq!(on(2), alone);
    assert_eq!(on(5), alone);
}

/// A block between two planes across the view: only an eye before it sees it, whichever way the eye looks.
#[test]
fn what_is_behind_the_eye_is_not_seen() {
    let dims = [16; 3];
    let volume = Volume::from_fn(dims, [1.0; 3], |_, y, _| if (3..6).contains(&y) { 200_u8 } else { 0 }).unwrap();
    let opaque = fog(0.0);
    let image = Image { width_px: 15, height_px: 15, pixel_size_voxel: None };
    let mut opaque = Scene { image, ..opaque };
    opaque.transfer.opacity = vec![[100.0, 0.0], [101.0, 1.0]];
    for (y, yaw_deg, seen) in [(1.5, 0.0, true), (8.5, 0.0, false), (8.5, 180.0, true), (1.5, 180.0, false)] {
        let view = View {
            perspective: Some(Perspective { eye_voxel: Some([7.5, y, 7.5]), ..Perspective::new(50.0) }),
            ..View::from_angles(yaw_deg, 0.0)
        };
        let scene = Scene { view, background: [0.0; 3], ..opaque.clone() };
        for cell in CELLS {
            let picture = picture(&volume, &scene, cell, TemplateRule::PlaneFloor);
            assert_eq!(picture[7 * 15 + 7][0] > 0.5, seen, "from {y} at {yaw_deg}°");
        }
    }
}

/// A light at the eye lights a wall by the cosine of each ray's angle to it; between samples a wall has one normal.
#[test]
fn a_wall_is_lit_along_each_ray() {
    let dims = [24; 3];
    let volume = Volume::from_fn(dims, [1.0; 3], |_, y, _| 20.0 * y as f64).unwrap();
    let mut scene = Scene { mode: Mode::FirstOpaque, ..fog(0.0) };
    scene.transfer.opacity = vec![[200.0, 0.0], [201.0, 1.0]];
    scene.material.shaded = true;
    (scene.material.ambient, scene.material.diffuse, scene.material.specular) = (0.1, 0.6, 0.2);
    scene.transfer.colour = vec![cube3_scene::ColourPoint { value: 0.0, rgb: [1.0; 3] }];
    for (eye, method) in [
        ([11.5, -30.0, 9.0], GradientMethod::Twelve),
        ([8.5, -9.0, 9.0], GradientMethod::SixSheared),
        ([11.0, 2.5, 12.0], GradientMethod::TwentySixSheared),
    ] {
        let scene = seen_from(&scene, dims, eye, 50.0);
        let frames = frames(&volume, &scene, method, TemplateRule::PlaneFloor);
        let geometry = &frames.setups[0].geometry;
        assert_eq!(geometry.axes.axis[2], 1);
        for cell in CELLS {
            let base = discrete(&volume, &scene, geometry, cell, &options(method), None).unwrap();
            let mut lit = 0;
            for (ray, pixel) in rays(geometry).zip(&base.pixels) {
                let place = line(geometry, ray)(11.0);
                // Away from what is beside the volume.
                if [place.x, place.z].iter().any(|x| !(6.0..=17.0).contains(x)) {
                    continue;
                }
                let (direction, _) = along(geometry, ray, volume.spacing);
                let cosine = direction.dot(DVec3::Y).abs();
                let expected = 0.1 + 0.6 * cosine + 0.2 * cosine.powf(scene.material.shininess);
                assert!((pixel[0] - expected).abs() < 1e-9, "{} for {expected} from {eye:?}", pixel[0]);
                lit += 1;
            }
            assert!(lit > 30, "{lit}");
        }
    }
}

/// True and sheared differ in their cells alone: of planes across w with no offset between them a cell that is a voxel wide is both.
#[test]
fn in_a_near_frame_without_an_offset_the_two_are_equal() {
    let dims = [16; 3];
    let volume = noise(dims, [1.0; 3], 7);
    let scene = Scene { mode: Mode::Maximum, ..seen_from(&Scene::default(), dims, [7.5, 2.25, 6.5], 60.0) };
    let frames = frames(&volume, &scene, GradientMethod::SixSheared, TemplateRule::PlaneFloor);
    let mut equal = 0;
    for geometry in geometries(&frames) {
        let pass = geometry.perspective.as_ref().unwrap();
        assert!(pass.doubled && geometry.offset == 0);
        let options = options(GradientMethod::SixSheared);
        let [exact, by_shear] = [true_3d, sheared].map(|cast| cast(&volume, &scene, geometry, &options, None).unwrap());
        assert_eq!(exact.samples, by_shear.samples);
        for (a, b) in exact.pixels.iter().zip(&by_shear.pixels) {
            equal += usize::from((0..4).all(|i| (a[i] - b[i]).abs() < 1e-9));
        }
    }
    assert!(equal > 200, "{equal}");
}
