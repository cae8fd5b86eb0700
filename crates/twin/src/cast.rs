//! Rays over the base plane, row by row on every core.

use crate::gradient::RealEstimator;
use crate::parts::Parts;
use crate::rays::Line;
use crate::sample_plane::{SampleWindow, Sampler};
use crate::step_length::line_step_length;
use cube3_frame::Geometry;
use cube3_reference::{Integrator, Ray, RowCount, SamplePoint};
use cube3_volume::Sample;
use rayon::prelude::*;

/// Rows of the base plane that one task does at least; as many more planes of samples are taken for them as neighbours are away on either
/// side.
const ROWS_IN_A_TASK: usize = 16;

/// The same for each ray by which neighbours are away: twice the planes of a task's margin.
const ROWS_FOR_REACH: usize = 4;

/// What the rays of a frame go by.
pub(crate) struct Caster<'a> {
    pub geometry: &'a Geometry,
    pub spacing: [f64; 3],
    pub parts: Parts<'a>,
    /// Whether opacity is corrected to the length of a step.
    pub by_length: bool,
    pub estimator: &'a RealEstimator<'a>,
    pub integrator: Integrator<'a>,
    /// The weight of a whole step in a weighted sum.
    pub sum: f64,
    /// Whether gradients are read.
    pub neighbours: bool,
    pub rows: &'a RowCount<'a>,
}

impl Caster<'_> {
    /// The pixels of the base plane.
    pub fn cast<S: Sample>(&self, sampler: &Sampler<'_, S>) -> Vec<[f64; 4]> {
        let [width, height] = self.geometry.base_plane_size();
        let in_a_task =
            if self.neighbours { ROWS_IN_A_TASK.max(ROWS_FOR_REACH * sampler.reach()) } else { ROWS_IN_A_TASK };
        let mut pixels = vec![[0.0; 4]; width * height];
        pixels.par_chunks_mut(width * in_a_task).enumerate().for_each(|(task, pixels)| {
            let first = (task * in_a_task) as i64 + self.geometry.first_ray().v;
            let mut window = sampler.window(first, self.neighbours);
            let mut integrator = self.integrator.clone();
            for (i, row) in pixels.chunks_mut(width).enumerate() {
                if i > 0 {
                    window.advance();
                }
                let parts = self.parts.plane(window.v, row.len());
                match self.geometry.perspective {
                    None => self.cast_row(&mut integrator, &window, &parts, row),
                    Some(_) => self.cast_fan(&mut integrator, &window, &parts, row),
                }
                self.rows.row_done();
            }
        });
        pixels
    }

    /// All parallel rays of a row step by step together, in the order in which their samples lie in memory.
    fn cast_row<S: Sample>(
        &self,
        integrator: &mut Integrator<'_>,
        window: &SampleWindow<'_, S>,
        parts: &[Option<f64>],
        row: &mut [[f64; 4]],
    ) {
        let first = self.geometry.first_ray().u;
        let mut rays = vec![Ray::START; row.len()];
        let depths = self.geometry.size[2];
        for k in 0..depths {
            for u in self.geometry.valid_columns(window.v, k) {
                let column = (u - first) as usize;
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

    /// The rays of an eye one by one, each with its own light and its own length of a step.
    fn cast_fan<S: Sample>(
        &self,
        integrator: &mut Integrator<'_>,
        window: &SampleWindow<'_, S>,
        parts: &[Option<f64>],
        row: &mut [[f64; 4]],
    ) {
        let rays = row.iter_mut().zip(parts.chunks(self.geometry.size[2]));
        for (column, (pixel, parts)) in rays.enumerate() {
            let line = Line::new(self.geometry, window.ray(column));
            let length = line_step_length(&line, self.geometry, self.spacing);
            let along = self.geometry.axes.to_world(line.step(self.geometry, self.spacing).normalize().to_array());
            integrator.start(self.estimator.basis.components(&self.geometry.axes, along).into(), self.sum);
            let mut ray = Ray::START;
            for (k, part) in parts.iter().enumerate() {
                let Some(part) = part else { continue };
                let part = if self.by_length { part * length } else { *part };
                integrator.add(&mut ray, k, window.sample(column, k), part, &self.point(window, column, k));
                if ray.done {
                    break;
                }
            }
            *pixel = integrator.finish(&ray, |k| self.point(window, column, k));
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
    estimator: &'a RealEstimator<'a>,
    window: &'a SampleWindow<'a, S>,
    column: usize,
    k: usize,
}

impl<S: Sample> SamplePoint for DiscreteSample<'_, S> {
    fn position(&self) -> [f64; 3] {
        let depth = self.k as f64 + self.geometry.real_offset();
        let place = Line::new(self.geometry, self.window.ray(self.column)).at(depth);
        self.geometry.axes.voxel_position(self.geometry.size, place)
    }

    fn gradient(&self) -> [f64; 3] {
        self.window.gradient(self.estimator, self.column, self.k)
    }
}
