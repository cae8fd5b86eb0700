//! The ABC gradient estimators in reals: Pfister et al. 1995, section 4, and design, section 3.

use crate::Basis;
use crate::rays::{Beside, Line};
use cube3_frame::{DiscreteRay, Geometry};
use cube3_machine::GradientMethod;
use cube3_reference::lerp;
use cube3_scene::smallest_spacing;
use glam::DVec3;

/// An estimator for one frame.
#[derive(Clone, Debug)]
pub(crate) struct RealEstimator<'a> {
    geometry: &'a Geometry,
    method: GradientMethod,
    /// Of every sample of a parallel frame.
    parallel: Slant,
    /// The frame that components are in.
    pub basis: Basis,
    /// Factors that make a component of differences a gradient, in values per smallest voxel spacing; but for the
    /// raw differences of method 10, which are left in proportion to their lengths: all are taken for the shortest.
    factors: [f64; 3],
}

/// How a ray lies among those beside it, at a sample.
///
/// With rays m voxels apart, the ray moves by q = slope/m of the way to the next one from a plane to the next. In a parallel frame m is 1
/// everywhere.
#[derive(Clone, Copy, Debug)]
struct Slant {
    /// q along u and v at the planes before the sample, of the sample, and behind it: −1 to 1.
    shears: [[f64; 2]; 3],
    /// From the sample to those beside it, in voxels.
    apart: f64,
}

impl Slant {
    fn of_parallel(geometry: &Geometry) -> Slant {
        Slant { shears: [geometry.real_slopes(); 3], apart: 1.0 }
    }
}

impl<'a> RealEstimator<'a> {
    pub fn new(geometry: &'a Geometry, spacing: [f64; 3], method: GradientMethod) -> Self {
        let basis = Basis::new(geometry, spacing, method);
        let lengths = match method {
            GradientMethod::Ten => [DVec3::from(basis.lengths).min_element(); 3],
            _ => basis.lengths,
        };
        let factors = lengths.map(|length| 0.5 * smallest_spacing(spacing) / length);
        RealEstimator { geometry, method, parallel: Slant::of_parallel(geometry), basis, factors }
    }

    /// The gradient at sample `k` of a ray in the frame's components, from `sample(i, j, l)`, the sample by so many rays along u and v and so
    /// many steps along the ray away.
    ///
    /// From an eye the rays beside are those about a voxel away. Where an eye is in the volume, the sample before the first of a ray is that
    /// one itself. Where neighbours are less than a voxel away, all components are those of a gradient as many times smaller.
    #[inline]
    pub fn gradient(&self, ray: DiscreteRay, k: usize, sample: impl Fn([i64; 3]) -> f64) -> [f64; 3] {
        let Some(pass) = &self.geometry.perspective else {
            return self.weighted(&self.parallel, sample);
        };
        let beside = |k: i64| Beside::of(pass, self.geometry, k);
        let (here, slopes) = (beside(k as i64), Line::new(self.geometry, ray).slopes);
        let shear = |apart: f64| slopes.map(|slope| (slope / apart.max(1.0)).clamp(-1.0, 1.0));
        let shears = [-1, 0, 1].map(|l| shear(beside(k as i64 + l).voxels));
        let first = pass.first_depth > 0 && k == pass.first_depth;
        self.weighted(&Slant { shears, apart: here.voxels }, |[i, j, l]| {
            if first && l < 0 { sample([0; 3]) } else { sample([i * here.rays, j * here.rays, l]) }
        })
    }

    #[inline]
    fn weighted(&self, slant: &Slant, sample: impl Fn([i64; 3]) -> f64) -> [f64; 3] {
        let Slant { shears, apart } = slant;
        let [along_u, along_v, along_ray] = match self.method {
            GradientMethod::Six | GradientMethod::SixSheared => six(sample),
            GradientMethod::TwentySix | GradientMethod::TwentySixSheared => twenty_six(sample),
            GradientMethod::Ten | GradientMethod::TenNormalised => ten(sample, self.basis.feet),
            GradientMethod::Twelve => twelve(sample, shears),
        };
        let along_ray = along_ray * apart.min(1.0);
        let along_w = match self.method {
            GradientMethod::SixSheared | GradientMethod::TwentySixSheared => {
                unsheared([along_u, along_v, along_ray], shears[1])
            }
            _ => along_ray,
        };
        let whole = apart.max(1.0);
        [along_u / whole * self.factors[0], along_v / whole * self.factors[1], along_w * self.factors[2]]
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

/// u and v as in 6; w between the points straight behind and straight in front, which lie on the side of each that the ray comes from.
fn twelve(sample: impl Fn([i64; 3]) -> f64, shears: &[[f64; 2]; 3]) -> [f64; 3] {
    let [along_u, along_v, _] = six(&sample);
    let straight = |l: i64| {
        let [i, j] = shears[(1 + l) as usize].map(|shear| if shear < 0.0 { l } else { -l });
        let [along_u, along_v] = shears[(1 + l) as usize].map(f64::abs);
        let near = lerp(sample([0, 0, l]), sample([i, 0, l]), along_u);
        let far = lerp(sample([0, j, l]), sample([i, j, l]), along_u);
        lerp(near, far, along_v)
    };
    [along_u, along_v, straight(1) - straight(-1)]
}

/// Gw = Gr − du·Gu − dv·Gv.
fn unsheared([along_u, along_v, along_ray]: [f64; 3], [du, dv]: [f64; 2]) -> f64 {
    along_ray - du * along_u - dv * along_v
}
