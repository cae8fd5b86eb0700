//! What is lost between voxels: values and gradients of `image_order` beside the fields that the voxels were taken from.
//!
//! A plane of samples is read out of a picture: a crop box without thickness leaves each ray one sample, in a mode that chooses one. The colour is
//! then the value, the light of three lamps the normal, or the opacity the gradient's magnitude.

use crate::common::order::{assert_order, order};
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_scene::{ColourPoint, Crop, Image, ImagePlane, Layer, Light, Material, Mode, Scene, Transfer, View};
use cube3_volume::{Phantom, PhantomParams, Volume};
use glam::DVec3;
use std::f64::consts::PI;

/// Pixels along each side of a plane of samples: odd, so that one is in the middle, and prime, so that they are everywhere in their cells.
const PIXELS: u32 = 101;

/// The samples of the plane y = `plane`, in voxels, of what is `shown`: each with its place in voxels. Pixels beyond the volume are left out.
fn samples(volume: &Volume, plane: f64, shown: Scene) -> Vec<(DVec3, [f64; 3])> {
    let [nx, ny, nz] = volume.dims;
    let top = [nx, ny, nz].map(|n| (n - 1) as f64);
    let scene = Scene {
        view: View::from_angles(0.0, 0.0),
        image: Image { width_px: PIXELS, height_px: PIXELS, pixel_size_voxel: Some(top[0] / f64::from(PIXELS)) },
        crop: Some(Crop { min_voxel: [0.0, plane, 0.0], max_voxel: [top[0], plane, top[2]] }),
        ..shown
    };
    let view = scene.view.frame().unwrap();
    let image = ImagePlane::new(&scene, &view, volume.dims, volume.spacing);
    let picture = image_order(volume, &scene, &ImageOrderOptions::default(), None).unwrap().picture;
    let place = |at: usize| {
        let point = image.point((at % picture.width) as f64, (at / picture.width) as f64);
        let voxel = point / DVec3::from(volume.spacing);
        DVec3::new(voxel.x, plane, voxel.z)
    };
    picture.pixels.iter().enumerate().map(|(at, pixel)| (place(at), *pixel)).collect()
}

fn grey(value: f64, c: f64) -> ColourPoint {
    ColourPoint { value, rgb: [c; 3] }
}

/// The interpolated values, which lie in `range`.
fn values(volume: &Volume, plane: f64, [low, high]: [f64; 2]) -> Vec<(DVec3, f64)> {
    let transfer =
        Transfer { opacity: vec![[0.0, 1.0]], colour: vec![grey(low, 0.0), grey(high, 1.0)], ..Transfer::default() };
    let shown = Scene { mode: Mode::Maximum, transfer, ..Scene::default() };
    samples(volume, plane, shown).into_iter().map(|(at, [red, ..])| (at, low + (high - low) * red)).collect()
}

/// −∇f/|∇f|, of which no component is below 0: three lamps along the axes, in red, green and blue.
fn normals(volume: &Volume, plane: f64) -> Vec<(DVec3, DVec3)> {
    let lamp = |axis: usize| {
        let mut unit = [0.0; 3];
        unit[axis] = 1.0;
        Light { direction: Some(unit), colour: unit }
    };
    let shown = Scene {
        mode: Mode::FirstOpaque,
        transfer: Transfer { opacity: vec![[0.0, 1.0]], ..Transfer::default() },
        material: Material { ambient: 0.0, diffuse: 1.0, specular: 0.0, two_sided: false, ..Material::default() },
        lights: vec![lamp(0), lamp(1), lamp(2)],
        ..Scene::default()
    };
    samples(volume, plane, shown).into_iter().map(|(at, rgb)| (at, rgb.into())).collect()
}

/// |∇f| a voxel, up to `most`: opacity that is linear in it.
fn magnitudes(volume: &Volume, plane: f64, most: f64) -> Vec<f64> {
    let layer = |gradient: f64, opacity: f64| Layer { gradient, opacity: vec![[0.0, opacity]] };
    let transfer = Transfer { layers: vec![layer(0.0, 0.0), layer(most, 1.0)], opacity: vec![], ..Transfer::default() };
    let shown = Scene { mode: Mode::Maximum, transfer, ..Scene::default() };
    samples(volume, plane, shown).into_iter().map(|(_, [red, ..])| red * most).collect()
}

/// A smooth field over the unit cube that falls along every axis.
fn field(at: DVec3) -> f64 {
    250.0 - 30.0 * (0.9 * at.x + 0.4 * at.y).exp() - 40.0 * (1.1 * at.y + 0.3 * at.z + 0.2).sin() * (1.0 + at.z)
}

fn field_gradient(at: DVec3) -> DVec3 {
    let growth = 30.0 * (0.9 * at.x + 0.4 * at.y).exp();
    let phase = 1.1 * at.y + 0.3 * at.z + 0.2;
    let (wave, slope) = (40.0 * phase.sin(), 40.0 * phase.cos() * (1.0 + at.z));
    -DVec3::new(0.9 * growth, 0.4 * growth + 1.1 * slope, 0.3 * slope + wave)
}

/// The field over n + 1 voxels along each side.
fn sampled(n: usize) -> Volume {
    let place = |i: usize| i as f64 / n as f64;
    Volume::from_fn([n + 1; 3], [1.0 / n as f64; 3], |x, y, z| field(DVec3::new(place(x), place(y), place(z)))).unwrap()
}

const SIDES: [usize; 3] = [16, 32, 64];

/// Planes of the unit cube, everywhere in their cells too.
fn planes() -> impl Iterator<Item = f64> {
    (0..13).map(|i| 0.15 + 0.7 * (f64::from(i) + 0.37) / 13.0)
}

fn spacings() -> [f64; 3] {
    SIDES.map(|n| 1.0 / n as f64)
}

/// Errors of the field over n voxels: of the value, of the gradient in its largest magnitude, both as root of the mean square, and the mean angle in
/// degrees. Two voxels from the border, where what is beyond is another field.
fn errors(n: usize) -> [f64; 3] {
    let (volume, side) = (sampled(n), n as f64);
    let inner = |at: DVec3| at.min_element() > 2.0 / 16.0 && at.max_element() < 1.0 - 2.0 / 16.0;
    let [mut value, mut gradient, mut angle] = [0.0; 3];
    let mut count = 0.0;
    for plane in planes() {
        let most = 300.0 / side;
        let all = normals(&volume, plane * side).into_iter().zip(magnitudes(&volume, plane * side, most));
        for (((at, normal), magnitude), (_, got)) in all.zip(values(&volume, plane * side, [0.0, 255.0])) {
            let at = at / side;
            if inner(at) {
                let truth = field_gradient(at);
                value += (got - field(at)).powi(2);
                gradient += (-normal * magnitude * side - truth).length_squared();
                angle += normal.angle_between(-truth).to_degrees();
                count += 1.0;
            }
        }
    }
    assert!(count > 1000.0);
    [(value / count).sqrt(), (gradient / count).sqrt(), angle / count]
}

#[test]
fn values_and_gradients_of_a_smooth_field_are_of_the_second_order() {
    let all = SIDES.map(errors);
    for (i, what) in ["value", "gradient", "angle"].into_iter().enumerate() {
        assert_order(what, &spacings(), &all.map(|errors| errors[i]), 2.0, 0.05);
    }
    // Levels: of the value 1/8 of the second derivatives at most, of the gradient as much of the third, and more.
    assert!(all[2][0] < 0.01 && all[2][1] < 0.05 && all[2][2] < 0.02, "{all:?}");
}

/// On a field x³ the central difference is 3x² + h², and trilinear interpolation is above a parabola by h²·w·(1 − w)·f''/2: the gradient
/// along x at the place w of a cell is 3x² + h² + 3·w·(1 − w)·h², exactly.
#[test]
fn a_cubics_gradient_is_wrong_by_its_closed_form() {
    let n = 16;
    let volume = Volume::from_fn([n + 1; 3], [1.0; 3], |x, _, _| (x as f64).powi(3)).unwrap();
    let most = 3.0 * (n * n) as f64;
    let got = magnitudes(&volume, 7.3, most);
    let places = values(&volume, 7.3, [0.0, (n as f64).powi(3)]);
    for ((at, _), got) in places.iter().zip(&got).filter(|((at, _), _)| at.x > 1.0 && at.x < n as f64 - 1.0) {
        let (corner, w) = (at.x.floor(), at.x.fract());
        let expected = 3.0 * at.x * at.x + 1.0 + 3.0 * w * (1.0 - w);
        // y and z are inside as well, so their components are 0.
        if at.z > 1.0 && at.z < n as f64 - 1.0 {
            assert!((got - expected).abs() < 1e-9, "{got}, not {expected} at {at} in cell {corner}");
        }
    }
}

/// cos of k waves over n intervals, a crest halfway between two voxels: at the crest linear interpolation gives cos(πk/n), and nowhere is it farther
/// off.
#[test]
fn a_sinusoids_largest_error_has_its_closed_form() {
    for (n, k) in [(15, 1.0), (31, 1.0), (63, 1.0), (127, 1.0), (47, 8.0), (47, 20.0), (23, 11.0)] {
        let extent = f64::from(n);
        let wave = |x: f64| (2.0 * PI * k / extent * (x - extent / 2.0)).cos();
        let volume = Volume::from_fn([n as usize + 1, 3, n as usize + 1], [1.0; 3], |x, _, _| wave(x as f64)).unwrap();
        let got = values(&volume, 1.0, [-1.0, 1.0]);
        let largest = got.iter().map(|(at, got)| (got - wave(at.x)).abs()).fold(0.0, f64::max);
        let expected = 1.0 - (PI * k / extent).cos();
        assert!((largest - expected).abs() < 1e-12, "{k} waves over {n}: {largest}, not {expected}");
    }
}

/// Marschner and Lobb 1994: ρ(x, y, z) over [−1, 1]³.
fn marschner_lobb(at: DVec3) -> f64 {
    const ALPHA: f64 = 0.25;
    const FREQUENCY: f64 = 6.0;
    let ripple = (2.0 * PI * FREQUENCY * (PI * at.x.hypot(at.y) / 2.0).cos()).cos();
    ((1.0 - (PI * at.z / 2.0).sin()) + ALPHA * (1.0 + ripple)) / (2.0 * (1.0 + ALPHA))
}

/// Root of the mean square and largest error of the signal over n voxels along each side.
fn marschner_lobb_errors(volume: &Volume) -> [f64; 2] {
    let side = (volume.dims[0] - 1) as f64;
    let (mut sum, mut largest, mut count) = (0.0, 0.0_f64, 0.0);
    for plane in 0..61 {
        let plane = (f64::from(plane) + 0.37) / 61.0 * side;
        for (at, got) in values(volume, plane, [0.0, 1.0]) {
            let off = (got - marschner_lobb(at / side * 2.0 - 1.0)).abs();
            (sum, largest, count) = (sum + off * off, largest.max(off), count + 1.0);
        }
    }
    [(sum / count).sqrt(), largest]
}

fn marschner_lobb_volume(n: usize) -> Volume {
    let place = |i: usize| 2.0 * i as f64 / (n - 1) as f64 - 1.0;
    Volume::from_fn([n; 3], [1.0; 3], |x, y, z| marschner_lobb(DVec3::new(place(x), place(y), place(z)))).unwrap()
}

/// 40 voxels along each side, as published, and half the distance, twice.
const SIGNAL_SIDES: [usize; 3] = [40, 79, 157];

#[test]
fn the_marschner_lobb_signal_is_off_by_what_was_measured() {
    let all = SIGNAL_SIDES.map(|n| marschner_lobb_errors(&marschner_lobb_volume(n)));
    println!("{all:?}");
    let phantom = Phantom::MarschnerLobb.generate(40, &PhantomParams::default()).unwrap();
    let of_phantom = marschner_lobb_errors(&phantom);
    assert!((0..2).all(|i| (of_phantom[i] - all[0][i]).abs() < 1e-6), "the phantom is that signal: {of_phantom:?}");
    let [rms, largest] = all[0];
    assert!((rms / 0.0366 - 1.0).abs() < 0.01 && (largest / 0.0905 - 1.0).abs() < 0.01, "{rms}, {largest}");
    // Its shortest wave, 1/(3π) at r = 1, is 2.07 voxels of the 40: there the order does not show yet.
    let orders = [0, 1].map(|i| (all[i][0] / all[i + 1][0]).log2());
    assert!((1.65..1.85).contains(&orders[0]) && (1.9..2.0).contains(&orders[1]), "{orders:?}");
}

/// The tables of the section "Order of convergence" in docs/src/raycast.md.
#[test]
#[ignore = "prints the book's table: cargo test --release -p cube3-reference --test all sampling:: -- --ignored --nocapture"]
fn what_is_lost_between_voxels_as_a_table() {
    let all = SIDES.map(errors);
    println!("| what | order | n = 16 | n = 32 | n = 64 |\n| --- | --- | --- | --- | --- |");
    for (i, what) in ["value, RMS", "gradient, RMS", "its angle, mean degrees"].into_iter().enumerate() {
        let errors = all.map(|errors| errors[i]);
        let shown = errors.map(|error| format!("{error:.2e}")).join(" | ");
        println!("| {what} | {:.2} | {shown} |", order(&spacings(), &errors));
    }
    println!("| Marschner-Lobb | RMS | largest |\n| --- | --- | --- |");
    for n in SIGNAL_SIDES {
        let [rms, largest] = marschner_lobb_errors(&marschner_lobb_volume(n));
        println!("| {n}³ | {rms:.5} | {largest:.4} |");
    }
}
