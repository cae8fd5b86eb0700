//! Two empty pictures are equal, and no report makes a result of that.

use crate::sample;
use cube3_metrics::{compare, footprint};
use cube3_picture::Picture;
use cube3_report::{ErrorReport, FrameReport, NO_OBJECT, RunReport, from_json, html, table, to_json};
use serde_json::Value;

/// The report of a run whose picture and reference show the background alone.
fn report() -> RunReport {
    let black = Picture::filled(8, 6, [0.0; 3]).unwrap();
    let object = footprint(&black, &black, [0.0; 3]).unwrap();
    let comparison = compare(&black, &black, Some(&object)).unwrap();
    RunReport { error: Some(ErrorReport::new("image-order", &comparison, 1.0)), ..sample::report() }
}

const MEASURES: [&str; 5] = ["mean_relative", "rms", "max", "psnr_db", "fraction_off"];

#[test]
fn every_measure_is_null_and_the_remark_says_why() {
    let text = to_json(&report()).unwrap();
    let error = serde_json::from_str::<Value>(&text).unwrap()["error"].clone();
    for measure in MEASURES {
        for part in [&error, &error["footprint"]] {
            assert_eq!(part.get(measure), Some(&Value::Null), "{measure}");
        }
    }
    assert_eq!(error["footprint"]["pixels"], 0);
    assert_eq!(error["remark"], NO_OBJECT);
    assert_eq!(from_json(&text).unwrap(), report());
}

#[test]
fn terminal_and_page_have_the_remark_and_no_number() {
    let (text, page) = (table(&report()), html(&report(), &[]));
    // The glossary explains words that are not used here.
    let page = page.split("<section id=\"glossary\">").next().unwrap();
    for shown in [text.as_str(), page] {
        assert!(shown.contains("there is no error to measure"), "{shown}");
        for number in ["∞", "equal", "Mean relative", "PSNR"] {
            assert!(!shown.contains(number), "{number}: {shown}");
        }
    }
}

/// Where one of the two shows something, the error is a number, and there is no remark.
#[test]
fn an_object_in_one_picture_alone_is_an_error() {
    let black = Picture::filled(8, 6, [0.0; 3]).unwrap();
    let mut dot = black.clone();
    dot.pixels[9] = [1.0; 3];
    for (a, b) in [(&black, &dot), (&dot, &black)] {
        let object = footprint(a, b, [0.0; 3]).unwrap();
        let error = ErrorReport::new("image-order", &compare(a, b, Some(&object)).unwrap(), 1.0);
        assert_eq!((error.footprint.error.unwrap().mean_relative, error.footprint.pixels), (1.0, 1));
        assert_eq!((error.whole.unwrap().mean_relative, error.remark), (1.0 / 48.0, None));
    }
}

#[test]
fn measures_are_all_numbers_or_none() {
    let mut value: Value = serde_json::from_str(&to_json(&sample::report()).unwrap()).unwrap();
    value["error"]["rms"] = Value::Null;
    let error = from_json(&value.to_string()).unwrap_err().to_string();
    assert!(error.contains("all are numbers, or none"), "{error}");
}

/// A frame of a sequence that shows nothing has the remark in the place of its number.
#[test]
fn frames_without_an_object_have_the_remark() {
    let frame = |error, remark| FrameReport {
        angles_deg: None,
        cycles: None,
        end_cycle: None,
        volume: 0,
        newest_volume: 0,
        newer_fraction: 0.0,
        torn: false,
        mixed_beams: 0,
        first_torn_plane: None,
        error,
        footprint: None,
        remark,
        digest: Default::default(),
    };
    let mut report = report();
    (report.timing, report.units) = (None, Vec::new());
    report.sequence = Some(cube3_report::SequenceReport {
        fps_sustained: None,
        time_s: None,
        playback_fps: None,
        acquisition: None,
        animation: None,
        frames: vec![frame(None, Some(NO_OBJECT.into()))],
    });
    report.check().unwrap();
    let page = html(&report, &[]);
    assert!(page.contains(&format!("<td>{NO_OBJECT}</td>")));
    assert!(table(&report).contains("Largest mean error over the object"));
    let text = to_json(&report).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&text).unwrap()["sequence"]["frames"][0]["remark"], NO_OBJECT);
    assert_eq!(from_json(&text).unwrap(), report);
}
