//! The study as one page for a browser, which needs nothing else.

use super::picture::Aim;
use super::summary::{
    Table, about, family_table, front_table, number, shortest_table, thin_shortest_table, thin_table,
};
use super::sweeps::Base;
use super::{Plots, Study};
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("page.css");

/// The page may show what it carries, and reach for nothing else.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'";

/// The page, with the diagrams.
pub fn page(study: &Study, plots: &Plots) -> String {
    let drawing = |svg: &str| html! { div.wide { (PreEscaped(svg.to_owned())) } };
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "Word lengths" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { "Word lengths: " (study.machine.name) }
                p { (about(study)) }
                h2 { "Error against cost" }
                p {
                    "Each grey dot is a design. Cost is the cells of all operators (a multiplier of a by b bits is a·b, an adder of w bits "
                    "is w) and the bits of tables and buffers, without the frame buffer."
                }
                (drawing(&plots.front))
                @for aim in Aim::ALL { (table(&front_table(study, aim))) }
                h2 { "All words alike" }
                (table(&family_table(study)))
                h2 { "One word at a time, the others at their longest" }
                (drawing(&plots.wires_wide))
                (table(&shortest_table(study, Base::Wide)))
                h2 { "One word at a time, the others as the machine has them" }
                (drawing(&plots.wires_machine))
                (table(&shortest_table(study, Base::Machine)))
                @if let Some(gradients) = &plots.gradients {
                    h2 { "Gradients and normals" }
                    p { "Angle to the gradient of the same estimator in reals. A gradient word of 0 has no direction and counts as 90 degrees." }
                    (drawing(gradients))
                }
                @if let Some(thin) = &plots.thin {
                    h2 { "The cone alone: thin opacity" }
                    (drawing(thin))
                    (table(&thin_table(study)))
                    (table(&thin_shortest_table(study, Base::Wide)))
                    (table(&thin_shortest_table(study, Base::Machine)))
                }
                h2 { "What the logic of the machine's own words is made of" }
                (parts(study))
            }
        }
    };
    markup.into_string()
}

fn table(table: &Table) -> Markup {
    html! {
        @if !table.rows.is_empty() {
            div.wide {
                table {
                    caption { (table.title) }
                    thead { tr { @for head in &table.head { th scope="col" { (head) } } } }
                    tbody { @for row in &table.rows { tr { @for cell in row { td { (cell) } } } } }
                }
            }
        }
    }
}

fn parts(study: &Study) -> Markup {
    let row = |part: &super::cost::PartCost| {
        let operators = &part.operators;
        vec![
            part.part.to_owned(),
            part.count.to_string(),
            operators.multipliers.to_string(),
            operators.adders.to_string(),
            operators.comparators.to_string(),
            part.cells.to_string(),
            number((part.count * part.cells) as f64 / 1e6),
        ]
    };
    table(&Table {
        title: "Operators and cells of each part".into(),
        head: ["part", "how often", "multipliers", "adders", "comparators", "cells of each", "cells, millions"]
            .map(String::from)
            .to_vec(),
        rows: study.parts.iter().map(row).collect(),
    })
}
