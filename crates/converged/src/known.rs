//! What is known of a part in which nothing is analytic: ranges.

use crate::optics::Optics;
use crate::part::Part;
use crate::polynomial;
use crate::stretches::Stretch;
use cube3_scene::{Mode, ResolvedLight};

/// −∫ln|p| over h for a cubic p is at most h·(3·ln 4 + 3 − ln max|p|): the set where |p| is below ε·max|p| is no longer than 4·h·∛ε
/// (Remez), and the logarithm's integral is that of the sets.
const REMEZ: f64 = 7.16;

/// The same of a polynomial of degree 6: h·(6·ln 4 + 6 − ln max|p|).
const REMEZ_OF_SQUARE: f64 = 14.32;

/// What is known of a part for which nothing else can be done.
pub(crate) struct Known {
    pub colour: [[f64; 2]; 3],
    pub depth: [f64; 2],
    /// It may hide everything behind it.
    pub hides_all: Option<Hides>,
}

/// What is seen of a part that may hide everything behind it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hides {
    /// The colours of what hides.
    pub colour: [[f64; 2]; 3],
    /// The most that is hidden by what is before it.
    pub before: f64,
}

impl Hides {
    /// The most that the middle of the colours is off by, if everything is hidden.
    pub fn error(&self) -> f64 {
        half(&self.colour) + self.before
    }
}

impl Known {
    /// The ranges of a part's colour and depth.
    pub fn of(optics: &Optics<'_>, lights: &[ResolvedLight], part: &Part) -> Known {
        let [low, high] = polynomial::range(&part.value);
        let values = [low - part.slack, high + part.slack];
        let colour = optics.colours(part, lights, false);
        let [least, most] = optics.stretches.opacities(values, optics.magnitudes(part));
        if optics.scene.mode == Mode::WeightedSum {
            return Known { colour, depth: [least, most].map(|alpha| alpha * part.length()), hides_all: None };
        }
        // What is rounded to 1 need not be.
        let least = -libm::log1p(-least.min(1.0 - 4.0 * f64::EPSILON)) * part.length();
        if optics.two_dimensional {
            // One minus it, less what rounding may have taken.
            let clear = 1.0 - most - 8.0 * f64::EPSILON;
            let most = match clear > 0.0 {
                true => -libm::log(clear) * part.length(),
                false => most_depth_by_gradient(optics, part, values),
            };
            let hides_all = most.is_infinite().then_some(Hides { colour, before: 0.0 });
            return Known { colour, depth: [least, most.max(least)], hides_all };
        }
        let most = most_depth(optics, part, values);
        if let Some(rgb) = optics.stretches.opaque_colours(values) {
            // What is not opaque comes before what is, or is not seen.
            let hides = match most.is_finite() {
                true => Hides { colour: optics.lit_range(part, lights, rgb, false), before: -libm::expm1(-most) },
                false => Hides { colour, before: 0.0 },
            };
            return Known { colour, depth: [least, f64::INFINITY], hides_all: Some(hides) };
        }
        let hides_all = most.is_infinite().then_some(Hides { colour, before: 0.0 });
        Known { colour, depth: [least, most.max(least)], hides_all }
    }

    /// With a depth that is known to be no more than `most`: then not everything is hidden.
    pub fn held(mut self, most: f64) -> Known {
        if most < self.depth[1] {
            self.depth[1] = most.max(self.depth[0]);
            self.hides_all = None;
        }
        self
    }

    /// Half of the widest range of a colour.
    fn colour_half(&self) -> f64 {
        half(&self.colour)
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

/// Half of the widest range.
fn half(ranges: &[[f64; 2]; 3]) -> f64 {
    ranges.iter().fold(0.0, |most, [low, high]| most.max((high - low) / 2.0))
}

/// The most that a part's depth is, but for what is opaque: by its least clearness, or where that comes to 0 at a single value by Remez;
/// infinite where that is not known.
fn most_depth(optics: &Optics<'_>, part: &Part, values: [f64; 2]) -> f64 {
    let (mut full, mut slope, mut extinction) = (None, f64::INFINITY, 0.0_f64);
    for stretch in optics.stretches.between(values).iter().filter(|stretch| !stretch.clear && !stretch.opaque) {
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

/// The same where opacity depends on the gradient and one layer is opaque: 1 − α goes to 0 with |g| − G, and |g|² is a polynomial of degree 6.
fn most_depth_by_gradient(optics: &Optics<'_>, part: &Part, values: [f64; 2]) -> f64 {
    let Some(gradient) = part.gradient.as_ref() else { return f64::INFINITY };
    let layers = &optics.stretches.gradients;
    let magnitudes = optics.magnitudes(part);
    let stretches = optics.stretches.between(values);
    let is_full = |layer: usize| stretches.iter().all(|stretch| !stretch.clear && stretch.opacity[layer] == [1.0, 0.0]);
    let least = |layer: usize| {
        let of = |stretch: &Stretch| {
            let moved = stretch.moved_opacity(4.0 * part.slack);
            stretch.part(values).map(|value| stretch.clearness_at(layer, value)).into_iter().fold(1.0, f64::min) - moved
        };
        stretches.iter().filter(|stretch| !stretch.clear).map(of).fold(1.0, f64::min)
    };
    let first = layers.partition_point(|g| *g <= magnitudes[0]).saturating_sub(1);
    let last = layers.partition_point(|g| *g < magnitudes[1]).min(layers.len() - 1);
    let mut full = (first..=last).filter(|&layer| is_full(layer));
    let (Some(layer), None) = (full.next(), full.next()) else { return f64::INFINITY };
    // Beyond the first and the last layer opacity stays what it is.
    let ends =
        (layer == 0 && magnitudes[0] < layers[0]) || (layer + 1 == layers.len() && magnitudes[1] > layers[layer]);
    let others = (first..=last).filter(|&other| other != layer);
    let clear = others.clone().map(least).fold(1.0, f64::min);
    let widest = others.map(|other| (layers[other] - layers[layer]).abs()).fold(0.0, f64::max);
    if ends || clear <= 0.0 || widest == 0.0 {
        return f64::INFINITY;
    }
    let level = layers[layer] * layers[layer];
    let square =
        |x: f64| gradient.square.iter().rev().fold(0.0, |sum, c| sum * x + c) * gradient.scale * gradient.scale;
    let slack =
        8.0 * magnitudes[1] * (gradient.moved() + 4.0 * f64::EPSILON * magnitudes[1] / gradient.scale) * gradient.scale;
    let away = [-1.0, 0.0, 1.0].map(|x| (square(x) - level).abs()).into_iter().fold(0.0, f64::max) - slack;
    if away <= slack {
        return f64::INFINITY;
    }
    let least = clear / widest * away / (magnitudes[1] + layers[layer]);
    part.length() * (REMEZ_OF_SQUARE - libm::log(least.min(1.0)))
}
