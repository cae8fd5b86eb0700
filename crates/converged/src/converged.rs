//! The picture: a ray for each pixel.

use crate::cell::{Field, Place, depth_along, extremes};
use crate::optics::Optics;
use crate::quadrature::Request;
use crate::ray::{Integral, Ray};
use cube3_picture::Picture;
use cube3_reference::{
    Drawn, Grid, Line, LinearCue, Progress, RaycastError, RowCount, check_volume, margin, nearest_axis, thickened,
};
use cube3_scene::{ImagePlane, Mode, ResolvedLight, Scene, over, resolve_lights, smallest_spacing, turn_lights};
use cube3_volume::{Volume, with_samples};
use rayon::prelude::*;

/// The least and the largest tolerance that can be asked for: below, rounding is more than it; above, it is no picture.
pub const TOLERANCES: [f64; 2] = [1e-13, 0.5];

/// A direction's component below this moves by less than rounding over any ray.
const ALONG: f64 = 1e-12;

/// What is asked of the rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConvergedOptions {
    /// The most that any channel of a pixel may be off by, of full scale, within [`TOLERANCES`].
    pub tolerance: f64,
    /// Value of the voxels beyond the volume, for gradients at its border.
    pub border: f64,
    /// Takes every so many pixels of a row and every so many rows, from the top left one on: 1 and up. The rendering is then as much
    /// smaller.
    pub every: usize,
}

impl Default for ConvergedOptions {
    /// A millionth, border 0, every pixel.
    fn default() -> Self {
        ConvergedOptions { tolerance: 1e-6, border: 0.0, every: 1 }
    }
}

/// What the rays gave.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergedRendering {
    /// The picture over its background.
    pub picture: Picture,
    /// The most that any channel of each pixel is off by: quadrature, what lies behind all that is seen, and rounding.
    pub bounds: Vec<f64>,
    /// Evaluations at the nodes of quadrature rules.
    pub evaluations: u64,
}

/// The integral of emission and absorption along the ray of every pixel, or of a weighted sum its integral.
///
/// ```text
///   C = ∫ c·μ·e^−τ dt,   τ = ∫ μ dt,   μ = −ln(1 − α)
/// ```
/// Rays, what is drawn of a volume, interpolation, gradients, classification and light are those of
/// [`image_order`](cube3_reference::image_order()), which comes to it as its steps become short. Opacity is that of a unit length, whether or
/// not the scene wants it corrected: an integral has no steps. The bound of a pixel is at most the tolerance, but where no number of nodes
/// could hold it in 64 bits (a normal of rounding alone, a surface that a ray touches); it is then the true bound.
///
/// # Errors
/// As [`image_order`](cube3_reference::image_order()); a tolerance out of range; a mode that chooses one sample.
pub fn converged(
    volume: &Volume,
    scene: &Scene,
    options: &ConvergedOptions,
    progress: Option<Progress<'_>>,
) -> Result<ConvergedRendering, RaycastError> {
    scene.validate()?;
    check_volume(volume, options.border)?;
    let (volume, scene) = thickened(volume, scene);
    let (volume, scene) = (&*volume, &*scene);
    if !(TOLERANCES[0]..=TOLERANCES[1]).contains(&options.tolerance) {
        return Err(RaycastError::Option {
            name: "tolerance",
            value: options.tolerance,
            reason: "not a tolerance that can be held",
            right: "give a number from 1e-13 to 0.5, of full scale",
        });
    }
    if !scene.mode.adds_up() {
        return Err(RaycastError::Option {
            name: "mode",
            value: f64::from(scene.mode.code()),
            reason: "a mode that chooses a sample, and no integral",
            right: "give composite or weighted-sum",
        });
    }
    let view = scene.view.frame()?;
    let smallest = smallest_spacing(volume.spacing);
    let plane = ImagePlane::new(scene, &view, volume.dims, volume.spacing);
    let axis = nearest_axis(view.direction, volume.spacing);
    let extent = (volume.dims[axis] - 1) as f64 + 2.0 * margin(scene);
    let cue = scene.depth_cue.as_ref().map(|cue| LinearCue::new(cue, volume, &view));
    let caster = Caster {
        scene,
        optics: Optics::new(scene),
        drawn: Drawn::new(scene, volume.dims),
        dims: volume.dims,
        labels: scene.volume.labels,
        cue,
        tolerance: options.tolerance,
        axis,
        extent,
    };
    let lights = resolve_lights(scene, &view);
    let per_voxel = volume.spacing.map(|s| s / smallest);
    let rows = RowCount::new(progress);
    let every = options.every.max(1);
    let [width, height] = [plane.width, plane.height].map(|pixels| pixels.div_ceil(every));
    let mut pixels = vec![([0.0; 3], 0.0); width * height];
    let evaluations = with_samples!(&volume.samples, v => {
        let grid = Grid { samples: v, dims: volume.dims, border: options.border, per_voxel, margin: margin(scene) };
        let field: &dyn Field = &grid;
        let cast = |(row, pixels): (usize, &mut [([f64; 3], f64)])| {
            let mut lights = lights.clone();
            let mut evaluations = 0;
            for (column, pixel) in pixels.iter_mut().enumerate() {
                let line = Line::of_pixel(&plane, [column * every, row * every], volume.spacing, smallest);
                turn_lights(scene, line.world_direction, &mut lights);
                let integral = caster.cast(field, &line, &lights);
                *pixel = (caster.pixel(&integral), integral.bound);
                evaluations += integral.evaluations;
            }
            rows.row_done();
            evaluations
        };
        pixels.par_chunks_mut(width).enumerate().map(cast).sum()
    });
    let (pixels, bounds) = pixels.into_iter().unzip();
    Ok(ConvergedRendering { picture: Picture { width, height, pixels }, bounds, evaluations })
}

struct Caster<'a> {
    scene: &'a Scene,
    optics: Optics<'a>,
    drawn: Drawn,
    dims: [usize; 3],
    labels: bool,
    cue: Option<LinearCue<'a>>,
    tolerance: f64,
    /// Of a weighted sum: the axis nearest to the view, and the volume's extent along it.
    axis: usize,
    extent: f64,
}

impl Caster<'_> {
    fn cast(&self, field: &dyn Field, line: &Line, lights: &[ResolvedLight]) -> Integral {
        let span = line.span(&self.drawn);
        let [enter, leave] = span.unwrap_or([0.0; 2]);
        let request = Request {
            tolerance: self.tolerance,
            weight: (self.scene.mode == Mode::WeightedSum).then(|| line.direction[self.axis].abs() / self.extent),
            length: leave - enter,
        };
        let mut ray = Ray::new(&self.optics, lights, request);
        if leave > enter {
            self.walk(field, line, [enter, leave], &mut ray);
        }
        ray.finish()
    }

    /// Cell by cell from the front.
    fn walk(&self, field: &dyn Field, line: &Line, [enter, leave]: [f64; 2], ray: &mut Ray<'_>) {
        let half = if self.labels { 0.5 } else { 0.0 };
        // A line along a face is on it, whatever rounding says.
        let mut line = *line;
        for (i, n) in self.dims.into_iter().enumerate().filter(|&(i, _)| line.direction[i].abs() < ALONG) {
            line.origin[i] = line.origin[i].clamp(-half, (n - 1) as f64 + half);
        }
        let line = &line;
        let last = [0, 1, 2].map(|i| self.dims[i] as isize - if self.labels { 1 } else { 2 });
        let at = |t: f64| [0, 1, 2].map(|i| line.origin[i] + line.direction[i] * t + half);
        let start = at(enter);
        let mut corner = [0, 1, 2].map(|i| (start[i].floor() as isize).clamp(0, last[i]));
        // Where the line leaves a cell along each axis.
        let crossing = |corner: &[isize; 3], i: usize| {
            let rate = line.direction[i];
            let face = corner[i] as f64 - half + if rate > 0.0 { 1.0 } else { 0.0 };
            if rate == 0.0 { f64::INFINITY } else { (face - line.origin[i]) / rate }
        };
        let mut next = [0, 1, 2].map(|i| crossing(&corner, i));
        let cue_ends = self.cue_ends(line);
        let mut from = enter;
        while from < leave && !ray.integral.done {
            let nearest = (0..3).fold(0, |best, i| if next[i] < next[best] { i } else { best });
            let to = next[nearest].min(leave);
            if to > from {
                let corners = field.corners(corner);
                if !self.optics.stretches.clear(extremes(&corners)) {
                    let cuts = cue_ends.into_iter().filter(|&t| from < t && t < to);
                    let mut begin = from;
                    for end in cuts.chain([to]) {
                        let place = Place { corner, ends: [begin, end] };
                        let wants = self.optics.wants_gradient();
                        ray.add(&place.piece(field, &corners, line, wants, self.cue.as_ref()));
                        begin = end;
                    }
                }
                from = to;
            }
            if next[nearest] > leave {
                break;
            }
            let ahead = corner[nearest] + if line.direction[nearest] > 0.0 { 1 } else { -1 };
            if ahead < 0 || ahead > last[nearest] {
                // The last face belongs to the last cell.
                next[nearest] = f64::INFINITY;
                continue;
            }
            corner[nearest] = ahead;
            next[nearest] = crossing(&corner, nearest);
        }
    }

    /// Where the cue's depth is 0 and 1, in ascending order; infinite without.
    fn cue_ends(&self, line: &Line) -> [f64; 2] {
        let Some(cue) = &self.cue else { return [f64::INFINITY; 2] };
        let [depth, rate] = depth_along(cue, line, 0.0);
        let ends = [-depth / rate, (1.0 - depth) / rate];
        if rate == 0.0 { [f64::INFINITY; 2] } else { [ends[0].min(ends[1]), ends[0].max(ends[1])] }
    }

    fn pixel(&self, integral: &Integral) -> [f64; 3] {
        let [r, g, b] = integral.colour;
        let alpha = 1.0 - integral.transmittance;
        let pixel = match self.scene.mode {
            Mode::WeightedSum => [r.min(1.0), g.min(1.0), b.min(1.0), alpha.min(1.0)],
            _ => [r, g, b, alpha],
        };
        over(pixel, self.scene.background)
    }
}
