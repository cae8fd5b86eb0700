//! What is known of a part in which nothing is analytic: ranges.

use crate::optics::Optics;
use crate::part::Part;
use crate::polynomial;
use cube3_scene::{Mode, ResolvedLight};

/// −∫ln|p| over h for a cubic p is at most h·(3·ln 4 + 3 − ln max|p|): the set where |p| is below ε·max|p| is no longer than 4·h·∛ε
/// (Remez), and the logarithm's integral is that of the sets.
const REMEZ: f64 = 7.16;

/// What is known of a part for which nothing else can be done.
pub(crate) struct Known {
    pub colour: [[f64; 2]; 3],
    pub depth: [f64; 2],
    /// It may hide everything behind it.
    pub hides_all: bool,
}

impl Known {
    /// The ranges of a part's colour and depth.
    pub fn of(optics: &Optics<'_>, lights: &[ResolvedLight], part: &Part) -> Known {
        let [low, high] = polynomial::range(&part.value);
        let values = [low - part.slack, high + part.slack];
        let colour = optics.colours(part, lights, false);
        let [least, most] = optics.stretches.opacities(values, optics.magnitudes(part));
        if optics.scene.mode == Mode::WeightedSum {
            return Known { colour, depth: [least, most].map(|alpha| alpha * 2.0 * part.half), hides_all: false };
        }
        let depth = [least, most].map(|alpha| -libm::log1p(-alpha) * part.length());
        let depth =
            if optics.two_dimensional { depth } else { [depth[0], most_depth(optics, part, values).max(depth[0])] };
        Known { colour, depth, hides_all: depth[1] == f64::INFINITY }
    }

    /// Half of the widest range of a colour.
    pub fn colour_half(&self) -> f64 {
        self.colour.iter().fold(0.0, |most, [low, high]| most.max((high - low) / 2.0))
    }

    /// The most that the middle of the ranges is off by, of light that reaches the part whole.
    pub fn error(&self) -> f64 {
        let [least, most] = self.depth.map(|depth| -libm::expm1(-depth));
        self.colour_half() * most + (most - least) / 2.0
    }

    /// The same of a weighted sum.
    pub fn error_of_sum(&self) -> f64 {
        self.colour_half() * self.depth[1] + (self.depth[1] - self.depth[0]) / 2.0
    }
}

/// The most that a part's depth is: by its least clearness, or where that comes to 0 at a single value by Remez; infinite where it stays
/// there.
fn most_depth(optics: &Optics<'_>, part: &Part, values: [f64; 2]) -> f64 {
    let (mut full, mut slope, mut extinction) = (None, f64::INFINITY, 0.0_f64);
    for stretch in optics.stretches.between(values).iter().filter(|stretch| !stretch.clear) {
        let moved = stretch.moved_opacity(4.0 * part.slack);
        let least =
            stretch.part(values).map(|value| stretch.clearness_at(0, value)).into_iter().fold(1.0, f64::min) - moved;
        if least > 0.0 {
            extinction = extinction.max(-libm::log(least));
            continue;
        }
        let is_full = |end: &f64| end.is_finite() && stretch.clearness_at(0, *end) <= moved;
        let mut ends = stretch.values.into_iter().filter(is_full);
        match (ends.next(), ends.next(), full) {
            (Some(end), None, None) => full = Some(end),
            (Some(end), None, Some(other)) if end == other => {}
            _ => return f64::INFINITY,
        }
        slope = slope.min(stretch.opacity[0][1].abs());
    }
    if let Some(full) = full {
        let away = [-1.0, 0.0, 1.0].map(|x| (polynomial::at(&part.value, x) - full).abs());
        let away = away.into_iter().fold(0.0, f64::max) - 4.0 * part.slack;
        if away <= 4.0 * part.slack {
            return f64::INFINITY;
        }
        extinction = extinction.max(0.0) + REMEZ - libm::log((slope * away).min(1.0));
    }
    extinction * part.length()
}
