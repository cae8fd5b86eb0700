//! Samples and gradients of single rays, taken one by one: for tests, metrics and questions.

use crate::TwinError;
use crate::check::check_geometry;
use crate::gradient::RealEstimator;
use crate::steps::{Cells, SampleCell, planes};
use crate::voxels::Voxels;
use cube3_frame::{DiscreteRay, Geometry};
use cube3_machine::GradientMethod;
use cube3_reference::{cell, check_volume};
use cube3_volume::{Volume, with_samples};
use glam::DVec3;

/// The samples that [`true_3d`](crate::true_3d) and [`sheared`](crate::sheared) take, to the bit.
pub struct RealSamples<'a> {
    volume: &'a Volume,
    geometry: &'a Geometry,
    cells: Cells,
    border: f64,
}

impl<'a> RealSamples<'a> {
    /// The samples of a volume under a geometry; neighbours that do not exist have the value `border`.
    ///
    /// # Errors
    /// A volume that is no grid of finite values, or a geometry of another volume.
    pub fn new(
        volume: &'a Volume,
        geometry: &'a Geometry,
        interpolation: SampleCell,
        border: f64,
    ) -> Result<Self, TwinError> {
        check_volume(volume, border)?;
        check_geometry(volume, geometry)?;
        Ok(RealSamples { volume, geometry, cells: Cells::new(geometry, interpolation), border })
    }

    /// Sample `k` of a ray, where the machine takes one.
    pub fn sample(&self, ray: DiscreteRay, k: i64) -> Option<f64> {
        if !self.geometry.has_sample(ray, k) {
            return None;
        }
        let k = k as usize;
        let planes = planes(self.geometry, k);
        let [along_u, along_v] = self.cells.sides(self.geometry, ray, k);
        let voxel = |plane: usize, j: usize, i: usize| {
            let at = [along_u.edges[i][plane], along_v.edges[j][plane], planes[plane]];
            with_samples!(&self.volume.samples, v => Voxels::new(v, self.volume.dims, self.geometry).at(at))
        };
        let corners = [0, 1].map(|plane| [0, 1].map(|j| [0, 1].map(|i| voxel(plane, j, i))));
        Some(cell(corners, [along_u.weight, along_v.weight, self.geometry.real_offset()]))
    }

    /// The gradient at sample `k` of a ray in the components of the method's
    /// [`Basis`](crate::Basis), in values per smallest voxel spacing (method 10: raw differences in
    /// proportion).
    pub fn gradient(&self, ray: DiscreteRay, k: i64, method: GradientMethod) -> [f64; 3] {
        self.estimate(&RealEstimator::new(self.geometry, self.volume.spacing, method), ray, k)
    }

    /// The same as a vector in the world.
    pub fn world_gradient(&self, ray: DiscreteRay, k: i64, method: GradientMethod) -> DVec3 {
        let estimator = RealEstimator::new(self.geometry, self.volume.spacing, method);
        estimator.basis.world(&self.geometry.axes, self.estimate(&estimator, ray, k))
    }

    fn estimate(&self, estimator: &RealEstimator<'_>, ray: DiscreteRay, k: i64) -> [f64; 3] {
        let beside =
            |[i, j, l]: [i64; 3]| self.sample(DiscreteRay { u: ray.u + i, v: ray.v + j }, k + l).unwrap_or(self.border);
        estimator.gradient(ray, usize::try_from(k).unwrap_or(0), beside)
    }
}
