//! A setup that is read from a file is checked whole: each leaf of its JSON, made impossible, is refused by its name.

use cube3_frame::FrameSetup;
use cube3_host::{VolumeInfo, picture_setup};
use cube3_machine::{Abc, MachineSpec, RayEnds, Rays, ShadingUnit};
use cube3_scene::{Crop, Cut, DepthCue, Layer, Light, Mode, Perspective, Scene, View};
use cube3_word::Words;
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Numbers of which others are legal as well, or make other fields wrong that are then named: the least and the most that one can be in any
/// of the setups. `[]` stands for any entry.
const RANGES: &[(&str, i64, i64)] = &[
    ("classification.colour[][]", 0, 4095),
    ("classification.gradient_rows.shift", 0, 30),
    ("classification.opacity[]", 0, 4095),
    ("classification.threshold[]", 0, 255),
    ("clips[].distance.constant", -1 << 60, 1 << 60),
    ("clips[].distance.k", -1 << 46, 1 << 46),
    ("clips[].distance.u", -1 << 46, 1 << 46),
    ("clips[].distance.v", -1 << 46, 1 << 46),
    ("cone.leaves", 1, 4096),
    ("cone.opaque", 1, 4095),
    ("cone.sum_weight", 0, 1 << 32),
    ("depth_cue.factor.constant", -1 << 60, 1 << 60),
    ("depth_cue.factor.k", -1 << 46, 1 << 46),
    ("depth_cue.factor.u", -1 << 46, 1 << 46),
    ("depth_cue.factor.v", -1 << 46, 1 << 46),
    ("ends.faces[].distance.constant", -1 << 60, 1 << 60),
    ("ends.faces[].distance.k", -1 << 46, 1 << 46),
    ("ends.faces[].distance.u", -1 << 46, 1 << 46),
    ("ends.faces[].distance.v", -1 << 46, 1 << 46),
    ("ends.steps[]", 0, 4096),
    ("geometry.offset", 0, 255),
    ("geometry.perspective.first_depth", 0, 5),
    ("geometry.perspective.grid_plane", 0, 30 << 30),
    ("geometry.perspective.most_reach", 1, 64),
    ("geometry.perspective.spacing[]", 0, 10 << 30),
    ("geometry.perspective.u.slopes[]", -1 << 37, 1 << 37),
    ("geometry.perspective.u.starts[]", -1 << 40, 1 << 40),
    ("geometry.perspective.v.slopes[]", -1 << 37, 1 << 37),
    ("geometry.perspective.v.starts[]", -1 << 40, 1 << 40),
    ("geometry.size[]", 1, 4096),
    ("geometry.slopes[]", 0, 1 << 30),
    ("gradient.border", 0, 255),
    ("gradient.scale.factors[]", 0, 1 << 16),
    ("gradient.scale.kept_bits", 0, 16),
    ("normaliser.root_bits", 4, 10),
    ("rays.factors[][]", 0, 1 << 16),
    ("rays.length_classes", 1, 16),
    ("rays.length_u[]", 0, (16 << 12) - 1),
    ("rays.length_v[]", 0, (16 << 12) - 1),
    ("rays.view_u[]", -1 << 28, 1 << 28),
    ("rays.view_v[]", -1 << 28, 1 << 28),
    ("rays.view_w", 0, 1 << 28),
    ("shading.Phong.ambient", 0, 15 * 4096),
    ("shading.Phong.lights[].diffuse[]", 0, 15 * 4096),
    ("shading.Phong.lights[].direction[]", -32, 32),
    ("shading.Phong.lights[].halfway[]", -32, 32),
    ("shading.Phong.lights[].specular[]", 0, 15 * 4095),
    ("shading.Phong.power[]", 0, 4096),
    ("shading.Phong.power_bits", 1, 5),
    ("shading.Table.bits", 2, 8),
    ("shading.Table.diffuse[][]", 0, 15 * 4096),
    ("shading.Table.flat", 0, 15 * 4096),
    ("shading.Table.specular[][]", 0, 15 * 4095),
    ("words.accumulator_bits", 1, 32),
    ("words.colour_bits", 1, 16),
    ("words.gradient_bits", 2, 9),
    ("words.normal_bits", 4, 15),
    ("words.opacity_bits", 1, 16),
    ("words.sample_fraction_bits", 0, 8),
    ("words.table_bits", 1, 8),
    ("words.table_gradient_bits", 1, 8),
    ("words.voxel_bits", 1, 16),
    ("words.weight_bits", 0, 12),
];

/// Choices that are free.
const FREE: &[&str] = &["geometry.axes.reversed[]", "rays.at_eye[]", "shading.Phong.two_sided"];

/// Lists and registers that may be shorter, longer or absent, or decide the length of others, which are then named.
const FREE_SHAPES: &[&str] = &[
    "classification.gradient_rows",
    "clips",
    "depth_cue",
    "ends",
    "geometry.perspective",
    "geometry.perspective.u.starts",
    "geometry.perspective.v.starts",
    "gradient.scale",
    "shading",
    "shading.Phong.lights",
];

/// Fields of 64 bits, for which a number of 32 is not out of range.
const LONG: &[&str] =
    &[".distance.", ".factor.", ".first", ".grid_plane", ".slopes[]", ".spacing[]", ".starts[]", "cone.sum_weight"];

/// Out of the range of every field.
const IMPOSSIBLE: [i64; 2] = [1 << 62, -(1 << 62)];
/// Out of the range of every field of 32 bits: the largest words that can be read, and the smallest.
const IMPOSSIBLE_WORDS: [i64; 3] = [u32::MAX as i64, i32::MAX as i64, i32::MIN as i64];

fn machine() -> MachineSpec {
    let words = Words {
        voxel_bits: 8,
        gradient_bits: 8,
        normal_bits: 6,
        table_bits: 3,
        table_gradient_bits: 1,
        ..Words::default()
    };
    let abc = Abc { power_bits: 3, root_bits: 4, reflectance_bits: 2, ..Abc::default() };
    MachineSpec { words, abc, lanes: 4, ..MachineSpec::default() }
}

fn scene() -> Scene {
    let mut scene = Scene {
        view: View { direction: Some([0.3, 0.4, 1.0]), ..View::default() },
        lights: vec![Light::default(), Light { direction: Some([1.0, 0.2, 0.3]), ..Light::default() }],
        cuts: vec![Cut { normal: [1.0, 0.4, -0.7], through_voxel: [2.0, 2.0, 2.0] }],
        crop: Some(Crop { min_voxel: [0.5; 3], max_voxel: [3.0; 3] }),
        depth_cue: Some(DepthCue { front: 1.0, back: 0.3 }),
        ..Scene::default()
    };
    scene.material.shaded = true;
    let layer = |gradient, opacity| Layer { gradient, opacity: vec![[0.0, 0.0], [255.0, opacity]] };
    scene.transfer.layers = vec![layer(0.0, 0.1), layer(40.0, 0.9)];
    scene
}

fn seen_from(eye: [f64; 3], scene: Scene) -> Scene {
    let perspective = Perspective { eye_voxel: Some(eye), ..Perspective::new(60.0) };
    Scene { view: View { perspective: Some(perspective), ..scene.view.clone() }, ..scene }
}

/// Setups that together have every field.
fn setups() -> Vec<(&'static str, Arc<FrameSetup>)> {
    let volume = VolumeInfo { dims: [4, 5, 6], spacing: [1.0, 1.25, 1.5], window: [0.0, 255.0] };
    let with = |shading, ends| MachineSpec {
        abc: Abc { shading, ..machine().abc },
        rays: Rays { ends, ..machine().rays },
        ..machine()
    };
    let flat = |scene: Scene| {
        let mut flat = Scene { cuts: Vec::new(), crop: None, ..scene };
        flat.transfer.layers.clear();
        flat
    };
    let phong = with(ShadingUnit::Phong, RayEnds::Published);
    let exact = with(ShadingUnit::Phong, RayEnds::Exact);
    let table = with(ShadingUnit::ReflectanceTable, RayEnds::Published);
    let cases = [
        ("parallel", scene(), phong.clone()),
        ("reflectance table", flat(scene()), table),
        ("an eye near by", seen_from([1.3, 2.2, 1.7], scene()), phong.clone()),
        ("an eye far away", seen_from([2.0, 2.0, -40.0], flat(scene())), phong),
        ("exact ends", flat(scene()), exact.clone()),
        ("exact ends for an eye", seen_from([1.2, 2.1, -3.4], Scene { mode: Mode::Composite, ..flat(scene()) }), exact),
    ];
    cases
        .map(|(name, scene, machine)| {
            let setup = picture_setup(&scene, &machine, &volume, true).unwrap().setups.swap_remove(0);
            assert_eq!(setup.check(), Ok(()), "{name}");
            (name, setup)
        })
        .to_vec()
}

/// A step from a value to one in it.
#[derive(Clone, Debug)]
enum Step {
    Key(String),
    Entry(usize),
}

fn path_of(steps: &[Step]) -> String {
    let mut path = String::new();
    for step in steps {
        match step {
            Step::Key(key) if path.is_empty() => path.push_str(key),
            Step::Key(key) => path += &format!(".{key}"),
            Step::Entry(i) => path += &format!("[{i}]"),
        }
    }
    path
}

/// The path with `[]` for every entry of a list.
fn pattern(steps: &[Step]) -> String {
    let mut path = path_of(steps);
    for step in steps {
        if let Step::Entry(i) = step {
            path = path.replacen(&format!("[{i}]"), "[]", 1);
        }
    }
    path
}

/// Every value within a value, and where it is.
fn places(value: &Value, at: &mut Vec<Step>, out: &mut Vec<Vec<Step>>) {
    let mut into = |step: Step, value: &Value| {
        at.push(step);
        out.push(at.clone());
        places(value, at, out);
        at.pop();
    };
    match value {
        Value::Object(keys) => keys.iter().for_each(|(key, value)| into(Step::Key(key.clone()), value)),
        Value::Array(entries) => entries.iter().enumerate().for_each(|(i, value)| into(Step::Entry(i), value)),
        _ => {}
    }
}

fn place<'a>(value: &'a mut Value, steps: &[Step]) -> &'a mut Value {
    steps.iter().fold(value, |value, step| match step {
        Step::Key(key) => &mut value[key],
        Step::Entry(i) => &mut value[i],
    })
}

/// A setup's JSON with one place of it changed, and what the reader said that it should not.
struct Changed<'a> {
    json: &'a mut Value,
    steps: &'a [Step],
    wrong: Vec<String>,
}

impl Changed<'_> {
    fn read(&mut self, value: Value) -> Result<(), (String, String)> {
        let before = std::mem::replace(place(self.json, self.steps), value);
        let text = self.json.to_string();
        *place(self.json, self.steps) = before;
        FrameSetup::from_json(&text, "frame.json").map(|_| ()).map_err(|error| (error.field(), error.to_string()))
    }

    /// Whether the place is so far back in a list that what holds for each entry has been tried on others.
    fn is_late(&self) -> bool {
        self.steps.iter().any(|step| matches!(step, Step::Entry(i) if *i >= 8))
    }

    /// The reader refuses a value and names the place, an entry of it, or the list that it is an entry of.
    fn is_refused(&mut self, value: impl Into<Value>) {
        let (path, value) = (path_of(self.steps), value.into());
        let shown: String = value.to_string().chars().take(40).collect();
        match self.read(value) {
            Ok(()) => self.wrong.push(format!("{path} = {shown} is taken")),
            Err((field, message)) => {
                let entry_of = |path: &str, list: &str| path.starts_with(&format!("{list}["));
                let named = field == path || entry_of(&field, &path) || entry_of(&path, &field);
                if !named || !message.starts_with(&format!("frame.json: {field}")) {
                    self.wrong.push(format!("{path} = {shown} gives: {message}"));
                }
            }
        }
    }
}

#[test]
fn every_leaf_that_is_made_impossible_is_refused_by_its_name() {
    let (mut seen, mut wrong) = (BTreeSet::new(), Vec::new());
    for (name, setup) in setups() {
        let mut json = serde_json::to_value(&*setup).unwrap();
        let mut all = Vec::new();
        places(&json, &mut Vec::new(), &mut all);
        for steps in &all {
            let pattern = pattern(steps);
            let value = place(&mut json, steps).clone();
            let mut changed = Changed { json: &mut json, steps, wrong: Vec::new() };
            change(&mut changed, &value, &pattern);
            wrong.extend(changed.wrong.into_iter().map(|wrong| format!("{name}: {wrong}")));
            seen.insert(pattern);
        }
    }
    assert!(wrong.is_empty(), "{} are wrong:\n{}", wrong.len(), wrong.join("\n"));
    let listed = FREE.iter().chain(FREE_SHAPES).copied();
    let unused: Vec<_> = RANGES.iter().map(|row| row.0).chain(listed).filter(|path| !seen.contains(*path)).collect();
    assert!(unused.is_empty(), "no setup has {unused:?}");
}

/// Tries all that a value at a place cannot be.
fn change(changed: &mut Changed, value: &Value, pattern: &str) {
    let [free, free_shape] = [FREE, FREE_SHAPES].map(|list| list.contains(&pattern));
    let range = RANGES.iter().find(|(path, ..)| *path == pattern);
    match value {
        Value::Null => return,
        Value::Number(number) => {
            let number = number.as_i64().unwrap();
            let (low, high) = range.map_or((number, number), |(_, low, high)| (*low, *high));
            changed.is_refused(low - 1);
            changed.is_refused(high + 1);
            if changed.is_late() {
                return;
            }
            IMPOSSIBLE.into_iter().for_each(|value| changed.is_refused(value));
            if !LONG.iter().any(|part| pattern.contains(part)) {
                IMPOSSIBLE_WORDS.into_iter().for_each(|value| changed.is_refused(value));
            }
            changed.is_refused("much");
            changed.is_refused(0.5);
        }
        Value::Bool(set) => {
            if !free {
                changed.is_refused(!set);
            }
            changed.is_refused(1);
        }
        Value::String(_) => {
            changed.is_refused("another");
            changed.is_refused(1);
        }
        Value::Array(entries) => {
            let resized = |length| {
                let mut other = entries.clone();
                other.resize(length, entries.last().cloned().unwrap_or(0.into()));
                other
            };
            if !free_shape {
                changed.is_refused(resized(entries.len() + 1));
                changed.is_refused(resized(entries.len().saturating_sub(1).max(usize::from(entries.is_empty()))));
            }
            if !pattern.ends_with("starts") {
                changed.is_refused(resized(1000));
            }
        }
        Value::Object(keys) => {
            let mut more = keys.clone();
            more.insert("surplus".to_owned(), 0.into());
            match changed.read(more.into()) {
                Err((_, message)) if message.contains("surplus") || pattern == "shading" => {}
                other => changed.wrong.push(format!("{pattern}.surplus gives {other:?}")),
            }
        }
    }
    if !free_shape && !changed.is_late() {
        changed.is_refused(Value::Null);
    }
}

#[test]
fn a_message_has_place_path_value_and_what_would_be_right() {
    let setups = setups();
    let [parallel, near] = [0, 2].map(|i| &setups[i].1);
    let told = |setup: &FrameSetup, change: fn(&mut FrameSetup)| {
        let mut setup = setup.clone();
        change(&mut setup);
        FrameSetup::from_json(&serde_json::to_string(&setup).unwrap(), "frame.json").unwrap_err().to_string()
    };
    let again = "; write the setup again with the program that made it";
    for (message, expected) in [
        (
            told(parallel, |setup| setup.classification.opacity[12] = 4096),
            "classification.opacity[12] = 4096 is outside 0 to 4095",
        ),
        (
            told(parallel, |setup| setup.geometry.u.columns[3] = 7),
            "geometry.u.columns[3] = 7 is not 1, which follows from slopes, offset and rule",
        ),
        (
            told(parallel, |setup| {
                setup.shading.take();
                setup.gradient = None;
            }),
            "gradient is absent, and the opacity table reads it",
        ),
        (told(parallel, |setup| setup.normaliser = None), "normaliser is absent, and the shading unit reads it"),
        (told(near, |setup| setup.rays = None), "rays is absent, and a perspective frame reads it"),
        (
            told(near, |setup| setup.geometry.slots = cube3_machine::RaySlots::Wrapped),
            "geometry.slots = Wrapped is not Padded, which follows from rays that are in perspective",
        ),
    ] {
        assert_eq!(message, format!("frame.json: {expected}{again}"));
    }
    let error = FrameSetup::from_json("{\"schema\": -1}", "frame.json").unwrap_err();
    assert!(error.to_string().starts_with("frame.json: schema: invalid value: integer `-1`, expected u32"), "{error}");
    let text = serde_json::to_string(&**parallel).unwrap() + "}";
    let error = FrameSetup::from_json(&text, "frame.json").unwrap_err();
    assert!(error.to_string().starts_with("frame.json: the setup: trailing characters"), "{error}");
}
