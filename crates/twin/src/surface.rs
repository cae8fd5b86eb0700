//! Gradients on a thresholded surface: the experiment of Pfister et al. 1995, section 6.2.

use crate::check::{check_estimator, check_geometry};
use crate::gradient::RealEstimator;
use crate::sample_plane::Sampler;
use crate::voxels::Voxels;
use crate::{DiscreteOptions, SampleCell, TwinError};
use cube3_frame::{DiscreteRay, Geometry};
use cube3_reference::check_volume;
use cube3_volume::{Volume, with_samples};
use glam::DVec3;
use rayon::prelude::*;

/// Where a ray meets the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The ray.
    pub ray: DiscreteRay,
    /// The sample's position in voxels, x, y, z.
    pub position: [f64; 3],
    /// The gradient there, in the world, in values per smallest voxel spacing.
    pub gradient: DVec3,
}

/// The first sample above `threshold` on every ray that has one, row by row of the base plane.
///
/// # Errors
/// A volume that is no grid of finite values, a geometry of another volume, a border that is not finite, an estimator of parallel rays in
/// perspective.
pub fn surface_gradients(
    volume: &Volume,
    geometry: &Geometry,
    interpolation: SampleCell,
    threshold: f64,
    options: &DiscreteOptions,
) -> Result<Vec<SurfacePoint>, TwinError> {
    check_volume(volume, options.border)?;
    check_geometry(volume, geometry)?;
    check_estimator(geometry, options.gradient)?;
    let estimator = RealEstimator::new(geometry, volume.spacing, options.gradient);
    let [width, height] = geometry.base_plane_size();
    let first = geometry.first_ray();
    Ok(with_samples!(&volume.samples, v => {
        let sampler = Sampler::new(geometry, Voxels::new(v, volume.dims, geometry), interpolation, options.border);
        let row = |row: usize| {
            let window = sampler.window(first.v + row as i64, true);
            let mut met = vec![None; width];
            for k in 0..geometry.size[2] {
                for u in geometry.valid_columns(window.v, k) {
                    let column = (u - first.u) as usize;
                    if met[column].is_none() && window.sample(column, k) > threshold {
                        met[column] = Some(k);
                    }
                }
            }
            let point = |(column, k): (usize, Option<usize>)| {
                let k = k?;
                let ray = window.ray(column);
                let components = window.gradient(&estimator, column, k);
                Some(SurfacePoint {
                    ray,
                    position: geometry.axes.voxel_position(geometry.size, geometry.sample_position(ray, k)),
                    gradient: estimator.basis.world(&geometry.axes, components),
                })
            };
            met.into_iter().enumerate().filter_map(point).collect::<Vec<_>>()
        };
        (0..height).into_par_iter().flat_map_iter(row).collect()
    }))
}
