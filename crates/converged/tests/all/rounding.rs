//! Scenes in which rounding is most of the error: values far from 0, normals that nearly vanish, lights along surfaces, opacity that is full at
//! a single place. What the bound says of rounding is true there, or it is seen.

use crate::exact::{Chord, ROUNDED, hold, hold_to, integral, layered, made, over, seen, unlit, views, volume};
use cube3_scene::{Image, Light, Material, Mode, Scene, View};
use cube3_volume::Volume;
use glam::DVec3;

const COLOUR: [f64; 3] = [0.9, 0.3, 0.0];
const SLOPE: DVec3 = DVec3::new(1.0 / 16.0, 1.0 / 8.0, 1.0 / 32.0);

/// So far from 0 values have 12 bits below 1.
const FAR: f64 = (1_u64 << 40) as f64;

/// A ramp of values beyond [`FAR`], which are exact.
fn far() -> Volume {
    volume([5, 7, 5], [1.0; 3], |at| FAR + at.dot(SLOPE))
}

#[test]
fn values_far_from_zero_have_few_digits_and_a_bound_that_says_so() {
    let (dark, bright) = ([0.1, 0.8, 0.0], [1.0, 0.2, 0.5]);
    let volume = far();
    for view in views() {
        for (alphas, dark) in [([0.0, 0.7], dark), ([0.4, 0.4], dark), ([0.9, 0.2], dark), ([0.0, 0.9], bright)] {
            let opacity = vec![[FAR, alphas[0]], [FAR + 1.5, alphas[1]]];
            let scene = unlit(&view, opacity, &[(FAR, dark), (FAR + 1.5, bright)]);
            hold_to(1.0, &format!("far, {alphas:?}"), &volume, &scene, |pixel| {
                let Some(chord) = Chord::whole(&volume, &scene, pixel) else { return (scene.background, 0.0) };
                let share = |t: f64| SLOPE.dot(chord.at(t)) / 1.5;
                let rgb = |t: f64| [0, 1, 2].map(|i| dark[i] + (bright[i] - dark[i]) * share(t));
                let alpha = |t: f64| alphas[0] + (alphas[1] - alphas[0]) * share(t);
                let (colour, left) = seen(alpha, rgb, chord.length, 60);
                (over(colour, left, scene.background), 1e-13)
            });
            let scene = Scene { mode: Mode::WeightedSum, background: [0.0; 3], ..scene };
            hold_to(1.0, &format!("far sum, {alphas:?}"), &volume, &scene, |pixel| {
                let Some(chord) = Chord::whole(&volume, &scene, pixel) else { return ([0.0; 3], 0.0) };
                let share = |t: f64| SLOPE.dot(chord.at(t)) / 1.5;
                let light = |t: f64| {
                    let alpha = alphas[0] + (alphas[1] - alphas[0]) * share(t);
                    [0, 1, 2].map(|i| alpha * (dark[i] + (bright[i] - dark[i]) * share(t)))
                };
                let direction = scene.view.frame().unwrap().direction;
                let axis = (0..3).max_by(|&a, &b| direction[a].abs().total_cmp(&direction[b].abs())).unwrap();
                let weight = chord.along[axis].abs() / (volume.dims[axis] - 1) as f64;
                (integral(light, [0.0, chord.length], 1).map(|c| c * weight), 1e-13)
            });
        }
    }
}

/// Where nothing can be known a ray is split to the last: two pixels are enough.
fn few(view: &View) -> Image {
    Image { width_px: 2, height_px: 1, pixel_size_voxel: view.perspective.is_none().then_some(0.93) }
}

#[test]
fn a_step_of_values_far_from_zero_is_somewhere_near() {
    let volume = far();
    for view in views().into_iter().skip(2).step_by(3) {
        // At the value of a voxel, and between two.
        for step in [0.5, 0.61] {
            let unlit = unlit(&view, vec![[FAR + step, 0.0], [FAR + step, 0.9]], &[(0.0, COLOUR)]);
            let scene = Scene { image: few(&view), ..unlit };
            // The scene's step is the nearest value that there is.
            let step = FAR + step - FAR;
            hold_to(1.0, &format!("far step {step}"), &volume, &scene, |pixel| {
                let Some(chord) = Chord::whole(&volume, &scene, pixel) else { return (scene.background, 0.0) };
                let (start, rate) = (SLOPE.dot(chord.from), SLOPE.dot(chord.along));
                let at = ((step - start) / rate).clamp(0.0, chord.length);
                let length = if rate > 0.0 { chord.length - at } else { at };
                let (colour, left) = layered([(length, 0.9, COLOUR)]);
                (over(colour, left, scene.background), 1e-13 / rate.abs())
            });
        }
    }
}

#[test]
fn a_bound_is_never_below_rounding() {
    let volume = volume([5, 4, 6], [1.0; 3], |_| 7.0);
    for alpha in [1e-30, 0.3, 1.0 - 1e-12] {
        for view in views() {
            for mode in [Mode::Composite, Mode::WeightedSum] {
                let scene = Scene { mode, ..unlit(&view, vec![[0.0, alpha]], &[(0.0, COLOUR)]) };
                let made = made(&volume, &scene, 1e-13);
                for (i, bound) in made.bounds.iter().enumerate() {
                    let meets = Chord::whole(&volume, &scene, [i % 4, i / 4]).is_some();
                    assert!(!meets || (f64::EPSILON..1e-10).contains(bound), "{alpha}, {mode:?}: {bound:e}");
                }
            }
        }
    }
}

#[test]
fn a_faint_ramp_has_all_its_digits() {
    let volume = volume([5, 7, 5], [1.0; 3], |at| at.dot(SLOPE));
    for view in views() {
        for faint in [1e-30, 1e-200] {
            let unlit = unlit(&view, vec![[0.0, 0.0], [1.5, faint]], &[(0.0, COLOUR)]);
            let scene = Scene { background: [0.0; 3], ..unlit };
            let made = made(&volume, &scene, 1e-6);
            for (i, pixel) in made.picture.pixels.iter().enumerate() {
                let Some(chord) = Chord::whole(&volume, &scene, [i % 4, i / 4]) else { continue };
                let exact = COLOUR[0] * faint * SLOPE.dot(chord.at(chord.length / 2.0)) / 1.5 * chord.length;
                assert!((pixel[0] / exact - 1.0).abs() < 1e-12, "{faint:e}: {}, not {exact:e}", pixel[0]);
            }
        }
    }
}

/// The picture of a side, lit by one light alone.
fn one_sided(view: &View, towards: DVec3) -> Scene {
    let material =
        Material { shaded: true, ambient: 0.1, diffuse: 0.0, specular: 0.8, shininess: 2.0, two_sided: false };
    let light = Light { direction: Some(towards.to_array()), colour: [1.0; 3] };
    let mut scene = Scene { material, lights: vec![light], ..unlit(view, vec![[0.0, 0.5]], &[(0.0, COLOUR)]) };
    scene.crop = Some(cube3_scene::Crop { min_voxel: [1.0; 3], max_voxel: [4.0; 3] });
    scene.image = few(view);
    scene
}

#[test]
fn a_light_along_a_one_sided_surface_may_be_mirrored_or_not() {
    let mut open = 0;
    for i in (0..60).step_by(10) {
        // Slopes and lights of which rounding says on which side they are.
        let slope = DVec3::new(0.1 + 0.013 * f64::from(i), 0.7 - 0.01 * f64::from(i), 0.3 + 0.02 * f64::from(i % 7));
        let volume = volume([6; 3], [1.0; 3], |at| 0.1 * at.dot(slope));
        let view = View::from_direction((slope + 0.3 * slope.any_orthogonal_vector()).to_array(), None);
        let towards = slope.cross(DVec3::new(0.3, f64::from(i % 5) - 2.2, 1.0)).normalize();
        let scene = one_sided(&view, towards);
        let made = made(&volume, &scene, 1e-3);
        let ray = scene.view.frame().unwrap().direction;
        let highlight = 0.8 * (-slope).normalize().dot((towards - ray).normalize()).max(0.0).powi(2);
        for (k, (pixel, bound)) in made.picture.pixels.iter().zip(&made.bounds).enumerate() {
            let inner = [DVec3::ONE, DVec3::splat(4.0)];
            let Some(chord) = Chord::new(&volume, &scene, [k, 0], inner) else { continue };
            let of = |highlight: f64| {
                let (colour, left) = layered([(chord.length, 0.5, COLOUR.map(|c| 0.1 * c + highlight))]);
                over(colour, left, scene.background)
            };
            let apart = |form: [f64; 3]| (0..3).map(|i| (pixel[i] - form[i]).abs()).fold(0.0, f64::max);
            let (lit, dark) = (apart(of(highlight)), apart(of(0.0)));
            // Which of both it is no number tells, and the bound knows neither.
            assert!(lit <= bound + 1e-12 && dark <= bound + 1e-12, "{i}, {k}: {lit:e} or {dark:e} above {bound:e}");
            open += u32::from(highlight > 0.1);
        }
    }
    assert!(open > 5, "{open}");
}

#[test]
fn a_normal_that_nearly_vanishes_is_as_wrong_as_its_bound_says() {
    for apart in [1e-4, 1e-6, 1e-8] {
        let image = Image { width_px: 2, height_px: 2, pixel_size_voxel: Some(1.0 / 3.0) };
        // Of the lower left ray: it passes the line on which the gradient is 0 by so little, and samples are exact.
        let near = |x: f64| ((2.5 - 1.0 / 6.0 + x) * f64::from(1 << 24)).round() / f64::from(1 << 24);
        let (a, b) = (near(apart), near(-0.7 * apart));
        let volume = volume([6; 3], [1.0; 3], |at| (at.x - a) * (at.z - b));
        for (shininess, specular) in [(300.0, 0.4), (10.0, 0.3), (1.0, 0.0)] {
            let view = View::from_direction([0.0, 1.0, 0.0], None);
            let material = Material { shaded: true, ambient: 0.1, diffuse: 0.5, specular, shininess, two_sided: true };
            let light = Light { direction: Some([-0.8, -1.0, 0.5]), colour: [1.0; 3] };
            let unlit = unlit(&view, vec![[0.0, 0.5]], &[(0.0, COLOUR)]);
            let mut scene = Scene { material, lights: vec![light], image: image.clone(), ..unlit };
            scene.crop = Some(cube3_scene::Crop { min_voxel: [1.0; 3], max_voxel: [4.0; 3] });
            for tolerance in [1e-6, 1e-9, 1e-12] {
                let made = made(&volume, &scene, tolerance);
                let chord = Chord::new(&volume, &scene, [0, 1], [DVec3::ONE, DVec3::splat(4.0)]).unwrap();
                // Differences of near numbers are exact.
                let normal = DVec3::new(chord.from.z - b, 0.0, chord.from.x - a).normalize();
                let towards = DVec3::new(-0.8, -1.0, 0.5).normalize();
                let halfway = (towards + DVec3::NEG_Y).normalize();
                let highlight = specular * normal.dot(halfway).abs().powf(shininess);
                let lit = COLOUR.map(|c| (0.1 + 0.5 * normal.dot(towards).abs()) * c + highlight);
                let (colour, left) = layered([(chord.length, 0.5, lit)]);
                let exact = over(colour, left, scene.background);
                let error = (0..3).map(|i| (made.picture.pixels[2][i] - exact[i]).abs()).fold(0.0, f64::max);
                let bound = made.bounds[2];
                assert!(error <= bound + 300.0 * ROUNDED, "{apart:e}, {shininess}: {error:e} above {bound:e}");
            }
        }
    }
}

#[test]
fn full_opacity_at_a_cubic_zero_is_hidden_by_its_logarithm() {
    // x·y·z along the diagonal is the cube of the way, and opacity one minus it; so short a way that most is seen through it.
    let volume = volume([3; 3], [1.0; 3], |at| at.x * at.y * at.z);
    let view = View::from_direction([1.0; 3], None);
    for side in [0.02_f64, 0.1, 0.4] {
        let opacity = vec![[-1.0, 0.0], [0.0, 1.0], [side.powi(3), 0.0]];
        let unlit = unlit(&view, opacity, &[(0.0, [1.0; 3])]);
        let mut scene = Scene { image: Image { width_px: 1, height_px: 1, pixel_size_voxel: None }, ..unlit };
        scene.crop = Some(cube3_scene::Crop { min_voxel: [0.0; 3], max_voxel: [side; 3] });
        for tolerance in (1..=8).map(|i| 0.3 / 1.6_f64.powi(i)) {
            let made = made(&volume, &scene, tolerance);
            // ∫ −ln((t/L)³) dt over L.
            let left = (-3.0 * side * 3.0_f64.sqrt()).exp();
            let exact = over([1.0 - left; 3], left, scene.background);
            let error = (0..3).map(|i| (made.picture.pixels[0][i] - exact[i]).abs()).fold(0.0, f64::max);
            assert!(error <= made.bounds[0], "{side} at {tolerance:e}: {error:e} above {:e}", made.bounds[0]);
        }
    }
}

#[test]
fn a_weighted_sum_of_labels_is_over_all_of_their_voxels() {
    let volume = volume([3, 4, 5], [1.0, 1.5, 1.0], |_| 1.0);
    for view in views() {
        let unlit = unlit(&view, vec![[0.0, 0.6]], &[(0.0, COLOUR)]);
        let mut scene = Scene { mode: Mode::WeightedSum, background: [0.0; 3], ..unlit };
        scene.volume.labels = true;
        hold("labels in a sum", &volume, &scene, |pixel| {
            let box_of = [DVec3::splat(-0.5), DVec3::from(volume.dims.map(|n| n as f64 - 0.5))];
            let Some(chord) = Chord::new(&volume, &scene, pixel, box_of) else { return ([0.0; 3], 0.0) };
            let direction = scene.view.frame().unwrap().direction / DVec3::from(volume.spacing);
            let axis = (0..3).max_by(|&a, &b| direction[a].abs().total_cmp(&direction[b].abs())).unwrap();
            let weight = chord.along[axis].abs() / volume.dims[axis] as f64;
            (COLOUR.map(|c| c * 0.6 * chord.length * weight), ROUNDED + chord.slack)
        });
    }
}
