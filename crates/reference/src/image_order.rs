//! Image-order ray casting: rays from the picture's pixels, steps of one length, exact interpolation.

use crate::check::{check_volume, thickened};
use crate::grid::Grid;
use crate::integrate::{Integrator, Ray, SamplePoint, StepWeights};
use crate::interpolate::cell;
use crate::line::{Line, nearest_axis};
use crate::progress::RowCount;
use crate::span::{Drawn, ON_FACE, margin};
use crate::{Progress, RaycastError};
use cube3_picture::Picture;
use cube3_scene::{ImagePlane, Scene, over, resolve_lights, smallest_spacing};
use cube3_volume::{Sample, Volume, with_samples};
use rayon::prelude::*;
use std::cmp::Ordering;

/// Transmittance below which [`ImageOrderOptions::early_termination`] stops a ray: no channel of the pixel is then
/// off by more, which is less than a sixteenth of the last bit of a 16-bit picture.
const TERMINATION: f64 = 1.0 / (1 << 20) as f64;

/// Most steps through the volume's diagonal.
const MOST_STEPS: f64 = 1e8;

/// How rays are sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageOrderOptions {
    /// Distance between samples, in units of the smallest voxel spacing, above 0.
    pub step_voxel: f64,
    /// Stops rays of which less than 2⁻²⁰ would still be seen. Without it they stop only where nothing can
    /// change a bit of the pixel.
    pub early_termination: bool,
    /// Value of the voxels beyond the volume, for gradients at its border.
    pub border: f64,
    /// Takes every so many pixels of a row and every so many rows, from the top left one on: 1 and up. The rendering is then as much
    /// smaller.
    pub every: usize,
}

impl Default for ImageOrderOptions {
    /// A step of one voxel, every sample, border 0, every pixel.
    fn default() -> Self {
        ImageOrderOptions { step_voxel: 1.0, early_termination: false, border: 0.0, every: 1 }
    }
}

/// What the rays gave.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageRendering {
    /// The picture over its background.
    pub picture: Picture,
    /// Samples taken along the rays; those for gradients not counted.
    pub samples: u64,
}

/// VolRen: casts a ray for every pixel of the picture.
///
/// A ray runs through the box of the voxel centres, [0, n−1] along each axis, inside of the crop box and of the cut planes; an axis of one
/// voxel is one thick ([`Volume::thickened`]). Its first sample is where it enters, the others follow at steps of one length, and the last
/// is where it leaves, after what is left of a step. A sample stands for the half of the way to each of its neighbours, so that together
/// they stand for the ray's length exactly: the trapezoid rule, of second order. Interpolation is trilinear; a gradient's component is the
/// central difference of the values one voxel to either side, over the voxels' distance in the world. Of a label volume a value is that of the
/// nearest voxel, halves towards higher numbers, and the box is that of whole voxels, [−½, n−½].
///
/// In perspective the rays run from the eye. One that begins in the box has its first sample at the eye. Light from the
/// eye shines along each ray, and the eye of a highlight is the ray's. Depth, for depth cueing, is measured along the
/// view and not along the ray. In a weighted sum the weight of a step is the part of the volume's extent, n−1 or of labels n, along the axis nearest to
/// the view which it covers: a ray through all planes sums to 1, in perspective as in a parallel view.
///
/// # Errors
/// A scene with a value out of range, a volume that is no grid of finite values, an option out of range.
pub fn image_order(
    volume: &Volume,
    scene: &Scene,
    options: &ImageOrderOptions,
    progress: Option<Progress<'_>>,
) -> Result<ImageRendering, RaycastError> {
    scene.validate()?;
    check_volume(volume, options.border)?;
    let (volume, scene) = thickened(volume, scene);
    let (volume, scene) = (&*volume, &*scene);
    let smallest = smallest_spacing(volume.spacing);
    let diagonal: f64 = (0..3).map(|i| volume.dims[i] as f64 * volume.spacing[i] / smallest).sum();
    if !(options.step_voxel > 0.0 && options.step_voxel.is_finite() && diagonal / options.step_voxel <= MOST_STEPS) {
        return Err(RaycastError::Option {
            name: "step_voxel",
            value: options.step_voxel,
            reason: "no step",
            right: "give a number above 0 that divides the volume's diagonal into at most 10^8 steps",
        });
    }
    let view = scene.view.frame()?;
    let plane = ImagePlane::new(scene, &view, volume.dims, volume.spacing);
    let axis = nearest_axis(view.direction, volume.spacing);
    let margin = margin(scene);
    let depth = (volume.dims[axis] - 1) as f64 + 2.0 * margin;
    let drawn = Drawn::new(scene, volume.dims);
    let weights = StepWeights {
        length: options.step_voxel,
        sum: 0.0,
        stop_below: if options.early_termination { TERMINATION } else { 0.0 },
    };
    let integrator = Integrator::new(scene, volume, &view, resolve_lights(scene, &view), weights);
    let per_voxel = volume.spacing.map(|s| s / smallest);
    let rows = RowCount::new(progress);
    let every = options.every.max(1);
    let [width, height] = [plane.width, plane.height].map(|pixels| pixels.div_ceil(every));
    let mut pixels = vec![[0.0; 3]; width * height];
    let samples = with_samples!(&volume.samples, v => {
        let grid = Grid { samples: v, dims: volume.dims, border: options.border, per_voxel, margin };
        let cast = |(row, pixels): (usize, &mut [[f64; 3]])| {
            let mut integrator = integrator.clone();
            let mut samples = 0;
            for (column, pixel) in pixels.iter_mut().enumerate() {
                let line = Line::of_pixel(&plane, [column * every, row * every], volume.spacing, smallest);
                let planes = line.direction[axis].abs() * options.step_voxel;
                integrator.start(line.world_direction, planes / depth);
                let (premultiplied, taken) = match line.span(&drawn) {
                    Some(span) => cast_ray(&mut integrator, &grid, &line, &Samples::new(span, options.step_voxel)),
                    None => ([0.0; 4], 0),
                };
                *pixel = over(premultiplied, scene.background);
                samples += taken;
            }
            rows.row_done();
            samples
        };
        pixels.par_chunks_mut(width).enumerate().map(cast).sum()
    });
    Ok(ImageRendering { picture: Picture { width, height, pixels }, samples })
}

/// Where a ray takes samples, and the part of a step that each stands for.
struct Samples {
    enter: f64,
    leave: f64,
    step: f64,
    /// Whole steps from the first sample on.
    whole: usize,
    /// What is left of a step behind them, 0 to below 1.
    rest: f64,
}

impl Samples {
    fn new([enter, leave]: [f64; 2], step: f64) -> Samples {
        let steps = (leave - enter) / step;
        let whole = (steps + ON_FACE).floor();
        let rest = steps - whole;
        Samples { enter, leave, step, whole: whole as usize, rest: if rest > ON_FACE { rest } else { 0.0 } }
    }

    fn count(&self) -> usize {
        self.whole + 1 + usize::from(self.rest > 0.0)
    }

    /// The ray's parameter at a sample.
    #[inline(always)]
    fn at(&self, index: usize) -> f64 {
        if index > self.whole { self.leave } else { self.enter + index as f64 * self.step }
    }

    /// Half of the way to the sample before and half of that to the one behind, in steps.
    #[inline(always)]
    fn part(&self, index: usize) -> f64 {
        let way = |behind: usize| match behind.cmp(&self.whole) {
            Ordering::Less => 1.0,
            Ordering::Equal => self.rest,
            Ordering::Greater => 0.0,
        };
        (if index == 0 { 0.0 } else { way(index - 1) } + way(index)) / 2.0
    }
}

/// The pixel of a ray, opacity-weighted, and how many samples it took.
fn cast_ray<S: Sample>(
    integrator: &mut Integrator<'_>,
    grid: &Grid<'_, S>,
    line: &Line,
    samples: &Samples,
) -> ([f64; 4], u64) {
    let sample_at = |index: usize| {
        let cell = grid.cell(line.at(samples.at(index), grid.dims, grid.margin));
        PlacedSample { grid, cell }
    };
    let mut ray = Ray::START;
    let mut taken = 0;
    for index in 0..samples.count() {
        let sample = sample_at(index);
        integrator.add(&mut ray, index, grid.value(sample.cell), samples.part(index), &sample);
        taken += 1;
        if ray.done {
            break;
        }
    }
    (integrator.finish(&ray, sample_at), taken)
}

/// A cell of eight voxels, by its corner of the smallest coordinates, and the place in it; of labels the nearest voxel, and the way from it.
#[derive(Clone, Copy)]
struct Cell {
    corner: [isize; 3],
    weights: [f64; 3],
}

impl<S: Sample> Grid<'_, S> {
    /// The cell around a position in the box; the last face belongs to the last cell.
    #[inline(always)]
    fn cell(&self, position: [f64; 3]) -> Cell {
        if self.nearest() {
            let corner = [0, 1, 2].map(|i| ((position[i] + 0.5) as isize).min(self.dims[i] as isize - 1));
            return Cell { corner, weights: [0, 1, 2].map(|i| position[i] - corner[i] as f64) };
        }
        let corner = [0, 1, 2].map(|i| (position[i] as isize).min(self.dims[i].saturating_sub(2) as isize));
        Cell { corner, weights: [0, 1, 2].map(|i| position[i] - corner[i] as f64) }
    }

    /// The interpolated value, or the nearest.
    #[inline(always)]
    fn value(&self, at: Cell) -> f64 {
        if self.nearest() {
            return self.voxel(at.corner);
        }
        let [x, y, z] = at.corner;
        let inside = |i: isize, n: usize| i >= 0 && (i as usize) + 1 < n;
        if !(inside(x, self.dims[0]) && inside(y, self.dims[1]) && inside(z, self.dims[2])) {
            return self.value_at_border(at);
        }
        let (row, slice) = (self.dims[0], self.dims[0] * self.dims[1]);
        let first = (z as usize * self.dims[1] + y as usize) * self.dims[0] + x as usize;
        let voxels = &self.samples[first..first + slice + row + 2];
        let pair = |from: usize| [voxels[from].into(), voxels[from + 1].into()];
        cell([[pair(0), pair(row)], [pair(slice), pair(slice + row)]], at.weights)
    }

    #[cold]
    fn value_at_border(&self, at: Cell) -> f64 {
        let corners = [0, 1].map(|z| {
            [0, 1].map(|y| [0, 1].map(|x| self.voxel([at.corner[0] + x, at.corner[1] + y, at.corner[2] + z])))
        });
        cell(corners, at.weights)
    }
}

/// A sample with its cell.
struct PlacedSample<'a, S> {
    grid: &'a Grid<'a, S>,
    cell: Cell,
}

impl<S: Sample> SamplePoint for PlacedSample<'_, S> {
    fn position(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| self.cell.corner[i] as f64 + self.cell.weights[i])
    }

    /// Central differences: the same place in the cells one voxel to either side.
    fn gradient(&self) -> [f64; 3] {
        let along = |axis: usize| {
            let beside = |by: isize| {
                let mut cell = self.cell;
                cell.corner[axis] += by;
                self.grid.value(cell)
            };
            (beside(1) - beside(-1)) * 0.5 / self.grid.per_voxel[axis]
        };
        [along(0), along(1), along(2)]
    }
}
