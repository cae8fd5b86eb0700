//! Pictures whose every pixel is known: fog, ramps, layers, steps. The fields of many cells are in `fields`.

use crate::exact::{
    Chord, Form, LEAST, Layer, ROUNDED, hold, hold_to, integral, last, layered, made, over, seen, unlit, views, volume,
};
use cube3_scene::{Image, Mode, Scene, View};
use cube3_volume::{Samples, Volume};
use glam::DVec3;

const WHITE: [f64; 3] = [1.0; 3];
const COLOUR: [f64; 3] = [0.9, 0.3, 0.0];
const SPACINGS: [[f64; 3]; 4] = [[1.0; 3], [1.0, 1000.0, 1.0], [0.001, 1.0, 0.7], [1.0, 2.0, 0.5]];

/// What a wrong end costs of a fog of such a depth.
fn ends(chord: &Chord, extinction: f64, left: f64) -> f64 {
    ROUNDED + chord.slack * extinction.min(50.0) * left
}

#[test]
fn fog_is_one_minus_the_power_of_its_clearness() {
    for alpha in [0.0, 1e-30, 1e-12, 0.01, 0.5, 0.999, 1.0 - f64::EPSILON / 2.0, 1.0] {
        for spacing in SPACINGS {
            let volume = volume([5, 4, 6], spacing, |_| 7.0);
            for view in views() {
                let scene = unlit(&view, vec![[0.0, alpha]], &[(0.0, COLOUR)]);
                hold(&format!("fog of {alpha:e}, {spacing:?}"), &volume, &scene, |pixel| {
                    let Some(chord) = Chord::whole(&volume, &scene, pixel) else { return (scene.background, 0.0) };
                    let (colour, left) = layered([(chord.length, alpha, COLOUR)]);
                    let extinction = -(-alpha).ln_1p();
                    (over(colour, left, scene.background), ends(&chord, extinction, left))
                });
            }
        }
    }
}

#[test]
fn of_faint_fog_the_light_is_its_depth_with_all_its_digits() {
    let volume = volume([5, 4, 6], [1.0; 3], |_| 7.0);
    for alpha in [1e-30, 1e-100, 1e-300] {
        for view in views() {
            for mode in [Mode::Composite, Mode::WeightedSum] {
                let scene = Scene { background: [0.0; 3], mode, ..unlit(&view, vec![[0.0, alpha]], &[(0.0, COLOUR)]) };
                let made = made(&volume, &scene, 1e-6);
                for (i, pixel) in made.picture.pixels.iter().enumerate() {
                    let Some(chord) = Chord::whole(&volume, &scene, [i % 4, i / 4]) else { continue };
                    let weight = if mode == Mode::WeightedSum { sum_weight(&volume, &scene, &chord) } else { 1.0 };
                    let exact = COLOUR[0] * alpha * chord.length * weight;
                    let rounded = exact * (2e-15 + chord.slack / chord.length);
                    assert!((pixel[0] - exact).abs() <= rounded, "{alpha:e}, {mode:?}: {pixel:?}, not {exact:e}");
                }
            }
        }
    }
}

#[test]
fn through_black_fog_a_white_background_is_e_to_minus_tau() {
    let volume = volume([5, 4, 6], [1.0; 3], |_| 7.0);
    for depth in [1e-9, 0.1, 3.0, 20.0] {
        let alpha = -f64::exp_m1(-depth);
        for view in views() {
            let scene = Scene { background: WHITE, ..unlit(&view, vec![[0.0, alpha]], &[(0.0, [0.0; 3])]) };
            hold(&format!("absorption {depth}"), &volume, &scene, |pixel| {
                let length = Chord::whole(&volume, &scene, pixel).map_or(0.0, |chord| chord.length);
                // 1 − α has no more digits than α is away from 1.
                ([(-depth * length).exp(); 3], ROUNDED + length * f64::EPSILON * (depth * (1.0 - length)).exp())
            });
        }
    }
}

/// What the integral of a weighted sum is multiplied by.
fn sum_weight(volume: &Volume, scene: &Scene, chord: &Chord) -> f64 {
    let direction = scene.view.frame().unwrap().direction;
    let steps = [0, 1, 2].map(|i| (direction[i] / volume.spacing[i]).abs());
    let axis = if steps[2] >= steps[0].max(steps[1]) { 2 } else { usize::from(steps[1] >= steps[0]) };
    chord.along[axis].abs() / (volume.dims[axis] - 1) as f64
}

/// A field that is linear along each of its rays, of 0 to 1.
struct Ramp {
    volume: Volume,
    slope: DVec3,
}

const SLOPES: [[f64; 3]; 3] =
    [[0.0, 1.0 / 8.0, 0.0], [1.0 / 16.0, 1.0 / 32.0, 1.0 / 16.0], [1.0 / 8.0, 0.0, 1.0 / 16.0]];

impl Ramp {
    fn new(slope: [f64; 3], spacing: [f64; 3]) -> Ramp {
        let slope = DVec3::from(slope);
        Ramp { volume: volume([5, 9, 5], spacing, |at| at.dot(slope)), slope }
    }

    /// Value where a ray enters, and its rate for a unit length.
    fn along(&self, chord: &Chord) -> [f64; 2] {
        [self.slope.dot(chord.from), self.slope.dot(chord.along)]
    }
}

/// ∫ −ln(1 − α) dα from 0 on.
fn depth_from_zero(alpha: f64) -> f64 {
    if alpha == 1.0 { 1.0 } else { (1.0 - alpha) * (-alpha).ln_1p() + alpha }
}

/// τ of a ray along which opacity is affine; α ln(1 − α) where it stays the same.
fn depth_of_ramp([start, rate]: [f64; 2], length: f64) -> f64 {
    let end = (start + rate * length).clamp(0.0, 1.0);
    if rate.abs() * length < 1e-3 {
        return integral(|t| [-(-(start + rate * t)).ln_1p()], [0.0, length], 4)[0];
    }
    (depth_from_zero(end) - depth_from_zero(start.clamp(0.0, 1.0))) / rate
}

#[test]
fn a_ramp_of_opacity_is_the_integral_of_its_logarithm() {
    // At its peak of full opacity τ is finite.
    for (slope, spacing) in SLOPES.into_iter().zip([[1.0; 3], [1.0, 3.0, 2.0], [1.0; 3]]) {
        let ramp = Ramp::new(slope, spacing);
        for view in views() {
            for most in [1e-9, 0.3, 0.999, 1.0] {
                let scene = unlit(&view, vec![[0.0, 0.0], [1.0, most], [2.0, 0.0]], &[(0.0, WHITE)]);
                hold(&format!("ramp to {most}, {slope:?}"), &ramp.volume, &scene, |pixel| {
                    let Some(chord) = Chord::whole(&ramp.volume, &scene, pixel) else { return (scene.background, 0.0) };
                    let line = ramp.along(&chord).map(|x| x * most);
                    let left = (-depth_of_ramp(line, chord.length)).exp();
                    let steep = if line[1].abs() * chord.length < 1e-3 { 0.0 } else { ROUNDED / line[1].abs() };
                    (over([1.0 - left; 3], left, scene.background), ends(&chord, 50.0 * most, left) + steep)
                });
            }
        }
    }
}

#[test]
fn a_ramp_of_opacity_and_colour_is_what_many_panels_give() {
    let (dark, bright) = ([0.1, 0.8, 0.0], [1.0, 0.2, 0.5]);
    for slope in SLOPES {
        let ramp = Ramp::new(slope, [1.0, 1.0, 2.0]);
        for view in views() {
            for most in [0.05, 0.9] {
                let scene = unlit(&view, vec![[0.0, 0.0], [1.0, most]], &[(0.0, dark), (1.0, bright)]);
                hold(&format!("coloured ramp to {most}"), &ramp.volume, &scene, |pixel| {
                    let Some(chord) = Chord::whole(&ramp.volume, &scene, pixel) else { return (scene.background, 0.0) };
                    let [start, rate] = ramp.along(&chord);
                    let rgb = |t: f64| [0, 1, 2].map(|i| dark[i] + (bright[i] - dark[i]) * (start + rate * t));
                    let (colour, left) = seen(|t| most * (start + rate * t), rgb, chord.length, 60);
                    (over(colour, left, scene.background), ends(&chord, 3.0, 1.0))
                });
            }
        }
    }
}

#[test]
fn the_weighted_sum_of_a_ramp_is_simpsons_rule() {
    for slope in SLOPES {
        let ramp = Ramp::new(slope, [1.0, 1.0, 2.0]);
        for view in views() {
            let unlit = unlit(&view, vec![[0.0, 0.1], [1.0, 0.6]], &[(0.0, [0.0, 0.5, 1.0]), (1.0, [1.0, 0.5, 0.0])]);
            let scene = Scene { mode: Mode::WeightedSum, background: [0.0; 3], ..unlit };
            hold("weighted ramp", &ramp.volume, &scene, |pixel| {
                let Some(chord) = Chord::whole(&ramp.volume, &scene, pixel) else { return ([0.0; 3], 0.0) };
                let [start, rate] = ramp.along(&chord);
                let at = |t: f64| {
                    let value = start + rate * t;
                    [value, 0.5, 1.0 - value].map(|c| c * (0.1 + 0.5 * value))
                };
                let [first, middle, end] = [0.0, 0.5, 1.0].map(|part| at(part * chord.length));
                let all = chord.length * sum_weight(&ramp.volume, &scene, &chord) / 6.0;
                ([0, 1, 2].map(|i| all * (first[i] + 4.0 * middle[i] + end[i])), ends(&chord, 1.0, 1.0))
            });
        }
    }
}

/// Voxels of labels, and what is seen of each label.
struct Blocks {
    volume: Volume,
    looks: Vec<(f64, [f64; 3])>,
}

impl Blocks {
    fn new(
        dims: [usize; 3],
        spacing: [f64; 3],
        looks: &[(f64, [f64; 3])],
        label: impl Fn([usize; 3]) -> usize,
    ) -> Blocks {
        let place = |i: usize| [i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]];
        let labels = (0..dims.iter().product()).map(|i| label(place(i)) as u8).collect();
        Blocks { volume: Volume::new(dims, spacing, Samples::U8(labels)).unwrap(), looks: looks.to_vec() }
    }

    fn scene(&self, view: &View) -> Scene {
        let around = |i: usize| [i as f64 - 0.5, i as f64 + 0.5];
        let opacity = self.looks.iter().enumerate().flat_map(|(i, look)| around(i).map(|value| [value, look.0]));
        let colour: Vec<(f64, [f64; 3])> =
            self.looks.iter().enumerate().flat_map(|(i, look)| around(i).map(|value| (value, look.1))).collect();
        let mut scene = unlit(view, opacity.collect(), &colour);
        scene.volume.labels = true;
        scene
    }

    /// All crossings of planes between voxels, in order, and the label in the middle between two.
    fn layers(&self, scene: &Scene, pixel: [usize; 2]) -> Option<(Chord, Vec<Layer>)> {
        let half = DVec3::splat(0.5);
        let chord = Chord::new(&self.volume, scene, pixel, [-half, last(&self.volume) + half])?;
        let mut cuts = vec![0.0, chord.length];
        for axis in 0..3 {
            let plane = |i: usize| (i as f64 - 0.5 - chord.from[axis]) / chord.along[axis];
            cuts.extend((0..=self.volume.dims[axis]).map(plane).filter(|t| 0.0 < *t && *t < chord.length));
        }
        cuts.sort_by(f64::total_cmp);
        let layer = |pair: &[f64]| {
            let at = (chord.at(f64::midpoint(pair[0], pair[1])) + half).floor().max(DVec3::ZERO);
            let [x, y, z] = at.min(last(&self.volume)).to_array().map(|x| x as usize);
            let Samples::U8(labels) = &self.volume.samples else { unreachable!() };
            let look = self.looks[labels[(z * self.volume.dims[1] + y) * self.volume.dims[0] + x] as usize];
            (pair[1] - pair[0], look.0, look.1)
        };
        Some((chord, cuts.windows(2).map(layer).collect()))
    }

    fn hold(&self, name: &str) {
        for view in views() {
            let scene = self.scene(&view);
            hold(name, &self.volume, &scene, |pixel| {
                let Some((chord, layers)) = self.layers(&scene, pixel) else { return (scene.background, 0.0) };
                let steepest = layers.iter().fold(0.0_f64, |most, layer| most.max(-(-layer.1).ln_1p()));
                let (colour, left) = layered(layers);
                (over(colour, left, scene.background), ends(&chord, steepest, 1.0))
            });
        }
    }
}

#[test]
fn blocks_of_two_materials_are_sums_of_layers() {
    let looks = [(0.2, [1.0, 0.5, 0.0]), (0.6, [0.0, 0.3, 1.0])];
    Blocks::new([4, 9, 5], [1.0, 1.5, 1.0], &looks, |[x, y, z]| (x + y + z) % 2).hold("checkerboard");
    Blocks::new([3, 16, 3], [1.0; 3], &looks, |[_, y, _]| y / 4 % 2).hold("slabs");
    Blocks::new([1, 7, 1], [1.0; 3], &looks, |[_, y, _]| usize::from(y == 3)).hold("a slab in fog");
}

#[test]
fn blocks_of_nothing_and_of_all_are_seen_or_not() {
    let looks = [(0.0, [1.0, 0.5, 0.0]), (1.0, [0.0, 0.3, 1.0]), (1e-9, WHITE)];
    Blocks::new([4, 9, 5], [1.0; 3], &looks, |[x, y, z]| (x + y + z) % 2).hold("clear and opaque");
    Blocks::new([5, 9, 5], [1.0; 3], &looks, |[x, y, z]| (x * y + 2 * z) % 3).hold("clear, opaque and faint");
}

#[test]
fn five_hundred_and_twelve_faint_slabs_are_a_product() {
    let looks = [(1e-4, [1.0, 0.5, 0.0]), (2e-3, [0.0, 0.3, 1.0])];
    let blocks = Blocks::new([2, 512, 2], [1.0; 3], &looks, |[_, y, _]| y % 2);
    let mut scene = blocks.scene(&View::from_direction([0.0, 1.0, 0.0], None));
    scene.image = Image { width_px: 3, height_px: 1, pixel_size_voxel: Some(0.3) };
    hold("faint slabs", &blocks.volume, &scene, |pixel| {
        let (_, layers) = blocks.layers(&scene, pixel).unwrap();
        let (colour, left) = layered(layers);
        (over(colour, left, scene.background), 512.0 * f64::EPSILON)
    });
    blocks.hold("faint slabs");
}

/// The layers of a ray through a ramp between steps of the transfer function, each of which begins with an opacity and a colour.
fn steps(ramp: &Ramp, chord: &Chord, steps: &[(f64, f64, [f64; 3])]) -> Vec<Layer> {
    let [start, rate] = ramp.along(chord);
    let mut cuts = vec![0.0, chord.length];
    cuts.extend(steps.iter().map(|step| (step.0 - start) / rate).filter(|t| 0.0 < *t && *t < chord.length));
    cuts.sort_by(f64::total_cmp);
    let look = |value: f64| steps.iter().rev().find(|step| step.0 <= value).map_or((0.0, [0.0; 3]), |s| (s.1, s.2));
    let layer = |pair: &[f64]| {
        let (alpha, rgb) = look(start + rate * f64::midpoint(pair[0], pair[1]));
        (pair[1] - pair[0], alpha, rgb)
    };
    cuts.windows(2).map(layer).collect()
}

fn hold_steps(least: f64, name: &str, of: &[(f64, f64, [f64; 3])]) {
    for slope in SLOPES {
        let ramp = Ramp::new(slope, [1.0, 1.0, 2.0]);
        for view in views() {
            let (mut opacity, mut colour) = (vec![[of[0].0, 0.0]], Vec::new());
            for (i, &(value, alpha, rgb)) in of.iter().enumerate() {
                let next = of.get(i + 1).map_or(9.0, |step| step.0);
                opacity.extend([[value, alpha], [next, alpha]]);
                colour.extend([(value, rgb), (next, rgb)]);
            }
            let scene = unlit(&view, opacity, &colour);
            hold_to(least, &format!("{name}, {slope:?}"), &ramp.volume, &scene, |pixel| {
                let Some(chord) = Chord::whole(&ramp.volume, &scene, pixel) else { return (scene.background, 0.0) };
                let rate = ramp.along(&chord)[1];
                if rate.abs() < 1e-12 {
                    return level(&ramp, &scene, &chord, of);
                }
                let (colour, left) = layered(steps(&ramp, &chord, of));
                // Where a step lies is known as well as the value.
                let steepest = of.iter().fold(0.0_f64, |most, step| most.max(-(-step.1).ln_1p()).min(50.0));
                (over(colour, left, scene.background), ends(&chord, steepest, 1.0) + steepest * ROUNDED / rate.abs())
            });
        }
    }
}

/// A ray along which the value stays the same.
fn level(ramp: &Ramp, scene: &Scene, chord: &Chord, of: &[(f64, f64, [f64; 3])]) -> Form {
    let value = ramp.along(chord)[0];
    let (alpha, rgb) = of.iter().rev().find(|step| step.0 <= value).map_or((0.0, [0.0; 3]), |s| (s.1, s.2));
    let (colour, left) = layered([(chord.length, alpha, rgb)]);
    (over(colour, left, scene.background), ends(chord, 50.0, left))
}

#[test]
fn steps_of_opacity_lie_where_the_ramp_takes_their_values() {
    hold_steps(LEAST, "one step", &[(0.3, 0.5, COLOUR)]);
    hold_steps(LEAST, "a step to full opacity in fog", &[(0.1, 0.05, COLOUR), (0.6, 1.0, COLOUR)]);
    let many: Vec<(f64, f64, [f64; 3])> = (0..20)
        .map(|i| {
            (0.013 + 0.047 * f64::from(i), f64::from(i % 4) * 0.17, [f64::from(i % 3) / 2.0, 1.0, f64::from(i % 2)])
        })
        .collect();
    hold_steps(LEAST, "many steps", &many);
}

#[test]
fn shells_that_no_sample_would_meet_are_seen() {
    for width in [0.1, 1e-3, 1e-6, 1e-9] {
        let shell =
            |alpha: f64, around: f64| [(0.1, around, COLOUR), (0.4, alpha, COLOUR), (0.4 + width, around, COLOUR)];
        hold_steps(LEAST, &format!("a shell of {width:e}"), &shell(0.9, 0.0));
        hold_steps(LEAST, &format!("an opaque shell of {width:e}"), &shell(1.0, 0.1));
        // Its extinction of 34 begins as exactly as the value is known.
        hold_steps(3.0 * LEAST, &format!("a dense shell of {width:e}"), &shell(1.0 - 1e-15, 0.0));
    }
}

#[test]
fn a_step_of_colour_at_a_step_to_full_opacity_has_an_honest_bound() {
    // Both sides' colours are taken as possible, so the bound is half of the step.
    hold_steps(1.0, "an opaque colour in white fog", &[(0.1, 0.1, WHITE), (0.4, 1.0, COLOUR), (0.5, 0.1, WHITE)]);
}
