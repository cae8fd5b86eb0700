//! The report for a terminal of 80 columns or more.

use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ContentArrangement, Table};

use crate::fact::Fact;
use crate::facts::{self, CycleKind, CycleShare};
use crate::quantity::{count, number};
use crate::shares::percent;
use crate::{ErrorReport, LeftOut, RunReport, UnitReport, headline};

/// No line is wider, in columns.
const WIDTH: u16 = 80;

/// The report as plain text without colours: throughput, what each unit did with its cycles, error,
/// wall times and what was left out. No line is wider than 80 columns, and the text ends in a newline.
///
/// Control characters in names are replaced, so that a file's name cannot steer the terminal.
pub fn table(report: &RunReport) -> String {
    let title = format!("{}: {}", report.program.name, facts::subject(report));
    let mut text = format!("{}\n", clean(&title).replace('\n', " "));
    let mut section = |title: &str, body: String| {
        text.push_str(&format!("\n{title}\n{body}\n"));
    };
    section("Error over the object", object_error(report));
    section("What limits the frame rate", listed(headline::throughput(report)));
    section("Set-up", listed([facts::asked(report), facts::derived(report)].concat()));
    match &report.timing {
        Some(timing) => {
            section("Throughput at the machine's clock", listed(facts::timing(timing)));
        }
        None => section("Throughput", "  not measured: no clock ran".into()),
    }
    if let Some(sequence) = &report.sequence {
        section("Sequence", listed(sequence.facts()));
    }
    if !report.units.is_empty() {
        section("Unit cycles", units(&report.units));
    }
    if let Some(traffic) = &report.traffic {
        section("Traffic", listed(facts::traffic(traffic)));
    }
    if let Some(resources) = &report.resources {
        section("What the machine is made of", listed(facts::resources(resources)));
    }
    match &report.error {
        Some(error) => section("Error", errors(error)),
        None => section("Error", "  not measured: no reference to compare with".into()),
    }
    let overflows = &report.words.overflows;
    if overflows.values().any(|&cycles| cycles > 0) {
        section("Words that overflowed and were saturated", listed_counts(overflows));
    }
    if !facts::wall(&report.wall).is_empty() {
        section("Wall time on this computer", listed(facts::wall(&report.wall)));
    }
    section("Left out", left_out(report.plan.enabled, &report.plan.left_out));
    text
}

fn listed(facts: Vec<Fact>) -> String {
    let rows = facts.into_iter().map(|(what, value)| vec![what.into(), value]);
    render(&[], rows.collect(), &[])
}

/// Each measure in parts of the full range and in levels, or why there is none.
fn object_error(report: &RunReport) -> String {
    match headline::object_error(report) {
        Ok(measures) => {
            let rows = measures.map(|measure| vec![measure.name.into(), measure.part, measure.levels]);
            let mut rows = rows.to_vec();
            rows.extend(headline::against(report).map(|against| vec!["Against".into(), String::new(), against]));
            render(&["", "of full range", "of 255"], rows, &[1])
        }
        Err(why) => render(&[], vec![vec![format!("not measured: {why}")]], &[]),
    }
}

fn listed_counts<'a>(counts: impl IntoIterator<Item = (&'a String, &'a u64)>) -> String {
    let counts = counts.into_iter().filter(|(_, value)| **value > 0);
    let rows = counts.map(|(wire, &value)| vec![wire.clone(), count(value)]);
    render(&[], rows.collect(), &[1])
}

fn units(units: &[UnitReport]) -> String {
    let cell = |share: &CycleShare| format!("{} {:>7}", count(share.cycles), percent(share.thousandths));
    let rows = units.iter().map(|unit| {
        let shares = facts::cycle_shares(unit);
        let of = |kind: CycleKind| shares.iter().filter(move |share| share.kind == kind);
        let one = |kind: CycleKind| of(kind).map(cell).collect::<String>();
        let waiting = of(CycleKind::Waiting).filter(|share| share.cycles > 0);
        let waiting: Vec<String> = waiting.map(|share| format!("{} {}", share.name, cell(share))).collect();
        let waiting = if waiting.is_empty() { "none".into() } else { waiting.join("\n") };
        vec![unit.name.clone(), one(CycleKind::Busy), one(CycleKind::Starved), one(CycleKind::Blocked), waiting]
    });
    render(&["unit", "busy", "starved", "blocked", "waiting for"], rows.collect(), &[1, 2, 3, 4])
}

fn errors(error: &ErrorReport) -> String {
    if let Some(remark) = &error.remark {
        return listed(vec![("Against", error.against.clone()), ("Not measured", remark.clone())]);
    }
    let mut rows = vec![];
    for (what, [whole, object]) in facts::errors(error) {
        rows.push(vec![what.into(), whole, object]);
    }
    let pixels = count(error.footprint.pixels as u64);
    rows.push(vec!["Pixels of the object".into(), String::new(), pixels]);
    let measures = render(&["", "image", "object alone"], rows, &[1, 2]);
    let factor = number(error.difference_factor);
    let about =
        listed(vec![("Against", error.against.clone()), ("Difference picture", format!("magnified {factor} times"))]);
    format!("{about}\n\n{measures}")
}

fn left_out(enabled: bool, left_out: &[LeftOut]) -> String {
    if !enabled {
        return "  nothing: the plan was switched off".into();
    }
    if left_out.is_empty() {
        return "  nothing: this scene needs all of the machine".into();
    }
    let rows = left_out.iter().map(|item| vec![item.what.clone(), item.why.clone(), item.saves.clone()]);
    render(&["what", "why", "saves"], rows.collect(), &[])
}

/// Rows in columns two spaces from the left; the columns in `right` end flush.
pub(crate) fn render(header: &[&str], rows: Vec<Vec<String>>, right: &[usize]) -> String {
    let mut table = Table::new();
    table.load_style(NOTHING).set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH - 1);
    if !header.is_empty() {
        table.set_header(header.to_vec());
    }
    for row in rows {
        table.add_row(row.iter().map(|cell| clean(cell)).collect::<Vec<_>>());
    }
    for &index in right {
        if let Some(column) = table.column_mut(index) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    let lines: Vec<String> = table.lines().map(|line| format!(" {}", line.trim_end())).collect();
    lines.join("\n")
}

/// Control characters other than line ends as a visible mark.
fn clean(text: &str) -> String {
    let visible = |c: char| if c.is_control() && c != '\n' { '\u{fffd}' } else { c };
    text.chars().map(visible).collect()
}
