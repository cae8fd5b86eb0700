//! Bars of what each unit did with its cycles, as inline SVG.

use maud::{Markup, html};

use crate::UnitReport;
use crate::facts::{CycleKind, CycleShare, cycle_shares};
use crate::quantity::count;
use crate::shares::percent;

const WIDTH: u32 = 960;
const LABEL: u32 = 110;
const ROW: u32 = 38;
const BAR: u32 = 28;
/// Width of a digit of the bars' text, measured generously.
const DIGIT: u32 = 8;

/// One bar for each unit, 100 % wide, cut into kinds of cycles. Each piece that is wide enough carries
/// its name and share; each kind has a pattern of its own besides its colour.
pub(crate) fn bars(units: &[UnitReport]) -> Markup {
    let height = ROW * units.len() as u32;
    html! {
        (legend())
        div.wide {
            svg.bars viewBox=(format!("0 0 {WIDTH} {height}")) role="img" aria-label="Shares of each unit's cycles; the table below holds the same numbers" {
                (patterns())
                @for (unit, row) in units.iter().zip(0..) {
                    @let top = row * ROW;
                    text.unit x=(LABEL - 10) y=(top + BAR - 9) text-anchor="end" { (unit.name) }
                    (pieces(unit, top))
                }
            }
        }
    }
}

fn pieces(unit: &UnitReport, top: u32) -> Markup {
    let span = f64::from(WIDTH - LABEL) / 1000.0;
    let mut right = f64::from(LABEL);
    let mut pieces = cycle_shares(unit)
        .into_iter()
        .map(|share| {
            let (left, width) = (right, span * f64::from(share.thousandths));
            right += width;
            (share, left, width)
        })
        .collect::<Vec<_>>();
    pieces.retain(|(share, ..)| share.thousandths > 0);
    html! {
        @for (share, left, width) in &pieces {
            g {
                title { (unit.name) ": " (share.name) " " (count(share.cycles)) " cycles, " (percent(share.thousandths)) }
                rect.(class(share.kind)) x=(format!("{left:.2}")) y=(top) width=(format!("{width:.2}")) height=(BAR) {}
                @if let Some(label) = label(share, *width) {
                    text.on.(class(share.kind)) x=(format!("{:.2}", left + width / 2.0)) y=(top + BAR - 9) text-anchor="middle" { (label) }
                }
            }
        }
    }
}

/// The longest text that fits: name and share, the share, or nothing.
fn label(share: &CycleShare, width: f64) -> Option<String> {
    let share_alone = percent(share.thousandths);
    let full = format!("{} {share_alone}", share.name);
    let fits = |text: &String| f64::from(DIGIT) * text.chars().count() as f64 + 6.0 <= width;
    [full, share_alone].into_iter().find(fits)
}

fn class(kind: CycleKind) -> &'static str {
    match kind {
        CycleKind::Busy => "busy",
        CycleKind::Starved => "starved",
        CycleKind::Blocked => "blocked",
        CycleKind::Waiting => "waiting",
    }
}

fn legend() -> Markup {
    let kinds = [
        (CycleKind::Busy, "busy: working (plain)"),
        (CycleKind::Starved, "starved: no input (dots)"),
        (CycleKind::Blocked, "blocked: no room for the result (stripes)"),
        (CycleKind::Waiting, "waiting for a resource (grid)"),
    ];
    html! {
        ul.legend {
            @for (kind, text) in kinds {
                li {
                    svg width="28" height="16" aria-hidden="true" { rect.(class(kind)) width="28" height="16" {} }
                    (text)
                }
            }
        }
    }
}

/// The fills that tell the kinds apart without colour. The legend's swatches use them too.
fn patterns() -> Markup {
    html! {
        defs {
            pattern id="dots" width="8" height="8" patternUnits="userSpaceOnUse" {
                rect.ground.starved width="8" height="8" {}
                circle.ink.starved cx="4" cy="4" r="1.2" {}
            }
            pattern id="stripes" width="8" height="8" patternUnits="userSpaceOnUse" patternTransform="rotate(45)" {
                rect.ground.blocked width="8" height="8" {}
                rect.ink.blocked width="2" height="8" {}
            }
            pattern id="grid" width="8" height="8" patternUnits="userSpaceOnUse" {
                rect.ground.waiting width="8" height="8" {}
                path.ink.waiting d="M0 0H8M0 0V8" {}
            }
        }
    }
}
