//! Where sample k of every ray lies in its cell: the one thing in which true and sheared interpolation differ.

use crate::rays::Line;
use cube3_frame::{DiscreteRay, Fan, Geometry, PerspectivePass};
use cube3_machine::TemplateRule;

/// Which eight voxels a sample of a discrete ray is interpolated from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SampleCell {
    /// The exact 8-neighbourhood of the sample's position: True3D.
    Exact,
    /// The sheared cell, four voxels of plane k and four of plane k+1 on the same discrete rays: Sheared3D.
    Sheared,
}

/// The cell of sample k, relative to its ray: the same for all rays of a parallel view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// The two planes of voxels; the same where the offset is 0.
    pub planes: [usize; 2],
    /// Column of the cell's corner in each plane, from the ray's u.
    pub columns: [usize; 2],
    /// Row of the cell's corner in each plane, from the ray's v.
    pub rows: [usize; 2],
    /// Weights along u, v, w.
    pub weights: [f64; 3],
}

/// A cell along one axis, u or v.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Side {
    /// The voxels of the near edge and of the far one, each in both planes.
    pub edges: [[usize; 2]; 2],
    /// The weight of the far edge.
    pub weight: f64,
}

/// The cells of a frame's samples.
pub(crate) struct Cells {
    interpolation: SampleCell,
    /// Of every sample of a parallel frame's rays.
    pub steps: Vec<Step>,
    /// Of a pass along u, the rays of a depth together.
    along_u: Vec<Side>,
}

impl Cells {
    /// Those of a geometry.
    pub fn new(geometry: &Geometry, interpolation: SampleCell) -> Cells {
        let Some(pass) = &geometry.perspective else {
            return Cells { interpolation, steps: steps(geometry, interpolation), along_u: Vec::new() };
        };
        let mut along_u = vec![Side::default(); pass.u.count() * geometry.size[2]];
        for (k, row) in along_u.chunks_mut(pass.u.count()).enumerate() {
            for i in pass.u.valid(k) {
                row[i] = fan_side(geometry, pass, 0, i, k, interpolation);
            }
        }
        Cells { interpolation, steps: Vec::new(), along_u }
    }

    /// Along u, of the rays of a pass that have sample `k`.
    pub fn along_u(&self, pass: &PerspectivePass, k: usize) -> &[Side] {
        &self.along_u[k * pass.u.count()..][pass.u.valid(k)]
    }

    /// Along v, of the rays `v` of a pass, which have sample `k`.
    pub fn along_v(&self, geometry: &Geometry, pass: &PerspectivePass, v: i64, k: usize) -> Side {
        fan_side(geometry, pass, 1, (v - pass.v.first) as usize, k, self.interpolation)
    }

    /// Along u and v, of a ray that has sample `k`.
    pub fn sides(&self, geometry: &Geometry, ray: DiscreteRay, k: usize) -> [Side; 2] {
        let Some(pass) = &geometry.perspective else {
            return self.steps[k].sides(ray, geometry.size);
        };
        let along_u = self.along_u[k * pass.u.count() + (ray.u - pass.u.first) as usize];
        [along_u, self.along_v(geometry, pass, ray.v, k)]
    }
}

/// The step of every sample of a parallel frame, in reals: exactly the registers' slopes and offset, no rounding of weights.
///
/// Of a label volume a sample is its nearest voxel, in either cell, and all weights are 0. In the sheared cell `w_u = p_u − lerp(X(k), X(k+1), o)` (design, section 3). The last sample has no far plane; it is
/// given the near one again and, with an offset above 0, is in no ray's valid set.
fn steps(geometry: &Geometry, interpolation: SampleCell) -> Vec<Step> {
    let offset = geometry.real_offset();
    let slopes = geometry.real_slopes();
    let templates = [&geometry.u, &geometry.v];
    let step = |k: usize| {
        let planes = planes(geometry, k);
        let axis = |i: usize| {
            let moved = (k as f64 + offset) * slopes[i];
            match (geometry.rule, interpolation) {
                (TemplateRule::Nearest, _) => ([(moved + 0.5).floor() as usize; 2], 0.0),
                (_, SampleCell::Exact) => {
                    let column = moved.floor();
                    ([column as usize; 2], moved - column)
                }
                (_, SampleCell::Sheared) => {
                    let columns = planes.map(|k| templates[i].columns[k]);
                    let left = f64::from(columns[0]) + offset * f64::from(columns[1] - columns[0]);
                    (columns.map(|column| column as usize), moved - left)
                }
            }
        };
        let ((columns, along_u), (rows, along_v)) = (axis(0), axis(1));
        Step { planes, columns, rows, weights: [along_u, along_v, offset] }
    };
    (0..geometry.size[2]).map(step).collect()
}

/// The two planes of voxels that sample k is between.
pub(crate) fn planes(geometry: &Geometry, k: usize) -> [usize; 2] {
    [k, if geometry.offset == 0 { k } else { (k + 1).min(geometry.size[2] - 1) }]
}

impl Step {
    /// The cell of a ray along u and v, in a volume of `size` voxels; a voxel beyond the last has no weight, and is the last.
    fn sides(&self, ray: DiscreteRay, size: [usize; 3]) -> [Side; 2] {
        let side = |first: i64, corners: [usize; 2], n: usize, weight: f64| {
            let edge = |beyond: usize| corners.map(|corner| ((first + corner as i64) as usize + beyond).min(n - 1));
            Side { edges: [edge(0), edge(1)], weight }
        };
        [side(ray.u, self.columns, size[0], self.weights[0]), side(ray.v, self.rows, size[1], self.weights[1])]
    }
}

/// Along u (0) or v (1) of a pass: the cell of sample k of the ray with index `i`, which has that sample.
///
/// The sheared cell lies between the columns L of the ray and R on its right, which are the geometry's; with p the sample's place,
///
/// ```text
///   w = (p − l) / (r − l),      l = lerp(L(k), L(k+1), o),   r = lerp(R(k), R(k+1), o)
/// ```
///
/// A far edge that is not all in the volume has no weight in words, and is the near one.
fn fan_side(
    geometry: &Geometry,
    pass: &PerspectivePass,
    axis: usize,
    i: usize,
    k: usize,
    interpolation: SampleCell,
) -> Side {
    let (n, offset) = (geometry.size[axis], geometry.real_offset());
    let fan = [&pass.u, &pass.v][axis];
    let mut ray = geometry.first_ray();
    *[&mut ray.u, &mut ray.v][axis] += i as i64;
    let place = Line::new(geometry, ray).at(k as f64 + offset)[axis];
    let held = |x: f64| (x as usize).min(n - 1);
    match (geometry.rule, interpolation) {
        (TemplateRule::Nearest, _) => Side { edges: [[held((place + 0.5).floor()); 2]; 2], weight: 0.0 },
        (_, SampleCell::Exact) => {
            let column = held(place.floor());
            Side { edges: [[column; 2], [(column + 1).min(n - 1); 2]], weight: place - column as f64 }
        }
        (_, SampleCell::Sheared) => {
            let planes = planes(geometry, k);
            let columns = [Fan::near, Fan::right].map(|of| planes.map(|k| of(fan, i, k)));
            let [left, right] = columns.map(|[near, far]| f64::from(near) + offset * f64::from(far - near));
            let voxel = |column: i32| usize::try_from(column).ok().filter(|&column| column < n);
            let edge = |[near, far]: [i32; 2]| Some([voxel(near)?, voxel(far)?]);
            let near = edge(columns[0]).unwrap_or([0; 2]);
            Side { edges: [near, edge(columns[1]).unwrap_or(near)], weight: (place - left) / (right - left) }
        }
    }
}
