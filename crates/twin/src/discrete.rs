//! The casters on the base plane: the machine's rays and samples in reals.
//!
//! A sample stands for half of the way to the sample before it and to the one behind; the first of a ray for all of the ray that lies before,
//! and the last for all that lies behind. So the samples of a ray stand for its length exactly. [`DiscreteOptions::whole_steps`] takes each
//! for a whole step instead, as the published machine does.

use crate::cast::Caster;
use crate::check::{check_estimator, check_geometry};
use crate::gradient::RealEstimator;
use crate::parts::Parts;
use crate::rays::eye_depth;
use crate::sample_plane::Sampler;
use crate::voxels::Voxels;
use crate::{BaseRendering, SampleCell, TwinError, step_length};
use cube3_frame::Geometry;
use cube3_machine::GradientMethod;
use cube3_reference::{Integrator, Progress, RowCount, StepWeights, check_volume, thickened};
use cube3_scene::{Mode, ResolvedLight, Scene, resolve_lights};
use cube3_volume::{Volume, with_samples};
use glam::DVec3;

/// What a caster on the base plane may be told beside scene and geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscreteOptions {
    /// The gradient estimator.
    pub gradient: GradientMethod,
    /// Value of the samples beyond the volume, for gradients: what the machine's voxel word 0 stands for.
    pub border: f64,
    /// Every sample stands for a whole step, and in a weighted sum for one plane of n_w, as with the machine's `rays.ends = "published"`.
    pub whole_steps: bool,
}

impl Default for DiscreteOptions {
    /// The paper's choice, 12 neighbours; border 0; rays of their own length.
    fn default() -> Self {
        DiscreteOptions { gradient: GradientMethod::Twelve, border: 0.0, whole_steps: false }
    }
}

/// True3D: the machine's rays and samples, each interpolated in its exact 8-neighbourhood.
///
/// # Errors
/// A scene with a value out of range, a volume that is no grid of finite values, a geometry of another
/// volume or of rays that are not the scene's, a border that is not finite, an estimator of parallel rays where each has its own direction.
pub fn true_3d(
    volume: &Volume,
    scene: &Scene,
    geometry: &Geometry,
    options: &DiscreteOptions,
    progress: Option<Progress<'_>>,
) -> Result<BaseRendering, TwinError> {
    discrete(volume, scene, geometry, SampleCell::Exact, options, progress)
}

/// Sheared3D: the machine's rays and samples, each interpolated in its sheared cell.
///
/// # Errors
/// As [`true_3d`].
pub fn sheared(
    volume: &Volume,
    scene: &Scene,
    geometry: &Geometry,
    options: &DiscreteOptions,
    progress: Option<Progress<'_>>,
) -> Result<BaseRendering, TwinError> {
    discrete(volume, scene, geometry, SampleCell::Sheared, options, progress)
}

/// Either of the two, of a parallel frame or of one pass of a perspective view. The image size of the scene plays no part, but for the place of
/// an eye that is to see all of the volume: the base plane is the geometry's, which is made for the [`thickened`](Volume::thickened) volume.
///
/// # Errors
/// As [`true_3d`].
pub fn discrete(
    volume: &Volume,
    scene: &Scene,
    geometry: &Geometry,
    interpolation: SampleCell,
    options: &DiscreteOptions,
    progress: Option<Progress<'_>>,
) -> Result<BaseRendering, TwinError> {
    scene.validate()?;
    check_volume(volume, options.border)?;
    let (volume, scene) = thickened(volume, scene);
    let (volume, scene) = (&*volume, &*scene);
    check_geometry(volume, geometry)?;
    if geometry.perspective.is_some() != scene.view.perspective.is_some() {
        return Err(TwinError::Rays { geometry: geometry.perspective.is_some() });
    }
    let neighbours = Integrator::reads_gradients(scene);
    if neighbours {
        check_estimator(geometry, options.gradient)?;
    }
    let view = scene.view.frame()?;
    let estimator = RealEstimator::new(geometry, volume.spacing, options.gradient);
    let in_frame = |vector: DVec3| DVec3::from(estimator.basis.components(&geometry.axes, vector));
    let lights: Vec<ResolvedLight> = resolve_lights(scene, &view)
        .into_iter()
        .map(|light| ResolvedLight {
            direction: in_frame(light.direction),
            halfway: in_frame(light.halfway),
            colour: light.colour,
        })
        .collect();
    let steps = if options.whole_steps { geometry.size[2] } else { geometry.bounding_planes() - 1 };
    let eye = eye_depth(scene, &view, volume, geometry);
    // From an eye each ray has a step of its own.
    let length = if eye.is_none() { step_length(geometry, volume.spacing) } else { 1.0 };
    let weights = StepWeights { length, sum: 1.0 / steps as f64, stop_below: 0.0 };
    let rows = RowCount::new(progress);
    let caster = Caster {
        geometry,
        spacing: volume.spacing,
        parts: Parts::new(scene, volume.dims, geometry, options.whole_steps, eye),
        by_length: scene.mode == Mode::Composite && scene.transfer.opacity_correction,
        estimator: &estimator,
        integrator: Integrator::new(scene, volume, &view, lights, weights),
        sum: weights.sum,
        neighbours,
        rows: &rows,
    };
    let pixels = with_samples!(&volume.samples, v => {
        let voxels = Voxels::new(v, volume.dims, geometry);
        caster.cast(&Sampler::new(geometry, voxels, interpolation, options.border))
    });
    let [width, height] = geometry.base_plane_size();
    Ok(BaseRendering { width, height, pixels, samples: geometry.sample_count() })
}
