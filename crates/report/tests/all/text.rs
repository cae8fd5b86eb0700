//! The terminal's tables.

use crate::sample;
use cube3_report::table;

/// The tokens of a line that are numbers, without their commas.
fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().filter_map(|token| token.replace(',', "").parse().ok()).collect()
}

/// The lines of the section on unit cycles, joined for each unit.
fn unit_lines(text: &str) -> Vec<String> {
    let section = text.split("\nUnit cycles\n").nth(1).unwrap();
    let section = section.split("\n\n").next().unwrap();
    let mut units: Vec<String> = Vec::new();
    for line in section.lines().skip(1) {
        if line.starts_with("    ") {
            units.last_mut().unwrap().push_str(line);
        } else {
            units.push(line.into());
        }
    }
    units
}

#[test]
fn the_rows_of_units_add_up_to_the_run_and_to_a_hundred() {
    let report = sample::report();
    let lines = unit_lines(&table(&report));
    assert_eq!(lines.len(), report.units.len());
    for line in lines {
        let numbers = numbers(&line);
        let cycles: f64 = numbers.iter().step_by(2).sum();
        let percent: f64 = numbers.iter().skip(1).step_by(2).sum();
        assert_eq!(cycles, 18_207.0, "{line}");
        assert!((percent - 100.0).abs() < 1e-9, "{line}");
    }
}

#[test]
fn says_what_the_run_is_asked_for() {
    let text = table(&sample::report());
    for part in [
        "18,207",
        "8 MHz",
        "Frames per second",
        "16,384",
        "2,064,384",
        "memory",
        "refresh",
        "image-order, step 1",
        "Mean relative RGB distance",
        "0.410 %",
        "3.1°",
        "abc.colour",
        "Wall time",
        "1,204 beams",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    assert!(!text.contains("cone.opacity"), "a wire without overflows is not news");
}

#[test]
fn fits_eighty_columns() {
    let mut report = sample::report();
    report.plan.left_out[0].why = "a long reason, at some length, ".repeat(20);
    report.error.as_mut().unwrap().against = "another caster ".repeat(20);
    for unit in &mut report.units {
        unit.busy = u64::MAX / 8;
    }
    let text = table(&report);
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
}

#[test]
fn a_name_cannot_steer_the_terminal() {
    let mut report = sample::report();
    report.scene = serde_json::json!({"name": "a\u{1b}[2Jb\u{7}"});
    report.volume.source = "\u{1b}]0;title\u{7}".into();
    report.units[0].name = "\u{9b}31m".into();
    let text = table(&report);
    assert!(!text.chars().any(|c| c.is_control() && c != '\n'), "{text:?}");
}

#[test]
fn what_was_not_run_is_said() {
    let mut report = sample::report();
    report.timing = None;
    report.units.clear();
    report.error = None;
    report.plan.left_out.clear();
    let text = table(&report);
    assert!(text.contains("not measured: no clock ran"));
    assert!(text.contains("not measured: no reference"));
    assert!(text.contains("nothing: this scene needs all of the machine"));
    report.plan.enabled = false;
    assert!(table(&report).contains("nothing: the plan was switched off"));
}
