//! What an analytic part adds, by the rule of fewest nodes whose error is allowed.

use crate::disc::Disc;
use crate::gauss::{RULES, Rule};
use crate::optics::{Moved, Obstacle, Optics};
use crate::part::Part;
use crate::polynomial;
use crate::stretches::{Layers, Stretch};
use cube3_scene::ResolvedLight;

/// Parameters of Bernstein's ellipses that are tried, the larger ones as long as everything is analytic in them.
const ELLIPSES: [f64; 4] = [4.0, 9.0, 25.0, 100.0];
/// Those that are tried where the first is too large.
const SMALL_ELLIPSES: [f64; 2] = [2.5, 1.7];

/// So few nodes are not worth a larger ellipse.
const FEW_NODES: usize = 2;

/// Shares of the tolerance: for what is seen of analytic parts, for their length, for parts of which ranges alone are known, and for what
/// lies behind everything that is seen.
const SHARES: [f64; 4] = [0.45, 0.35, 0.1, 0.1];

/// What bounds of quadrature are widened by for the rounding of the bounds themselves.
const WIDENED: f64 = 1.0 + 1e-9;

/// How much a ray may be off by, and what for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Request {
    /// The most that a channel of a pixel may be off by, of full scale.
    pub tolerance: f64,
    /// Of a weighted sum: what its integral is multiplied by. None where light is absorbed.
    pub weight: Option<f64>,
    /// The length of the ray in what is drawn.
    pub length: f64,
}

impl Request {
    /// What a part of a length may be off by that hides at most `hidden` of what is behind it, of the light that arrives at it.
    pub fn allowed(&self, length: f64, hidden: f64, arriving: f64) -> f64 {
        let [seen, long, ..] = SHARES;
        let share = length / self.length;
        match self.weight {
            Some(_) => self.tolerance * (seen + long) * share,
            None => self.tolerance * (seen * hidden * arriving + long * share),
        }
    }

    /// What a part may be off by of which ranges alone are known, after so many others on its ray: 1/2, 1/6, 1/12 … of their share, which add up
    /// to it. It does not shrink with the part, as its error does.
    pub fn allowed_range(&self, before: u64) -> f64 {
        let count = before as f64;
        self.tolerance * SHARES[2] / ((count + 1.0) * (count + 2.0))
    }

    /// So little light does not matter.
    pub fn dark(&self) -> f64 {
        SHARES[3] * self.tolerance
    }
}

/// What a part adds, of light that reaches it whole.
pub(crate) struct Added {
    pub colour: [f64; 3],
    /// Its optical depth; in a weighted sum its opacity.
    pub depth: f64,
    pub error: f64,
    pub evaluations: u64,
}

/// Integrates parts of one ray.
#[derive(Clone, Copy)]
pub(crate) struct Quadrature<'a> {
    pub optics: &'a Optics<'a>,
    pub lights: &'a [ResolvedLight],
    pub request: Request,
}

impl Quadrature<'_> {
    /// Integrates a part in which everything is analytic, if few nodes hold the error that it is allowed.
    pub fn analytic(&self, part: &Part, stretch: &Stretch, layers: Layers, arriving: f64) -> Result<Added, Obstacle> {
        if let Some(weight) = self.request.weight {
            return self.analytic_sum(part, stretch, layers, weight);
        }
        let full = self.optics.clamped(part, self.lights)?;
        let moved = self.optics.moved(part, stretch, layers, self.lights);
        let plan = |rho: f64, below: usize| self.plan(part, stretch, layers, [rho, arriving], below, full);
        let mut best: Option<Plan> = None;
        for rho in ELLIPSES {
            let below = best.as_ref().map_or(usize::MAX, |plan| plan.rule.count());
            match plan(rho, below) {
                Ok(fewer) => best = fewer.or(best),
                Err(Obstacle::At(x)) => return Err(Obstacle::At(x)),
                Err(Obstacle::Near) => break,
            }
            if best.as_ref().is_some_and(|plan| plan.rule.count() <= FEW_NODES) {
                break;
            }
        }
        for rho in SMALL_ELLIPSES {
            best = best.or_else(|| plan(rho, usize::MAX).ok().flatten());
        }
        let plan = best.ok_or(Obstacle::Near)?;
        self.sum_of_nodes(part, stretch, layers, &plan, moved)
    }

    /// The fewest nodes, below a number of them, whose bound in an ellipse is allowed.
    fn plan(
        &self,
        part: &Part,
        stretch: &Stretch,
        layers: Layers,
        [rho, arriving]: [f64; 2],
        below: usize,
        full: [bool; 3],
    ) -> Result<Option<Plan>, Obstacle> {
        let reach = f64::midpoint(rho, 1.0 / rho);
        let smooth = self.optics.smooth(part, stretch, layers, self.lights, reach, full)?;
        let (extinction, colour) = (smooth.extinction().ok_or(Obstacle::Near)?, smooth.colour);
        let hidden = -libm::expm1(-2.0 * part.half * extinction.mid);
        let allowed = self.request.allowed(part.length(), hidden, arriving) / arriving;
        let found = RULES.iter().take_while(|rule| rule.count() < below).find_map(|rule| {
            let error = quadrature_error(part, extinction, &colour, rule, rho);
            (error <= allowed).then_some((rule, error))
        });
        Ok(found.map(|(rule, error)| Plan { rule, error, extinction, colour }))
    }

    /// The least that a unit length of a part lets through; `most` is its largest opacity.
    fn least_clearness(&self, part: &Part, stretch: &Stretch, layers: Layers, most: f64) -> f64 {
        let Layers::One(layer) = layers else { return 1.0 - most };
        let clearness = polynomial::range(&part.value).map(|value| stretch.clearness_at(layer, value));
        clearness[0].min(clearness[1])
    }

    /// The rule's sums: τ to every node and to the end, and what is seen.
    fn sum_of_nodes(
        &self,
        part: &Part,
        stretch: &Stretch,
        layers: Layers,
        plan: &Plan,
        moved: Moved,
    ) -> Result<Added, Obstacle> {
        let (half, rule) = (part.half, plan.rule);
        let most = self.optics.stretches.opacities(polynomial::range(&part.value), self.optics.magnitudes(part))[1];
        let least_clear = self.least_clearness(part, stretch, layers, most);
        if least_clear <= 4.0 * moved.opacity {
            return Err(Obstacle::Near);
        }
        let constant = plan.extinction.radius == 0.0;
        let mut extinctions = [0.0; 16];
        for (extinct, &x) in extinctions.iter_mut().zip(&rule.nodes) {
            *extinct = if constant { plan.extinction.mid } else { self.optics.extinction(part, stretch, layers, x) };
        }
        let extinctions = &extinctions[..rule.count()];
        let depth = half * dot(&rule.weights, extinctions);
        let hidden = -libm::expm1(-depth);
        let middle = plan.colour.map(|c| c.mid);
        let spread = plan.colour.iter().fold(0.0_f64, |most, c| most.max(c.radius));
        let mut colour = middle.map(|c| c * hidden);
        if spread > 0.0 {
            for (j, &x) in rule.nodes.iter().enumerate() {
                let before = half * dot(&rule.integrals[j], extinctions);
                let weight = half * rule.weights[j] * extinctions[j] * libm::exp(-before);
                let seen = self.optics.colour(part, stretch, self.lights, x);
                for i in 0..3 {
                    colour[i] += weight * (seen[i] - middle[i]);
                }
            }
        }
        // Rounding: of the colour where it is seen, of the depth for all that is behind.
        let moved_depth = 2.0 * half * 2.0 * moved.opacity / least_clear + 16.0 * f64::EPSILON * depth;
        let rounding =
            hidden * (moved.colour + 64.0 * f64::EPSILON) + (1.0 - hidden + spread.min(1.0)) * libm::expm1(moved_depth);
        Ok(Added { colour, depth, error: plan.error + rounding, evaluations: rule.count() as u64 })
    }

    /// As [`Quadrature::analytic`], of a weighted sum: colours and opacities are polynomials.
    fn analytic_sum(&self, part: &Part, stretch: &Stretch, layers: Layers, weight: f64) -> Result<Added, Obstacle> {
        let moved = self.optics.moved(part, stretch, layers, self.lights);
        let allowed = self.request.allowed(part.length(), 0.0, 1.0) / weight;
        for rho in ELLIPSES.into_iter().chain(SMALL_ELLIPSES) {
            let Ok(smooth) =
                self.optics.smooth(part, stretch, layers, self.lights, f64::midpoint(rho, 1.0 / rho), [false; 3])
            else {
                continue;
            };
            let seen = smooth.colour.map(|c| c.times(smooth.opacity));
            let radius = seen.iter().fold(smooth.opacity.radius, |most, disc: &Disc| most.max(disc.radius));
            let error = |rule: &&Rule| 2.0 * part.half * radius * rule.error(rho) * WIDENED;
            let Some(rule) = RULES.iter().find(|rule| error(rule) <= allowed) else { continue };
            let mut added =
                Added { colour: [0.0; 3], depth: 0.0, error: error(&rule), evaluations: rule.count() as u64 };
            for (&x, share) in rule.nodes.iter().zip(&rule.weights) {
                let opacity = part.half * share * self.optics.opacity(part, stretch, layers, x);
                let colour = self.optics.colour(part, stretch, self.lights, x);
                for (sum, colour) in added.colour.iter_mut().zip(colour) {
                    *sum += opacity * colour;
                }
                added.depth += opacity;
            }
            added.error += 4.0 * part.half * (moved.opacity + moved.colour + 32.0 * f64::EPSILON);
            return Ok(added);
        }
        Err(Obstacle::Near)
    }
}

/// How a part is integrated.
struct Plan {
    rule: &'static Rule,
    /// The bound of the quadrature.
    error: f64,
    extinction: Disc,
    colour: [Disc; 3],
}

/// The bound of what a rule gives for a part: of its depth, for all that is behind, and of its colour. See the book, "Converged".
fn quadrature_error(part: &Part, extinction: Disc, colour: &[Disc; 3], rule: &Rule, rho: f64) -> f64 {
    let half = part.half;
    let reach = f64::midpoint(rho, 1.0 / rho);
    let depth = half * extinction.radius * rule.error(rho);
    let left = libm::exp(-2.0 * half * (extinction.mid - extinction.radius).max(0.0));
    let spread = colour.iter().fold(0.0_f64, |most, c| most.max(c.radius));
    if spread == 0.0 {
        return left * libm::expm1(depth) * WIDENED;
    }
    let to_nodes = half * extinction.radius * rule.error_of_integrals(rho);
    let grown = libm::exp(half * (extinction.mid * (reach - 1.0) + extinction.radius * (reach + 1.0)));
    let seen = half * spread * extinction.largest() * grown * rule.error(rho);
    // Wrong depths at the nodes weigh the colours' distances from the middle wrongly.
    let weighed = spread.min(1.0) * 2.0 * half * extinction.largest() * libm::expm1(to_nodes);
    (left * libm::expm1(depth) + seen + weighed) * WIDENED
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
