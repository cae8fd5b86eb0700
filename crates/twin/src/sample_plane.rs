//! The samples of one plane of rays, and three of them for gradients: the paper's ABC buffers.

use crate::steps::{SampleCell, Step, steps};
use crate::voxels::Voxels;
use cube3_frame::Geometry;
use cube3_reference::lerp;
use cube3_volume::Sample;
use std::ops::Range;

/// Takes samples, plane by plane.
pub(crate) struct Sampler<'a, S> {
    geometry: &'a Geometry,
    voxels: Voxels<'a, S>,
    steps: Vec<Step>,
    border: f64,
}

/// The samples of the rays (·, v), with a margin of `border` all round so that neighbours need no test.
#[derive(Clone)]
pub(crate) struct SamplePlane {
    /// Samples along k follow each other by this.
    stride: usize,
    values: Vec<f64>,
}

/// The planes v − 1, v and v + 1.
pub(crate) struct SampleWindow<'a, S> {
    sampler: &'a Sampler<'a, S>,
    planes: [SamplePlane; 3],
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
        Sampler { geometry, voxels, steps: steps(geometry, interpolation), border }
    }

    /// The three planes around `v`; without `neighbours` the outer two are left empty.
    pub fn window(&'a self, v: i64, neighbours: bool) -> SampleWindow<'a, S> {
        let n = self.geometry.size[0];
        let beam = || vec![0.0; n + 1];
        let mut window = SampleWindow {
            sampler: self,
            planes: [self.empty(), self.empty(), self.empty()],
            scratch: Scratch { beams: [beam(), beam(), beam(), beam()], between: [beam(), beam()] },
            v,
        };
        for (i, plane) in window.planes.iter_mut().enumerate() {
            if i == 1 || neighbours {
                self.fill(v + i as i64 - 1, plane, &mut window.scratch);
            }
        }
        window
    }

    fn empty(&self) -> SamplePlane {
        let [width, _] = self.geometry.base_plane_size();
        let stride = width + 2;
        SamplePlane { stride, values: vec![self.border; stride * (self.geometry.size[2] + 2)] }
    }

    fn fill(&self, v: i64, plane: &mut SamplePlane, scratch: &mut Scratch) {
        plane.values.fill(self.border);
        for k in 0..self.geometry.size[2] {
            let rays = self.geometry.valid_columns(v, k);
            if !rays.is_empty() {
                let column = (rays.start + self.geometry.shear_u() as i64) as usize;
                let from = plane.index(column, k, [0, 0]);
                let count = (rays.end - rays.start) as usize;
                self.row(v, k, rays, scratch, &mut plane.values[from..from + count]);
            }
        }
    }

    /// Samples k of the rays (u, v) for u in `rays`, all valid: the lerps of [`cell`](cube3_reference::cell), each
    /// done for all rays at once.
    fn row(&self, v: i64, k: usize, rays: Range<i64>, scratch: &mut Scratch, samples: &mut [f64]) {
        let step = &self.steps[k];
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
        (k as i64 + 1 + l) as usize * self.stride + (column as i64 + 1 + i) as usize
    }
}

impl<S: Sample> SampleWindow<'_, S> {
    /// Moves on to v + 1. The window must have been made with neighbours.
    pub fn advance_with_neighbours(&mut self) {
        self.v += 1;
        self.planes.rotate_left(1);
        self.sampler.fill(self.v + 1, &mut self.planes[2], &mut self.scratch);
    }

    /// Moves on to v + 1 where only the plane in the middle is read.
    pub fn advance(&mut self) {
        self.v += 1;
        self.sampler.fill(self.v, &mut self.planes[1], &mut self.scratch);
    }

    /// Sample `k` of the ray at pixel `column` of the plane in the middle.
    #[inline(always)]
    pub fn sample(&self, column: usize, k: usize) -> f64 {
        let plane = &self.planes[1];
        plane.values[plane.index(column, k, [0, 0])]
    }

    /// The sample by (i, j, l) away along u, v and the ray, each −1, 0 or 1; the border where there is none.
    #[inline(always)]
    pub fn neighbour(&self, column: usize, k: usize, [i, j, l]: [i64; 3]) -> f64 {
        let plane = &self.planes[(1 + j) as usize];
        plane.values[plane.index(column, k, [i, l])]
    }
}
