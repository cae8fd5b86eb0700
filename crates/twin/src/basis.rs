//! The directions that a gradient estimator takes its differences along, and how far it takes them.

use crate::rays::Line;
use cube3_frame::{Axes, Geometry};
use cube3_machine::GradientMethod;
use glam::DVec3;

/// The frame of an estimator's three differences.
///
/// In a parallel view let r be the step of the ray in the world, and e_u the way from a ray to the next one along u. Estimators 10 and 10n take their
/// difference along u between the feet of the perpendiculars from the sample on the rays beside it: e_u − t·r is at right angles to r for
///
/// ```text
///   t = e_u·r / |r|²
/// ```
///
/// and likewise along v; the third is along r. A foot is a lerp between two samples of its ray, so t is held at 1, which only voxels far
/// from cubes reach. The others have the volume's axes, and in perspective, where r differs from ray to ray, there are only those. Light is reckoned as if the three were at right angles to each other, as in the
/// machine. Pfister et al. 1995, section 4, figure 10.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    /// Directions of the components, of unit length, in the world along u, v, w.
    pub vectors: [[f64; 3]; 3],
    /// Half of the way from the one place of a difference to the other, in the unit of the spacing.
    pub lengths: [f64; 3],
    /// t of the feet on the rays beside along u and along v, in steps of the ray, 0 to 1; for every estimator, though only 10 and 10n have
    /// feet.
    pub feet: [f64; 2],
}

impl Basis {
    /// The frame of an estimator on the rays of a geometry, in voxels of `spacing` (x, y, z). Of a perspective one it is good for estimators
    /// other than 10 and 10n.
    pub fn new(geometry: &Geometry, spacing: [f64; 3], method: GradientMethod) -> Basis {
        let ray = Line::parallel(geometry).step(geometry, spacing);
        let beside = DVec3::from(geometry.axes.permute(spacing));
        let beside = [DVec3::X * beside, DVec3::Y * beside, DVec3::Z * beside];
        let foot = |side: DVec3| (side.dot(ray) / ray.length_squared()).min(1.0);
        let feet = [foot(beside[0]), foot(beside[1])];
        let along = match method {
            GradientMethod::Ten | GradientMethod::TenNormalised => {
                [beside[0] - feet[0] * ray, beside[1] - feet[1] * ray, ray]
            }
            _ => beside,
        };
        let lengths = along.map(DVec3::length);
        Basis { vectors: [0, 1, 2].map(|i| (along[i] / lengths[i]).to_array()), lengths, feet }
    }

    /// A world vector in the frame's components: its part along each direction.
    pub fn components(&self, axes: &Axes, world: DVec3) -> [f64; 3] {
        let along = DVec3::from(axes.to_canonical(world));
        self.vectors.map(|vector| DVec3::from(vector).dot(along))
    }

    /// A gradient in the frame's components as a world vector: each component along its direction.
    pub fn world(&self, axes: &Axes, components: [f64; 3]) -> DVec3 {
        let [u, v, w] = self.vectors.map(DVec3::from);
        axes.to_world((components[0] * u + components[1] * v + components[2] * w).to_array())
    }
}
