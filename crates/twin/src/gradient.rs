//! The ABC gradient estimators in reals: Pfister et al. 1995, section 4, and design, section 3.

use crate::Basis;
use cube3_frame::Geometry;
use cube3_machine::GradientMethod;
use cube3_reference::lerp;
use cube3_scene::smallest_spacing;
use glam::DVec3;

/// An estimator for one view.
#[derive(Clone, Debug)]
pub(crate) struct RealEstimator {
    method: GradientMethod,
    slopes: [f64; 2],
    /// The frame that components are in.
    pub basis: Basis,
    /// Factors that make a component of differences a gradient, in values per smallest voxel spacing; but for the
    /// raw differences of method 10, which are left in proportion to their lengths: all are taken for the shortest.
    factors: [f64; 3],
}

impl RealEstimator {
    pub fn new(geometry: &Geometry, spacing: [f64; 3], method: GradientMethod) -> Self {
        let basis = Basis::new(geometry, spacing, method);
        let lengths = match method {
            GradientMethod::Ten => [DVec3::from(basis.lengths).min_element(); 3],
            _ => basis.lengths,
        };
        let factors = lengths.map(|length| 0.5 * smallest_spacing(spacing) / length);
        RealEstimator { method, slopes: geometry.real_slopes(), basis, factors }
    }

    /// The gradient in the frame's components, from `sample(i, j, l)`, the sample by so many rays along u and v and so
    /// many steps along the ray away.
    #[inline]
    pub fn gradient(&self, sample: impl Fn([i64; 3]) -> f64) -> [f64; 3] {
        let differences = match self.method {
            GradientMethod::Six => six(sample),
            GradientMethod::TwentySix => twenty_six(sample),
            GradientMethod::Ten | GradientMethod::TenNormalised => ten(sample, self.basis.feet),
            GradientMethod::Twelve => twelve(sample, self.slopes),
            GradientMethod::SixSheared => unsheared(six(sample), self.slopes),
            GradientMethod::TwentySixSheared => unsheared(twenty_six(sample), self.slopes),
        };
        [0, 1, 2].map(|i| differences[i] * self.factors[i])
    }
}

/// Neighbours along u, v and the ray.
#[inline]
fn six(sample: impl Fn([i64; 3]) -> f64) -> [f64; 3] {
    [
        sample([1, 0, 0]) - sample([-1, 0, 0]),
        sample([0, 1, 0]) - sample([0, -1, 0]),
        sample([0, 0, 1]) - sample([0, 0, -1]),
    ]
}

/// Differences between opposite planes of nine, weights 1, ½, ¼, which add to 4.
fn twenty_six(sample: impl Fn([i64; 3]) -> f64) -> [f64; 3] {
    let weight = [0.5, 1.0, 0.5];
    [0, 1, 2].map(|axis| {
        let mut sum = 0.0;
        for a in -1..=1 {
            for b in -1..=1 {
                let mut at = [0; 3];
                at[(axis + 1) % 3] = a;
                at[(axis + 2) % 3] = b;
                at[axis] = 1;
                let front = sample(at);
                at[axis] = -1;
                sum += weight[(a + 1) as usize] * weight[(b + 1) as usize] * (front - sample(at));
            }
        }
        sum * 0.25
    })
}

/// Along the ray, and at the feet of the perpendiculars on the side rays.
fn ten(sample: impl Fn([i64; 3]) -> f64, feet: [f64; 2]) -> [f64; 3] {
    let right = lerp(sample([1, 0, 0]), sample([1, 0, -1]), feet[0]);
    let left = lerp(sample([-1, 0, 0]), sample([-1, 0, 1]), feet[0]);
    let below = lerp(sample([0, 1, 0]), sample([0, 1, -1]), feet[1]);
    let above = lerp(sample([0, -1, 0]), sample([0, -1, 1]), feet[1]);
    [right - left, below - above, sample([0, 0, 1]) - sample([0, 0, -1])]
}

/// u and v as in 6; w between the points straight behind and straight in front.
fn twelve(sample: impl Fn([i64; 3]) -> f64, [du, dv]: [f64; 2]) -> [f64; 3] {
    let [along_u, along_v, _] = six(&sample);
    let straight = |l: i64| {
        let near = lerp(sample([0, 0, l]), sample([-l, 0, l]), du);
        let far = lerp(sample([0, -l, l]), sample([-l, -l, l]), du);
        lerp(near, far, dv)
    };
    [along_u, along_v, straight(1) - straight(-1)]
}

/// Gw = Gr − du·Gu − dv·Gv.
fn unsheared([along_u, along_v, along_ray]: [f64; 3], [du, dv]: [f64; 2]) -> [f64; 3] {
    [along_u, along_v, along_ray - du * along_u - dv * along_v]
}
