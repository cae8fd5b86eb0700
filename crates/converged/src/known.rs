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
        let length = 2.0 * part.half;
        let mut depth = [least, most].map(|alpha| -libm::log1p(-alpha) * length);
        if most >= 1.0 - 1e-9 {
            depth[1] = depth_near_opaque(optics, part, values).unwrap_or(f64::INFINITY).max(depth[0]);
        }
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

/// The most that a part's depth is where opacity comes to 1 at a single value, by Remez; none where it stays there.
fn depth_near_opaque(optics: &Optics<'_>, part: &Part, values: [f64; 2]) -> Option<f64> {
    if optics.two_dimensional {
        return None;
    }
    let (mut full, mut slope) = (None, f64::INFINITY);
    for stretch in optics.stretches.between(values) {
        if stretch.opaque {
            return None;
        }
        for end in stretch.values.into_iter().filter(|end| end.is_finite()) {
            if stretch.clear || stretch.opacity_at(0, end) < 1.0 - 1e-9 {
                continue;
            }
            if full.is_some_and(|full| full != end) || stretch.opacity[0][1] == 0.0 {
                return None;
            }
            full = Some(end);
            slope = slope.min(stretch.opacity[0][1].abs());
        }
    }
    let full = full?;
    let away = [-1.0, 0.0, 1.0].map(|x| (polynomial::at(&part.value, x) - full).abs());
    let away = away.into_iter().fold(0.0, f64::max) - 4.0 * part.slack;
    (away > 4.0 * part.slack).then(|| 2.0 * part.half * (REMEZ - libm::log((slope * away).min(1.0))))
}
