//! Diagrams with a logarithmic vertical axis, as SVG that stands alone.

use super::summary::number;
use maud::{Markup, PreEscaped, html};
use std::collections::BTreeSet;

/// Space around a panel's axes, in pixels.
const LEFT: f64 = 66.0;
const TOP: f64 = 30.0;
const RIGHT: f64 = 14.0;
const BOTTOM: f64 = 46.0;
/// Height of the legend above the panels.
const LEGEND: f64 = 30.0;
/// Width of a letter, measured generously.
const LETTER: f64 = 7.0;

/// The whole drawing's style: an SVG file must carry its own.
const STYLE: &str = "text{font:12px system-ui,'DejaVu Sans',sans-serif;fill:#16191d}.title{font-weight:600;font-size:13px}\
.axis{stroke:#16191d;fill:none}.grid{stroke:#d9dde3;fill:none}.bound{stroke:#6b7480;stroke-dasharray:2 3;fill:none}\
.line{fill:none;stroke-width:1.8}.cloud{stroke:#b9c0ca;stroke-width:2.4;stroke-linecap:round;fill:none}\
.mark{stroke-width:1.4}.halo{paint-order:stroke;stroke:#ffffff;stroke-width:3px}";

/// Marks of a series with more points are smaller.
const MANY: usize = 40;

/// Look of a series: colour, dashes, shape of its marks; told apart without colour too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Look {
    /// Colour.
    pub colour: &'static str,
    /// Dashed, with hollow marks.
    pub dashed: bool,
    /// Marks.
    pub mark: Mark,
}

/// Shape of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mark {
    Circle,
    Square,
    Triangle,
    Diamond,
    Star,
}

/// Points of one kind.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    /// What the legend calls it.
    pub name: String,
    /// Its look.
    pub look: Look,
    /// Whether lines join the points.
    pub joined: bool,
    /// Abscissa and ordinate. An ordinate of 0 is drawn at the lower edge.
    pub points: Vec<[f64; 2]>,
}

/// One diagram.
#[derive(Clone, Debug, Default)]
pub(crate) struct Panel {
    /// Above it.
    pub title: String,
    /// Name and unit of the abscissa.
    pub across: String,
    /// Name and unit of the ordinate.
    pub up: String,
    /// Whether the abscissa is logarithmic; else it is in whole numbers.
    pub log: bool,
    /// Lines and marks.
    pub series: Vec<Series>,
    /// Points without a name, behind all.
    pub cloud: Vec<[f64; 2]>,
    /// A line across, with its name.
    pub bound: Option<(f64, String)>,
}

/// Panels in rows under one legend, each `width` by `height` pixels. The legend is that of the first panel.
pub(crate) fn figure(panels: &[Panel], columns: usize, width: f64, height: f64) -> String {
    let rows = panels.len().div_ceil(columns);
    let (whole, tall) = (width * columns.min(panels.len()) as f64, LEGEND + height * rows as f64);
    let place = |index: usize| [width * (index % columns) as f64, LEGEND + height * (index / columns) as f64];
    let markup = html! {
        svg xmlns="http://www.w3.org/2000/svg" width=(whole) height=(tall) viewBox=(format!("0 0 {whole} {tall}")) role="img" {
            style { (PreEscaped(STYLE)) }
            rect width=(whole) height=(tall) fill="#ffffff" {}
            @if let Some(first) = panels.first() { (legend(&first.series)) }
            @for (index, panel) in panels.iter().enumerate() {
                @let [x, y] = place(index);
                g transform=(format!("translate({x} {y})")) { (panel.draw(width, height)) }
            }
        }
    };
    markup.into_string()
}

fn legend(series: &[Series]) -> Markup {
    let mut left = 12.0;
    let entries: Vec<(f64, &Series)> = series
        .iter()
        .map(|series| {
            let at = left;
            left += 44.0 + LETTER * series.name.chars().count() as f64;
            (at, series)
        })
        .collect();
    html! {
        @for (x, series) in entries {
            @if series.joined { (line(&[[x, 16.0], [x + 26.0, 16.0]], series.look)) }
            (marks(&[[x + 13.0, 16.0]], series.look, 1.0))
            text x=(x + 32.0) y="20" { (series.name) }
        }
    }
}

/// A line through places.
fn line(places: &[[f64; 2]], look: Look) -> Markup {
    let points: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
    html! {
        polyline.line points=(points.join(" ")) stroke=(look.colour) stroke-dasharray=[look.dashed.then_some("6 3")] {}
    }
}

/// Marks, `size` times as large as by themselves, in one path. Squares are larger than circles, so that both show where they lie
/// on each other.
fn marks(places: &[[f64; 2]], look: Look, size: f64) -> Markup {
    let fill = if look.dashed { "#ffffff" } else { look.colour };
    let shape = match look.mark {
        Mark::Circle => "m-2.3 0a2.3 2.3 0 1 0 4.6 0a2.3 2.3 0 1 0 -4.6 0z",
        Mark::Square => "m-3.5 -3.5h7v7h-7z",
        Mark::Triangle => "m0 -3.4l3.2 5.6h-6.4z",
        Mark::Diamond => "m0 -4.6l4.6 4.6l-4.6 4.6l-4.6 -4.6z",
        Mark::Star => "m0 -7.5l2 5.2h5.4l-4.4 3.4l1.7 5.4l-4.7 -3.3l-4.7 3.3l1.7 -5.4l-4.4 -3.4h5.4z",
    };
    let at = |[x, y]: &[f64; 2]| format!("M{:.1} {:.1}{shape}", x / size, y / size);
    let scale = (size != 1.0).then(|| format!("scale({size})"));
    html! {
        path.mark d=(places.iter().map(at).collect::<String>()) transform=[scale] fill=(fill) stroke=(look.colour) {}
    }
}

/// An axis: values at both ends, and where its lines are.
struct Axis {
    low: f64,
    high: f64,
    log: bool,
    ticks: Vec<f64>,
}

impl Axis {
    /// Whole decades around the values; or a part of one between 1, 2 and 5, where they span little.
    fn decades(values: impl Iterator<Item = f64>) -> Axis {
        let positive: Vec<f64> = values.filter(|value| *value > 0.0).collect();
        let low = positive.iter().copied().fold(f64::INFINITY, f64::min);
        let high = positive.iter().copied().fold(0.0, f64::max);
        if positive.is_empty() {
            return Axis { low: 0.1, high: 10.0, log: true, ticks: vec![0.1, 1.0, 10.0] };
        }
        let (first, last) = (low.log10().floor() as i32 - 1, high.log10().ceil() as i32 + 1);
        let steps: &[f64] = if high / low < 30.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let all: Vec<f64> =
            (first..=last).flat_map(|decade| steps.iter().map(move |step| step * 10_f64.powi(decade))).collect();
        let from = all.iter().rposition(|tick| *tick <= low).unwrap_or(0);
        let to = all.iter().position(|tick| *tick >= high).unwrap_or(all.len() - 1).max(from + 1);
        let ticks = all[from..=to.min(all.len() - 1)].to_vec();
        Axis { low: all[from], high: ticks[ticks.len() - 1], log: true, ticks }
    }

    /// Whole numbers around the values.
    fn whole(values: impl Iterator<Item = f64>) -> Axis {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if low > high {
            return Axis { low: 0.0, high: 1.0, log: false, ticks: vec![0.0, 1.0] };
        }
        let high = high.max(low + 1.0);
        let step = [1.0, 2.0, 4.0, 8.0].into_iter().find(|step| (high - low) / step <= 9.0).unwrap_or(16.0);
        let first = (low / step).ceil();
        let ticks = (0..).map(|i| (first + f64::from(i)) * step).take_while(|tick| *tick <= high).collect();
        Axis { low, high, log: false, ticks }
    }

    /// Part of the way from the low to the high end; values below the low end are at it.
    fn part(&self, value: f64) -> f64 {
        match self.log {
            true if value <= self.low => 0.0,
            true => (value / self.low).log10() / (self.high / self.low).log10(),
            false => (value - self.low) / (self.high - self.low),
        }
    }
}

impl Panel {
    fn draw(&self, width: f64, height: f64) -> Markup {
        let points = || self.series.iter().flat_map(|series| &series.points).chain(&self.cloud);
        let abscissas = || points().map(|point| point[0]);
        let across = if self.log { Axis::decades(abscissas()) } else { Axis::whole(abscissas()) };
        let bound = self.bound.as_ref().map(|(bound, _)| *bound);
        let up = Axis::decades(points().map(|point| point[1]).chain(bound));
        let (right, bottom) = (width - RIGHT, height - BOTTOM);
        let x = |value: f64| LEFT + across.part(value) * (right - LEFT);
        let y = |value: f64| bottom - up.part(value) * (bottom - TOP);
        let place = |&[a, b]: &[f64; 2]| [x(a), y(b)];
        let middle = (TOP + bottom) / 2.0;
        // One path for all, each pixel once: a dot is a line without length.
        let pixels: BTreeSet<[i64; 2]> =
            self.cloud.iter().map(|point| place(point).map(|at| at.round() as i64)).collect();
        let cloud: String = pixels.iter().map(|[x, y]| format!("M{x} {y}h0")).collect();
        html! {
            text.title x="8" y=(TOP - 10.0) { (self.title) }
            @for tick in &up.ticks {
                @let at = y(*tick);
                path.grid d=(format!("M{LEFT} {at:.1}H{right}")) {}
                text x=(LEFT - 6.0) y=(format!("{:.1}", at + 4.0)) text-anchor="end" { (number(*tick)) }
            }
            @for tick in &across.ticks {
                @let at = x(*tick);
                path.grid d=(format!("M{at:.1} {TOP}V{bottom}")) {}
                text x=(format!("{at:.1}")) y=(bottom + 16.0) text-anchor="middle" { (number(*tick)) }
            }
            path.axis d=(format!("M{LEFT} {TOP}V{bottom}H{right}")) {}
            text x=(format!("{:.1}", (LEFT + right) / 2.0)) y=(bottom + 34.0) text-anchor="middle" { (self.across) }
            text transform=(format!("translate(14 {middle:.1}) rotate(-90)")) text-anchor="middle" { (self.up) }
            @if !cloud.is_empty() { path.cloud d=(cloud) {} }
            @if let Some((bound, _)) = &self.bound {
                @let at = y(*bound);
                path.bound d=(format!("M{LEFT} {at:.1}H{right}")) {}
            }
            // The first series is on top.
            @for series in self.series.iter().rev() {
                @let places: Vec<[f64; 2]> = series.points.iter().map(place).collect();
                @let size = if places.len() > MANY { 0.6 } else { 1.0 };
                @if series.joined { (line(&places, series.look)) }
                (marks(&places, series.look, size))
            }
            @if let Some((bound, name)) = &self.bound {
                // Below the line where the title is above it.
                @let under = if y(*bound) < TOP + 16.0 { 14.0 } else { -4.0 };
                text.halo x=(right - 2.0) y=(format!("{:.1}", y(*bound) + under)) text-anchor="end" { (name) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_hold_their_values_between_round_ticks() {
        let axis = Axis::decades([0.03, 7.0, 0.0].into_iter());
        assert_eq!((axis.low, axis.high, axis.ticks.len()), (0.01, 10.0, 4));
        assert_eq!((axis.part(0.0), axis.part(0.01), axis.part(10.0)), (0.0, 0.0, 1.0));
        assert!((axis.part(1.0) - 2.0 / 3.0).abs() < 1e-12);
        let axis = Axis::decades([3.0e6, 4.0e6].into_iter());
        assert_eq!(axis.ticks, [2e6, 5e6]);
        let axis = Axis::decades([1.0].into_iter());
        assert!(axis.low <= 1.0 && axis.high > axis.low);
        let axis = Axis::whole((1..=32).map(f64::from));
        assert_eq!(axis.ticks, [4.0, 8.0, 12.0, 16.0, 20.0, 24.0, 28.0, 32.0]);
        assert_eq!((axis.part(1.0), axis.part(32.0)), (0.0, 1.0));
    }
}
