//! `report.json`: its keys, its bytes, its round trip.

use crate::sample;
use cube3_report::{ReportError, WallReport, from_json, to_json, write_json};
use serde_json::{Value, json};

fn value() -> Value {
    serde_json::from_str(&to_json(&sample::report()).unwrap()).unwrap()
}

#[test]
fn has_every_key_that_scripts_rely_on() {
    let value = value();
    for pointer in [
        "/schema",
        "/scene/view/yaw_deg",
        "/machine/lanes",
        "/plan/left_out/0/what",
        "/plan/left_out/0/why",
        "/plan/left_out/0/saves",
        "/timing/cycles",
        "/timing/clock_hz",
        "/timing/frame_time_s",
        "/timing/fps",
        "/timing/fps_sustained",
        "/timing/frame_interval_cycles",
        "/timing/beams",
        "/timing/samples",
        "/timing/samples_per_s",
        "/timing/ray_slots",
        "/timing/fill_cycles",
        "/units/0/name",
        "/units/0/busy",
        "/units/0/starved",
        "/units/0/blocked",
        "/units/0/waiting/memory",
        "/channels/0/name",
        "/channels/0/capacity",
        "/channels/0/latency",
        "/channels/0/pushes",
        "/channels/0/pops",
        "/channels/0/occupancy",
        "/channels/0/max_occupancy",
        "/channels/0/mean_occupancy",
        "/words/overflows/abc.colour",
        "/error/against",
        "/error/mean_relative",
        "/error/rms",
        "/error/max",
        "/error/psnr_db",
        "/error/fraction_off",
        "/error/percentile_99",
        "/error/bias",
        "/error/gradient_mean_deg",
        "/error/footprint/mean_relative",
        "/error/footprint/rms",
        "/error/footprint/max",
        "/error/footprint/psnr_db",
        "/error/footprint/fraction_off",
        "/error/footprint/percentile_99",
        "/error/footprint/bias",
        "/error/footprint/pixels",
        "/error/difference_factor",
        "/wall/volume_s",
        "/wall/total_s",
        "/wall/timing_s",
        "/wall/function_s",
        "/wall/reference_s",
        "/wall/samples_per_s",
        "/digest/base_plane",
        "/digest/image",
        "/volume/source",
        "/volume/dims",
        "/volume/spacing",
        "/volume/conversion",
        "/volume/window",
        "/volume/word_bits",
        "/volume/scale",
        "/volume/clipped_below",
        "/volume/clipped_above",
        "/volume/masked",
        "/command/0",
        "/sources/machine_preset",
        "/sources/machine_file",
        "/sources/scene_file",
        "/channels/0/from",
        "/channels/0/to",
        "/view/major_axis",
        "/view/flips",
        "/view/slopes",
        "/view/offset",
        "/view/template_rule",
        "/view/base_plane_size",
        "/program/version",
        "/seed",
    ] {
        assert!(value.pointer(pointer).is_some(), "{pointer}");
    }
    assert_eq!(value["schema"], 3);
}

#[test]
fn comes_back_as_it_went() {
    let report = sample::report();
    let text = to_json(&report).unwrap();
    assert_eq!(from_json(&text).unwrap(), report);
    assert_eq!(to_json(&from_json(&text).unwrap()).unwrap(), text);
}

#[test]
fn every_double_comes_back_to_the_bit() {
    let mut report = sample::report();
    for bits in [0x3fb9_9999_9999_999a_u64, 0x3fe5_5555_5555_5555, 0x0010_0000_0000_0001, 1] {
        report.view.offset = f64::from_bits(bits);
        let back = from_json(&to_json(&report).unwrap()).unwrap();
        assert_eq!(back.view.offset.to_bits(), bits);
    }
}

#[test]
fn is_indented_and_ends_in_a_newline() {
    let mut bytes = Vec::new();
    write_json(&sample::report(), &mut bytes).unwrap();
    assert!(bytes.starts_with(b"{\n  \"schema\": 3,\n"));
    assert!(bytes.ends_with(b"}\n"));
}

#[test]
fn differs_between_runs_only_under_wall() {
    let slow = sample::report();
    let mut fast = slow.clone();
    fast.wall = WallReport { timing_s: Some(1e-3), threads: Some(64), ..WallReport::default() };
    assert_ne!(to_json(&slow).unwrap(), to_json(&fast).unwrap());
    assert_eq!(to_json(&slow.without_wall()).unwrap(), to_json(&fast.without_wall()).unwrap());
}

#[test]
fn what_was_not_run_is_null_and_not_missing() {
    let mut report = sample::report();
    report.timing = None;
    report.units.clear();
    report.error = None;
    report.wall = WallReport::default();
    let value: Value = serde_json::from_str(&to_json(&report).unwrap()).unwrap();
    assert_eq!(value["timing"], Value::Null);
    assert_eq!(value["error"], Value::Null);
    assert_eq!(value["wall"]["timing_s"], Value::Null);
    assert!(value["wall"].get("timing_s").is_some());
    assert_eq!(from_json(&to_json(&report).unwrap()).unwrap(), report);
}

#[test]
fn equal_pictures_have_a_null_psnr() {
    let mut report = sample::report();
    let error = report.error.as_mut().unwrap();
    error.whole.as_mut().unwrap().psnr_db = None;
    let value: Value = serde_json::from_str(&to_json(&report).unwrap()).unwrap();
    assert_eq!(value["error"]["psnr_db"], Value::Null);
    assert_eq!(from_json(&to_json(&report).unwrap()).unwrap(), report);
}

#[test]
fn a_number_that_json_cannot_hold_is_refused_with_its_key() {
    let mut report = sample::report();
    report.error.as_mut().unwrap().footprint.error.as_mut().unwrap().rms = f64::NAN;
    let mut bytes = Vec::new();
    let error = write_json(&report, &mut bytes).unwrap_err();
    assert!(error.to_string().starts_with("error.footprint.rms is NaN"), "{error}");
    assert!(bytes.is_empty());
}

#[test]
fn another_schema_is_named() {
    let mut value = value();
    value["schema"] = json!(1);
    let error = from_json(&value.to_string()).unwrap_err();
    assert!(matches!(error, ReportError::Schema { found: 1, expected: 3 }), "{error}");
}

#[test]
fn text_that_is_no_report_is_an_error() {
    for text in ["", "{", "[]", "{}", "{\"schema\":3}"] {
        assert!(matches!(from_json(text), Err(ReportError::Json(_))), "{text}");
    }
}
