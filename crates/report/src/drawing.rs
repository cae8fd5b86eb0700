//! The machine as a drawing for one who has not read the paper: units from the volume to the host, and the channels between them, as inline SVG.
//!
//! What is drawn is what the report names; a sentence for each unit that is known is added.

use maud::{Markup, html};

use crate::quantity::number;
use crate::shares::{percent, thousandths};
use crate::{ChannelReport, UnitReport};

/// What each unit does, in words that need no paper.
const DOES: [(&str, &str); 8] = [
    ("cfb", "Frame buffer: the volume, read a beam at a time"),
    ("bus", "Fast bus: turns each beam towards the rays"),
    ("dsb.write", "Skewed buffer: takes beams, plane by plane"),
    ("dsb.read", "Skewed buffer: gives rays, all depths at once"),
    ("trilin", "Interpolates samples between the voxels"),
    ("abc", "Gradient, colour, opacity, light of a sample"),
    ("cone", "Adds up the samples of each ray to a pixel"),
    ("host", "Warps the pixels to the picture that is seen"),
];

/// In the drawing's own units, of which a narrow telephone shows one as nearly a pixel.
const WIDTH: u32 = 380;
const BOX: u32 = 60;
const GAP: u32 = 42;
const BAR: u32 = 5;
/// From the edges of a box to what is in it.
const INSET: u32 = 12;
/// From the left edge to the arrows.
const ARROW: u32 = 24;

/// The units one below the other in the order of the report, with the share of cycles in which each worked; none where no clock ran.
pub(crate) fn drawing(units: &[UnitReport], channels: &[ChannelReport]) -> Markup {
    let height = (BOX + GAP) * units.len() as u32 - GAP.min(units.len() as u32 * GAP) + 2;
    html! {
        section #machine {
            h2 { "The machine" }
            p {
                "Cube-3 makes a picture of a volume, a grid of numbers such as a scan, by casting rays through it. In each cycle it reads a whole row of "
                "voxels, a beam, so that the samples of a whole ray come out at once. "
                @if units.is_empty() {
                    "No clock ran, so that there are no cycles of its units to show."
                } @else {
                    "Each box is a unit; all work at the same time, each on another part of the picture. Each arrow is a channel, a short queue that holds "
                    "the unit behind it back when it is full. The bar in a box is the share of the cycles in which the unit worked."
                }
            }
            @if !units.is_empty() {
                svg.machine viewBox=(format!("0 0 {WIDTH} {height}")) role="img" aria-label="The units of the machine from the volume to the picture, and the channels between them" {
                    defs {
                        marker #head viewBox="0 0 10 10" refX="9" refY="5" markerWidth="8" markerHeight="8" orient="auto" {
                            path.head d="M0 0L10 5L0 10z" {}
                        }
                    }
                    @for (unit, row) in units.iter().zip(0..) {
                        (unit_box(unit, row * (BOX + GAP)))
                    }
                    @for (pair, row) in units.windows(2).zip(0..) {
                        (arrow(&pair[0].name, &pair[1].name, channels, row * (BOX + GAP) + BOX))
                    }
                }
            }
        }
    }
}

fn unit_box(unit: &UnitReport, top: u32) -> Markup {
    let waiting = u64::try_from(unit.waiting_cycles()).unwrap_or(u64::MAX);
    let busy = thousandths(&[unit.busy, unit.starved, unit.blocked, waiting])[0];
    let does = DOES.iter().find(|(name, _)| *name == unit.name).map_or("", |(_, does)| does);
    let track = WIDTH - 2 * INSET;
    html! {
        g {
            rect.unit x="1" y=(top + 1) width=(WIDTH - 2) height=(BOX) rx="6" {}
            rect.track x=(INSET) y=(top + BOX - BAR - 4) width=(track) height=(BAR) {}
            rect.work x=(INSET) y=(top + BOX - BAR - 4) width=(format!("{:.1}", f64::from(track) * f64::from(busy) / 1000.0)) height=(BAR) {}
            text.unit x=(INSET) y=(top + 21) { (unit.name) }
            text.note x=(WIDTH - INSET) y=(top + 21) text-anchor="end" { "busy " (percent(busy)) }
            text x=(INSET) y=(top + 41) { (does) }
        }
    }
}

/// The channel from one unit to the next, or dashes where both are ports of one unit.
fn arrow(from: &str, to: &str, channels: &[ChannelReport], top: u32) -> Markup {
    let channel = channels.iter().find(|channel| channel.from == from && channel.to == to);
    let unit = |name: &str| name.split_once('.').map(|(unit, _)| unit.to_owned());
    let inside = unit(from).is_some() && unit(from) == unit(to);
    let (y1, y2, middle) = (top + 1, top + GAP, top + GAP / 2 + 5);
    html! {
        @if let Some(channel) = channel {
            line.channel x1=(ARROW) y1=(y1) x2=(ARROW) y2=(y2) marker-end="url(#head)" {}
            text.note x=(ARROW + 16) y=(middle) {
                tspan.unit { (channel.name) } ": holds " (channel.capacity) ", " (number(channel.mean_occupancy)) " on average"
            }
        } @else if inside {
            line.channel x1=(ARROW) y1=(y1) x2=(ARROW) y2=(y2) stroke-dasharray="5 4" marker-end="url(#head)" {}
            text.note x=(ARROW + 16) y=(middle) { "inside of the unit" }
        }
    }
}
