//! Where the rays of a frame are, in reals: the one thing that the machine's geometry decides.

use cube3_frame::{DiscreteRay, Geometry, PerspectivePass, SLOPE_FRACTION_BITS};
use cube3_scene::{Scene, ViewFrame, eye};
use cube3_volume::Volume;
use glam::DVec3;

/// A ray in canonical voxels: where it crosses w = 0, and how far it moves along u and v from a plane to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    origin: [f64; 2],
    /// Of a parallel frame du and dv.
    pub slopes: [f64; 2],
}

/// Exactly what the registers hold, fractions of [`SLOPE_FRACTION_BITS`].
fn real(register: i64) -> f64 {
    register as f64 / f64::from(1_u32 << SLOPE_FRACTION_BITS)
}

impl Line {
    /// That of ray (0, 0) of a parallel frame.
    pub fn parallel(geometry: &Geometry) -> Line {
        Line { origin: [0.0; 2], slopes: geometry.real_slopes() }
    }

    /// The line of a ray of the frame.
    pub fn new(geometry: &Geometry, ray: DiscreteRay) -> Line {
        let Some(pass) = &geometry.perspective else {
            return Line { origin: [ray.u as f64, ray.v as f64], ..Line::parallel(geometry) };
        };
        let rays = [(&pass.u, ray.u), (&pass.v, ray.v)].map(|(fan, ray)| {
            let i = (ray - fan.first) as usize;
            (fan.starts[i] - pass.first_depth as i64 * fan.slopes[i], fan.slopes[i])
        });
        Line { origin: rays.map(|(origin, _)| real(origin)), slopes: rays.map(|(_, slope)| real(slope)) }
    }

    /// The place at a depth, canonical, in voxels.
    pub fn at(&self, depth: f64) -> [f64; 3] {
        let [u, v] = [0, 1].map(|i| self.origin[i] + depth * self.slopes[i]);
        [u, v, depth]
    }

    /// From a sample of the ray to the next, along u, v, w, in the unit of the `spacing` (x, y, z): a voxel along w, and the slopes of one
    /// along u and v. Pfister et al. 1995, section 2.
    pub fn step(&self, geometry: &Geometry, spacing: [f64; 3]) -> DVec3 {
        let [du, dv] = self.slopes;
        DVec3::new(du, dv, 1.0) * DVec3::from(geometry.axes.permute(spacing))
    }
}

/// The samples beside a sample that its gradient reads, along u and along v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Beside {
    /// How many rays away they are.
    pub rays: i64,
    /// How far away they are, in voxels.
    pub voxels: f64,
}

/// How far a pass's rays are from each other, in voxels, `depth` planes behind its first one.
pub(crate) fn apart(pass: &PerspectivePass, depth: f64) -> f64 {
    let [first, step] = pass.spacing.map(real);
    first + depth * step
}

/// How much steeper than 45° the last rays of a pass are that pictures show where another base plane joins: so many rays, each of which is
/// steeper than the one before by what their distance grows by from plane to plane.
pub(crate) fn steeper(pass: &PerspectivePass) -> f64 {
    f64::from(pass.overlap) * real(pass.spacing[1])
}

impl Beside {
    /// Of samples at plane `k` of a pass, which may be before its first or behind its last.
    pub fn of(pass: &PerspectivePass, geometry: &Geometry, k: i64) -> Beside {
        let apart = apart(pass, (k - pass.first_depth as i64) as f64 + geometry.real_offset());
        let rays = pass.reach_at(k, geometry.offset, geometry.weight_bits);
        Beside { rays: i64::from(rays), voxels: f64::from(rays) * apart }
    }
}

/// The depth at which the rays of a perspective view begin, that of its eye; none in a parallel one.
pub(crate) fn eye_depth(scene: &Scene, view: &ViewFrame, volume: &Volume, geometry: &Geometry) -> Option<f64> {
    let eye = eye(&scene.view, view, &scene.image, volume.dims, volume.spacing)? / DVec3::from(volume.spacing);
    let [_, _, depth] = geometry.axes.canonical_position(geometry.size, eye.to_array());
    Some(depth)
}
