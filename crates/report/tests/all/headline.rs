//! What comes first: the error over the object in parts and levels, then what limits.

use crate::sample;
use cube3_metrics::{ImageComparison, ImageError};
use cube3_report::{ErrorReport, RunReport, html, table};

/// A report whose object is off by these parts of the full range.
fn off(mean_relative: f64, percentile_99: f64, max: f64, bias: f64) -> RunReport {
    let error = ImageError {
        mean_relative,
        rms: mean_relative,
        max,
        psnr_db: Some(20.0),
        fraction_off: 1.0,
        percentile_99,
        bias,
    };
    // Over the whole image everything is a tenth, so that one is not taken for the other.
    let whole = ImageError {
        mean_relative: mean_relative / 10.0,
        percentile_99: percentile_99 / 10.0,
        max,
        bias: bias / 10.0,
        ..error
    };
    let comparison = ImageComparison { whole, footprint: Some(error), footprint_pixels: 100 };
    RunReport { error: Some(ErrorReport::new("true", &comparison, 1.0)), ..sample::report() }
}

/// The texts of a page without its head and its tags, in order.
fn words(page: &str) -> Vec<String> {
    let body = page.split("<body>").nth(1).unwrap();
    let mut words = Vec::new();
    for piece in body.split('<').skip(1) {
        let text = piece.split_once('>').map_or("", |(_, text)| text).trim();
        if !text.is_empty() {
            words.push(text.to_owned());
        }
    }
    words
}

#[test]
fn the_first_number_of_the_page_is_the_error_over_the_object() {
    let report = off(0.02, 0.1, 0.2, -0.01);
    let words = words(&html(&report, &[]));
    let expected = [
        "Head phantom, bone and skin",
        "Error over the object",
        "2 %",
        "5.10 levels of 255 on average, against true",
        "99th percentile",
        "10 %",
        "25.5 levels",
        "Largest",
        "20 %",
        "51 levels",
        "Bias",
        "−1 %",
        "2.55 levels, darker than the reference",
        "Frames per second",
        "488",
        "in an animation; 439 for one frame alone",
        "What limits",
        "memory",
    ];
    assert_eq!(words[..expected.len()], expected);
}

#[test]
fn the_first_numbers_of_the_table_are_those_of_the_object() {
    let text = table(&off(0.02, 0.1, 0.2, 0.01));
    let lines: Vec<String> =
        text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).take(13).collect();
    let expected = [
        "cube3: Head phantom, bone and skin",
        "",
        "Error over the object",
        "of full range of 255",
        "Mean 2 % 5.10 levels",
        "99th percentile 10 % 25.5 levels",
        "Largest 20 % 51 levels",
        "Bias +1 % 2.55 levels, brighter than the reference",
        "Against true",
        "",
        "What limits the frame rate",
        "Frames per second 488 in an animation, 439 alone",
        "What limits memory: 439.4 frames/s; without it 520.5, then the bus",
    ];
    assert_eq!(lines, expected);
}

#[test]
fn where_no_error_was_measured_it_says_why_in_that_place() {
    let mut timing = sample::report();
    (timing.error, timing.digest.image) = (None, None);
    let mut plain = sample::report();
    plain.error = None;
    let empty = ImageComparison {
        footprint: None,
        footprint_pixels: 0,
        whole: off(0.1, 0.1, 0.1, 0.0).error.unwrap().whole.unwrap(),
    };
    let nothing = RunReport { error: Some(ErrorReport::new("true", &empty, 1.0)), ..sample::report() };
    for (report, why) in [
        (timing, "no picture was made: only the clock ran"),
        (plain, "the picture was made without a reference to compare it with"),
        (nothing, "neither picture shows an object: there is no error to measure"),
    ] {
        let words = words(&html(&report, &[]));
        assert_eq!(words[1..4], ["Error over the object", "not measured", why]);
        let text = table(&report);
        let third = text.lines().skip(3).take(2).map(str::trim).collect::<Vec<_>>().join(" ");
        assert!(third.starts_with(&format!("not measured: {why}")), "{third}");
    }
}

#[test]
fn what_was_asked_for_stands_on_page_and_table() {
    let report = sample::report();
    let (page, text) = (html(&report, &[]), table(&report));
    for part in [
        "preset cube3-128",
        "file my head.toml",
        "phantom head, 128 × 128 × 128 voxels",
        "yaw 30°, tilt 7°, parallel",
        "composite",
        "cube3 run --scene 'my head.toml' --machine cube3-128",
    ] {
        assert!(page.replace("&#39;", "'").contains(part), "{part} is not on the page");
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    for (name, view, words) in [
        ("a direction", serde_json::json!({"direction": [1.0, 0.5, 0.0]}), "along (1, 0.5, 0), parallel"),
        (
            "an eye",
            serde_json::json!({"yaw_deg": -20.0, "tilt_deg": 0.0, "roll_deg": 3.0, "perspective": {"field_of_view_deg": 40.0}}),
            "yaw -20°, tilt 0°, roll 3°, perspective of 40°",
        ),
    ] {
        let mut report = sample::report();
        report.scene["view"] = view;
        assert!(table(&report).contains(words), "{name}");
    }
    let mut file = sample::report();
    (file.sources.machine_preset, file.sources.machine_file) = (None, Some("my.toml".into()));
    assert!(table(&file).contains("file my.toml"));
    file.sources.machine_file = None;
    assert!(table(&file).contains("cube3-128"), "a machine without a source has its name");
}

#[test]
fn an_estimator_that_the_plan_left_out_is_said_to_be() {
    let mut report = sample::report();
    assert!(
        table(&report).lines().any(|line| line.trim().starts_with("Gradient estimator") && line.trim().ends_with("12"))
    );
    report.plan.left_out[0].rule = "gradient-unit".into();
    report.plan.left_out[0].why = "nothing is shaded".into();
    assert!(table(&report).contains("12; left out here: nothing is shaded"));
}
