//! Rays from an eye: closed forms of what they see, the parallel picture as their limit, and eyes in every place.

use crate::common;
use crate::common::{affine, largest_difference, noise};
use cube3_reference::{ImageOrderOptions, ImageRendering, image_order};
use cube3_scene::{
    Cut, DepthCue, Image, ImagePlane, Light, Material, Mode, Perspective, Scene, Transfer, View, corrected_opacity,
    unit_vector,
};
use cube3_volume::{Phantom, PhantomParams, Volume};
use glam::DVec3;

/// A scene seen along +y, or as `view` says, in pictures without a pixel size.
fn scene(view: View, perspective: Perspective, [width_px, height_px]: [u32; 2]) -> Scene {
    Scene {
        view: View { perspective: Some(perspective), ..view },
        image: Image { width_px, height_px, pixel_size_voxel: None },
        ..Scene::default()
    }
}

fn ahead() -> View {
    View::from_angles(0.0, 0.0)
}

fn from_eye(field_of_view_deg: f64, eye: [f64; 3]) -> Perspective {
    Perspective { eye_voxel: Some(eye), ..Perspective::new(field_of_view_deg) }
}

fn render(volume: &Volume, scene: &Scene, step_voxel: f64) -> ImageRendering {
    let options = ImageOrderOptions { step_voxel, ..ImageOrderOptions::default() };
    image_order(volume, scene, &options, None).unwrap()
}

fn flat() -> Material {
    Material { shaded: false, ..Material::default() }
}

fn opacity(points: &[[f64; 2]]) -> Transfer {
    Transfer { opacity: points.to_vec(), ..Transfer::default() }
}

/// The rays of a picture, from the eye, of unit length in voxels of unit spacing, in the order of the pixels.
fn rays(volume: &Volume, scene: &Scene) -> Vec<DVec3> {
    let plane = ImagePlane::new(scene, &scene.view.frame().unwrap(), volume.dims, volume.spacing);
    let pixels = (0..plane.height).flat_map(|row| (0..plane.width).map(move |column| (column, row)));
    pixels.map(|(column, row)| plane.ray(column as f64, row as f64).1.normalize()).collect()
}

/// A soft ball in 24³ voxels that vanishes before the border, and its scene: so no ray has an end that counts.
fn ball(mode: Mode) -> (Volume, Scene) {
    let volume = Volume::from_fn([24; 3], [1.0, 1.1, 0.9], |x, y, z| {
        let square: f64 = [x, y, z].map(|i| (i as f64 - 11.5) / 10.0).map(|c| c * c).iter().sum();
        200.0 * (1.0 - square).max(0.0).powi(3)
    })
    .unwrap();
    let scene = Scene {
        mode,
        view: View::from_angles(24.0, 11.0),
        image: Image { width_px: 25, height_px: 20, pixel_size_voxel: Some(1.0) },
        transfer: Transfer { opaque_alpha: 0.1, ..opacity(&[[5.0, 0.0], [200.0, 0.6]]) },
        lights: vec![Light::default(), Light { direction: Some([1.0, -2.0, 1.5]), colour: [0.3, 0.2, 0.1] }],
        depth_cue: Some(DepthCue::default()),
        ..Scene::default()
    };
    (volume, scene)
}

/// The ball's scene from `distance`, with the field of view of its parallel picture at the centre.
fn from_distance(parallel: &Scene, distance: f64) -> Scene {
    let half_height = f64::from(parallel.image.height_px) * 0.5 * parallel.image.pixel_size_voxel.unwrap();
    let field_of_view_deg = 2.0 * (half_height / distance).atan().to_degrees();
    let mut seen = parallel.clone();
    seen.image.pixel_size_voxel = None;
    seen.view.perspective = Some(Perspective { distance_voxel: Some(distance), ..Perspective::new(field_of_view_deg) });
    seen
}

#[test]
fn from_far_away_the_picture_is_the_parallel_one() {
    // The narrowest field of view is 17453 voxels high at the largest distance: a picture as high has pixels of a voxel.
    let narrowest = 2.0 * f64::tan(0.0005_f64.to_radians());
    for (distance, height_px, tolerance) in [(1e6, 20, 1e-4), (1e9, 16383, 1e-7)] {
        for mode in Mode::ALL {
            let (volume, mut parallel) = ball(mode);
            parallel.image.height_px = height_px;
            if height_px > 20 {
                parallel.image.pixel_size_voxel = Some(distance * narrowest / f64::from(height_px));
            }
            let expected = render(&volume, &parallel, 0.7);
            let shown = expected.picture.pixels.iter().filter(|pixel| pixel[0] > 0.1).count();
            assert!(shown > 30 || mode == Mode::Minimum, "{mode} shows {shown}");
            let got = render(&volume, &from_distance(&parallel, distance), 0.7);
            assert_eq!(got.samples, expected.samples, "{mode} from {distance}");
            let error = largest_difference(&got.picture.pixels, &expected.picture.pixels);
            assert!(error < tolerance, "{mode} from {distance}: {error:e}");
        }
    }
}

#[test]
fn at_every_distance_the_middle_pixel_is_the_parallel_one_s() {
    for mode in Mode::ALL {
        let (volume, mut parallel) = ball(mode);
        (parallel.image.width_px, parallel.image.height_px) = (1, 1);
        let expected = render(&volume, &parallel, 0.7);
        let along = parallel.view.frame().unwrap().direction;
        let centre = DVec3::splat(11.5) * DVec3::from(volume.spacing);
        for distance in [1e2, 1e9, 1e12] {
            let mut seen = parallel.clone();
            seen.image.pixel_size_voxel = None;
            seen.view.perspective = Some(Perspective { distance_voxel: Some(distance), ..Perspective::new(0.001) });
            let got = render(&volume, &seen, 0.7);
            assert_eq!(got.samples, expected.samples);
            let error = largest_difference(&got.picture.pixels, &expected.picture.pixels);
            assert!(error < 1e-8, "{mode} from {distance}: {error:e}");
            // Given as a place, the eye has the digits that a coordinate of its size has.
            let eye = (centre - along * distance * 0.9) / DVec3::from(volume.spacing);
            seen.view.perspective = Some(from_eye(0.001, eye.to_array()));
            let error = largest_difference(&render(&volume, &seen, 0.7).picture.pixels, &expected.picture.pixels);
            assert!(error < 1e-8 + 1e-15 * distance, "{mode} from {distance}: {error:e}");
        }
    }
}

#[test]
fn twice_the_distance_is_half_as_far_from_the_parallel_picture() {
    let (volume, parallel) = ball(Mode::WeightedSum);
    let expected = render(&volume, &parallel, 0.1);
    let errors = [1e3, 2e3, 4e3, 8e3].map(|distance| {
        let got = render(&volume, &from_distance(&parallel, distance), 0.1);
        largest_difference(&got.picture.pixels, &expected.picture.pixels)
    });
    for pair in errors.windows(2) {
        assert!((1.8..2.2).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

#[test]
fn a_sphere_is_as_large_as_its_closed_form_says() {
    let radius = 26.0;
    let parameters = PhantomParams { ramp: Some(1.0), radius: Some(radius), ..PhantomParams::default() };
    let volume = Phantom::Sphere.generate(64, &parameters).unwrap();
    let half = f64::from(u16::MAX) * 0.5;
    for (distance, field_of_view_deg) in [(40.0, 110.0), (80.0, 60.0), (160.0, 25.0), (320.0, 10.0), (1e4, 0.5)] {
        let perspective = Perspective { distance_voxel: Some(distance), ..Perspective::new(field_of_view_deg) };
        let seen = Scene {
            transfer: Transfer { opaque_alpha: 1.0, ..opacity(&[[half, 0.0], [half, 1.0]]) },
            mode: Mode::FirstOpaque,
            material: flat(),
            ..scene(View::from_angles(30.0, 20.0), perspective, [301, 201])
        };
        let picture = render(&volume, &seen, 0.1);
        // From the middle of the picture to the edge of the sphere, in pixels: the tangent of asin(r/d).
        let tangent = f64::tan((radius / distance).asin());
        let expected = tangent / (field_of_view_deg / 2.0).to_radians().tan() * 100.5;
        assert!(expected > 20.0 && expected < 100.0);
        let lit = |column: usize, row: usize| picture.picture.pixels[row * 301 + column][0] > 0.5;
        let width = (0..301).filter(|&column| lit(column, 100)).count() as f64;
        let height = (0..201).filter(|&row| lit(150, row)).count() as f64;
        for across in [width, height] {
            assert!((across * 0.5 - expected).abs() < 1.0, "{across} across, not {} at {distance}", 2.0 * expected);
        }
    }
}

#[test]
fn a_homogeneous_cube_around_the_eye_has_the_depth_of_each_chord() {
    let volume = Volume::from_fn([33; 3], [1.0; 3], |_, _, _| 100_u8).unwrap();
    let (alpha, step) = (0.05, 0.25);
    for (view, field_of_view_deg, eye) in [
        (ahead(), 90.0, [16.0; 3]),
        (View::from_angles(33.0, -21.0), 60.0, [16.0; 3]),
        (View::from_angles(-120.0, 75.0), 170.0, [16.0; 3]),
        (View::from_angles(45.0, 30.0), 120.0, [3.3, 30.1, 17.0]),
    ] {
        let seen = Scene {
            transfer: opacity(&[[0.0, alpha]]),
            material: flat(),
            ..scene(view, from_eye(field_of_view_deg, eye), [40, 30])
        };
        let picture = render(&volume, &seen, step);
        for (pixel, ray) in picture.picture.pixels.iter().zip(rays(&volume, &seen)) {
            let chord = (0..3)
                .map(|i| (if ray[i] > 0.0 { 32.0 - eye[i] } else { -eye[i] }) / ray[i])
                .fold(f64::INFINITY, f64::min);
            let transmittance = |length: f64| f64::powf(1.0 - alpha, length);
            let got = 1.0 - pixel[0];
            assert!((got / transmittance(chord) - 1.0).abs() < 1e-9, "{got} after {chord}");
        }
    }
}

#[test]
fn nothing_behind_the_eye_is_seen() {
    let far_side = |y: usize| y >= 16;
    let volume = Volume::from_fn([24; 3], [1.0; 3], |_, y, _| if far_side(y) { 0_u8 } else { 255 }).unwrap();
    let noisy =
        Volume::from_fn(
            [24; 3],
            [1.0; 3],
            |x, y, z| {
                if far_side(y) { 0_u8 } else { (common::hash(4, [x, y, z]) * 255.0) as u8 }
            },
        )
        .unwrap();
    for eye in [[11.5, 18.0, 11.5], [3.0, 17.5, 20.25], [11.0, 23.0, 0.0], [11.0, 40.0, 11.0]] {
        for field_of_view_deg in [40.0, 120.0, 179.0] {
            for mode in Mode::ALL {
                let looking = |view| Scene { mode, ..scene(view, from_eye(field_of_view_deg, eye), [21, 21]) };
                let away = render(&volume, &looking(ahead()), 0.5);
                assert!(away.picture.pixels.iter().all(|pixel| *pixel == [0.0; 3]), "{mode} from {eye:?}");
                assert_eq!(away, render(&noisy, &looking(ahead()), 0.5));
                let towards = render(&volume, &looking(View::from_angles(180.0, 0.0)), 0.5);
                let seen = towards.picture.pixels.iter().any(|pixel| pixel[0] > 0.1);
                // The smallest value is the clear one in front of the block.
                assert_eq!(seen, mode != Mode::Minimum, "{mode} from {eye:?}");
            }
        }
    }
}

#[test]
fn light_from_the_eye_shines_along_each_ray() {
    // A wall across the view: its normal is −y everywhere, and the ray's slope is its angle to it.
    let volume = affine([41, 21, 41], [1.0; 3], [0.0, 10.0, 0.0], 0.0);
    let transfer = Transfer { opaque_alpha: 1.0, ..opacity(&[[100.0, 0.0], [100.0, 1.0]]) };
    let to_light = [2.0, -1.0, 0.5];
    let sun = Light { direction: Some(to_light), colour: [0.5, 1.0, 0.25] };
    for lights in [vec![Light::default()], vec![sun.clone()], vec![sun, Light::default()]] {
        let mut seen = scene(ahead(), from_eye(80.0, [20.0, 2.0, 20.0]), [31, 31]);
        (seen.mode, seen.transfer, seen.lights) = (Mode::FirstOpaque, transfer.clone(), lights);
        let picture = render(&volume, &seen, 0.1);
        for (pixel, ray) in picture.picture.pixels.iter().zip(rays(&volume, &seen)) {
            let normal = DVec3::NEG_Y;
            let mut expected = [0.1; 3];
            for light in &seen.lights {
                let towards = light.direction.map_or(-ray, |direction| unit_vector(direction.into()).unwrap());
                let halfway = (towards - ray).normalize();
                let (diffuse, specular) = (0.7 * normal.dot(towards), 0.2 * normal.dot(halfway).abs().powi(10));
                for (sum, colour) in expected.iter_mut().zip(light.colour) {
                    *sum += colour * (diffuse + specular);
                }
            }
            let error = (0..3).map(|i| (pixel[i] - expected[i].min(1.0)).abs()).fold(0.0, f64::max);
            assert!(error < 1e-12, "{pixel:?}, not {expected:?} along {ray}");
        }
    }
}

#[test]
fn a_cue_is_of_depth_along_the_view_and_not_of_distance() {
    let volume = Volume::from_fn([41; 3], [1.0; 3], |_, _, _| 200_u8).unwrap();
    let seen = Scene {
        mode: Mode::FirstOpaque,
        material: flat(),
        cuts: vec![Cut { normal: [0.0, -1.0, 0.0], through_voxel: [0.0, 10.0, 0.0] }],
        depth_cue: Some(DepthCue { front: 1.0, back: 0.0 }),
        ..scene(ahead(), from_eye(80.0, [20.0, -4.0, 20.0]), [31, 31])
    };
    let step = 0.01;
    for pixel in render(&volume, &seen, step).picture.pixels {
        assert!((0.75 - step / 40.0..=0.75).contains(&pixel[0]), "{pixel:?}");
    }
}

#[test]
fn in_a_weighted_sum_every_ray_across_the_planes_sees_as_much() {
    let n = 41;
    let volume = Volume::from_fn([n; 3], [1.0; 3], |_, _, _| 200_u8).unwrap();
    let (alpha, step) = (0.4, 0.01);
    for perspective in [from_eye(70.0, [20.0, -60.0, 20.0]), from_eye(25.0, [70.0, -300.0, 20.0])] {
        let seen = Scene {
            mode: Mode::WeightedSum,
            transfer: opacity(&[[0.0, alpha]]),
            ..scene(ahead(), perspective, [31, 31])
        };
        let picture = render(&volume, &seen, step);
        let mut through = 0;
        for (pixel, ray) in picture.picture.pixels.iter().zip(rays(&volume, &seen)) {
            let eye = DVec3::from(perspective.eye_voxel.unwrap());
            let inside = |y: f64| {
                let at = eye + ray * ((y - eye.y) / ray.y);
                [at.x, at.z].iter().all(|c| (0.0..=40.0).contains(c))
            };
            if inside(0.0) && inside(40.0) {
                assert!((pixel[0] - alpha).abs() < 1e-9, "{pixel:?}, not {alpha}");
                through += 1;
            }
        }
        assert!(through > 50, "{through} rays go through");
    }
}

#[test]
fn eyes_anywhere_give_a_picture() {
    let eyes = [
        [3.5, 3.0, 2.5],
        [3.0, 2.0, 4.0],
        [0.0, 0.0, 0.0],
        [7.0, 3.0, 2.5],
        [7.0, 6.0, 5.0],
        [3.3, 0.0, 2.0],
        [-0.5, 3.0, 2.0],
        [1e9, 0.0, -3.0],
        [-1e12, 1e12, 1e12],
        [3.5, -1e12, 2.5],
        [f64::MIN_POSITIVE, -0.0, 1e-300],
    ];
    let volumes = [
        noise([8, 7, 6], [1.0; 3], 3),
        noise([8, 7, 6], [1e-3, 1.0, 0.03], 3),
        noise([8, 1, 6], [1.0, 1000.0, 1.0], 3),
        noise([1; 3], [1.0; 3], 3),
    ];
    let views = [ahead(), View::from_angles(90.0, 0.0), View::from_angles(30.0, 7.0), View::from_angles(0.0, -90.0)];
    let places = eyes.map(|eye| (Some(eye), None)).into_iter();
    let places = places.chain([None, Some(0.0), Some(1.0), Some(1e12)].map(|distance| (None, distance)));
    for (eye_voxel, distance_voxel) in places {
        for field_of_view_deg in [0.001, 60.0, 179.0] {
            let perspective = Perspective { field_of_view_deg, eye_voxel, distance_voxel };
            for (volume, view) in volumes.iter().flat_map(|volume| views.iter().map(move |view| (volume, view))) {
                for mode in Mode::ALL {
                    let seen = Scene {
                        mode,
                        depth_cue: Some(DepthCue::default()),
                        ..scene(view.clone(), perspective, [7, 5])
                    };
                    let picture = render(volume, &seen, 1.3);
                    assert_eq!(picture.picture.pixels.len(), 35);
                    let sane = picture.picture.pixels.iter().flatten().all(|c| (0.0..=1.0 + 1e-12).contains(c));
                    assert!(sane, "{perspective:?}, {mode}");
                }
            }
        }
    }
}

#[test]
fn an_eye_on_a_face_sees_the_whole_way_inwards_and_the_face_outwards() {
    for n in [2, 9, 12] {
        let last = (n - 1) as f64;
        for spacing in [1.0, 0.1, 1.0 / 3.0] {
            let volume = noise([n; 3], [spacing; 3], 5);
            let eye = from_eye(30.0, [last * 0.5, 0.0, last * 0.5]);
            for (yaw, samples) in [(0.0, n as u64), (180.0, 1)] {
                let seen = scene(View::from_angles(yaw, 0.0), eye, [1, 1]);
                let seen = Scene { mode: Mode::Maximum, ..seen };
                assert_eq!(render(&volume, &seen, 1.0).samples, samples, "{n} voxels of {spacing}, yaw {yaw}");
            }
        }
    }
}

#[test]
fn twice_as_large_voxels_seen_from_twice_as_far_change_no_bit() {
    let [small, large] = [1.0, 2.0].map(|scale| noise([12, 9, 10], [scale, 1.25 * scale, 0.75 * scale], 8));
    for eye_voxel in [None, Some([5.0, 4.0, 6.5]), Some([30.0, -20.0, 9.0])] {
        let perspective = Perspective { eye_voxel, ..Perspective::new(50.0) };
        let seen = scene(View::from_angles(20.0, 10.0), perspective, [19, 23]);
        assert_eq!(render(&small, &seen, 0.5), render(&large, &seen, 0.5));
    }
}

#[test]
fn a_wider_picture_of_the_same_field_of_view_shows_the_same_in_its_middle() {
    let volume = noise([16; 3], [1.0; 3], 8);
    let perspective = from_eye(50.0, [20.0, -20.0, 9.0]);
    let [narrow, wide] = [21, 35].map(|width| {
        let seen = scene(View::from_angles(20.0, 10.0), perspective, [width, 21]);
        render(&volume, &seen, 0.5)
    });
    for row in 0..21 {
        assert_eq!(narrow.picture.pixels[row * 21..][..21], wide.picture.pixels[row * 35 + 7..][..21]);
    }
}

#[test]
fn thin_and_full_opacity_are_the_eyes_too() {
    let volume = noise([12; 3], [1.0; 3], 9);
    let perspective = from_eye(60.0, [5.0; 3]);
    let full = Scene { transfer: opacity(&[[0.0, 1.0]]), ..scene(ahead(), perspective, [15, 15]) };
    let first = render(&volume, &Scene { mode: Mode::FirstOpaque, ..full.clone() }, 0.5);
    let full = render(&volume, &full, 0.5);
    assert_eq!((full.samples, full.picture.pixels), (15 * 15, first.picture.pixels));
    // A single voxel is one thick; straight ahead of its centre there is half of it.
    let voxel = Volume::from_fn([1; 3], [1.0; 3], |_, _, _| 200_u8).unwrap();
    let thin = Scene {
        transfer: opacity(&[[0.0, 0.3]]),
        material: flat(),
        ..scene(ahead(), from_eye(60.0, [0.0; 3]), [3, 3])
    };
    for step in [0.1, 0.2, 0.5, 7.0] {
        let got = render(&voxel, &thin, step).picture.pixels[4][0];
        assert!((got - corrected_opacity(0.3, 0.5)).abs() < 1e-15, "{got} at steps of {step}");
    }
}
