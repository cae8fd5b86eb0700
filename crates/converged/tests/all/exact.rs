//! Rays, sums and integrals as one works them out by hand, to hold pictures to: nothing here is taken from what is tested.

use cube3_converged::{ConvergedOptions, ConvergedRendering, converged};
use cube3_scene::{ColourPoint, Image, ImagePlane, Material, Perspective, Scene, Transfer, View};
use cube3_volume::{Samples, Volume};
use glam::DVec3;

/// Tolerances at which every closed form is tried; at the last rounding may be more than what is asked for.
pub const TOLERANCES: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// What a closed form's own sums are rounded by.
pub const ROUNDED: f64 = 8.0 * f64::EPSILON;

/// A ray in a box.
#[derive(Clone, Copy, Debug)]
pub struct Chord {
    /// Where it enters, in voxels.
    pub from: DVec3,
    /// Voxels for a unit length, which is the smallest spacing.
    pub along: DVec3,
    /// Unit lengths in the box.
    pub length: f64,
    /// The direction in the world.
    pub world: DVec3,
    /// What its ends are rounded by.
    pub slack: f64,
}

impl Chord {
    /// The ray of a pixel between two corners of a box, in voxels; none where it misses.
    pub fn new(volume: &Volume, scene: &Scene, [column, row]: [usize; 2], [low, high]: [DVec3; 2]) -> Option<Chord> {
        let (column, row) = (column as f64, row as f64);
        let plane = ImagePlane::new(scene, &scene.view.frame().unwrap(), volume.dims, volume.spacing);
        let spacing = DVec3::from(volume.spacing);
        let unit = spacing.min_element();
        let ray = plane.ray(column, row).1;
        let world = ray.normalize();
        let (origin, along) = (plane.crossing(column, row) / spacing, world / spacing * unit);
        let eye = if plane.eye.is_some() { -plane.depth * ray.length() / unit } else { f64::NEG_INFINITY };
        let (mut enter, mut leave) = (eye, f64::INFINITY);
        for axis in 0..3 {
            if along[axis] == 0.0 {
                if origin[axis] < low[axis] || origin[axis] > high[axis] {
                    return None;
                }
                continue;
            }
            let ends = [low, high].map(|end| (end[axis] - origin[axis]) / along[axis]);
            enter = enter.max(ends[0].min(ends[1]));
            leave = leave.min(ends[0].max(ends[1]));
        }
        let slack = ROUNDED * (enter.abs() + leave.abs());
        let from = origin + along * enter;
        (leave > enter).then_some(Chord { from, along, length: leave - enter, world, slack })
    }

    /// The ray of a pixel in all of a volume.
    pub fn whole(volume: &Volume, scene: &Scene, pixel: [usize; 2]) -> Option<Chord> {
        Chord::new(volume, scene, pixel, [DVec3::ZERO, last(volume)])
    }

    /// Where it is after a length, in voxels.
    pub fn at(&self, t: f64) -> DVec3 {
        self.from + self.along * t
    }
}

/// The last voxel.
pub fn last(volume: &Volume) -> DVec3 {
    DVec3::from(volume.dims.map(|n| (n - 1) as f64))
}

/// A closed form of a pixel and what it is rounded by.
pub type Form = ([f64; 3], f64);

/// What rounding may leave of a bound, where nothing is steep.
pub const LEAST: f64 = 1e-9;

/// At each tolerance no pixel is farther from its closed form than its bound says, and the bound is what was asked for.
pub fn hold(name: &str, volume: &Volume, scene: &Scene, form: impl Fn([usize; 2]) -> Form) {
    hold_to(LEAST, name, volume, scene, form);
}

/// The same where rounding leaves at most a `least` bound.
pub fn hold_to(least: f64, name: &str, volume: &Volume, scene: &Scene, form: impl Fn([usize; 2]) -> Form) {
    for tolerance in TOLERANCES {
        let made = made(volume, scene, tolerance);
        for (i, (pixel, bound)) in made.picture.pixels.iter().zip(&made.bounds).enumerate() {
            let place = [i % made.picture.width, i / made.picture.width];
            let (exact, rounded) = form(place);
            let error = (0..3).map(|k| (pixel[k] - exact[k]).abs()).fold(0.0, f64::max);
            let where_ = format!("{name}, {place:?} at {tolerance:e}, seen as {:?}", scene.view);
            assert!(
                error <= bound + rounded,
                "{where_}: {error:e} is above {bound:e} and {rounded:e}; {pixel:?}, not {exact:?}"
            );
            assert!(*bound <= tolerance.max(least) || tolerance < LEAST, "{where_}: the bound is {bound:e}");
        }
    }
}

/// The picture of a scene, with a border of 0.
pub fn made(volume: &Volume, scene: &Scene, tolerance: f64) -> ConvergedRendering {
    converged(volume, scene, &ConvergedOptions { tolerance, border: 0.0, every: 1 }, None).unwrap()
}

/// Along two axes, oblique in two ways, in perspective from before the volume and from inside of it.
pub fn views() -> Vec<View> {
    let parallel = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.3, 1.0, -0.4], [-1.0, -0.7, 0.2]];
    let near = |(field_of_view_deg, distance, direction)| {
        let perspective = Perspective { field_of_view_deg, eye_voxel: None, distance_voxel: Some(distance) };
        View { perspective: Some(perspective), ..View::from_direction(direction, None) }
    };
    let parallel = parallel.into_iter().map(|direction| View::from_direction(direction, None));
    parallel.chain([(30.0, 12.0, [1.0, 0.4, 0.3]), (70.0, 1.5, [0.2, 0.6, 1.0])].map(near)).collect()
}

/// A scene without light.
pub fn unlit(view: &View, opacity: Vec<[f64; 2]>, colour: &[(f64, [f64; 3])]) -> Scene {
    let colour = colour.iter().map(|&(value, rgb)| ColourPoint { value, rgb }).collect();
    Scene {
        background: [0.2, 0.9, 1.0],
        view: view.clone(),
        image: Image { width_px: 4, height_px: 3, pixel_size_voxel: view.perspective.is_none().then_some(0.93) },
        transfer: Transfer { colour, opacity, ..Transfer::default() },
        material: Material { shaded: false, ..Material::default() },
        lights: Vec::new(),
        ..Scene::default()
    }
}

/// A volume of a function of the place in voxels.
pub fn volume(dims: [usize; 3], spacing: [f64; 3], f: impl Fn(DVec3) -> f64) -> Volume {
    let place = |i: usize| [i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]].map(|x| x as f64);
    let samples = (0..dims.iter().product()).map(|i| f(DVec3::from(place(i)))).collect();
    Volume::new(dims, spacing, Samples::F64(samples)).unwrap()
}

/// What lies over the background: light, and what is left of that behind.
pub fn over(colour: [f64; 3], left: f64, background: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| colour[i] + left * background[i])
}

/// A layer of fog: its length, its opacity of a unit length, its colour.
pub type Layer = (f64, f64, [f64; 3]);

/// Light and what is left behind layers of fog, the front one first: (1 − α)^length, layer by layer.
pub fn layered(layers: impl IntoIterator<Item = Layer>) -> ([f64; 3], f64) {
    layers.into_iter().fold(([0.0; 3], 1.0), |(colour, left), (length, alpha, rgb)| {
        let depth = if length > 0.0 { length * -(-alpha).ln_1p() } else { 0.0 };
        let hidden = left * -(-depth).exp_m1();
        ([0, 1, 2].map(|i| colour[i] + hidden * rgb[i]), left * (-depth).exp())
    })
}

/// Gauss's five nodes and weights, which integrate polynomials of the ninth degree exactly.
fn nodes() -> [[f64; 2]; 5] {
    let (inner, outer) = (2.0 * (10.0_f64 / 7.0).sqrt(), 13.0 * 70.0_f64.sqrt());
    let (near, far) = ((5.0 - inner).sqrt() / 3.0, (5.0 + inner).sqrt() / 3.0);
    let (much, little) = ((322.0 + outer) / 900.0, (322.0 - outer) / 900.0);
    [[-far, little], [-near, much], [0.0, 128.0 / 225.0], [near, much], [far, little]]
}

/// The integral of a smooth function, by five nodes in each of many panels.
pub fn integral<const N: usize>(f: impl Fn(f64) -> [f64; N], [from, to]: [f64; 2], panels: usize) -> [f64; N] {
    let half = (to - from) / panels as f64 / 2.0;
    let mut sum = [0.0; N];
    for panel in 0..panels {
        let middle = from + (2 * panel + 1) as f64 * half;
        for [x, weight] in nodes() {
            let value = f(middle + half * x);
            for i in 0..N {
                sum[i] += half * weight * value[i];
            }
        }
    }
    sum
}

/// Light and what is left along a ray on which opacity and colour are smooth: panels of five nodes, and between the nodes of a panel again
/// five for τ.
pub fn seen(alpha: impl Fn(f64) -> f64, rgb: impl Fn(f64) -> [f64; 3], length: f64, panels: usize) -> ([f64; 3], f64) {
    let extinction = |t: f64| -(-alpha(t)).ln_1p();
    let depth = |from: f64, to: f64| integral(|t| [extinction(t)], [from, to], 1)[0];
    let (mut colour, mut before) = ([0.0; 3], 0.0);
    let width = length / panels as f64;
    for panel in 0..panels {
        let from = panel as f64 * width;
        let light = |t: f64| rgb(t).map(|c| c * extinction(t) * (-(before + depth(from, t))).exp());
        let added = integral(light, [from, from + width], 1);
        colour = [0, 1, 2].map(|i| colour[i] + added[i]);
        before += depth(from, from + width);
    }
    (colour, (-before).exp())
}
