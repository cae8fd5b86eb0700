//! The picture of an eye from the base planes of its passes.

use crate::BaseRendering;
use crate::rays::{Line, apart, steeper};
use cube3_frame::{DiscreteRay, Geometry};
use cube3_scene::{ImagePlane, over};
use glam::DVec3;
use rayon::prelude::*;

/// A base plane, and where its rays are.
struct Pass<'a> {
    base: &'a BaseRendering,
    geometry: &'a Geometry,
    /// The eye sees these rays run towards higher (false) or lower (true) numbers of a voxel axis.
    along: (usize, bool),
    /// The depth at which a pixel's ray is looked for among the frame's: behind the volume, where they are far apart.
    depth: f64,
    /// The place of the first ray at that depth, along u and v, and from a ray to the next.
    first: [f64; 2],
    apart: [f64; 2],
    /// How much steeper than 45° the last rays are that pictures show where another base plane joins.
    beyond: f64,
}

/// The picture of an eye over `background`, row-major from the top left: of each pass its base plane and its geometry, in voxels of `spacing`
/// (x, y, z). For a parallel view there is [`BaseRendering::warp`].
///
/// A pixel's ray belongs to the pass of the voxel axis along which it is longest, counted in voxels, z before y before x at ties. Behind the
/// volume, on the plane w = k₀ + n_w, it passes between four of the frame's rays, and the pixels of those are interpolated:
///
/// ```text
///   column = (x − x_0) / m,     x the ray's place on that plane, x_0 that of the first ray, m from ray to ray
/// ```
///
/// Where two near frames join, both have rays a little steeper than 45°, up to a slope of 1 + s for the smaller s of the two. There a ray
/// whose part along the other pass's axis is t of that along its own, 1/(1 + s) < t ≤ 1, is also looked for in that pass, with the weight
/// 1 − (1 − t)·(1 + s)/s beside its own pass's 1. Elsewhere its own pass has all.
pub fn warp_passes(
    passes: &[(&BaseRendering, &Geometry)],
    plane: &ImagePlane,
    spacing: [f64; 3],
    background: [f64; 3],
) -> Vec<[f64; 3]> {
    let passes: Vec<Pass<'_>> = passes.iter().filter_map(|(base, geometry)| Pass::new(base, geometry)).collect();
    let spacing = DVec3::from(spacing);
    let pixel = |place: usize| {
        let (column, row) = ((place % plane.width) as f64, (place / plane.width) as f64);
        let (_, direction) = plane.ray(column, row);
        let through = plane.crossing(column, row);
        over(seen(&passes, (through / spacing).to_array(), (direction / spacing).to_array()), background)
    };
    (0..plane.width * plane.height).into_par_iter().map(pixel).collect()
}

/// What a ray through a place along a direction, both in voxels, sees.
fn seen(passes: &[Pass<'_>], through: [f64; 3], direction: [f64; 3]) -> [f64; 4] {
    let longest = [2, 1, 0]
        .into_iter()
        .fold(2, |longest, axis| if direction[axis].abs() > direction[longest].abs() { axis } else { longest });
    let of = |axis: usize| passes.iter().find(|pass| pass.along == (axis, direction[axis] < 0.0));
    let Some(own) = of(longest) else {
        return [0.0; 4];
    };
    let mut sum = own.pixel(through, direction);
    let mut weights = 1.0;
    for axis in (0..3).filter(|&axis| axis != longest) {
        let Some(joining) = of(axis) else { continue };
        let beyond = own.beyond.min(joining.beyond);
        let part = direction[axis].abs() / direction[longest].abs();
        let weight = 1.0 - (1.0 - part) * (1.0 + beyond) / beyond;
        // Without rays beyond 45° the weight is that of nothing over nothing.
        if beyond > 0.0 && weight > 0.0 {
            let pixel = joining.pixel(through, direction);
            sum = [0, 1, 2, 3].map(|i| sum[i] + weight * pixel[i]);
            weights += weight;
        }
    }
    sum.map(|channel| channel / weights)
}

impl<'a> Pass<'a> {
    /// None for a geometry of parallel rays.
    fn new(base: &'a BaseRendering, geometry: &'a Geometry) -> Option<Pass<'a>> {
        let pass = geometry.perspective.as_ref()?;
        let depth = (pass.first_depth + geometry.size[2]) as f64;
        let start = geometry.first_ray();
        let [columns, rows] = geometry.base_plane_size().map(|count| count as i64);
        let place = |u: i64, v: i64| Line::new(geometry, DiscreteRay { u, v }).at(depth);
        let (first, last) = (place(start.u, start.v), place(start.u + columns - 1, start.v + rows - 1));
        let between = |axis: usize, count: i64| match count {
            1 => apart(pass, geometry.size[2] as f64),
            _ => (last[axis] - first[axis]) / (count - 1) as f64,
        };
        let axes = &geometry.axes;
        Some(Pass {
            base,
            geometry,
            along: (axes.axis[2], axes.reversed[2]),
            depth,
            first: [first[0], first[1]],
            apart: [between(0, columns), between(1, rows)],
            beyond: steeper(pass),
        })
    }

    /// The pixels around the place at which a ray passes those of the frame, each by its share.
    fn pixel(&self, through: [f64; 3], direction: [f64; 3]) -> [f64; 4] {
        let Geometry { axes, size, .. } = self.geometry;
        let at = axes.canonical_position(*size, through);
        let along = axes.to_canonical(direction.into());
        let steps = (self.depth - at[2]) / along[2];
        let [column, row] = [0, 1].map(|i| (at[i] + steps * along[i] - self.first[i]) / self.apart[i]);
        self.base.between(column, row)
    }
}
