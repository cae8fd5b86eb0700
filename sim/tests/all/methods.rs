//! `cube3 methods`, `cube3 render`, any method as a reference, and a run without the search for what limits.

use crate::checked;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn cube3(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cube3")).current_dir(folder).args(arguments).output().unwrap()
}

fn good(folder: &Path, arguments: &[&str]) -> String {
    let output = cube3(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = cube3(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(told.lines().count(), 1, "{told}");
    told.trim_end().to_owned()
}

/// A small scene on a small machine.
const SMALL: [&str; 8] = ["--scene", "small.toml", "--machine", "lanes.toml", "--phantom", "head", "--size", "16"];

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("small.toml"), "[image]\nwidth_px = 30\nheight_px = 24\n").unwrap();
    std::fs::write(folder.path().join("lanes.toml"), "lanes = 16\n").unwrap();
    folder
}

fn names(folder: &Path) -> Vec<String> {
    let rows: Vec<Value> = serde_json::from_str(&good(folder, &["methods", "--json"])).unwrap();
    rows.iter().map(|row| row["name"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn the_table_lists_every_method_and_what_it_shows() {
    let folder = folder();
    let names = names(folder.path());
    assert_eq!(names, ["function", "cycle", "sheared", "true", "image-order", "converged"]);
    let text = good(folder.path(), &["methods"]);
    for name in &names {
        assert!(text.lines().any(|line| line == name), "{name}");
    }
    assert!(text.contains("0.002 to 8 voxels") && text.contains("perspective") && text.contains("needs a machine"));
    let rows: Vec<Value> = serde_json::from_str(&good(folder.path(), &["methods", "--json"])).unwrap();
    let shows = |name: &str, feature: &str| {
        let row = rows.iter().find(|row| row["name"] == name).unwrap();
        row["supports"].as_array().unwrap().contains(&feature.into())
    };
    assert!(names.iter().all(|name| shows(name, "perspective") && shows(name, "labels")));
}

/// Each method renders, and *function*, *cycle* and a run give the same picture.
#[test]
fn every_method_renders_and_says_what_it_took() {
    let folder = folder();
    let path = folder.path();
    let mut digests = Vec::new();
    for name in names(path) {
        let arguments = [&["render", "--method", &name, "--no-cache", "--out", "made"], SMALL.as_slice()].concat();
        assert!(good(path, &arguments).contains("samples in"), "{name}");
        let numbers: Value = serde_json::from_slice(&std::fs::read(path.join("made/rendering.json")).unwrap()).unwrap();
        assert_eq!(numbers["method"], name);
        assert!(numbers["samples"].as_u64().unwrap() > 1000 && numbers["bytes"].as_u64().unwrap() >= 4096);
        let phases = numbers["phases"].as_array().unwrap();
        let sum: f64 = phases.iter().map(|phase| phase["time_s"].as_f64().unwrap()).sum();
        assert!(!phases.is_empty() && (sum - numbers["time_s"].as_f64().unwrap()).abs() < 1e-9);
        let picture = image::open(path.join("made/image.png")).unwrap().to_rgb8();
        assert_eq!(picture.dimensions(), (30, 24));
        assert!(picture.pixels().any(|pixel| pixel.0 != [0; 3]), "{name}");
        digests.push(numbers["digest"].clone());
    }
    good(path, &[&["run", "--out", "run", "--reference", "none", "--no-limits"], SMALL.as_slice()].concat());
    let report = checked::report(&path.join("run"));
    assert_eq!(digests[0], report["digest"]["image"]);
    assert_eq!(digests[0], digests[1]);
    assert!(digests[2..].iter().all(|digest| *digest != digests[0]));
}

/// The machine against itself is no distance; any other method is one, with its options in the report.
#[test]
fn any_method_can_be_the_reference() {
    let folder = folder();
    let path = folder.path();
    let against = |reference: &str| {
        good(path, &[&["run", "--out", "out", "--no-limits", "--reference", reference], SMALL.as_slice()].concat());
        checked::report(&path.join("out"))["error"].clone()
    };
    for reference in ["function", "cycle"] {
        let error = against(reference);
        assert_eq!((error["against"].as_str(), error["max"].as_f64()), (Some(reference), Some(0.0)));
    }
    for reference in ["sheared", "true:published", "image-order:0.25"] {
        let error = against(reference);
        assert_eq!(error["against"], reference);
        assert!(error["max"].as_f64().unwrap() > 0.0, "{reference}");
        assert_eq!(error["reference"].is_null(), reference != "image-order:0.25");
        assert!(error["reference_bound"].is_null());
    }
    let own = against("image-order:0.25")["reference"].clone();
    assert_eq!((own["of"].as_str(), own["against"].as_str()), (Some("image-order:0.25"), Some("converged:1e-5")));
    assert!(own["against_bound"].as_f64().is_some_and(|bound| bound > 0.0 && bound <= 1e-5), "{own}");
}

/// A picture with a bound says it; the second run finds it, and measures the same to the bit.
#[test]
fn the_converged_integral_is_a_reference_with_a_bound_and_is_kept() {
    let folder = folder();
    let path = folder.path();
    let run = |more: &[&str]| {
        let command = ["run", "--out", "out", "--no-limits", "--reference", "converged:1e-4"];
        let told = good(path, &[command.as_slice(), more, &SMALL].concat());
        (told, checked::report(&path.join("out"))["error"].clone())
    };
    let cache = ["--cache", "kept"];
    let (first, second, without) = (run(&cache), run(&cache), run(&["--no-cache"]));
    for (_, error) in [&first, &second, &without] {
        assert_eq!(error, &first.1);
        assert_eq!(error["against"], "converged:1e-4");
        assert!(error["reference_bound"].as_f64().is_some_and(|bound| bound > 0.0 && bound <= 1e-4), "{error}");
    }
    let found = "the reference was made by an earlier run";
    assert_eq!([&first.0, &second.0, &without.0].map(|told| told.contains(found)), [false, true, false]);
    let command = ["render", "--method", "converged:1e-4", "--out", "out", "--cache", "kept"];
    let told = good(path, &[command.as_slice(), &SMALL].concat());
    assert!(
        told.contains("made by an earlier run") && told.contains("no channel of a pixel is off by more than"),
        "{told}"
    );
    assert_eq!(std::fs::read_dir(path.join("kept")).unwrap().count(), 1);
    let told = refused(path, &[&["render", "--cache", "kept", "--no-cache"], SMALL.as_slice()].concat());
    assert!(told.contains("--no-cache"), "{told}");
}

#[test]
fn without_the_search_a_report_says_so() {
    let folder = folder();
    let path = folder.path();
    let run = |more: &[&str]| {
        good(
            path,
            &[&["run", "--out", "out", "--reference", "none", "--fidelity", "timing"], SMALL.as_slice(), more].concat(),
        )
    };
    let (with, without) = (run(&[]), run(&["--no-limits"]));
    assert!(!with.contains("not looked for") && without.contains("not looked for"));
    let report = checked::report(&path.join("out"));
    assert!(report["limits"].is_null() && report["timing"]["cycles"].as_u64().unwrap() > 0);
    assert!(std::fs::read_to_string(path.join("out/report.html")).unwrap().contains("not looked for"));
}

#[test]
fn an_eye_sees_by_every_method_and_against_every_reference() {
    let folder = folder();
    let path = folder.path();
    let eye = ["--fov", "70", "--no-limits"];
    let mut pictures = Vec::new();
    for name in ["sheared", "true"] {
        good(path, &[&["render", "--method", name, "--fov", "70", "--out", name], SMALL.as_slice()].concat());
        let picture = std::fs::read(path.join(name).join("image.png")).unwrap();
        good(path, &[&["run", "--reference", name, "--out", "run"], eye.as_slice(), &SMALL].concat());
        assert_eq!(checked::report(&path.join("run"))["error"]["against"], name);
        assert_eq!(std::fs::read(path.join("run/reference.png")).unwrap(), picture, "{name}");
        pictures.push(picture);
    }
    assert_ne!(pictures[0], pictures[1]);
}

#[test]
fn a_method_that_is_not_there_is_refused_with_what_is() {
    let folder = folder();
    let path = folder.path();
    let told = refused(path, &["render", "--method", "imageorder"]);
    assert!(told.contains("there is no method imageorder: did you mean image-order?"), "{told}");
    let told = refused(path, &["run", "--reference", "image-order:9"]);
    assert!(told.contains("'9' is no option of the method image-order; give step: 0.002 to 8 voxels"), "{told}");
    let told = refused(path, &["render", "--method", "function", "--machine", "nowhere.toml"]);
    assert!(told.contains("nowhere.toml") && told.contains("give a machine file"), "{told}");
}

#[test]
fn what_a_method_cannot_show_is_refused_with_what_it_lacks() {
    let folder = folder();
    let path = folder.path();
    let lacks = "the method converged cannot show what the scene asks for: maximum; take function or cycle or sheared or true or image-order";
    for command in [["render", "--method", "converged"], ["run", "--reference", "converged"]] {
        let told = refused(path, &[command.as_slice(), &["--mode", "maximum", "--out", "none"], &SMALL].concat());
        assert_eq!(told, format!("cube3: {lacks}"));
    }
    assert!(!path.join("none").exists());
}
