//! The casters on the base plane: the machine's rays and samples in reals.
//!
//! A sample stands for half of the way to the sample before it and to the one behind; the first of a ray for all of the ray that lies before,
//! and the last for all that lies behind. So the samples of a ray stand for its length exactly. [`DiscreteOptions::whole_steps`] takes each
//! for a whole step instead, as the published machine does.

use crate::check::check_geometry;
use crate::gradient::RealEstimator;
use crate::sample_plane::{SampleWindow, Sampler};
use crate::voxels::Voxels;
use crate::{BaseRendering, SampleCell, TwinError, step_length};
use cube3_frame::{DiscreteRay, Geometry};
use cube3_machine::GradientMethod;
use cube3_reference::{
    Drawn, Integrator, ON_FACE, Progress, Ray, RowCount, SamplePoint, StepWeights, check_volume, thickened,
};
use cube3_scene::{Mode, ResolvedLight, Scene, resolve_lights};
use cube3_volume::{Sample, Volume, with_samples};
use glam::DVec3;
use rayon::prelude::*;

/// Rows of the base plane that one task does: two more planes of samples are taken for them.
const ROWS_IN_A_TASK: usize = 16;

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
/// volume, a border that is not finite.
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

/// Either of the two. The image size of the scene plays no part: the base plane is the geometry's, which is made for the
/// [`thickened`](Volume::thickened) volume.
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
    if scene.view.perspective.is_some() {
        return Err(TwinError::Perspective);
    }
    check_volume(volume, options.border)?;
    let (volume, scene) = thickened(volume, scene);
    let (volume, scene) = (&*volume, &*scene);
    check_geometry(volume, geometry)?;
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
    let weights =
        StepWeights { length: step_length(geometry, volume.spacing), sum: 1.0 / steps as f64, stop_below: 0.0 };
    let integrator = Integrator::new(scene, volume, &view, lights, weights);
    let neighbours = Integrator::reads_gradients(scene);
    let rows = RowCount::new(progress);
    let drawn = if options.whole_steps { Drawn::clips(scene) } else { Drawn::new(scene, volume.dims) };
    let whole_steps = options.whole_steps.then_some(scene.mode);
    let caster = Caster { geometry, drawn, whole_steps, estimator: &estimator, integrator, neighbours, rows: &rows };
    let pixels = with_samples!(&volume.samples, v => {
        let voxels = Voxels::new(v, volume.dims, geometry);
        caster.cast(&Sampler::new(geometry, voxels, interpolation, options.border))
    });
    let [width, height] = geometry.base_plane_size();
    Ok(BaseRendering { width, height, pixels, samples: geometry.sample_count() })
}

struct Caster<'a> {
    geometry: &'a Geometry,
    drawn: Drawn,
    /// The mode, where every sample stands for a whole step.
    whole_steps: Option<Mode>,
    estimator: &'a RealEstimator,
    integrator: Integrator<'a>,
    /// Whether gradients are read.
    neighbours: bool,
    rows: &'a RowCount<'a>,
}

impl Caster<'_> {
    fn cast<S: Sample>(&self, sampler: &Sampler<'_, S>) -> Vec<[f64; 4]> {
        let [width, height] = self.geometry.base_plane_size();
        let mut pixels = vec![[0.0; 4]; width * height];
        pixels.par_chunks_mut(width * ROWS_IN_A_TASK).enumerate().for_each(|(task, pixels)| {
            let first = (task * ROWS_IN_A_TASK) as i64 - self.geometry.shear_v() as i64;
            let mut window = sampler.window(first, self.neighbours);
            let mut integrator = self.integrator.clone();
            for (i, row) in pixels.chunks_mut(width).enumerate() {
                match (i, self.neighbours) {
                    (0, _) => {}
                    (_, true) => window.advance_with_neighbours(),
                    (_, false) => window.advance(),
                }
                self.cast_row(&mut integrator, &window, row);
                self.rows.row_done();
            }
        });
        pixels
    }

    /// All rays of a row step by step together, in the order in which their samples lie in memory.
    fn cast_row<S: Sample>(&self, integrator: &mut Integrator<'_>, window: &SampleWindow<'_, S>, row: &mut [[f64; 4]]) {
        let shear = self.geometry.shear_u() as i64;
        let mut rays = vec![Ray::START; row.len()];
        let depths = self.geometry.size[2];
        let parts = self.parts(window.v, row.len());
        for k in 0..depths {
            for u in self.geometry.valid_columns(window.v, k) {
                let column = (u + shear) as usize;
                let ray = &mut rays[column];
                if let Some(part) = parts[column * depths + k]
                    && !ray.done
                {
                    integrator.add(ray, k, window.sample(column, k), part, &self.point(window, column, k));
                }
            }
        }
        for (column, (pixel, ray)) in row.iter_mut().zip(&rays).enumerate() {
            *pixel = integrator.finish(ray, |k| self.point(window, column, k));
        }
    }

    /// The part of a step that each sample of the rays of plane `v` stands for, ray by ray in order of depth; none where there is no sample
    /// in what is drawn.
    fn parts(&self, v: i64, width: usize) -> Vec<Option<f64>> {
        let depths = self.geometry.size[2];
        let first = -(self.geometry.shear_u() as i64);
        let mut parts = vec![None; width * depths];
        for k in 0..depths {
            for u in self.geometry.valid_columns(v, k) {
                parts[(u - first) as usize * depths + k] = Some(0.0);
            }
        }
        for (u, parts) in (first..).zip(parts.chunks_mut(depths)) {
            self.ray_parts(DiscreteRay { u, v }, parts);
        }
        parts
    }

    /// Of the samples of a ray, those in what is drawn, and how much of the ray is nearer to each than to the others.
    fn ray_parts(&self, ray: DiscreteRay, parts: &mut [Option<f64>]) {
        let Geometry { axes, size, .. } = self.geometry;
        let [u, v] = [ray.u as f64, ray.v as f64];
        let [du, dv] = self.geometry.real_slopes();
        let origin = axes.voxel_position(*size, [u, v, 0.0]);
        let ahead = axes.voxel_position(*size, [u + du, v + dv, 1.0]);
        let span = self.drawn.span(origin, [0, 1, 2].map(|i| ahead[i] - origin[i]));
        let mut before: Option<usize> = None;
        for k in 0..parts.len() {
            let depth = |k: usize| k as f64 + self.geometry.real_offset();
            // A sample that stands for the step behind it is not on a face where the ray leaves.
            let end = if self.whole_steps.is_some_and(Mode::adds_up) { -ON_FACE } else { ON_FACE };
            let drawn = span.filter(|[enter, leave]| (enter - ON_FACE..=leave + end).contains(&depth(k)));
            let (Some([enter, leave]), Some(_)) = (drawn, parts[k]) else {
                parts[k] = None;
                continue;
            };
            if self.whole_steps.is_some() {
                parts[k] = Some(1.0);
                continue;
            }
            // All that is left, until there is another one behind.
            let mut from = enter;
            if let Some((before, part)) = before.and_then(|k| Some((k, parts[k].as_mut()?))) {
                from = f64::midpoint(depth(before), depth(k));
                *part -= leave - from;
            }
            parts[k] = Some(leave - from);
            before = Some(k);
        }
    }

    fn point<'b, S: Sample>(
        &'b self,
        window: &'b SampleWindow<'b, S>,
        column: usize,
        k: usize,
    ) -> DiscreteSample<'b, S> {
        DiscreteSample { geometry: self.geometry, estimator: self.estimator, window, column, k }
    }
}

/// Sample `k` of the ray at pixel `column`.
struct DiscreteSample<'a, S> {
    geometry: &'a Geometry,
    estimator: &'a RealEstimator,
    window: &'a SampleWindow<'a, S>,
    column: usize,
    k: usize,
}

impl<S: Sample> SamplePoint for DiscreteSample<'_, S> {
    fn position(&self) -> [f64; 3] {
        let ray = DiscreteRay { u: self.column as i64 - self.geometry.shear_u() as i64, v: self.window.v };
        self.geometry.axes.voxel_position(self.geometry.size, self.geometry.sample_position(ray, self.k))
    }

    fn gradient(&self) -> [f64; 3] {
        self.estimator.gradient(|by| self.window.neighbour(self.column, self.k, by))
    }
}
