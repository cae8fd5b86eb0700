//! The JSON schema and the report say the same.

use crate::follows;
use crate::sample;
use cube3_report::{
    AcquisitionReport, DigestReport, FrameReport, JSON_SCHEMA, NO_OBJECT, RunReport, SCHEMA, SequenceReport, to_json,
};
use serde_json::Value;

/// Keys that are not there in every report, by their path with `[]` for any element of a list.
const OPTIONAL: [&str; 19] = [
    "/sequence",
    "/volume/axes",
    "/view/sides",
    "/view/perspective",
    "/timing/frames",
    "/traffic/memory",
    "/traffic/reorder",
    "/traffic/links",
    "/traffic/links[]/slots",
    "/words/opacity",
    "/error/remark",
    "/error/reference",
    "/error/reference/against_bound",
    "/error/reference_bound",
    "/sequence/frames[]/remark",
    "/view/perspective/passes[]/gradient",
    // Names in open maps.
    "/words/overflows/*",
    "/units[]/waiting/*",
    "/scene/*",
];

fn schema() -> Value {
    serde_json::from_str(JSON_SCHEMA).unwrap()
}

fn value(report: &RunReport) -> Value {
    serde_json::from_str(&to_json(report).unwrap()).unwrap()
}

fn faults(report: &Value) -> Vec<String> {
    follows::faults(&schema(), report)
}

/// The sample with two frames, one of them torn and one of nothing.
fn sequence() -> RunReport {
    let mut report = sample::report();
    let error = report.error.as_ref().unwrap();
    let frame = |error, footprint, remark: Option<&str>| FrameReport {
        angles_deg: Some([30.0, 7.0, 0.0]),
        cycles: Some(9_000),
        end_cycle: Some(9_000),
        volume: 0,
        newest_volume: 1,
        newer_fraction: 0.25,
        torn: true,
        mixed_beams: 5,
        first_torn_plane: Some(3),
        error,
        footprint,
        remark: remark.map(String::from),
        digest: DigestReport::default(),
    };
    report.sequence = Some(SequenceReport {
        fps_sustained: Some(488.0),
        time_s: Some(0.0041),
        playback_fps: Some(30.0),
        acquisition: Some(AcquisitionReport {
            mode: "dual-port".into(),
            words_per_cycle: 128.0,
            words_written: 4_000_000,
            volumes_written: 1,
            updates_per_s: 480.0,
            updates_per_s_limit: 488.0,
            stolen_cycles: 0,
            buffers: 1,
            torn_frames: 1,
        }),
        animation: Some("animation.png".into()),
        frames: vec![frame(error.whole, error.footprint.error, None), frame(None, None, Some(NO_OBJECT))],
    });
    report
}

#[test]
fn is_of_this_layout() {
    assert_eq!(schema()["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert_eq!(schema()["properties"]["schema"]["const"], SCHEMA);
}

#[test]
fn full_empty_and_long_reports_follow_it() {
    let mut empty = sample::report();
    (empty.timing, empty.limits, empty.resources, empty.traffic, empty.error) = (None, None, None, None, None);
    empty.units.clear();
    empty.channels.clear();
    empty.plan.left_out.clear();
    (empty.words, empty.wall, empty.digest) = Default::default();
    empty.volume.scale = None;
    empty.sources = Default::default();
    empty.command.clear();
    for report in [sample::report(), sequence(), empty] {
        assert_eq!(faults(&value(&report)), [""; 0]);
    }
}

/// Each place of a report: the way to it, and the same with `[]` for any element of a list.
fn places(value: &Value, pointer: &str, path: &str, places: &mut Vec<[String; 2]>) {
    match value {
        Value::Object(entries) => {
            for (key, value) in entries {
                let [pointer, path] = [format!("{pointer}/{key}"), format!("{path}/{key}")];
                places_of_key(value, pointer, path, places);
            }
        }
        Value::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                self::places(item, &format!("{pointer}/{index}"), &format!("{path}[]"), places);
            }
        }
        _ => {}
    }
}

fn places_of_key(value: &Value, pointer: String, path: String, places: &mut Vec<[String; 2]>) {
    self::places(value, &pointer, &path, places);
    places.push([pointer, path]);
}

fn is_optional(path: &str) -> bool {
    let open = ["/words/overflows/", "/units[]/waiting/", "/scene/", "/machine/"];
    OPTIONAL.contains(&path) || open.iter().any(|map| path.starts_with(map))
}

#[test]
fn a_report_without_one_of_its_keys_or_with_another_is_refused() {
    let whole = value(&sequence());
    let mut all = Vec::new();
    places(&whole, "", "", &mut all);
    assert!(all.len() > 250, "{}", all.len());
    let schema = schema();
    let is_valid = |report: &Value| follows::faults(&schema, report).is_empty();
    for [pointer, path] in &all {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let mut without = whole.clone();
        let object = without.pointer_mut(parent).unwrap().as_object_mut().unwrap();
        let gone = object.remove(key).unwrap();
        assert_eq!(is_valid(&without), is_optional(path), "without {path}");
        let object = without.pointer_mut(parent).unwrap().as_object_mut().unwrap();
        object.insert(key.into(), gone);
        object.insert("unknown".into(), serde_json::json!([true]));
        let open = path.starts_with("/scene/") || path.starts_with("/machine/");
        assert_eq!(is_valid(&without), open, "another key beside {path}");
    }
}

#[test]
fn numbers_of_the_wrong_kind_are_refused() {
    let breaks = [
        ("/timing/cycles", serde_json::json!(0.5)),
        ("/timing/cycles", serde_json::json!(-1)),
        ("/timing/fps", Value::Null),
        ("/view/offset", serde_json::json!(1.0)),
        ("/volume/dims", serde_json::json!([1, 2])),
        ("/volume/dims/0", serde_json::json!(0)),
        ("/volume/window", serde_json::json!("0 to 1")),
        ("/digest/image", serde_json::json!("0123")),
        ("/error/fraction_off", serde_json::json!(1.5)),
        ("/sequence/acquisition/mode", serde_json::json!("none")),
        ("/schema", serde_json::json!(1)),
    ];
    let whole = value(&sequence());
    for (pointer, wrong) in breaks {
        let mut report = whole.clone();
        *report.pointer_mut(pointer).unwrap() = wrong;
        assert!(faults(&report).iter().any(|fault| fault.starts_with(pointer)), "{pointer}");
    }
}

/// Every object of the schema is closed, or says of what its entries are, and each of its keys is explained.
#[test]
fn explains_every_key() {
    fn walk(value: &Value, path: &str) {
        if let Some(properties) = value.get("properties").and_then(Value::as_object) {
            assert_eq!(value["additionalProperties"], false, "{path}");
            for (key, property) in properties {
                let about = property["description"].as_str().unwrap_or_default();
                assert!(about.ends_with('.'), "{path}/{key} has no sentence: {about}");
            }
        }
        match value {
            Value::Object(entries) => entries.iter().for_each(|(key, value)| walk(value, &format!("{path}/{key}"))),
            Value::Array(items) => items.iter().for_each(|item| walk(item, path)),
            _ => {}
        }
    }
    walk(&schema(), "");
}
