//! Two hundred nasty rays against 50 digits from outside: `fifty_digits.py` has the integrals from the book and mpmath alone.
//!
//! The rays and the scenes go out in `fifty_digits_cases.json`, the pixels come back in `fifty_digits.json`. To make both again:
//!
//! ```text
//! cargo test --release -p cube3-converged --test all -- --ignored writes_the_cases
//! cd crates/converged/tests/all && python fifty_digits.py
//! ```

use crate::nasty::{Case, cases};
use cube3_converged::{ConvergedOptions, converged};
use cube3_reference::{ImageOrderOptions, Line, image_order, margin, nearest_axis};
use cube3_scene::{ImagePlane, Scene, smallest_spacing};
use cube3_volume::{Volume, with_samples};
use serde_json::{Map, Value, json};
use std::cmp::Ordering;
use std::sync::LazyLock;

const CASES: &str = include_str!("fifty_digits_cases.json");
const EXPECTED: &str = include_str!("fifty_digits.json");

const TOLERANCES: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// Tables of a scene that differ from the default's.
fn scene_json(scene: &Scene) -> Value {
    let default = serde_json::to_value(Scene::default()).unwrap();
    let Value::Object(all) = serde_json::to_value(scene).unwrap() else { unreachable!() };
    Value::Object(all.into_iter().filter(|(key, value)| default.get(key) != Some(value)).collect::<Map<_, _>>())
}

fn volume_json(volume: &Volume) -> Value {
    let samples: Vec<f64> = with_samples!(&volume.samples, v => v.iter().map(|x| f64::from(*x)).collect());
    json!({ "dims": volume.dims, "spacing": volume.spacing, "samples": samples })
}

/// The case with its ray, each number in as many digits as bring its bits back.
fn case_json(case: &Case, volume_number: usize) -> Value {
    let Case { name, volume, scene, border, pixel } = case;
    let view = scene.view.frame().unwrap();
    let plane = ImagePlane::new(scene, &view, volume.dims, volume.spacing);
    let smallest = smallest_spacing(volume.spacing);
    let line = Line::of_pixel(&plane, *pixel, volume.spacing, smallest);
    let axis = nearest_axis(view.direction, volume.spacing);
    let extent = (volume.dims[axis] - 1) as f64 + 2.0 * margin(scene);
    json!({
        "name": name,
        "volume": volume_number,
        "border": border,
        "pixel": pixel,
        "origin": line.origin,
        "direction": line.direction,
        "world_direction": line.world_direction.to_array(),
        "view_direction": view.direction.to_array(),
        "eye": line.eye.is_finite().then_some(line.eye),
        "smallest": smallest,
        "weight": line.direction[axis].abs() / extent,
        "scene": scene_json(scene),
    })
}

/// The file of the cases: the default scene, volumes, and cases that name them by their places.
fn written() -> String {
    let mut volumes: Vec<Value> = Vec::new();
    let mut lines = Vec::new();
    for case in cases() {
        let volume = volume_json(&case.volume);
        let place = volumes.iter().position(|other| *other == volume).unwrap_or_else(|| {
            volumes.push(volume);
            volumes.len() - 1
        });
        lines.push(case_json(&case, place).to_string());
    }
    let default = serde_json::to_string(&Scene::default()).unwrap();
    let volumes: Vec<String> = volumes.iter().map(Value::to_string).collect();
    let [volumes, cases] = [volumes, lines].map(|all| all.join(",\n"));
    format!("{{\"default\":{default},\n\"volumes\":[\n{volumes}\n],\n\"cases\":[\n{cases}\n]}}\n")
}

#[test]
#[ignore = "writes a file into the source"]
fn writes_the_cases() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/all/fifty_digits_cases.json");
    std::fs::write(path, written()).unwrap();
}

#[test]
fn the_cases_are_those_that_were_sent_out() {
    assert!(written() == CASES, "rays or scenes have changed: write the cases again, and their pixels");
}

/// A ray at a tolerance.
struct Measured {
    name: String,
    tolerance: f64,
    /// The largest of the three channels'.
    error: f64,
    bound: f64,
}

impl Measured {
    /// The error in parts of its bound; both are 0 where nothing is seen.
    fn ratio(&self) -> f64 {
        if self.error == 0.0 { 0.0 } else { self.error / self.bound }
    }

    fn line(&self) -> String {
        let Measured { name, tolerance, error, bound } = self;
        format!("{name} at {tolerance:e}: error {error:.3e}, bound {bound:.3e}\n")
    }
}

/// What the bound of rounding is at most: of a highlight of an exponent below 1, whose slope has no end, where it begins.
const ROUNDING: f64 = 1e-7;

/// The largest distance of a channel from its 25 digits, which a double reads as well as it can.
fn distance(pixel: [f64; 3], expected: &Value) -> f64 {
    let channel = |k: usize| (pixel[k] - expected["pixel"][k].as_str().unwrap().parse::<f64>().unwrap()).abs();
    channel(0).max(channel(1)).max(channel(2))
}

/// The cases with what was worked out for them.
fn expected() -> Vec<(Case, Value)> {
    let expected: Vec<Value> = serde_json::from_str(EXPECTED).unwrap();
    let cases = cases();
    assert_eq!(cases.len(), expected.len());
    let pairs = cases.into_iter().zip(expected);
    pairs.inspect(|(case, expected)| assert_eq!(case.name, expected["name"].as_str().unwrap())).collect()
}

/// Every case at every tolerance.
static MEASURED: LazyLock<Vec<Measured>> = LazyLock::new(|| {
    let measure = |(case, expected): &(Case, Value), tolerance: f64| {
        let options = ConvergedOptions { tolerance, border: case.border, every: 1 };
        let made = converged(&case.volume, &case.scene, &options, None).unwrap();
        let index = case.pixel[1] * made.picture.width + case.pixel[0];
        let error = distance(made.picture.pixels[index], expected);
        Measured { name: case.name.clone(), tolerance, error, bound: made.bounds[index] }
    };
    let expected = expected();
    TOLERANCES.iter().flat_map(|tolerance| expected.iter().map(|case| measure(case, *tolerance))).collect()
});

#[test]
fn two_hundred_nasty_rays_are_within_their_bounds_of_fifty_digits() {
    for tolerance in TOLERANCES {
        // A bound that is wide says little: those within the tolerance are what a wrong one would show in.
        let of = MEASURED.iter().filter(|m| m.tolerance == tolerance);
        let (within, wide): (Vec<&Measured>, Vec<&Measured>) = of.partition(|m| m.bound <= tolerance);
        let worst = |all: &[&Measured]| {
            let most = all.iter().max_by(|a, b| a.ratio().total_cmp(&b.ratio()));
            most.map_or("none".into(), |m| format!("{:.4} in {}", m.ratio(), m.name))
        };
        let near = within.iter().filter(|m| m.error > 0.1 * m.bound).count();
        println!(
            "{tolerance:e}: {} bounds within; largest error/bound {}, {near} above a tenth; {} wide, largest {}",
            within.len(),
            worst(&within),
            wide.len(),
            worst(&wide)
        );
    }
    let wrong: Vec<String> = MEASURED
        .iter()
        .filter(|m| m.error.partial_cmp(&m.bound).is_none_or(Ordering::is_gt))
        .map(Measured::line)
        .collect();
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.concat());
}

#[test]
fn the_bounds_of_two_hundred_nasty_rays_are_within_the_tolerance() {
    // At 10⁻¹² rounding itself may be more than the tolerance: there the bound alone counts. At 10⁻⁹ it is where a highlight is steepest.
    let asked = MEASURED.iter().filter(|m| m.tolerance > 1e-12);
    let allowed = |m: &Measured| if m.tolerance < 1e-8 { ROUNDING } else { m.tolerance };
    let wide: Vec<String> = asked.filter(|m| m.bound > allowed(m)).map(Measured::line).collect();
    assert!(wide.is_empty(), "{} wide:\n{}", wide.len(), wide.concat());
}

/// The outside hand's pixels against steps: a shell or a surface is off by a step's absorption, all else by far less.
#[test]
#[ignore = "short steps: seconds on every core"]
fn image_order_comes_to_the_same_pixels() {
    for (case, expected) in expected() {
        let options = ImageOrderOptions { step_voxel: 0.0005, border: case.border, ..ImageOrderOptions::default() };
        let made = image_order(&case.volume, &case.scene, &options, None).unwrap();
        let apart = distance(made.picture.pixels[case.pixel[1] * made.picture.width + case.pixel[0]], &expected);
        assert!(apart < 2e-3, "{}: {apart:e}", case.name);
    }
}
