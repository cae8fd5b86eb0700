//! Solids made of smooth unions and cuts of ellipsoids and capsules, by their signed distance.
//!
//! A distance is negative inside. For ellipsoids it is the usual first-order estimate
//! k₀(k₀ − 1)/k₁ with k₀ = |p/r|, k₁ = |p/r²|, which is exact on the surface and in its gradient
//! there; far from a flat ellipsoid it is much too small, so its bounding box and ball bound it. All lengths have one unit, chosen by the user of the solid.

use glam::DVec3;

/// A body that solids are built from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Body {
    /// Centre and half axes; turned by an angle about z through the centre, (cos, sin).
    Ellipsoid { centre: DVec3, radii: DVec3, turn: (f64, f64) },
    /// Two ends with a radius each, and all between.
    Capsule { ends: [DVec3; 2], radii: [f64; 2] },
    /// Centre, half sides and the radius of the rounded edges.
    Block { centre: DVec3, half: DVec3, edge: f64 },
}

impl Body {
    /// An ellipsoid along the axes.
    pub fn ellipsoid(centre: [f64; 3], radii: [f64; 3]) -> Body {
        Body::turned(centre, radii, 0.0)
    }

    /// An ellipsoid turned by `degrees` about z, counter-clockwise seen from above.
    pub fn turned(centre: [f64; 3], radii: [f64; 3], degrees: f64) -> Body {
        let angle = degrees.to_radians();
        Body::Ellipsoid { centre: centre.into(), radii: radii.into(), turn: (angle.cos(), angle.sin()) }
    }

    /// A capsule from `a` to `b`, with a radius at each end.
    pub fn capsule(a: [f64; 3], b: [f64; 3], radii: [f64; 2]) -> Body {
        Body::Capsule { ends: [a.into(), b.into()], radii }
    }

    /// A block with rounded edges; `half` sides include the rounding.
    pub fn block(centre: [f64; 3], half: [f64; 3], edge: f64) -> Body {
        Body::Block { centre: centre.into(), half: half.into(), edge }
    }

    /// Signed distance of `p`.
    fn distance(&self, p: DVec3) -> f64 {
        match *self {
            Body::Ellipsoid { centre, radii, turn: (c, s) } => {
                let q = p - centre;
                let q = DVec3::new(c * q.x + s * q.y, c * q.y - s * q.x, q.z);
                let k0 = (q / radii).length();
                let k1 = (q / (radii * radii)).length();
                let estimate = if k1 > 0.0 { k0 * (k0 - 1.0) / k1 } else { -radii.min_element() };
                // Never less than the distances of the box and of the ball around the ellipsoid.
                let bound = (q.abs() - radii).max_element().max(q.length() - radii.max_element());
                estimate.max(bound)
            }
            Body::Capsule { ends: [a, b], radii: [ra, rb] } => {
                let (along, q) = (b - a, p - a);
                let t = (q.dot(along) / along.length_squared()).clamp(0.0, 1.0);
                (q - along * t).length() - (ra + (rb - ra) * t)
            }
            Body::Block { centre, half, edge } => {
                let q = (p - centre).abs() - half + DVec3::splat(edge);
                q.max(DVec3::ZERO).length() + q.max_element().min(0.0) - edge
            }
        }
    }

    /// Centre and radius of a ball around the body.
    fn ball(&self) -> (DVec3, f64) {
        match *self {
            Body::Ellipsoid { centre, radii, .. } => (centre, radii.max_element()),
            Body::Capsule { ends: [a, b], radii: [ra, rb] } => ((a + b) / 2.0, (b - a).length() / 2.0 + ra.max(rb)),
            Body::Block { centre, half, .. } => (centre, half.length()),
        }
    }
}

/// What a body does to the solid before it.
#[derive(Clone, Copy, Debug)]
enum Step {
    Add,
    Cut,
}

/// Bodies added and cut, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Solid {
    steps: Vec<(Step, Body, f64)>,
}

impl Solid {
    /// Adds a body; `blend` is the width over which the joint is rounded.
    pub fn add(&mut self, blend: f64, body: Body) {
        self.steps.push((Step::Add, body, blend));
    }

    /// Takes a body away; `blend` is the width over which the new edge is rounded.
    pub fn cut(&mut self, blend: f64, body: Body) {
        self.steps.push((Step::Cut, body, blend));
    }

    /// The part of the solid that matters within `radius` of `centre`, correct for distances up to
    /// `reach`.
    pub fn near(&self, centre: DVec3, radius: f64, reach: f64) -> Solid {
        // A body is blended by its own step and by those after it, so the widest blend counts for all.
        let blend = self.steps.iter().fold(0.0, |widest: f64, step| widest.max(step.2));
        let matters = |body: &Body| {
            let (middle, size) = body.ball();
            (middle - centre).length() <= size + radius + reach + blend
        };
        Solid { steps: self.steps.iter().filter(|(_, body, _)| matters(body)).copied().collect() }
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Signed distance of `p`.
    pub fn distance(&self, p: DVec3) -> f64 {
        self.steps.iter().fold(FAR, |so_far, (step, body, blend)| match step {
            Step::Add => smooth_min(so_far, body.distance(p), *blend),
            Step::Cut => -smooth_min(-so_far, body.distance(p), *blend),
        })
    }
}

/// The distance of nothing.
pub(super) const FAR: f64 = 1e6;

/// The lesser of two distances, rounded where they are within `blend` of each other: Quilez's
/// polynomial, min − h²·blend/4 with h = max(0, 1 − |a − b|/blend).
pub(super) fn smooth_min(a: f64, b: f64, blend: f64) -> f64 {
    if blend <= 0.0 {
        return a.min(b);
    }
    let h = (1.0 - (a - b).abs() / blend).max(0.0);
    a.min(b) - h * h * blend / 4.0
}

/// The share of a voxel inside a surface at signed distance `d`: a linear ramp of width `ramp`.
#[inline]
pub(super) fn coverage(d: f64, ramp: f64) -> f64 {
    (0.5 - d / ramp).clamp(0.0, 1.0)
}

/// The same with a cubic ramp, 3t² − 2t³, whose gradient has no jumps.
#[inline]
pub(super) fn smooth_coverage(d: f64, ramp: f64) -> f64 {
    let t = coverage(d, ramp);
    t * t * (3.0 - 2.0 * t)
}
