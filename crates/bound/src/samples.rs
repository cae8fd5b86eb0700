//! The samples of a frame and their gradients.

use crate::grains::Grains;
use crate::interval::Interval;
use cube3_frame::{DiscreteRay, Geometry};
use cube3_machine::{Differences, GradientMethod};
use cube3_twin::Basis;

/// A frame's samples, all at once.
pub struct Samples<'a> {
    geometry: &'a Geometry,
    grains: &'a Grains,
    depths: usize,
    values: Vec<Option<Interval>>,
}

/// Around a sample, by rays along u and v and steps along the ray.
type Around<'a> = &'a dyn Fn([i64; 3]) -> Interval;

/// What a gradient's components are weighed with.
struct Local {
    /// Rays to a neighbour.
    apart: i64,
    /// Whether neighbours are less than a voxel away, and the difference along the ray is relative to theirs.
    near: bool,
    /// Voxels to a neighbour.
    distance: f64,
    /// Shear at the sample's own slice, the one behind and the one before.
    shears: [[Interval; 2]; 3],
    /// Whether the ray runs against u and against v.
    mirrored: [bool; 2],
}

impl<'a> Samples<'a> {
    /// Those of voxels with data `values`, x fastest.
    pub fn new(geometry: &'a Geometry, grains: &'a Grains, values: &[f64]) -> Samples<'a> {
        let depths = geometry.size[2];
        let [width, height] = geometry.base_plane_size();
        let mut samples = Samples { geometry, grains, depths, values: vec![None; width * height * depths] };
        for ray in samples.rays() {
            for k in 0..depths {
                if geometry.has_sample(ray, k as i64) {
                    let place = samples.index(ray) * depths + k;
                    samples.values[place] = Some(samples.cell(ray, k, values));
                }
            }
        }
        samples
    }

    /// Every ray, in the order of the base plane's pixels.
    pub fn rays(&self) -> impl Iterator<Item = DiscreteRay> + use<> {
        let (first, [width, height]) = (self.geometry.first_ray(), self.geometry.base_plane_size());
        (0..height as i64).flat_map(move |row| {
            (0..width as i64).map(move |column| DiscreteRay { u: first.u + column, v: first.v + row })
        })
    }

    fn index(&self, ray: DiscreteRay) -> usize {
        let [column, row] = self.geometry.pixel(ray);
        row * self.geometry.base_plane_size()[0] + column
    }

    /// Sample k of a ray, where the machine takes one.
    pub fn sample(&self, ray: DiscreteRay, k: i64) -> Option<Interval> {
        if !self.geometry.has_sample(ray, k) {
            return None;
        }
        self.values[self.index(ray) * self.depths + k as usize]
    }

    /// In the sheared cell: four lerps along w, two along u, one along v. A voxel that is not there has no weight.
    fn cell(&self, ray: DiscreteRay, k: usize, values: &[f64]) -> Interval {
        let geometry = self.geometry;
        let [nx, ny, _] = geometry.dims();
        let corner = |w: usize, v: usize, u: usize| {
            let [x, y, z] = geometry.axes.voxel(geometry.size, geometry.corner(ray, k, [w, v, u])?);
            Some(Interval::point(values[x + nx * (y + ny * z)]))
        };
        let offset = Interval::point(geometry.real_offset());
        let [along_u, along_v] = self.weights(ray, k);
        let edge = |v: usize, u: usize| {
            let near = corner(0, v, u)?;
            Some(self.lerp(near, corner(1, v, u).unwrap_or(near), offset))
        };
        let side = |v: usize| {
            let near = edge(v, 0)?;
            Some(self.lerp(near, edge(v, 1).unwrap_or(near), along_u))
        };
        let near = side(0).unwrap_or(Interval::point(0.0));
        self.lerp(near, side(1).unwrap_or(near), along_v)
    }

    /// Weights along u and v: where the sample is between the edges of its cell.
    fn weights(&self, ray: DiscreteRay, k: usize) -> [Interval; 2] {
        let geometry = self.geometry;
        let offset = geometry.real_offset();
        let far = if geometry.offset == 0 { k } else { (k + 1).min(self.depths - 1) };
        let between = |near: f64, far: f64| near + offset * (far - near);
        let position = geometry.sample_position(ray, k);
        [0, 1].map(|axis| {
            let edges = match &geometry.perspective {
                None => {
                    let columns = &[&geometry.u, &geometry.v][axis].columns;
                    let start = [ray.u, ray.v][axis] as f64;
                    let left = start + between(f64::from(columns[k]), f64::from(columns[far]));
                    [left, left + 1.0]
                }
                Some(pass) => {
                    let (fan, ray) = [(&pass.u, ray.u), (&pass.v, ray.v)][axis];
                    let i = (ray - fan.first) as usize;
                    let of = |edge: fn(&cube3_frame::Fan, usize, usize) -> i32| {
                        between(f64::from(edge(fan, i, k)), f64::from(edge(fan, i, far)))
                    };
                    [of(cube3_frame::Fan::near), of(cube3_frame::Fan::right)]
                }
            };
            let weight = (position[axis] - edges[0]) / (edges[1] - edges[0]);
            Interval::around(weight, self.grains.weight).held(0.0, 1.0)
        })
    }

    /// A lerp of words: none is beyond its operands, and equal ones and the ends of the weight are exact.
    fn lerp(&self, near: Interval, far: Interval, weight: Interval) -> Interval {
        let exact = weight.is_point() && (weight.low == 0.0 || weight.low == 1.0) || near.is_point() && near == far;
        let lerped = Interval::between(near, far, weight);
        let all = near.or(far);
        if exact { lerped } else { lerped.wider(self.grains.sample).held(all.low, all.high) }
    }

    /// The gradient at sample k of a ray, in the components of the method's frame, as differences of two samples a pair of the shortest
    /// length apart: `value` is such a difference as data for each smallest voxel spacing.
    pub fn gradient(
        &self,
        ray: DiscreteRay,
        k: usize,
        method: GradientMethod,
        basis: &Basis,
        border: f64,
    ) -> [Interval; 3] {
        let local = self.local(ray, k);
        let first = self.geometry.perspective.as_ref().map_or(0, |pass| pass.first_depth);
        let here = |by: [i64; 3]| {
            // No ray goes on before its eye.
            if by[2] < 0 && first > 0 && k == first {
                return self.sample(ray, k as i64);
            }
            let beside = DiscreteRay { u: ray.u + by[0] * local.apart, v: ray.v + by[1] * local.apart };
            self.sample(beside, k as i64 + by[2])
        };
        let turn = |by: i64, mirrored: bool| if mirrored { -by } else { by };
        let around = |[i, j, l]: [i64; 3]| {
            here([turn(i, local.mirrored[0]), turn(j, local.mirrored[1]), l]).unwrap_or(Interval::point(border))
        };
        let differences = self.differences(method, &around, &local, basis.feet);
        let shortest = basis.lengths.into_iter().fold(f64::INFINITY, f64::min);
        let apart = local.distance.max(1.0);
        let limit = self.grains.largest_component;
        [0, 1, 2].map(|i| {
            let length = if method.row().normalised { basis.lengths[i] } else { shortest };
            let factor = shortest / length / if i < 2 { apart } else { 1.0 };
            let factor =
                if factor == 1.0 { Interval::point(1.0) } else { Interval::around(factor, self.grains.factor) };
            let component = (differences[i] * factor).wider(self.grains.component);
            let component = component.or(component.held(-limit, limit));
            if local.mirrored.get(i) == Some(&true) { -component } else { component }
        })
    }

    fn local(&self, ray: DiscreteRay, k: usize) -> Local {
        let geometry = self.geometry;
        let Some(pass) = &geometry.perspective else {
            let shear = geometry.real_slopes().map(|slope| Interval::around(slope, self.grains.weight).held(0.0, 1.0));
            return Local { apart: 1, near: false, distance: 1.0, shears: [shear; 3], mirrored: [false; 2] };
        };
        let apart = |k: usize| pass.neighbour_spacing(k as i64, geometry.offset, geometry.weight_bits);
        let [row, column] = geometry.slot_of(ray);
        let one = f64::from(1_u32 << cube3_frame::SLOPE_FRACTION_BITS);
        let slopes = [pass.u.slopes[column], pass.v.slopes[row]].map(|slope| slope.unsigned_abs() as f64 / one);
        let shear = |k: usize| {
            slopes.map(|slope| Interval::around(slope.min(2.0) / apart(k).max(1.0), self.grains.shear).held(0.0, 1.0))
        };
        let reach = pass.reach_at(k as i64, geometry.offset, geometry.weight_bits);
        Local {
            apart: if pass.doubled { i64::from(reach) } else { 1 },
            near: pass.doubled && apart(k) < 1.0,
            distance: apart(k),
            shears: [shear(k), shear((k + 1).min(self.depths - 1)), shear(k.saturating_sub(1))],
            mirrored: geometry.mirrored(ray),
        }
    }

    fn differences(&self, method: GradientMethod, around: Around<'_>, local: &Local, feet: [f64; 2]) -> [Interval; 3] {
        let [here, behind, before] = local.shears;
        let straight = |axis: usize| {
            let mut ahead = [0; 3];
            ahead[axis] = 1;
            around(ahead) - around(ahead.map(|by: i64| -by))
        };
        let row = method.row();
        let differences = match row.differences {
            Differences::Central => [0, 1, 2].map(straight),
            Differences::Weighted => [0, 1, 2].map(|axis| weighted(axis, around)),
            Differences::Feet => {
                let feet = feet.map(|foot| Interval::around(foot, self.grains.weight).held(0.0, 1.0));
                let foot = |[u, v]: [i64; 2], foot: Interval| {
                    let towards_eye = -(u + v);
                    self.lerp(around([u, v, 0]), around([u, v, towards_eye]), foot)
                };
                let along_u = foot([1, 0], feet[0]) - foot([-1, 0], feet[0]);
                [along_u, foot([0, 1], feet[1]) - foot([0, -1], feet[1]), straight(2)]
            }
            Differences::Bilinear => {
                let on = |l: i64, [along_u, along_v]: [Interval; 2]| {
                    let near = self.lerp(around([0, 0, l]), around([-l, 0, l]), along_u);
                    let far = self.lerp(around([0, -l, l]), around([-l, -l, l]), along_u);
                    self.lerp(near, far, along_v)
                };
                [straight(0), straight(1), on(1, behind) - on(-1, before)]
            }
        };
        let [along_u, along_v, ray] = differences;
        let ray = if local.near {
            (ray * Interval::around(local.distance, self.grains.factor)).wider(self.grains.sheared)
        } else {
            ray
        };
        let sheared = along_u * here[0] + along_v * here[1];
        [along_u, along_v, if row.sheared { (ray - sheared).wider(self.grains.sheared) } else { ray }]
    }
}

/// Nine differences along an axis, weights 1, ½, ¼, which add to 4.
fn weighted(axis: usize, around: Around<'_>) -> Interval {
    let mut sum = Interval::point(0.0);
    for (a, first) in [(-1, 0.25), (0, 0.5), (1, 0.25)] {
        for (b, second) in [(-1, 0.25), (0, 0.5), (1, 0.25)] {
            let mut at = [0; 3];
            (at[(axis + 1) % 3], at[(axis + 2) % 3], at[axis]) = (a, b, 1);
            let front = around(at);
            at[axis] = -1;
            sum = sum + (front - around(at)) * (first * second);
        }
    }
    sum
}
