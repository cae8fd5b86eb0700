//! The table of parameters against the scenes that it is of.

use cube3_parameter::{Legal, Parameter, Value, ValueKind};
use cube3_scene::{
    ColourPoint, Crop, Cut, DepthCue, FileAxes, Interpolation, Layer, Light, Path, PathKey, Perspective,
    SCENE_PARAMETERS, Scene, Threshold, View, VolumeSource,
};
use std::collections::BTreeSet;

/// Scenes that have, between them, every key.
fn scenes() -> [Scene; 3] {
    let mut phantom = Scene {
        path: Some(Path::turntable(90.0)),
        depth_cue: Some(DepthCue::default()),
        cuts: vec![Cut { normal: [0.0, 0.0, 1.0], through_voxel: [1.0, 2.0, 3.0] }; 2],
        crop: Some(Crop { min_voxel: [1.0; 3], max_voxel: [2.0; 3] }),
        threshold: Some(Threshold { low: Some(1.0), high: Some(2.0) }),
        lights: vec![Light { direction: Some([1.0, 0.0, 0.0]), colour: [0.5; 3] }, Light::default()],
        ..Scene::default()
    };
    (phantom.volume.labels, phantom.volume.phase, phantom.volume.phase_per_frame) = (true, Some(0.5), Some(0.1));
    phantom.view.perspective = Some(Perspective { distance_voxel: Some(300.0), ..Perspective::new(30.0) });

    let mut file = Scene {
        volume: VolumeSource { time: Some(3), axes: FileAxes::Stored, ..VolumeSource::from_file("a.nrrd") },
        path: Some(Path { interpolation: Interpolation::Smooth, turntable_deg: None, keys: vec![key(0.0), key(5.0)] }),
        ..Scene::default()
    };
    file.volume.window = Some([1.0, 2.0]);
    file.image.pixel_size_voxel = Some(1.0);
    file.transfer.opacity = vec![];
    file.transfer.layers = vec![
        Layer { gradient: 1.0, opacity: vec![[10.0, 0.5], [20.0, 1.0]] },
        Layer { gradient: 2.0, opacity: vec![[30.0, 0.0]] },
    ];
    file.transfer.colour.push(ColourPoint { value: 5.0, rgb: [0.0, 0.5, 1.0] });

    let files = ["a.nrrd", "b.nrrd"].map(Into::into);
    let mut series = Scene { volume: VolumeSource::from_files(files), ..Scene::default() };
    series.view = View::from_direction([0.0, 1.0, 0.0], Some([0.0, 0.0, 1.0]));
    series.view.perspective = Some(Perspective { eye_voxel: Some([1.0, 2.0, 3.0]), ..Perspective::new(30.0) });
    [phantom, file, series]
}

fn key(frame: f64) -> PathKey {
    PathKey { frame, yaw_deg: Some(1.0), tilt_deg: Some(2.0), roll_deg: Some(3.0) }
}

fn keys_of(value: &toml::Value, path: &str, keys: &mut BTreeSet<String>) {
    match value {
        toml::Value::Table(table) => {
            let dot = if path.is_empty() { "" } else { "." };
            table.iter().for_each(|(name, value)| keys_of(value, &format!("{path}{dot}{name}"), keys));
        }
        toml::Value::Array(values) if values.iter().any(|value| value.is_table() || value.is_array()) => {
            for value in values {
                match value.as_array() {
                    Some(point) => keys.extend((0..point.len()).map(|i| format!("{path}[][{i}]"))),
                    None => keys_of(value, &format!("{path}[]"), keys),
                }
            }
        }
        _ => drop(keys.insert(path.to_owned())),
    }
}

#[test]
fn the_keys_of_files_are_those_of_the_table() {
    let mut keys = BTreeSet::new();
    for scene in scenes() {
        scene.validate().unwrap();
        keys_of(&toml::Value::Table(scene.to_toml().unwrap().parse().unwrap()), "", &mut keys);
    }
    // A list that is empty in one scene has its elements in another.
    keys.remove("transfer.opacity");
    let rows: BTreeSet<String> = SCENE_PARAMETERS.iter().map(|row| row.key.to_owned()).collect();
    assert_eq!(rows.len(), SCENE_PARAMETERS.len(), "each key once");
    assert_eq!(keys, rows);
}

#[test]
fn values_are_legal_and_set_as_they_are_got() {
    for scene in scenes().into_iter().chain([Scene::default()]) {
        for row in SCENE_PARAMETERS {
            row.check(&scene).unwrap();
            let mut same = scene.clone();
            (row.set)(&mut same, &(row.get)(&scene)).unwrap();
            assert_eq!(same, scene, "{}", row.key);
            let other = match (row.get)(&scene) {
                Value::Flag(flag) => Value::Flag(!flag),
                Value::Text(_) if row.kind == ValueKind::Text => Value::Text("another".into()),
                value => value,
            };
            (row.set)(&mut same, &other).unwrap();
            assert_eq!((row.get)(&same), other, "{}", row.key);
        }
    }
}

/// A value with its first number, name or flag, however deep in lists, exchanged; none where there is nothing to exchange.
fn exchanged(value: &Value, by: &Value) -> Option<Value> {
    match value {
        Value::List(values) => {
            let mut values = values.clone();
            *values.first_mut()? = exchanged(values.first()?, by)?;
            Some(Value::List(values))
        }
        Value::Absent => None,
        _ => Some(by.clone()),
    }
}

fn outside(row: &Parameter<Scene>, scene: &Scene) -> Vec<Value> {
    match (row.legal)(scene) {
        Legal::Whole { low, high } => [low - 1, high + 1].map(Value::Whole).to_vec(),
        Legal::Real { low, high, .. } => {
            // Where an end is that of all numbers, what is beyond it is infinite.
            let beyond = |end: f64, step: f64| if end.abs() == f64::MAX { end * 2.0 } else { end + step };
            [beyond(low, -1.0), beyond(high, high.abs().max(1.0)), f64::NAN].map(Value::Real).to_vec()
        }
        Legal::OneOf(_) => vec![Value::Text("nothing".into())],
        Legal::Anything => vec![],
    }
}

#[test]
fn a_value_out_of_range_is_refused_with_key_range_and_the_nearest_which_can_be_set() {
    let mut met = BTreeSet::new();
    for scene in scenes() {
        for row in SCENE_PARAMETERS {
            let (value, legal) = ((row.get)(&scene), (row.legal)(&scene));
            for bad in outside(row, &scene) {
                let Some(value) = exchanged(&value, &bad) else { continue };
                let fault = row.fault(&scene, &value).unwrap();
                let nearest = legal.nearest(&value);
                assert_eq!((&fault.legal, legal.contains(&nearest)), (&legal, true), "{fault}");
                let start = row.key.split("[]").next().unwrap();
                assert!(fault.key.starts_with(start) && !fault.key.contains("[]"), "{fault}");
                let mut other = scene.clone();
                (row.set)(&mut other, &nearest).unwrap();
                assert_eq!((row.get)(&other), nearest, "{}", row.key);
                row.check(&other).unwrap();
                if (row.set)(&mut other, &value).is_ok() && !matches!(row.kind, ValueKind::Choice) {
                    let error = other.validate().unwrap_err();
                    let expected = format!("scene: {}: {}; {}", fault.key, fault.reason(), fault.remedy());
                    assert_eq!(error.to_string(), expected);
                    met.insert(row.key);
                }
            }
        }
    }
    let ranged = |row: &&Parameter<Scene>| matches!((row.legal)(&Scene::default()), Legal::Real { .. });
    for row in SCENE_PARAMETERS.iter().filter(ranged) {
        assert!(met.contains(row.key), "{} has not been out of range", row.key);
    }
}

#[test]
fn names_are_those_of_files() {
    for row in SCENE_PARAMETERS.iter().filter(|row| row.kind == ValueKind::Choice) {
        let Legal::OneOf(names) = (row.legal)(&Scene::default()) else { panic!("{} has names", row.key) };
        for name in &names {
            let mut scene = scenes()[1].clone();
            (row.set)(&mut scene, name).unwrap();
            assert_eq!((row.get)(&Scene::from_toml(&scene.to_toml().unwrap(), "s").unwrap()), *name);
        }
        let (section, name) = row.key.rsplit_once('.').unwrap_or(("", row.key));
        let header = if section.is_empty() { String::new() } else { format!("[{section}]\n") };
        let error = Scene::from_toml(&format!("{header}{name} = \"?\""), "s").unwrap_err().to_string();
        let known: Vec<String> = names.iter().map(|name| name.to_string().trim_matches('"').to_owned()).collect();
        assert!(error.ends_with(&format!("the choices are {}", known.join(", "))), "{error}");
    }
}

#[test]
fn a_number_that_its_type_cannot_hold_is_out_of_range_in_its_line() {
    for (text, expected) in [
        (
            "[image]\nwidth_px = -1",
            "s.toml:2: image.width_px: -1 is outside 1 to 16384 pixels; the nearest legal value is 1",
        ),
        (
            "[volume]\nsize_voxels = -7",
            "s.toml:2: volume.size_voxels: -7 is outside 1 to 4096 voxels; the nearest legal value is 1",
        ),
        (
            "[[light]]\n[[light]]\ncolour = [0, 0, 2]",
            "s.toml:3: light[1].colour[2]: 2.0 is outside 0 to 1; the nearest legal value is 1.0",
        ),
        (
            "[material]\nshininess = 0",
            "s.toml:2: material.shininess: 0.0 is not above 0 and at most 1000; the nearest legal value is just above 0",
        ),
        ("[view]\nyaw_deg = nan", "s.toml:2: view.yaw_deg: nan is not a finite number of degrees; give a number"),
    ] {
        assert_eq!(Scene::from_toml(text, "s.toml").unwrap_err().to_string(), expected);
    }
}
