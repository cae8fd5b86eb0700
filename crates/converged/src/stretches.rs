//! The transfer function and the threshold as stretches of values, on each of which opacity and colour are affine.

use cube3_scene::{Scene, Threshold};
use std::borrow::Cow;

/// A straight line: the value at the stretch's origin, and the slope.
type Line = [f64; 2];

/// Values between two bends.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// From the bend below to the one above; infinite beyond the last ones.
    pub values: [f64; 2],
    /// Where the lines begin.
    pub origin: f64,
    /// Opacity of a unit length, for each layer of gradients, or one.
    pub opacity: Vec<Line>,
    /// Red, green and blue.
    pub colour: [Line; 3],
    /// Nothing of it is seen.
    pub clear: bool,
    /// Nothing is seen through it.
    pub opaque: bool,
}

impl Stretch {
    pub fn opacity_at(&self, layer: usize, value: f64) -> f64 {
        let [a, b] = self.opacity[layer];
        a + b * (value - self.origin)
    }

    /// What a unit length lets through: 1 − opacity, with the digits that it has where the opacity is near to 1.
    pub fn clearness_at(&self, layer: usize, value: f64) -> f64 {
        let [a, b] = self.opacity[layer];
        (1.0 - a) - b * (value - self.origin)
    }

    /// What rounding of a value by `slack` and of the line itself moves an opacity by, and one minus it: nothing where it is level.
    pub fn moved_opacity(&self, slack: f64) -> f64 {
        let of = |layer: usize| {
            let slope = self.opacity[layer][1].abs();
            let ends = self.values.map(|end| if end.is_finite() { self.clearness_at(layer, end).abs() } else { 0.0 });
            if slope == 0.0 { 0.0 } else { slope * slack + 8.0 * f64::EPSILON * ends[0].max(ends[1]) }
        };
        (0..self.opacity.len()).map(of).fold(0.0, f64::max)
    }

    pub fn colour_at(&self, value: f64) -> [f64; 3] {
        self.colour.map(|[a, b]| (a + b * (value - self.origin)).clamp(0.0, 1.0))
    }

    /// The largest slope of its colour.
    pub fn steepest_colour(&self) -> f64 {
        self.colour.iter().fold(0.0, |most, line| most.max(line[1].abs()))
    }

    /// Whether nothing is seen through it where some layers count.
    pub fn is_opaque(&self, layers: Layers) -> bool {
        let full = |layer: usize| self.opacity[layer] == [1.0, 0.0];
        !self.clear
            && match layers {
                Layers::One(layer) => full(layer),
                Layers::Between(layer) => full(layer) && full(layer + 1),
            }
    }

    /// Both ends of the part of some values that lies in it.
    pub fn part(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        let part = [low.max(self.values[0]), high.min(self.values[1])];
        // Values that only touch it from outside.
        if part[0] > part[1] { [part[0].min(self.values[1]); 2] } else { part }
    }
}

/// Which layers of gradients count: one alone, or the two on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Layers {
    One(usize),
    Between(usize),
}

/// All stretches, in ascending order; neighbours meet at a bend.
#[derive(Clone, Debug)]
pub(crate) struct Stretches {
    list: Vec<Stretch>,
    /// The layers' gradients.
    pub gradients: Vec<f64>,
    /// Whether rounding must not take a gradient beyond a layer: two have one gradient, so that opacity jumps there, or one hides everything.
    strict_layers: bool,
    threshold: Option<Threshold>,
}

impl Stretches {
    pub fn new(scene: &Scene) -> Stretches {
        let transfer = &scene.transfer;
        let layers: Vec<&[[f64; 2]]> = match transfer.is_two_dimensional() {
            true => transfer.layers.iter().map(|layer| layer.opacity.as_slice()).collect(),
            false => vec![&transfer.opacity],
        };
        let colours = [0, 1, 2].map(|i| transfer.colour.iter().map(|p| [p.value, p.rgb[i]]).collect::<Vec<_>>());
        let threshold = scene.threshold.as_ref();
        let mut bends: Vec<f64> = layers.iter().copied().flatten().chain(&colours[0]).map(|point| point[0]).collect();
        bends.extend(threshold.and_then(|t| t.low));
        bends.extend(threshold.and_then(|t| t.high));
        bends.sort_by(f64::total_cmp);
        bends.dedup();
        let ends = std::iter::once(f64::NEG_INFINITY).chain(bends.iter().copied());
        let ends = ends.zip(bends.iter().copied().chain([f64::INFINITY]));
        let stretch = |(low, high): (f64, f64)| {
            // At the end of the largest opacity lines have their digits of what is let through.
            let most = |end: f64, other: f64| {
                layers.iter().map(|points| end_of(points, end, other)).fold(f64::NEG_INFINITY, f64::max)
            };
            let origin = match (low.is_finite(), high.is_finite()) {
                (true, true) if most(high, low) > most(low, high) => high,
                (true, _) => low,
                _ => high,
            };
            let opacity: Vec<Line> = layers.iter().map(|points| line(points, low, high, origin)).collect();
            let inside = match (low.is_finite(), high.is_finite()) {
                (true, true) => f64::midpoint(low, high),
                (true, false) => f64::MAX,
                _ => f64::MIN,
            };
            let removed = threshold.is_some_and(|threshold| threshold.removes(inside));
            let all = |value: f64| opacity.iter().all(|&line| line == [value, 0.0]);
            Stretch {
                values: [low, high],
                origin,
                clear: removed || all(0.0),
                opaque: !removed && all(1.0),
                colour: [0, 1, 2].map(|i| line(&colours[i], low, high, origin)),
                opacity,
            }
        };
        let list: Vec<Stretch> = ends.map(stretch).collect();
        let gradients: Vec<f64> = transfer.layers.iter().map(|layer| layer.gradient).collect();
        let full = |layer: usize| list.iter().any(|stretch| !stretch.clear && stretch.opacity[layer] == [1.0, 0.0]);
        let strict_layers = gradients.windows(2).any(|pair| pair[0] == pair[1]) || (0..gradients.len()).any(full);
        Stretches { list, gradients, strict_layers, threshold: scene.threshold.clone() }
    }

    /// The place of the stretch of a value; at a bend of the one above.
    fn place(&self, value: f64) -> usize {
        self.list.partition_point(|stretch| stretch.values[1] <= value).min(self.list.len() - 1)
    }

    /// Whether nothing is seen of any value in between.
    pub fn clear(&self, [low, high]: [f64; 2]) -> bool {
        self.list[self.place(low.next_down())..=self.place(high)].iter().all(|stretch| stretch.clear)
    }

    /// A single value as a stretch of its own.
    pub fn at(&self, value: f64) -> Stretch {
        let around = &self.list[self.place(value)];
        let opacity: Vec<Line> =
            (0..around.opacity.len()).map(|i| [around.opacity_at(i, value).clamp(0.0, 1.0), 0.0]).collect();
        let removed = self.threshold.as_ref().is_some_and(|threshold| threshold.removes(value));
        Stretch {
            values: [value; 2],
            origin: value,
            clear: removed || opacity.iter().all(|line| line[0] == 0.0),
            opaque: !removed && opacity.iter().all(|line| line[0] == 1.0),
            colour: around.colour_at(value).map(|colour| [colour, 0.0]),
            opacity,
        }
    }

    /// The one stretch of all values in between, which are known to within `slack`; none where they are of several, or may be.
    pub fn around(&self, [low, high]: [f64; 2], slack: f64) -> Option<Cow<'_, Stretch>> {
        if low == high && slack == 0.0 {
            return Some(Cow::Owned(self.at(low)));
        }
        let stretch = &self.list[self.place(f64::midpoint(low, high))];
        let [from, to] = stretch.values;
        (from + slack <= low && high <= to - slack).then_some(Cow::Borrowed(stretch))
    }

    /// Bends between two values.
    pub fn bends(&self, [low, high]: [f64; 2]) -> impl Iterator<Item = Bend> + '_ {
        let first = self.place(low).saturating_sub(1);
        self.list[first..]
            .windows(2)
            .map(|pair| Bend { value: pair[0].values[1], opaque: [pair[0].opaque, pair[1].opaque] })
            .skip_while(move |bend| bend.value < low)
            .take_while(move |bend| bend.value <= high)
    }

    /// The layers of gradients between two magnitudes, which are known to within `slack`; none where they are more than two.
    pub fn layers(&self, [low, high]: [f64; 2], slack: f64) -> Option<Layers> {
        let g = &self.gradients;
        let Some(last) = g.len().checked_sub(1) else { return Some(Layers::One(0)) };
        let slack = if self.strict_layers { -slack } else { slack };
        if high <= g[0] + slack {
            return Some(Layers::One(0));
        }
        if low >= g[last] - slack {
            return Some(Layers::One(last));
        }
        let between = |&i: &usize| g[i] < g[i + 1] && g[i] - slack <= low && high <= g[i + 1] + slack;
        (0..last).find(between).map(Layers::Between)
    }

    /// The least and the largest opacity of values and gradient magnitudes.
    pub fn opacities(&self, values: [f64; 2], magnitudes: [f64; 2]) -> [f64; 2] {
        let layers = self.layers_of(magnitudes);
        let of = |stretch: &Stretch| {
            if stretch.clear {
                return [0.0; 2];
            }
            let ends = stretch.part(values);
            hull(layers.iter().flat_map(|&(layer, weight)| {
                let at = |layer: usize, value: f64| stretch.opacity_at(layer, value);
                ends.map(|value| {
                    if weight == 0.0 {
                        at(layer, value)
                    } else {
                        at(layer, value) + weight * (at(layer + 1, value) - at(layer, value))
                    }
                })
            }))
        };
        let [low, high] = hull(self.between(values).iter().flat_map(of));
        [low.clamp(0.0, 1.0), high.clamp(0.0, 1.0)]
    }

    /// The layers that bound opacity between two magnitudes, each with the weight of the next one: of both ends, and of all in between.
    fn layers_of(&self, magnitudes: [f64; 2]) -> Vec<(usize, f64)> {
        let g = &self.gradients;
        let Some(last) = g.len().checked_sub(1) else { return vec![(0, 0.0)] };
        let end = |magnitude: f64| {
            let above = g.partition_point(|g| *g <= magnitude);
            match above {
                0 => (0, 0.0),
                _ if above > last => (last, 0.0),
                _ => (above - 1, ((magnitude - g[above - 1]) / (g[above] - g[above - 1])).clamp(0.0, 1.0)),
            }
        };
        let inside = (0..=last).filter(|&i| magnitudes[0] <= g[i] && g[i] <= magnitudes[1]).map(|i| (i, 0.0));
        magnitudes.map(end).into_iter().chain(inside).collect()
    }

    /// The least and the largest colour of values.
    pub fn colours(&self, values: [f64; 2]) -> [[f64; 2]; 3] {
        colours(self.between(values).iter(), values)
    }

    /// The least and the largest colour of those values through which nothing is seen, whatever the gradient; none where there are none.
    pub fn opaque_colours(&self, values: [f64; 2]) -> Option<[[f64; 2]; 3]> {
        let opaque = self.between(values).iter().filter(|stretch| stretch.opaque);
        opaque.clone().next().map(|_| colours(opaque, values))
    }

    /// The stretches of values in between, those that they touch with them.
    pub fn between(&self, [low, high]: [f64; 2]) -> &[Stretch] {
        &self.list[self.place(low.next_down())..=self.place(high)]
    }
}

fn colours<'a>(stretches: impl Iterator<Item = &'a Stretch> + Clone, values: [f64; 2]) -> [[f64; 2]; 3] {
    [0, 1, 2].map(|i| {
        let of = |stretch: &Stretch| stretch.part(values).map(|value| stretch.colour_at(value)[i]);
        hull(stretches.clone().flat_map(of))
    })
}

/// Where two stretches meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bend {
    pub value: f64,
    /// Of the stretches below and above.
    pub opaque: [bool; 2],
}

/// The least and the largest of some numbers.
fn hull(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

/// The value of points at one end of a stretch, seen from the other end.
fn end_of(points: &[[f64; 2]], end: f64, other: f64) -> f64 {
    let [at, _] = line(points, end.min(other), end.max(other), end);
    at
}

/// The line of points between two neighbouring bends.
fn line(points: &[[f64; 2]], low: f64, high: f64, origin: f64) -> Line {
    let below = points.iter().rev().find(|point| point[0] <= low);
    let above = points.iter().find(|point| point[0] >= high);
    match (below, above) {
        (Some(&[from, a]), Some(&[to, b])) => {
            // Halves, so that the difference of the largest numbers does not overflow.
            let slope = (b - a) / (to * 0.5 - from * 0.5) * 0.5;
            match origin {
                _ if slope == 0.0 || !slope.is_finite() => [a, 0.0],
                origin if origin == to => [b, slope],
                origin => [a + slope * (origin - from), slope],
            }
        }
        (Some(&[_, a]), None) | (None, Some(&[_, a])) => [a, 0.0],
        (None, None) => [0.0, 0.0],
    }
}
