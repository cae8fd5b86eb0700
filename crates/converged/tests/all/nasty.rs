//! Rays made to be hard: each kind of edge that a transfer function, a volume, a light or an eye can put in the way of a rule for smooth
//! integrands.

use crate::scenes::{Dice, random};
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_scene::{
    ColourPoint, Crop, Cut, DepthCue, Image, Layer, Light, Material, Mode, Perspective, Scene, Threshold, Transfer,
    View,
};
use cube3_volume::{Samples, Volume};

/// A ray: of one pixel of a picture.
pub struct Case {
    pub name: String,
    pub volume: Volume,
    pub scene: Scene,
    pub border: f64,
    pub pixel: [usize; 2],
}

/// Kinds, and how many there are of each.
const KINDS: [(&str, usize); 25] = [
    ("steps", 7),
    ("plateaus", 5),
    ("thin shells", 8),
    ("ramp to one", 8),
    ("step to one", 6),
    ("tent to one", 7),
    ("nearly one", 8),
    ("faint", 4),
    ("alternating shells", 7),
    ("long voxels", 8),
    ("eyes", 9),
    ("axes and diagonals", 8),
    ("linear", 7),
    ("constant", 4),
    ("two levels", 8),
    ("one-sided", 10),
    ("shininess", 8),
    ("clamped", 8),
    ("coloured lights", 4),
    ("layers", 9),
    ("thresholds", 4),
    ("crops and cuts", 6),
    ("cues", 4),
    ("labels", 7),
    ("sums", 8),
];

/// Cases in all; those that are not of a kind are random.
const CASES: usize = 200;

/// Seeds of cases that see nothing, or nothing but the first point of the volume: the next ones take their places.
const PASSED_OVER: [u64; 25] = [
    20, 60, 2010, 3010, 3050, 3060, 4010, 4011, 4020, 4021, 4030, 4031, 4040, 4050, 4051, 5020, 5021, 5040, 14020,
    14021, 14050, 14051, 21040, 24060, 24070,
];

/// All cases, in their order.
pub fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    for (kind, (name, count)) in KINDS.into_iter().enumerate() {
        all.extend((0..count).map(|i| {
            let first = (1000 * kind + 10 * i) as u64;
            made(name, i, (first..).find(|seed| !PASSED_OVER.contains(seed)).unwrap())
        }));
    }
    let random = (0..).filter_map(from_seed).take(CASES - all.len());
    all.extend(random.collect::<Vec<_>>());
    all
}

/// A random scene, if its volume is small enough to be written down and its pixel sees it.
fn from_seed(seed: u64) -> Option<Case> {
    let (volume, scene) = random(seed, 2);
    let many = if matches!(volume.samples, Samples::F64(_) | Samples::F32(_)) { 60 } else { 216 };
    if volume.dims.iter().any(|n| *n > 6) || volume.dims.iter().product::<usize>() > many {
        return None;
    }
    let pixel = [(seed % 2) as usize, (seed / 2 % 2) as usize];
    let options = ImageOrderOptions { step_voxel: 0.1, border: 3.0, ..ImageOrderOptions::default() };
    let seen = image_order(&volume, &scene, &options, None).unwrap().picture.pixels[pixel[1] * 2 + pixel[0]];
    let differs = (0..3).any(|k| (seen[k] - scene.background[k]).abs() > 1e-3);
    differs.then(|| Case { name: format!("random {seed}"), volume, scene, border: 3.0, pixel })
}

fn volume(dims: [usize; 3], spacing: [f64; 3], value: impl FnMut([usize; 3]) -> f64) -> Volume {
    let [nx, ny, nz] = dims;
    let places = (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
    Volume::new(dims, spacing, Samples::F64(places.map(value).collect())).unwrap()
}

fn noise(seed: u64) -> Volume {
    let dice = &mut Dice::new(seed);
    volume([5, 4, 5], [1.0; 3], |_| dice.between(0.0, 256.0).floor())
}

fn levels(seed: u64) -> Volume {
    let dice = &mut Dice::new(seed);
    volume([4, 5, 4], [1.0; 3], |_| [0.0, 80.0, 120.0, 255.0][dice.below(4)])
}

fn ball() -> Volume {
    let square = |x: usize, middle: f64| (x as f64 - middle) * (x as f64 - middle);
    volume([5, 5, 6], [1.0; 3], |[x, y, z]| {
        let radius = square(x, 2.2) + square(y, 1.9) + square(z, 2.6);
        (255.0 * 8.0 / (1.0 + 0.3 * radius)).round() / 8.0
    })
}

/// A block of 200 in 0: flat within, without, and along its faces.
fn block() -> Volume {
    volume([6; 3], [1.0; 3], |at| if at.iter().all(|x| (2..5).contains(x)) { 200.0 } else { 0.0 })
}

fn linear(slope: [f64; 3]) -> Volume {
    volume([5, 6, 4], [1.0; 3], |at| 20.0 + (0..3).map(|i| slope[i] * at[i] as f64).sum::<f64>())
}

fn labels() -> Volume {
    volume([4, 5, 4], [1.0, 1.0, 1.5], |[x, y, z]| ((x * x + 2 * y + 3 * z * y) % 5) as f64)
}

fn stretched(volume: Volume, spacing: [f64; 3]) -> Volume {
    Volume { spacing, ..volume }
}

fn opacity(points: &[[f64; 2]]) -> Transfer {
    let colour = [(0.0, [0.9, 0.2, 0.1]), (100.0, [0.3, 0.8, 0.4]), (100.0, [0.1, 0.5, 1.0]), (220.0, [1.0, 0.9, 0.6])];
    Transfer {
        opacity: points.to_vec(),
        colour: colour.map(|(value, rgb)| ColourPoint { value, rgb }).to_vec(),
        ..Transfer::default()
    }
}

/// What most kinds stand on: one of the volumes, one of the directions, a pixel beside the picture's middle, a transfer function
/// of plain ramps, and Phong's light at the eye.
fn plain(name: &str, number: usize, seed: u64) -> (Case, Dice) {
    let mut dice = Dice::new(seed);
    let volume = match dice.below(4) {
        0 => noise(1),
        1 => noise(2),
        2 => levels(3),
        _ => ball(),
    };
    let free = [dice.between(-1.0, 1.0), dice.between(-1.0, 1.0), dice.between(-1.0, 1.0)];
    let view = match dice.below(5) {
        0 => View::from_angles(45.0, 0.0),
        1 => View::from_angles(30.0, 7.0),
        _ => View::from_direction(free, None),
    };
    let scene = Scene {
        background: [0.2, 0.4, 0.7],
        view,
        image: Image { width_px: 2, height_px: 2, pixel_size_voxel: Some(dice.between(0.3, 2.0)) },
        transfer: opacity(&[[60.0, 0.0], [140.0, 0.3], [220.0, 0.9]]),
        ..Scene::default()
    };
    let pixel = [dice.below(2), dice.below(2)];
    (Case { name: format!("{name} {number}"), volume, scene, border: 0.0, pixel }, dice)
}

/// Case `i` of a kind.
fn made(kind: &str, i: usize, seed: u64) -> Case {
    let (mut case, mut dice) = plain(kind, i, seed);
    let scene = &mut case.scene;
    let ramps = |points: &[&[[f64; 2]]]| opacity(points[i % points.len()]);
    match kind {
        "steps" => {
            scene.transfer = ramps(&[
                &[[100.0, 0.0], [100.0, 0.6]],
                &[[70.0, 0.1], [70.0, 0.8], [150.0, 0.8], [150.0, 0.05]],
                &[[50.0, 0.0], [50.0, 0.3], [51.0, 0.0], [130.0, 0.0], [130.0, 0.95]],
            ]);
        }
        "plateaus" => {
            let high = dice.between(0.1, 0.99);
            scene.transfer = opacity(&[[40.0, 0.0], [60.0, high], [110.0, high], [125.0, 0.02], [255.0, 0.02]]);
        }
        "thin shells" => {
            let at = dice.between(60.0, 160.0).round();
            let high = [0.5, 0.999, 1.0 - 1e-9][i % 3];
            let wide = [1e-6, 0.5, 1e-3][i / 3 % 3];
            scene.transfer = opacity(&[[at, 0.0], [at + wide / 2.0, high], [at + wide, 0.0], [at + 40.0, 0.2]]);
        }
        "ramp to one" => {
            let low = dice.between(30.0, 100.0).round();
            case.volume = [ball(), levels(3), ball(), noise(1)][i % 4].clone();
            scene.transfer = ramps(&[&[[low, 0.0], [low + 60.0, 1.0]], &[[low, 0.0], [low, 0.4], [low + 9.0, 1.0]]]);
        }
        "step to one" => {
            let at = dice.between(60.0, 150.0).round();
            case.volume = [ball(), ball(), levels(3), noise(1)][i % 4].clone();
            scene.transfer = ramps(&[&[[20.0, 0.0], [at, 0.3], [at, 1.0]], &[[at, 0.0], [at, 1.0], [at + 5.0, 1.0]]]);
        }
        "tent to one" => {
            let at = dice.between(60.0, 160.0).round();
            let wide = [30.0, 3.0, 1e-4][i % 3];
            scene.transfer = opacity(&[[at - wide, 0.0], [at, 1.0], [at + wide, 0.0]]);
        }
        "nearly one" => {
            let high = 1.0 - [1e-12, 1e-15, 1e-5, 1e-9][i % 4];
            scene.transfer = ramps(&[&[[50.0, 0.0], [110.0, high]], &[[40.0, 0.0], [90.0, high], [91.0, 0.1]]]);
        }
        "faint" => {
            let low = [1e-30, 1e-12, 1e-300, 1e-6][i % 4];
            scene.transfer = opacity(&[[0.0, low], [120.0, low], [121.0, 2.0 * low]]);
        }
        "alternating shells" => {
            let high = [1.0, 0.7, 0.999_999][i % 3];
            let wide = [7.0, 0.01, 2.0][i / 3 % 3];
            let shell = |k: usize| {
                let at = 35.0 + 23.0 * k as f64;
                let high = if k == 8 { high } else { 0.8 * high };
                [[at, 0.0], [at, high], [at + wide, high], [at + wide, 0.0]]
            };
            scene.transfer = opacity(&(0..9).flat_map(shell).collect::<Vec<_>>());
        }
        "long voxels" => {
            let spacing = [[1.0, 1.0, 1000.0], [0.001, 1.0, 1.0], [0.5, 3.0, 2.0]][i % 3];
            case.volume = stretched([ball(), noise(1)][i % 2].clone(), spacing);
            let thin = [0.0, 0.9, 0.99][dice.below(3)];
            scene.transfer = opacity(&[[60.0, 0.0], [140.0, 0.3 * (1.0 - thin)], [220.0, 0.9 * (1.0 - thin)]]);
            if i >= 4 {
                scene.view = View::from_direction([[0.1, 0.2, 70.0], [80.0, 0.1, 0.2], [0.2, 1.0, 9.0]][i % 3], None);
            }
        }
        "eyes" => {
            let within = [dice.between(0.5, 3.0), dice.between(0.5, 2.5), dice.between(0.5, 3.0)];
            let far = scene.view.frame().unwrap().direction * 1e6;
            let far = [0, 1, 2].map(|k| (within[k] - far[k]).round());
            let eye = match i % 3 {
                0 => Perspective { eye_voxel: Some(within), ..Perspective::new(60.0) },
                1 => Perspective { eye_voxel: Some(within.map(f64::round)), ..Perspective::new(100.0) },
                _ => Perspective { eye_voxel: Some(far), ..Perspective::new(0.001) },
            };
            if i % 3 == 2 {
                scene.image = Image { width_px: 1, height_px: 1, pixel_size_voxel: None };
                case.pixel = [0; 2];
            }
            scene.view.perspective = Some(eye);
            scene.image.pixel_size_voxel = None;
            scene.lights.push(Light { direction: Some([0.3, -0.5, 0.8]), colour: [0.5, 0.5, 0.4] });
        }
        "axes and diagonals" => {
            let along: [[f64; 3]; 8] = [
                [1.0, 0.0, 0.0],
                [0.0, -1.0, 0.0],
                [0.0, 0.0, 1.0],
                [1.0, 1.0, 0.0],
                [1.0, -1.0, 1.0],
                [0.0, 1.0, 1.0],
                [1.0, 2.0, 0.0],
                [-1.0, 1.0, 1.0],
            ];
            scene.view = View::from_direction(along[i % 8], None);
            scene.image.pixel_size_voxel = Some([1.0, 0.5, 0.731][i % 3]);
            case.volume = [noise(1), levels(3), ball()][i % 3].clone();
        }
        "linear" => {
            case.volume = linear([[40.0, 0.0, 0.0], [0.0, 0.0, 60.0], [13.0, 22.0, -7.0], [0.5, 30.0, 0.0]][i % 4]);
            let one = [0.9, 1.0][i % 2];
            scene.transfer = opacity(&[[50.0, 0.0], [110.0, 0.4], [111.0, 0.1], [160.0, one]]);
            case.border = [0.0, 20.0][i % 2];
        }
        "constant" => {
            case.volume = volume([4; 3], [1.0, 1.0, 2.0], |_| 100.0);
            scene.transfer = ramps(&[&[[0.0, 0.3]], &[[100.0, 0.1], [100.0, 0.999]], &[[0.0, 0.0], [200.0, 1.0]]]);
            case.border = [0.0, 100.0][i % 2];
        }
        "two levels" => {
            case.volume = block();
            scene.image.pixel_size_voxel = Some([0.5, 1.5][i % 2]);
            scene.transfer = ramps(&[
                &[[0.0, 0.1], [200.0, 0.5]],
                &[[0.0, 0.0], [199.0, 0.2], [200.0, 0.9]],
                &[[100.0, 0.0], [100.0, 1.0]],
            ]);
        }
        _ => light_or_more(kind, i, &mut case, &mut dice),
    }
    case
}

/// Kinds that are of lights, clips, cues, layers, labels and sums.
fn light_or_more(kind: &str, i: usize, case: &mut Case, dice: &mut Dice) {
    let scene = &mut case.scene;
    let direction = |dice: &mut Dice| Some([0; 3].map(|_| dice.between(-1.0, 1.0)));
    match kind {
        "one-sided" => {
            let shininess = [10.0, 0.6, 1.0, 300.0][i % 4];
            scene.material =
                Material { specular: 0.9, shininess, two_sided: false, ambient: 0.05, ..Material::default() };
            let behind = Light { direction: direction(dice), colour: [0.9, 0.7, 0.5] };
            scene.lights = if i.is_multiple_of(2) { vec![behind] } else { vec![behind, Light::default()] };
        }
        "shininess" => {
            let shininess = [0.6, 1.0, 10.0, 300.0][i % 4];
            scene.material = Material { specular: 0.6, shininess, two_sided: i < 4, ..Material::default() };
            scene.lights[0].direction = direction(dice);
        }
        "clamped" => {
            let shininess = [10.0, 2.0, 40.0, 0.6][i % 4];
            scene.material = Material {
                ambient: 0.4,
                diffuse: 0.9,
                specular: [1.0, 0.5][i % 2],
                shininess,
                two_sided: !i.is_multiple_of(3),
                ..Material::default()
            };
            scene.lights = vec![
                Light { direction: direction(dice), colour: [1.0, 0.8, 0.3] },
                Light { direction: direction(dice), colour: [0.2, 0.9, 1.0] },
            ];
        }
        "coloured lights" => {
            let one = |dice: &mut Dice| {
                let colour = [0; 3].map(|_| dice.between(0.0, 1.0));
                Light { direction: direction(dice), colour }
            };
            scene.lights = (0..2 + i).map(|_| one(dice)).collect();
        }
        "layers" => {
            let layer = |gradient, points: &[[f64; 2]]| Layer { gradient, opacity: points.to_vec() };
            let one = [0.8, 1.0, 1.0 - 1e-12][i % 3];
            scene.transfer.opacity.clear();
            scene.transfer.layers = vec![
                layer(5.0, &[[50.0, 0.0], [150.0, 0.2]]),
                layer(30.0, &[[40.0, 0.0], [90.0, 0.1], [90.0, one], [200.0, one]]),
                layer(70.0, &[[30.0, 0.05], [120.0, 0.6], [121.0, 0.0]]),
            ];
            if i % 4 == 3 {
                case.volume = [block(), linear([13.0, 22.0, -7.0])][i / 4 % 2].clone();
            }
            scene.material.shaded = i % 3 != 1;
        }
        "thresholds" => {
            let low = dice.between(30.0, 120.0);
            scene.threshold = Some(Threshold { low: Some(low), high: i.is_multiple_of(2).then_some(low + 60.0) });
            scene.transfer = opacity(&[[0.0, 0.3], [140.0, 0.5], [220.0, 1.0]]);
        }
        "crops and cuts" => {
            if i.is_multiple_of(2) {
                scene.crop = Some(Crop { min_voxel: [0.3, 0.5, -1.0], max_voxel: [3.25, 2.7, 3.9] });
            }
            if !i.is_multiple_of(3) {
                let normal = direction(dice).unwrap();
                scene.cuts = vec![Cut { normal, through_voxel: [2.0, 1.7, 1.9] }];
                scene.cuts.push(Cut { normal: [0.0, 1.0, 0.0], through_voxel: [0.0, 2.9, 0.0] });
            }
        }
        "cues" => {
            scene.depth_cue = Some(DepthCue { front: 1.0, back: [0.1, 0.5, 0.0, 0.9][i % 4] });
            scene.material.shaded = i.is_multiple_of(2);
        }
        "labels" => {
            case.volume = labels();
            scene.volume.labels = true;
            scene.transfer =
                opacity(&[[0.5, 0.0], [0.5, 0.2], [2.0, 0.6], [2.5, 0.1], [3.0, 0.4], [3.5, [1.0, 0.9][i % 2]]]);
            for (point, value) in scene.transfer.colour.iter_mut().zip([0.0, 1.0, 2.0, 4.0]) {
                point.value = value;
            }
            scene.depth_cue = Some(DepthCue { front: 0.9, back: 0.3 });
            scene.material.two_sided = i.is_multiple_of(2);
            scene.lights[0].direction = if i.is_multiple_of(3) { None } else { direction(dice) };
            if i >= 4 {
                scene.mode = [Mode::Composite, Mode::WeightedSum][i % 2];
                scene.view.perspective = Some(Perspective::new(25.0));
                scene.image.pixel_size_voxel = None;
            }
        }
        "sums" => {
            scene.mode = Mode::WeightedSum;
            scene.depth_cue = i.is_multiple_of(3).then_some(DepthCue { front: 1.0, back: 0.2 });
            scene.transfer = match i % 4 {
                0 => opacity(&[[20.0, 0.0], [150.0, 1.0]]),
                1 => opacity(&[[80.0, 0.0], [80.0, 1.0], [80.5, 0.3], [170.0, 0.9]]),
                2 => opacity(&[[0.0, 0.9], [1.0, 1.0]]),
                _ => opacity(&[[90.0, 0.0], [90.0, 1.0], [90.000_001, 1.0], [90.000_001, 0.1]]),
            };
            if i >= 4 {
                scene.view.perspective = Some(Perspective::new(20.0));
                scene.image.pixel_size_voxel = None;
            }
        }
        _ => unreachable!("{kind}"),
    }
}
