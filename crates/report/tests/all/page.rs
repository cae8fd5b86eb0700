//! The HTML page.

use crate::sample;
use cube3_report::{Figure, html, png_rgb8};
use serde_json::json;

fn page() -> String {
    let png = png_rgb8(2, 1, &[255, 0, 0, 0, 0, 255]).unwrap();
    let figure = Figure { title: "Image", caption: "Two pixels", png: &png, still: None };
    html(&sample::report(), &[figure])
}

#[test]
fn refers_to_nothing_outside_itself() {
    let page = page();
    let outside = page.replace("http://www.w3.org/2000/svg", "");
    for word in ["http://", "https://", "//cdn", "@import", "<link", "<script", "<iframe"] {
        assert!(!outside.contains(word), "{word}");
    }
    for (at, _) in page.match_indices("src=\"") {
        assert!(page[at..].starts_with("src=\"data:image/png;base64,"));
    }
    for (at, _) in page.match_indices("url(") {
        assert!(page[at..].starts_with("url(#"));
    }
}

#[test]
fn carries_its_pictures() {
    let page = page();
    assert!(page.contains("base64,iVBORw0KGgo"));
    assert!(page.contains("width=\"2\" height=\"1\""));
    assert!(page.contains("alt=\"Image: Two pixels\""));
}

#[test]
fn escapes_text_wherever_it_stands() {
    let evil = "<script>alert(\"1\")</script>'&";
    let mut report = sample::report();
    report.scene = json!({"name": evil, "note": evil});
    report.machine = json!({"name": evil, "nothing": null});
    report.fidelity = evil.into();
    report.program.version = evil.into();
    report.volume.source = evil.into();
    report.volume.conversion = evil.into();
    report.command = vec!["cube3".into(), evil.into()];
    report.sources.machine_preset = Some(evil.into());
    report.sources.scene_file = Some(evil.into());
    report.view.template_rule = evil.into();
    report.view.major_axis = evil.into();
    report.plan.left_out[0].what = evil.into();
    report.plan.left_out[0].why = evil.into();
    report.plan.left_out[0].saves = evil.into();
    report.units[0].name = evil.into();
    report.units[0].waiting = [(evil.into(), 820)].into();
    report.channels[0].name = evil.into();
    report.channels[0].from = evil.into();
    report.words.overflows = [(evil.into(), 1)].into();
    report.error.as_mut().unwrap().against = evil.into();
    report.digest.image = Some(evil.into());
    let figure = Figure { title: evil, caption: evil, png: b"", still: None };
    let page = html(&report, &[figure]);
    assert!(!page.contains("<script"));
    assert!(!page.contains("alert(\"1\")"));
    assert!(page.contains("&lt;script&gt;alert(&quot;1&quot;)"));
}

#[test]
fn is_well_formed_for_a_reader() {
    let page = page();
    assert!(page.starts_with("<!DOCTYPE html><html lang=\"en\">"));
    assert_eq!(page.matches("<h1>").count(), 1);
    assert!(page.matches("<h2>").count() >= 6);
    assert_eq!(page.matches("<img").count(), page.matches(" alt=\"").count());
    assert!(page.contains("prefers-color-scheme: dark"));
    assert!(page.contains("role=\"img\""));
    for tag in ["section", "table", "details", "svg", "g", "figure", "div", "dl", "pre"] {
        let open = page.matches(&format!("<{tag}>")).count() + page.matches(&format!("<{tag} ")).count();
        assert_eq!(open, page.matches(&format!("</{tag}>")).count(), "{tag}");
    }
}

#[test]
fn each_bar_fills_its_row() {
    let page = page();
    let bars = page.split("<svg class=\"bars\"").nth(1).unwrap().split("</svg>").next().unwrap();
    let widths: Vec<f64> = bars
        .match_indices("<rect class=\"")
        .filter_map(|(at, _)| bars[at..].split("width=\"").nth(1)?.split('"').next()?.parse().ok())
        .filter(|width: &f64| width.fract() != 0.0 || *width > 30.0)
        .collect();
    let sum: f64 = widths.iter().sum();
    let rows = sample::report().units.len() as f64;
    assert!((sum - 850.0 * rows).abs() < 0.1, "{sum}");
}

#[test]
fn shows_scene_and_machine_ready_for_a_file() {
    let page = page();
    assert!(page.contains("The scene as resolved (TOML)"));
    assert!(page.contains("yaw_deg = 30.0"));
    let mut report = sample::report();
    report.machine = json!({"preset": null});
    assert!(html(&report, &[]).contains("The machine as resolved (JSON)"));
}

#[test]
fn a_report_of_nothing_is_still_a_page() {
    let mut report = sample::report();
    report.timing = None;
    report.error = None;
    report.units.clear();
    report.channels.clear();
    report.plan.left_out.clear();
    report.words.overflows.clear();
    report.wall = Default::default();
    report.digest = Default::default();
    let page = html(&report, &[]);
    assert!(page.contains("Not measured: no clock ran."));
    assert!(page.ends_with("</html>"));
}
