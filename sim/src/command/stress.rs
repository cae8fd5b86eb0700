//! `cube3 stress`: the stiff and the extreme, by every method and every formula.

use super::run::print;
use super::{on_threads, threads};
use crate::output::write_files;
use crate::problem::{Outcome, Problem};
use crate::progress::Bars;
use clap::Args;
use comfy_table::{Cell, CellAlignment, Table, presets};
use cube3_method::{METHODS, Method, find};
use cube3_rendering::MethodError;
use cube3_report::number;
use cube3_study::stress::{CASES, FORMULAS, Row, stress, try_formula};
use serde_json::json;
use std::path::PathBuf;

/// Version of the file's form.
const SCHEMA: u32 = 1;

/// Arguments of `cube3 stress`.
#[derive(Debug, Args)]
pub struct StressArguments {
    /// Methods that are tried, e.g. function,converged; all without it.
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = method)]
    methods: Vec<&'static Method>,
    /// Cases whose group or name has this text; all without it.
    #[arg(long, value_name = "TEXT", default_value = "")]
    only: String,
    /// A line for each method of a case, and not the worst alone.
    #[arg(long)]
    each: bool,
    /// Threads; all cores without it.
    #[arg(long)]
    threads: Option<usize>,
    /// Folder for the numbers.
    #[arg(long, value_name = "DIR", default_value = "out/stress")]
    out: PathBuf,
}

fn method(name: &str) -> Result<&'static Method, MethodError> {
    find(METHODS, name.trim())
}

impl StressArguments {
    /// Tries every case, prints a line for each and writes the numbers.
    ///
    /// # Errors
    /// A case that is not finite, out of range or beyond its bound; a text that no case has.
    pub fn execute(self) -> Outcome<()> {
        let methods = if self.methods.is_empty() { METHODS.to_vec() } else { self.methods.clone() };
        let has = |group: &str, name: &str| format!("{group}: {name}").contains(&self.only);
        let cases: Vec<_> = CASES.iter().filter(|case| has(case.group, case.name)).collect();
        let formulas: Vec<_> = FORMULAS.iter().filter(|formula| has("formulas", formula.name)).collect();
        if cases.is_empty() && formulas.is_empty() {
            let groups: std::collections::BTreeSet<&str> =
                CASES.iter().map(|case| case.group).chain(["formulas"]).collect();
            let groups = groups.into_iter().collect::<Vec<_>>().join(", ");
            return Err(Problem::new(format!("--only {}: no case has this text; groups are {groups}", self.only)));
        }
        threads(self.threads)?;
        let bars = Bars::default();
        let all = cases.len() + formulas.len();
        let rows: Vec<Vec<Row>> = on_threads(self.threads, || {
            let mut rows = Vec::new();
            for case in cases {
                bars.set("cases", rows.len() as u64, all as u64);
                rows.push(stress(case, &methods));
            }
            for formula in formulas {
                bars.set("cases", rows.len() as u64, all as u64);
                rows.push(try_formula(formula));
            }
            Ok(rows)
        })?;
        drop(bars);
        print(&format!("{}\n", table(&rows, self.each)))?;
        let rows: Vec<Row> = rows.into_iter().flatten().collect();
        let wrong: Vec<&Row> = rows.iter().filter(|row| !row.holds()).collect();
        let numbers = json!({ "schema": SCHEMA, "rows": rows });
        let files = [
            ("stress.json", (serde_json::to_string_pretty(&numbers)? + "\n").into_bytes()),
            ("stress.csv", csv(&rows).into_bytes()),
        ];
        print(&format!("wrote {}\n", write_files(&self.out, &files)?.join(" ")))?;
        let Some(first) = wrong.first() else { return Ok(()) };
        Err(Problem::found(format!(
            "{} of {} are wrong, the first: {}: {} by {}: {}",
            wrong.len(),
            rows.len(),
            first.group,
            first.case,
            first.method,
            state(first)
        )))
    }
}

/// A line a case: the method nearest to its bound, and what has failed; classic formulas have their own.
fn table(rows: &[Vec<Row>], each: bool) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_header(["case", "by", "worst error", "bound", "of", "", "time"]);
    let right = |text: String| Cell::new(text).set_alignment(CellAlignment::Right);
    for of_case in rows {
        let part = |row: &Row| {
            let share = row.error.map_or(0.0, |error| error / row.bound.max(f64::MIN_POSITIVE));
            (!row.holds(), share)
        };
        let worst = of_case
            .iter()
            .filter(|row| !row.classic)
            .max_by(|a, b| part(a).partial_cmp(&part(b)).unwrap_or(std::cmp::Ordering::Equal));
        let shown =
            of_case.iter().filter(|row| each || row.classic || worst.is_some_and(|worst| std::ptr::eq(*row, worst)));
        let seconds: f64 = of_case.iter().map(|row| row.time_s).sum();
        for (i, row) in shown.enumerate() {
            let time = if each { row.time_s } else { seconds };
            table.add_row([
                Cell::new(if i == 0 { format!("{}: {}", row.group, row.case) } else { String::new() }),
                Cell::new(&row.method),
                right(row.error.map_or_else(|| "–".into(), number)),
                right(if row.error.is_some() { number(row.bound) } else { "–".into() }),
                Cell::new(row.unit),
                Cell::new(state(row)),
                right(if each || i == 0 { format!("{time:.2} s") } else { String::new() }),
            ]);
        }
    }
    table
}

fn state(row: &Row) -> String {
    if let Some(why) = &row.refused {
        return format!("refused: {why}");
    }
    match (row.finite, row.in_range, row.kept, row.classic) {
        (false, ..) => "not finite".into(),
        (_, false, ..) => "out of range".into(),
        (_, _, false, true) => "fails, as is known".into(),
        (_, _, false, false) => "beyond its bound".into(),
        _ => "holds".into(),
    }
}

fn csv(rows: &[Row]) -> String {
    let mut text =
        String::from("schema,group,case,method,unit,error,bound,kept,finite,in_range,classic,time_s,refused\n");
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    for row in rows {
        text += &format!(
            "{SCHEMA},{},{},{},{},{},{},{},{},{},{},{},{}\n",
            quoted(&row.group),
            quoted(&row.case),
            quoted(&row.method),
            quoted(row.unit),
            row.error.map_or(String::new(), |error| error.to_string()),
            row.bound,
            row.kept,
            row.finite,
            row.in_range,
            row.classic,
            row.time_s,
            quoted(row.refused.as_deref().unwrap_or_default()),
        );
    }
    text
}
