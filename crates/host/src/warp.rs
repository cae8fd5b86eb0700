//! The warp of base planes to the picture.

use crate::picture::major;
use cube3_frame::{BasePlane, Geometry, PerspectivePass, SLOPE_FRACTION_BITS};
use cube3_scene::{ImagePlane, over};
use glam::{DAffine2, DMat2, DVec2, DVec3};

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

/// The affine map from pixel (column, row) to the base plane's ray coordinates (u, v), of a parallel view.
fn to_base_plane(plane: &ImagePlane, geometry: &Geometry, spacing: [f64; 3]) -> DAffine2 {
    let [du, dv] = geometry.real_slopes();
    let project = |world: DVec3, affine: bool| {
        let xyz = [0, 1, 2].map(|i| world[i] / spacing[i]);
        let c = [0, 1, 2].map(|i| {
            let along = xyz[geometry.axes.axis[i]];
            match (geometry.axes.reversed[i], affine) {
                (true, true) => (geometry.size[i] - 1) as f64 - along,
                (true, false) => -along,
                (false, _) => along,
            }
        });
        DVec2::new(c[0] - c[2] * du, c[1] - c[2] * dv)
    };
    DAffine2::from_mat2_translation(
        DMat2::from_cols(project(plane.across, false), project(plane.down, false)),
        project(plane.first, true),
    )
}

/// The same for a base plane of reals, `pixel(column, row)` opacity-weighted and transparent beyond the edge.
pub fn warp_reals(
    pixel: &dyn Fn(i64, i64) -> [f64; 4],
    geometry: &Geometry,
    plane: &ImagePlane,
    spacing: [f64; 3],
    background: [f64; 3],
) -> Vec<[f64; 3]> {
    let to_base = to_base_plane(plane, geometry, spacing);
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
    let farthest = |geometry: &Geometry| geometry.perspective.as_ref().map_or(1.0, PerspectivePass::farthest_slope);
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
