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
use cube3_reference::{Line, margin, nearest_axis};
use cube3_scene::{ImagePlane, Scene, smallest_spacing};
use cube3_volume::{Volume, with_samples};
use serde_json::{Map, Value, json};

const CASES: &str = include_str!("fifty_digits_cases.json");
const EXPECTED: &str = include_str!("fifty_digits.json");

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

/// The largest error of a channel, and the bound.
fn error_and_bound(case: &Case, expected: &Value, tolerance: f64) -> [f64; 2] {
    let options = ConvergedOptions { tolerance, border: case.border, every: 1 };
    let made = converged(&case.volume, &case.scene, &options, None).unwrap();
    let index = case.pixel[1] * made.picture.width + case.pixel[0];
    let error = |k: usize| {
        let digits: f64 = expected["pixel"][k].as_str().unwrap().parse().unwrap();
        (made.picture.pixels[index][k] - digits).abs()
    };
    [error(0).max(error(1)).max(error(2)), made.bounds[index]]
}

#[test]
fn two_hundred_nasty_rays_are_within_their_bounds_of_fifty_digits() {
    let expected: Vec<Value> = serde_json::from_str(EXPECTED).unwrap();
    let cases = cases();
    assert_eq!(cases.len(), expected.len());
    let mut wrong = Vec::new();
    for tolerance in [1e-3, 1e-6, 1e-9, 1e-12] {
        let mut worst = (0.0, String::new());
        for (case, expected) in cases.iter().zip(&expected) {
            assert_eq!(case.name, expected["name"].as_str().unwrap());
            let [error, bound] = error_and_bound(case, expected, tolerance);
            if error > bound {
                wrong.push(format!("{} at {tolerance:e}: error {error:e}, bound {bound:e}", case.name));
            }
            if tolerance > 1e-12 && bound > tolerance {
                wrong.push(format!("{} at {tolerance:e}: bound {bound:e}", case.name));
            }
            if error / bound > worst.0 {
                worst = (error / bound, case.name.clone());
            }
        }
        println!("{tolerance:e}: the largest error is {} of its bound, in {}", worst.0, worst.1);
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
}
