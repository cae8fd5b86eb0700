//! A ray from front to back, part by part.
//!
//! ```text
//!   piece ─► part ─► analytic? ──yes──► fewest nodes whose bound is allowed ──► add
//!              ▲        │no                        │none
//!              └─split──┴──────────────────────────┘      too small to split: add what is known of it, with its bound
//! ```

use crate::cell::Piece;
use crate::known::Known;
use crate::optics::{Obstacle, Optics};
use crate::part::Part;
use crate::polynomial;
use crate::quadrature::{Added, Quadrature, Request};
use crate::stretches::Bend;
use cube3_scene::ResolvedLight;

/// Parts of a ray that are looked at, at most; after that what is known of a part is taken as it is.
const MOST_PARTS: u64 = 1 << 18;

/// What sums are rounded by, for every part that is added.
const ROUNDED: f64 = 8.0 * f64::EPSILON;

/// Extinction of a unit length where opacity is as near to 1 as numbers are.
const MOST_EXTINCTION: f64 = 50.0;

/// What has been integrated of a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Integral {
    /// Red, green and blue, each as it reaches the eye.
    pub colour: [f64; 3],
    /// What is left of the light from behind; in a weighted sum 1 − Σ.
    pub transmittance: f64,
    /// The most that a channel of the pixel is off by.
    pub bound: f64,
    /// Evaluations at nodes.
    pub evaluations: u64,
    /// Parts that were looked at.
    parts: u64,
    /// Parts that were added of which ranges alone are known.
    ranges: u64,
    /// A part behind which all may be hidden: the range of its colours.
    pending: Option<[[f64; 2]; 3]>,
    /// Nothing behind can matter.
    pub done: bool,
}

/// A part of a piece that is still to be done.
#[derive(Clone, Copy, Debug)]
struct Task {
    ends: [f64; 2],
    /// Around a bend, and as small as can be: it is taken as it is.
    last: bool,
    /// Behind it nothing is seen.
    then_opaque: bool,
    /// No part is deeper than what it is a part of.
    most_depth: f64,
}

/// Adds the pieces of one ray.
pub(crate) struct Ray<'a> {
    quadrature: Quadrature<'a>,
    pub integral: Integral,
    tasks: Vec<Task>,
}

impl<'a> Ray<'a> {
    pub fn new(optics: &'a Optics<'a>, lights: &'a [ResolvedLight], request: Request) -> Ray<'a> {
        let integral = Integral {
            colour: [0.0; 3],
            transmittance: 1.0,
            bound: 0.0,
            evaluations: 0,
            parts: 0,
            ranges: 0,
            pending: None,
            done: false,
        };
        Ray { quadrature: Quadrature { optics, lights, request }, integral, tasks: Vec::new() }
    }

    /// Adds the next piece from the front.
    pub fn add(&mut self, piece: &Piece) {
        self.tasks.clear();
        self.tasks.push(Task { ends: [0.0, piece.length], last: false, then_opaque: false, most_depth: f64::INFINITY });
        let mut seen = false;
        let arriving = self.integral.transmittance;
        while let Some(task) = self.tasks.pop() {
            if self.integral.done {
                break;
            }
            seen |= self.part(piece, task);
        }
        if seen {
            self.integral.bound += self.moved_ends(piece, arriving);
        }
    }

    /// What a piece costs whose ends are moved by rounding, of the light that arrives at it.
    fn moved_ends(&self, piece: &Piece, arriving: f64) -> f64 {
        let opacity = |at: f64| {
            let end = Part::of(piece, [at, at]);
            let value = end.value[0];
            let values = [value - piece.slack, value + piece.slack];
            self.quadrature.optics.stretches.opacities(values, self.quadrature.optics.magnitudes(&end))[1]
        };
        let most = opacity(0.0).max(opacity(piece.length));
        let moved = 2.0 * piece.end_slack;
        match self.quadrature.request.weight {
            Some(weight) => weight * most * moved,
            None => arriving * (-libm::log1p(-most)).min(MOST_EXTINCTION) * moved,
        }
    }

    /// What has been added, with all that is still open.
    pub fn finish(mut self) -> Integral {
        self.resolve();
        self.integral
    }

    /// Adds a part, or puts what it is split into on the list; whether anything of it can be seen.
    fn part(&mut self, piece: &Piece, task: Task) -> bool {
        self.integral.parts += 1;
        let part = Part::of(piece, task.ends);
        let [low, high] = polynomial::range(&part.value);
        let slack = part.slack;
        if self.quadrature.optics.stretches.clear([low - slack, high + slack]) {
            return false;
        }
        let smallest = part.half <= piece.end_slack;
        let last = task.last || smallest || self.integral.parts > MOST_PARTS;
        let stretch = self.quadrature.optics.stretches.around([low, high], if low == high { 0.0 } else { slack });
        let Some(stretch) = stretch else {
            if last || !self.split_at_bend(&part, [low, high], task, piece.end_slack) {
                self.whole_or_halves(&part, task, last);
            }
            return true;
        };
        if stretch.clear {
            return false;
        }
        let layers = self.quadrature.optics.layers(&part);
        if layers.is_some_and(|layers| stretch.is_opaque(layers)) && self.quadrature.request.weight.is_none() {
            self.opaque(piece, task.ends);
            return true;
        }
        let arriving = self.integral.transmittance;
        let analytic = |layers| self.quadrature.analytic(&part, &stretch, layers, arriving);
        match layers.ok_or(Obstacle::Near).and_then(analytic) {
            Ok(added) => self.apply(added),
            // Near an end halves come away from it sooner.
            Err(Obstacle::At(x)) if !last && x.abs() < 1.0 - 1e-3 => self.split(task, x),
            Err(_) => self.whole_or_halves(&part, task, last),
        }
        true
    }

    /// Splits around where values bend, as near to it as rounding allows, if they do between the ends of a part and not only near them.
    fn split_at_bend(&mut self, part: &Part, values: [f64; 2], task: Task, smallest: f64) -> bool {
        let value = |x: f64| polynomial::at(&part.value, x);
        let bends = self.quadrature.optics.stretches.bends(values);
        // A bend at which the part was split already may seem to be a bit inside.
        let inside = |x: &f64| (1.0 - x.abs()) * part.half > 2.0 * smallest;
        let crossing = |bend: Bend| Some((polynomial::crossing(value, bend.value).filter(inside)?, bend));
        let found = bends.filter_map(crossing).next();
        let Some((x, bend)) = found else {
            let turn = polynomial::turns(&part.value).into_iter().flatten().find(|x| x.abs() < 1.0 - 1e-9);
            if let Some(x) = turn {
                self.split(task, x);
            }
            return turn.is_some();
        };
        let rises = value(1.0) > value(-1.0);
        let opaque = bend.opaque[usize::from(rises)];
        let slope = part.value[1] + x * (2.0 * part.value[2] + x * 3.0 * part.value[3]);
        let around = (64.0 * part.slack / slope.abs()).max(4.0 * f64::EPSILON);
        // Where values hardly move rounding leaves too much open.
        if around.is_nan() || around >= 1e-3 {
            return false;
        }
        let [from, to] = task.ends;
        let place = |x: f64| from + (x + 1.0) * 0.5 * (to - from);
        let (before, behind) = (place(x - around).max(from), place(x + around).min(to));
        self.push(Task { ends: [behind, to], last: false, ..task });
        self.push(Task { ends: [before, behind], last: true, then_opaque: opaque, ..task });
        self.push(Task { ends: [from, before], last: false, then_opaque: false, ..task });
        true
    }

    /// At ζ.
    fn split(&mut self, task: Task, x: f64) {
        let [from, to] = task.ends;
        let middle = from + (x + 1.0) * 0.5 * (to - from);
        self.push(Task { ends: [middle, to], ..task });
        self.push(Task { ends: [from, middle], then_opaque: false, ..task });
    }

    fn push(&mut self, task: Task) {
        if task.ends[1] > task.ends[0] {
            self.tasks.push(task);
        }
    }

    /// Adds a part with what little is known of it, if that is little enough or it is the `last` that can be done; or splits it in half.
    fn whole_or_halves(&mut self, part: &Part, task: Task, last: bool) {
        let Quadrature { optics, lights, request } = self.quadrature;
        let arriving = self.integral.transmittance;
        let known = Known::of(optics, lights, part).held(task.most_depth);
        let allowed = request.allowed_range(self.integral.ranges);
        let small = match request.weight {
            Some(weight) => known.error_of_sum() * weight <= allowed,
            None => match &known.hides_all {
                Some(hides) => task.then_opaque && arriving * hides.error() <= allowed,
                None => arriving * known.error() <= allowed,
            },
        };
        if small || last {
            // What cannot be split any more has no share.
            self.integral.ranges += u64::from(!last);
            self.take(&known);
        } else {
            self.split(Task { most_depth: known.depth[1], ..task }, 0.0);
        }
    }

    /// Adds a part of which only ranges are known.
    fn take(&mut self, known: &Known) {
        if let Some(hides) = &known.hides_all {
            let hull = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
            self.integral.pending = Some(match self.integral.pending {
                Some(before) => [0, 1, 2].map(|i| hull(before[i], hides.colour[i])),
                None => hides.colour,
            });
            self.integral.bound += self.integral.transmittance * hides.before + ROUNDED;
            return;
        }
        self.resolve();
        let integral = &mut self.integral;
        if let Some(weight) = self.quadrature.request.weight {
            let middle = f64::midpoint(known.depth[0], known.depth[1]) * weight;
            for (sum, [low, high]) in integral.colour.iter_mut().zip(known.colour) {
                *sum += f64::midpoint(low, high) * middle;
            }
            integral.transmittance -= middle;
            integral.bound += known.error_of_sum() * weight + ROUNDED;
            return;
        }
        let [least, most] = known.depth.map(|depth| -libm::expm1(-depth));
        let hidden = f64::midpoint(least, most);
        for (sum, [low, high]) in integral.colour.iter_mut().zip(known.colour) {
            *sum += integral.transmittance * hidden * f64::midpoint(low, high);
        }
        integral.bound += integral.transmittance * known.error() + ROUNDED;
        integral.transmittance *= 1.0 - hidden;
        self.stop_where_nothing_matters();
    }

    /// Behind the beginning of this part nothing is seen.
    fn opaque(&mut self, piece: &Piece, [from, to]: [f64; 2]) {
        // A bit of the way, as the beginning is not known better.
        let start = Part::of(piece, [from, to.min(from + piece.end_slack)]);
        let mut colours = self.quadrature.optics.colours(&start, self.quadrature.lights, false);
        if let Some(before) = self.integral.pending.take() {
            for (range, before) in colours.iter_mut().zip(before) {
                *range = [range[0].min(before[0]), range[1].max(before[1])];
            }
        }
        let integral = &mut self.integral;
        let mut half = 0.0_f64;
        for (sum, [low, high]) in integral.colour.iter_mut().zip(colours) {
            *sum += integral.transmittance * f64::midpoint(low, high);
            half = half.max((high - low) / 2.0);
        }
        integral.bound += integral.transmittance * (half + ROUNDED) + ROUNDED;
        integral.transmittance = 0.0;
        integral.done = true;
    }

    /// What may hide all did not: its whole range is open.
    fn resolve(&mut self) {
        let Some(colours) = self.integral.pending.take() else { return };
        let integral = &mut self.integral;
        for (sum, [low, high]) in integral.colour.iter_mut().zip(colours) {
            *sum += integral.transmittance * 0.5 * f64::midpoint(low, high);
        }
        integral.bound += integral.transmittance;
        integral.transmittance *= 0.5;
    }

    fn apply(&mut self, added: Added) {
        self.resolve();
        let integral = &mut self.integral;
        integral.evaluations += added.evaluations;
        match self.quadrature.request.weight {
            Some(weight) => {
                for (sum, colour) in integral.colour.iter_mut().zip(added.colour) {
                    *sum += colour * weight;
                }
                integral.transmittance -= added.depth * weight;
                integral.bound += added.error * weight + ROUNDED;
            }
            None => {
                for (sum, colour) in integral.colour.iter_mut().zip(added.colour) {
                    *sum += integral.transmittance * colour;
                }
                integral.bound += integral.transmittance * added.error + ROUNDED;
                integral.transmittance *= libm::exp(-added.depth);
                self.stop_where_nothing_matters();
            }
        }
    }

    fn stop_where_nothing_matters(&mut self) {
        let integral = &mut self.integral;
        if integral.transmittance <= self.quadrature.request.dark() {
            integral.bound += integral.transmittance;
            integral.done = true;
        }
    }
}
