//! The samples of one plane of rays, and as many as a gradient needs on either side of it: the paper's ABC buffers.

use crate::gradient::RealEstimator;
use crate::steps::{Cells, SampleCell, planes};
use crate::voxels::Voxels;
use cube3_frame::{DiscreteRay, Geometry, PerspectivePass};
use cube3_reference::{cell, lerp};
use cube3_volume::Sample;
use std::ops::Range;

/// Takes samples, plane by plane.
pub(crate) struct Sampler<'a, S> {
    geometry: &'a Geometry,
    voxels: Voxels<'a, S>,
    cells: Cells,
    border: f64,
}

/// The samples of the rays (·, v), with a margin of `border` all round so that neighbours need no test.
#[derive(Clone)]
pub(crate) struct SamplePlane {
    /// Samples along k follow each other by this.
    stride: usize,
    /// Places before the first ray.
    margin: usize,
    values: Vec<f64>,
}

/// The planes from v − reach to v + reach.
pub(crate) struct SampleWindow<'a, S> {
    sampler: &'a Sampler<'a, S>,
    planes: Vec<SamplePlane>,
    /// How many rays away neighbours are at most; 0 where none are read.
    reach: usize,
    scratch: Scratch,
    /// v of the plane in the middle.
    pub v: i64,
}

/// Beams of voxels, one for each row and plane of a cell, and the two rows between them.
struct Scratch {
    beams: [Vec<f64>; 4],
    between: [Vec<f64>; 2],
}

impl<'a, S: Sample> Sampler<'a, S> {
    pub fn new(geometry: &'a Geometry, voxels: Voxels<'a, S>, interpolation: SampleCell, border: f64) -> Self {
        Sampler { geometry, voxels, cells: Cells::new(geometry, interpolation), border }
    }

    /// The planes around `v`, as many on either side as neighbours are away; without `neighbours` none.
    pub fn window(&'a self, v: i64, neighbours: bool) -> SampleWindow<'a, S> {
        let n = self.geometry.size[0];
        let beam = || vec![0.0; n + 1];
        let reach = if neighbours { self.reach() } else { 0 };
        let mut window = SampleWindow {
            sampler: self,
            planes: (0..=2 * reach).map(|_| self.empty(reach)).collect(),
            reach,
            scratch: Scratch { beams: [beam(), beam(), beam(), beam()], between: [beam(), beam()] },
            v,
        };
        for (plane, v) in window.planes.iter_mut().zip(v - reach as i64..) {
            self.fill(v, plane, &mut window.scratch);
        }
        window
    }

    /// How many rays away neighbours are at most.
    pub fn reach(&self) -> usize {
        self.geometry.perspective.as_ref().map_or(1, |pass| pass.most_reach as usize)
    }

    fn empty(&self, margin: usize) -> SamplePlane {
        let [width, _] = self.geometry.base_plane_size();
        let stride = width + 2 * margin;
        SamplePlane { stride, margin, values: vec![self.border; stride * (self.geometry.size[2] + 2)] }
    }

    fn fill(&self, v: i64, plane: &mut SamplePlane, scratch: &mut Scratch) {
        plane.values.fill(self.border);
        let first = self.geometry.first_ray().u;
        for k in 0..self.geometry.size[2] {
            let rays = self.geometry.valid_columns(v, k);
            if !rays.is_empty() {
                let from = plane.index((rays.start - first) as usize, k, [0, 0]);
                let count = (rays.end - rays.start) as usize;
                let samples = &mut plane.values[from..from + count];
                match &self.geometry.perspective {
                    None => self.row(v, k, rays, scratch, samples),
                    Some(pass) => self.fan_row(pass, v, k, scratch, samples),
                }
            }
        }
    }

    /// Samples k of all rays (u, v) of a pass that have it: each gathered from its own cell.
    fn fan_row(&self, pass: &PerspectivePass, v: i64, k: usize, scratch: &mut Scratch, samples: &mut [f64]) {
        let (planes, along_w) = (planes(self.geometry, k), self.geometry.real_offset());
        let along_v = self.cells.along_v(self.geometry, pass, v, k);
        for j in 0..2 {
            for (plane, (row, w)) in along_v.edges[j].into_iter().zip(planes).enumerate() {
                self.voxels.read_beam(row, w, &mut scratch.beams[2 * j + plane]);
            }
        }
        for (sample, along_u) in samples.iter_mut().zip(self.cells.along_u(pass, k)) {
            let voxel = |plane: usize, j: usize, i: usize| scratch.beams[2 * j + plane][along_u.edges[i][plane]];
            let corners = [0, 1].map(|plane| [0, 1].map(|j| [0, 1].map(|i| voxel(plane, j, i))));
            *sample = cell(corners, [along_u.weight, along_v.weight, along_w]);
        }
    }

    /// Samples k of the rays (u, v) for u in `rays`, all valid: the lerps of [`cell`](cube3_reference::cell), each
    /// done for all rays of a parallel frame at once.
    fn row(&self, v: i64, k: usize, rays: Range<i64>, scratch: &mut Scratch, samples: &mut [f64]) {
        let step = &self.cells.steps[k];
        let [along_u, along_v, along_w] = step.weights;
        let last_row = self.geometry.size[1] - 1;
        let count = samples.len();
        for j in 0..2 {
            for plane in 0..2 {
                let row = ((v + step.rows[plane] as i64) as usize + j).min(last_row);
                self.voxels.read_beam(row, step.planes[plane], &mut scratch.beams[2 * j + plane]);
            }
            let from = step.columns.map(|column| (rays.start + column as i64) as usize);
            let near = &scratch.beams[2 * j][from[0]..=from[0] + count];
            let far = &scratch.beams[2 * j + 1][from[1]..=from[1] + count];
            for ((to, near), far) in scratch.between[j].iter_mut().zip(near).zip(far) {
                *to = lerp(*near, *far, along_w);
            }
        }
        let [above, below] = &scratch.between;
        for (i, sample) in samples.iter_mut().enumerate() {
            let above = lerp(above[i], above[i + 1], along_u);
            let below = lerp(below[i], below[i + 1], along_u);
            *sample = lerp(above, below, along_v);
        }
    }
}

impl SamplePlane {
    #[inline(always)]
    fn index(&self, column: usize, k: usize, [i, l]: [i64; 2]) -> usize {
        (k as i64 + 1 + l) as usize * self.stride + (column as i64 + self.margin as i64 + i) as usize
    }
}

impl<S: Sample> SampleWindow<'_, S> {
    /// Moves on to v + 1.
    pub fn advance(&mut self) {
        self.v += 1;
        self.planes.rotate_left(1);
        if let Some(last) = self.planes.last_mut() {
            self.sampler.fill(self.v + self.reach as i64, last, &mut self.scratch);
        }
    }

    /// The ray at pixel `column` of the plane in the middle.
    #[inline(always)]
    pub fn ray(&self, column: usize) -> DiscreteRay {
        DiscreteRay { u: self.sampler.geometry.first_ray().u + column as i64, v: self.v }
    }

    /// Sample `k` of the ray at pixel `column` of the plane in the middle.
    #[inline(always)]
    pub fn sample(&self, column: usize, k: usize) -> f64 {
        let plane = &self.planes[self.reach];
        plane.values[plane.index(column, k, [0, 0])]
    }

    /// The gradient there, of a window with neighbours.
    #[inline]
    pub fn gradient(&self, estimator: &RealEstimator<'_>, column: usize, k: usize) -> [f64; 3] {
        estimator.gradient(self.ray(column), k, |by| self.neighbour(column, k, by))
    }

    /// The sample by (i, j, l) away along u, v and the ray, i and j up to the window's reach and l −1, 0 or 1; the border where there is none.
    #[inline(always)]
    fn neighbour(&self, column: usize, k: usize, [i, j, l]: [i64; 3]) -> f64 {
        let plane = &self.planes[(self.reach as i64 + j) as usize];
        plane.values[plane.index(column, k, [i, l])]
    }
}
