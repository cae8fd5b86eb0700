//! The base-plane image, and its warp to the picture.

use crate::perspective::Perspective;
use crate::picture::major;
use crate::{Geometry, ImagePlane, SLOPE_FRACTION_BITS};
use glam::DVec2;

/// The machine's output: a pixel for each ray, red, green, blue (opacity-weighted) and opacity, unit words of
/// `bits`. Row-major from ray (−Y, −X).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BasePlane {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Bits of a component.
    pub bits: u32,
    /// The pixels.
    pub pixels: Vec<[u32; 4]>,
}

impl BasePlane {
    /// An empty base plane of a geometry's size.
    pub fn empty(geometry: &Geometry, bits: u32) -> BasePlane {
        let [width, height] = geometry.base_plane_size();
        BasePlane { width, height, bits, pixels: vec![[0; 4]; width * height] }
    }

    /// The pixel as reals 0 to 1; transparent beyond the edge.
    fn real(&self, column: i64, row: i64) -> [f64; 4] {
        if column < 0 || row < 0 || column >= self.width as i64 || row >= self.height as i64 {
            return [0.0; 4];
        }
        let full = f64::from(cube3_word::unit_full(self.bits));
        self.pixels[row as usize * self.width + column as usize].map(|word| f64::from(word) / full)
    }

    /// The base plane over a background, row-major: opacity-weighted colour plus what shows through.
    pub fn over(&self, background: [f64; 3]) -> Vec<[f64; 3]> {
        let full = f64::from(cube3_word::unit_full(self.bits));
        self.pixels.iter().map(|pixel| over(pixel.map(|word| f64::from(word) / full), background)).collect()
    }
}

/// Opacity-weighted colour over a background, held to 0..1.
pub fn over(pixel: [f64; 4], background: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (pixel[i] + (1.0 - pixel[3]) * background[i]).clamp(0.0, 1.0))
}

/// Warps a base plane given as a function of (column, row) to the picture: bilinear, over `background`, row-major
/// from the top left.
pub fn warp(
    base: &BasePlane,
    geometry: &Geometry,
    plane: &ImagePlane,
    spacing: [f64; 3],
    background: [f64; 3],
) -> Vec<[f64; 3]> {
    warp_reals(&|column, row| base.real(column, row), geometry, plane, spacing, background)
}

/// The same for a base plane of reals, `pixel(column, row)` opacity-weighted and transparent beyond the edge.
pub fn warp_reals(
    pixel: &dyn Fn(i64, i64) -> [f64; 4],
    geometry: &Geometry,
    plane: &ImagePlane,
    spacing: [f64; 3],
    background: [f64; 3],
) -> Vec<[f64; 3]> {
    let to_base = plane.to_base_plane(geometry, spacing);
    let origin = DVec2::new(geometry.shear_u() as f64, geometry.shear_v() as f64);
    let mut picture = Vec::with_capacity(plane.width * plane.height);
    for row in 0..plane.height {
        for column in 0..plane.width {
            let at = to_base.transform_point2(DVec2::new(column as f64, row as f64)) + origin;
            picture.push(over(bilinear(pixel, at), background));
        }
    }
    picture
}

/// Warps the base planes of a picture's passes, each with its geometry: [`warp`] for a parallel view; for an eye each pixel is taken
/// from the pass of its ray's major axis, where the ray crosses its grid plane. Where near frames join, whose samples begin at the eye
/// and not at a common face, both show the rays of a narrow strip, and one gives way to the other: see `share`.
pub fn warp_passes(
    passes: &[(&BasePlane, &Geometry)],
    plane: &ImagePlane,
    spacing: [f64; 3],
    background: [f64; 3],
) -> Vec<[f64; 3]> {
    if let (None, [(base, geometry)]) = (plane.eye, passes) {
        return warp(base, geometry, plane, spacing, background);
    }
    let mut picture = Vec::with_capacity(plane.width * plane.height);
    for row in 0..plane.height {
        for column in 0..plane.width {
            let (_, direction) = plane.ray(column as f64, row as f64);
            let direction = [0, 1, 2].map(|i| direction[i] / spacing[i]);
            let through = plane.crossing(column as f64, row as f64);
            let through = [0, 1, 2].map(|i| through[i] / spacing[i]);
            let seen = |(base, geometry): &(&BasePlane, &Geometry)| {
                bilinear(&|column, row| base.real(column, row), on_grid(geometry, through, direction))
            };
            let (axis, reversed) = major(direction);
            let of = |axis: usize, reversed: bool| {
                passes
                    .iter()
                    .find(|(_, geometry)| (geometry.axes.axis[2], geometry.axes.reversed[2]) == (axis, reversed))
            };
            let Some(main) = of(axis, reversed) else {
                picture.push(over([0.0; 4], background));
                continue;
            };
            let (mut sum, mut whole) = (seen(main), 1.0);
            for other in (0..3).filter(|&other| other != axis) {
                let slope = (direction[other] / direction[axis]).abs();
                let Some(beside) = of(other, direction[other] < 0.0) else {
                    continue;
                };
                let share = share(slope, main.1, beside.1);
                if share > 0.0 {
                    let pixel = seen(beside);
                    sum = [0, 1, 2, 3].map(|i| sum[i] + share * pixel[i]);
                    whole += share;
                }
            }
            picture.push(over(sum.map(|x| x / whole), background));
        }
    }
    picture
}

/// What the pass beside weighs against 1 of a ray's own pass, for a ray whose part along the other major axis is `slope` of that along its
/// own: 1 at the joint, down to 0 at the last slope that both have.
fn share(slope: f64, own: &Geometry, beside: &Geometry) -> f64 {
    let farthest = |geometry: &Geometry| geometry.perspective.as_ref().map_or(1.0, Perspective::farthest_slope);
    let width = 1.0 - 1.0 / farthest(own).min(farthest(beside));
    if width > 0.0 { (1.0 - (1.0 - slope) / width).max(0.0) } else { 0.0 }
}

/// Where a ray (a point and a direction in voxels) crosses the grid plane of a pass, in pixels of its base plane.
fn on_grid(geometry: &Geometry, through: [f64; 3], direction: [f64; 3]) -> DVec2 {
    let grid_plane = geometry.perspective.as_ref().map_or(0, |pass| pass.grid_plane);
    let grid_plane = grid_plane as f64 / f64::from(1_u32 << SLOPE_FRACTION_BITS);
    let at = geometry.axes.canonical_position(geometry.size, through);
    let along = geometry.axes.to_canonical(direction.into());
    let steps = (grid_plane - at[2]) / along[2];
    let first = geometry.first_ray();
    DVec2::new(at[0] + along[0] * steps - first.u as f64, at[1] + along[1] * steps - first.v as f64)
}

fn bilinear(pixel: &dyn Fn(i64, i64) -> [f64; 4], at: DVec2) -> [f64; 4] {
    let corner = at.floor();
    let part = at - corner;
    let (column, row) = (corner.x as i64, corner.y as i64);
    let mut sum = [0.0; 4];
    let weights = [
        (0, 0, (1.0 - part.x) * (1.0 - part.y)),
        (1, 0, part.x * (1.0 - part.y)),
        (0, 1, (1.0 - part.x) * part.y),
        (1, 1, part.x * part.y),
    ];
    for (right, below, weight) in weights {
        let corner = pixel(column + right, row + below);
        for i in 0..4 {
            sum[i] += weight * corner[i];
        }
    }
    sum
}
