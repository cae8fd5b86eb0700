//! The machine as a drawing: units with their utilisation as colour, channels with capacity, latency and mean occupancy.
//!
//! What is drawn is what the run has counted; nothing is listed here a second time.

use cube3_channel::{Account, Reason};
use cube3_pipeline::{ChannelReading, RunCounters};
use maud::{Markup, html};
use std::fmt::Write;
use std::path::Path;

/// How a drawing is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawing {
    /// A picture.
    Svg,
    /// A graph for Graphviz.
    Dot,
}

impl Drawing {
    /// The drawing that a file's extension asks for, svg or dot.
    pub fn of(path: &Path) -> Option<Drawing> {
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("svg") => Some(Drawing::Svg),
            Some("dot") => Some(Drawing::Dot),
            _ => None,
        }
    }

    /// The drawing of a run.
    pub fn draw(self, counters: &RunCounters) -> String {
        match self {
            Drawing::Svg => svg(counters),
            Drawing::Dot => dot(counters),
        }
    }
}

/// An arrow: from and to are places among the units.
struct Arrow<'a> {
    from: usize,
    to: usize,
    /// None where two ports of one unit share what is inside.
    channel: Option<&'a ChannelReading>,
}

fn arrows(counters: &RunCounters) -> Vec<Arrow<'_>> {
    let place = |name: &str| counters.units.iter().position(|(unit, _)| *unit == name);
    let channels = counters.channels.iter().filter_map(|channel| {
        let (from, to) = (place(channel.joint.from)?, place(channel.joint.to)?);
        Some(Arrow { from, to, channel: Some(channel) })
    });
    let unit = |name: &'static str| name.split_once('.').map(|(unit, _)| unit);
    let ports = counters.units.windows(2).enumerate().filter_map(|(i, pair)| {
        (unit(pair[0].0).is_some() && unit(pair[0].0) == unit(pair[1].0)).then_some(Arrow {
            from: i,
            to: i + 1,
            channel: None,
        })
    });
    channels.chain(ports).collect()
}

/// The row of each unit: one below the lowest of those that it takes from.
fn rows(units: usize, arrows: &[Arrow<'_>]) -> Vec<usize> {
    let mut rows = vec![0; units];
    // A path has fewer arrows than there are units; a circle ends here, too.
    for _ in 1..units {
        for arrow in arrows {
            rows[arrow.to] = rows[arrow.to].max(rows[arrow.from] + 1).min(units - 1);
        }
    }
    rows
}

fn share(part: u64, account: &Account) -> f64 {
    part as f64 / account.cycles().max(1) as f64
}

/// White for a unit that never works to dark blue for one that always does; and a colour for the text on it.
fn colours(busy: f64) -> (String, &'static str) {
    const IDLE: [f64; 3] = [247.0, 251.0, 255.0];
    const FULL: [f64; 3] = [8.0, 69.0, 148.0];
    let [r, g, b] = [0, 1, 2].map(|i| (IDLE[i] + (FULL[i] - IDLE[i]) * busy).round() as u8);
    (format!("#{r:02x}{g:02x}{b:02x}"), if busy > 0.5 { "#ffffff" } else { "#1a1a1a" })
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// Every kind of cycle of a unit, in words.
fn words(name: &str, account: &Account) -> String {
    let kinds = [("busy", account.busy), ("starved", account.starved), ("blocked", account.blocked)];
    let waiting = Reason::ALL.iter().map(|&reason| (reason.name(), account.waiting[reason as usize]));
    let parts: Vec<String> = kinds
        .into_iter()
        .chain(waiting.filter(|(_, cycles)| *cycles > 0))
        .map(|(kind, cycles)| format!("{kind} {}", percent(share(cycles, account))))
        .collect();
    format!("{name}: {}", parts.join(", "))
}

/// What is written at an arrow: a line of name, and one of numbers.
fn label(channel: &ChannelReading, cycles: u64) -> [String; 2] {
    let mean = channel.counters.occupancy_cycles as f64 / cycles.max(1) as f64;
    let (tokens, s) = (channel.capacity, if channel.latency == 1 { "" } else { "s" });
    [
        channel.name.to_owned(),
        format!("capacity {tokens}, latency {} cycle{s}, mean occupancy {mean:.2}", channel.latency),
    ]
}

const BOX: [usize; 2] = [190, 52];
/// From box to box, across and down.
const STEP: [usize; 2] = [470, 112];
const MARGIN: usize = 24;
const TITLE: usize = 40;
const LEGEND: usize = 64;
const LEGEND_STEPS: usize = 11;

fn svg(counters: &RunCounters) -> String {
    let arrows = arrows(counters);
    let rows = rows(counters.units.len(), &arrows);
    let place: Vec<[usize; 2]> = (0..rows.len())
        .map(|unit| {
            let column = rows[..unit].iter().filter(|row| **row == rows[unit]).count();
            [MARGIN + column * STEP[0], TITLE + MARGIN + rows[unit] * STEP[1]]
        })
        .collect();
    let right = place.iter().map(|place| place[0]).max().unwrap_or(0);
    let below = place.iter().map(|place| place[1]).max().unwrap_or(0);
    let (width, height) = (right + STEP[0] + MARGIN, below + BOX[1] + LEGEND + MARGIN);
    let title = format!("Cube-3: {} cycles", counters.cycles);
    let drawing = html! {
        svg xmlns="http://www.w3.org/2000/svg" viewBox=(format!("0 0 {width} {height}")) width=(width) height=(height)
            font-family="sans-serif" font-size="13" fill="#1a1a1a" role="img" aria-label=(title) {
            title { (title) }
            defs {
                marker id="head" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="8" markerHeight="8" orient="auto" {
                    path d="M0 0L10 5L0 10z" fill="#1a1a1a" {}
                }
            }
            rect width="100%" height="100%" fill="#ffffff" {}
            text x=(MARGIN) y=(TITLE) font-size="18" font-weight="bold" { (title) }
            @for arrow in &arrows {
                (svg_arrow(arrow, &place, counters.cycles))
            }
            @for ((name, account), place) in counters.units.iter().zip(&place) {
                (svg_unit(name, account, *place))
            }
            (svg_legend(below + BOX[1] + MARGIN))
        }
    };
    drawing.into_string() + "\n"
}

fn svg_unit(name: &str, account: &Account, [x, y]: [usize; 2]) -> Markup {
    let busy = share(account.busy, account);
    let (fill, ink) = colours(busy);
    let middle = x + BOX[0] / 2;
    html! {
        g {
            title { (words(name, account)) }
            rect x=(x) y=(y) width=(BOX[0]) height=(BOX[1]) rx="6" fill=(fill) stroke="#1a1a1a" {}
            text x=(middle) y=(y + 22) fill=(ink) text-anchor="middle" font-size="15" font-weight="bold" { (name) }
            text x=(middle) y=(y + 41) fill=(ink) text-anchor="middle" { "busy " (percent(busy)) }
        }
    }
}

fn svg_arrow(arrow: &Arrow<'_>, place: &[[usize; 2]], cycles: u64) -> Markup {
    let [from, to] = [place[arrow.from], place[arrow.to]];
    let (x1, y1, x2, y2) = (from[0] + BOX[0] / 2, from[1] + BOX[1], to[0] + BOX[0] / 2, to[1]);
    let dashes = if arrow.channel.is_some() { None } else { Some("5 4") };
    let (x, y) = ((x1 + x2) / 2 + 14, usize::midpoint(y1, y2));
    html! {
        line x1=(x1) y1=(y1) x2=(x2) y2=(y2) stroke="#1a1a1a" stroke-width="1.5" stroke-dasharray=[dashes] marker-end="url(#head)" {}
        @if let Some(channel) = arrow.channel {
            @let [name, numbers] = label(channel, cycles);
            text x=(x) y=(y - 4) font-weight="bold" { (name) }
            text x=(x) y=(y + 14) { (numbers) }
        } @else {
            text x=(x) y=(y + 5) font-style="italic" { (INSIDE) }
        }
    }
}

/// What joins two ports of one unit.
const INSIDE: &str = "inside of the unit";

fn svg_legend(y: usize) -> Markup {
    let step = 2 * BOX[0] / LEGEND_STEPS;
    html! {
        g {
            text x=(MARGIN) y=(y + 12) { "busy, share of the cycles" }
            @for i in 0..LEGEND_STEPS {
                @let busy = i as f64 / (LEGEND_STEPS - 1) as f64;
                @let (fill, ink) = colours(busy);
                rect x=(MARGIN + i * step) y=(y + 22) width=(step) height="20" fill=(fill) stroke="#1a1a1a" {}
                text x=(MARGIN + i * step + step / 2) y=(y + 36) fill=(ink) text-anchor="middle" font-size="11" { (format!("{:.0}", 100.0 * busy)) }
            }
        }
    }
}

fn dot(counters: &RunCounters) -> String {
    let cycles = counters.cycles;
    let mut text = format!(
        "digraph cube3 {{\n  label=\"Cube-3: {cycles} cycles; colour: busy, white 0 % to blue 100 %\";\n  node [shape=box, style=\"filled,rounded\", fontname=\"sans-serif\"];\n  edge [fontname=\"sans-serif\"];\n"
    );
    // Writing to a string cannot fail.
    for (name, account) in &counters.units {
        let busy = share(account.busy, account);
        let (fill, ink) = colours(busy);
        let _ = writeln!(
            text,
            "  \"{name}\" [label=\"{name}\\nbusy {}\", fillcolor=\"{fill}\", fontcolor=\"{ink}\", tooltip=\"{}\"];",
            percent(busy),
            words(name, account)
        );
    }
    for arrow in arrows(counters) {
        let [from, to] = [arrow.from, arrow.to].map(|unit| counters.units[unit].0);
        let (label, style) = match arrow.channel {
            Some(channel) => (label(channel, cycles).join("\\l") + "\\l", "solid"),
            None => (INSIDE.to_owned(), "dashed"),
        };
        let _ = writeln!(text, "  \"{from}\" -> \"{to}\" [label=\"{label}\", style={style}];");
    }
    text + "}\n"
}
