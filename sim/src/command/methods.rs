//! `cube3 methods`: the ways to make a picture, and what each can show.

use super::run::print;
use crate::problem::Outcome;
use clap::Args;
use comfy_table::{Cell, CellAlignment, Table, presets};
use cube3_method::{METHODS, Method};
use cube3_rendering::{Feature, MethodOption};
use serde_json::{Value, json};

/// Arguments of `cube3 methods`.
#[derive(Debug, Args)]
pub struct MethodsArguments {
    /// As JSON.
    #[arg(long)]
    json: bool,
}

impl MethodsArguments {
    /// Prints the table.
    ///
    /// # Errors
    /// JSON that cannot be made.
    pub fn execute(self) -> Outcome<()> {
        if self.json {
            let rows: Vec<Value> = METHODS.iter().map(|method| row(method)).collect();
            return print(&(serde_json::to_string_pretty(&rows)? + "\n"));
        }
        let mut text = String::new();
        for method in METHODS {
            let about = method.about;
            text += &format!("{}\n  {}\n  {}\n", about.name, about.what, about.source);
            for MethodOption { name, about, kind } in about.options.iter().copied() {
                let values = MethodOption { name, about, kind }.values();
                text += &format!("  :{name}  {about}: {values}\n");
            }
        }
        print(&format!("{text}\n{}\n", features()))
    }
}

/// What each can show: a row for each feature, a column for each method.
fn features() -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_header(std::iter::once("shows").chain(METHODS.iter().map(|method| method.about.name)));
    for feature in Feature::ALL {
        let mark = |method: &&Method| {
            let mark = if method.about.supports.contains(&feature) { "yes" } else { "–" };
            Cell::new(mark).set_alignment(CellAlignment::Center)
        };
        table.add_row(std::iter::once(Cell::new(feature.name())).chain(METHODS.iter().map(mark)));
    }
    let mark = |method: &&Method| {
        Cell::new(if method.needs_no_machine() { "–" } else { "yes" }).set_alignment(CellAlignment::Center)
    };
    table.add_row(std::iter::once(Cell::new("needs a machine")).chain(METHODS.iter().map(mark)));
    table
}

fn row(method: &Method) -> Value {
    let about = method.about;
    let option =
        |option: &MethodOption| json!({ "name": option.name, "about": option.about, "values": option.values() });
    json!({
        "name": about.name,
        "what": about.what,
        "source": about.source,
        "supports": about.supports.iter().map(|feature| feature.name()).collect::<Vec<_>>(),
        "options": about.options.iter().map(option).collect::<Vec<_>>(),
        "needs_machine": !method.needs_no_machine(),
    })
}
