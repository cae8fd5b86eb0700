//! Fields of many cells whose pictures are known: blobs and spheres as their grids are refined, a saddle, Phong's light, depth cues.

use crate::exact::{
    Chord, Form, LEAST, ROUNDED, hold, hold_to, integral, layered, made, over, seen, unlit, views, volume,
};
use cube3_scene::{Crop, DepthCue, Image, Layer, Light, Material, Mode, Perspective, Scene, View};
use cube3_volume::Volume;
use glam::DVec3;

const WHITE: [f64; 3] = [1.0; 3];
const COLOUR: [f64; 3] = [0.8, 0.3, 0.5];

/// A blob of e^(−r²/2σ²) in a cube of 12σ with so many cells a side, weighted sums of it along rays of a picture, and where these pass.
fn blob(cells: usize) -> Vec<[f64; 3]> {
    let sigma = cells as f64 / 12.0;
    let middle = DVec3::splat(cells as f64 / 2.0);
    let of = |at: DVec3| (-(at - middle).length_squared() / (2.0 * sigma * sigma)).exp();
    let volume = volume([cells + 1; 3], [1.0; 3], of);
    let view = View::from_direction([0.0, 1.0, 0.0], None);
    let unlit = unlit(&view, vec![[0.0, 0.0], [1.0, 1.0]], &[(0.0, WHITE)]);
    let image = Image { width_px: 5, height_px: 3, pixel_size_voxel: Some(0.73 * sigma) };
    let scene = Scene { mode: Mode::WeightedSum, background: [0.0; 3], image, ..unlit };
    let made = made(&volume, &scene, 1e-9);
    let row = |i: usize| {
        let chord = Chord::whole(&volume, &scene, [i % 5, i / 5]).unwrap();
        let beside = (chord.from - middle) * DVec3::new(1.0, 0.0, 1.0);
        let inside = libm::erf(6.0 / std::f64::consts::SQRT_2);
        let exact = sigma
            * (2.0 * std::f64::consts::PI).sqrt()
            * inside
            * (-beside.length_squared() / (2.0 * sigma * sigma)).exp();
        // A second derivative is 1/σ² at most, along each of three axes.
        let derived = cells as f64 * 3.0 / (8.0 * sigma * sigma);
        [made.picture.pixels[i][0] - exact / cells as f64, derived / cells as f64, made.bounds[i]]
    };
    (0..15).map(row).collect()
}

#[test]
fn a_blob_is_approached_at_order_two_as_its_grid_is_refined() {
    // Of odd numbers: the middle ray runs through the middles of cells, where interpolation is off by most; along it alone trapezoids would be
    // better than any order.
    let cells = [17, 33, 65];
    let grids = cells.map(blob);
    for [error, derived, bound] in grids.iter().flatten() {
        assert!(error.abs() <= derived + bound, "{error:e} is above {derived:e}");
    }
    for i in 0..2 {
        let ratio = grids[i][7][0] / grids[i + 1][7][0];
        let order = ratio.ln() / (cells[i + 1] as f64 / cells[i] as f64).ln();
        assert!((1.8..2.1).contains(&order), "{order}");
    }
}

/// The chords of a sphere of radius R in a field of R − r: relative errors of rays of a picture.
fn sphere(radius: f64) -> f64 {
    let cells = (2.4 * radius).ceil() as usize;
    let middle = DVec3::splat(cells as f64 / 2.0) + DVec3::new(0.11, 0.23, 0.31);
    let volume = volume([cells + 1; 3], [1.0; 3], |at| radius - at.distance(middle));
    let alpha: f64 = 1.0 - 0.3_f64.powf(1.0 / radius);
    let mut sum = 0.0;
    for direction in [[0.0, 1.0, 0.0], [0.3, 1.0, -0.4]] {
        let unlit = unlit(&View::from_direction(direction, None), vec![[0.0, 0.0], [0.0, alpha]], &[(0.0, WHITE)]);
        let image = Image { width_px: 12, height_px: 12, pixel_size_voxel: Some(radius / 9.0) };
        let scene = Scene { image, background: [0.0; 3], ..unlit };
        let made = made(&volume, &scene, 1e-9);
        for (i, (pixel, bound)) in made.picture.pixels.iter().zip(&made.bounds).enumerate() {
            let chord = Chord::whole(&volume, &scene, [i % 12, i / 12]).unwrap();
            let along = chord.along.normalize();
            let beside = (chord.from - middle).reject_from(along).length();
            // Near the surface a second derivative of r is at most 1/r; where |R − r| is above the error of interpolation its sign is known.
            let off = 3.0 / 8.0 / (radius - 3.0);
            let half = |r: f64| (r * r - beside * beside).max(0.0).sqrt();
            let hidden = |r: f64| -(2.0 * half(r) * (-alpha).ln_1p()).exp_m1();
            assert!(pixel[0] >= hidden(radius - off) - bound && pixel[0] <= hidden(radius + off) + bound);
            sum += (pixel[0] - hidden(radius)).abs();
        }
    }
    sum
}

#[test]
fn the_chords_of_a_sphere_are_approached_at_order_two_as_its_grid_is_refined() {
    let errors = [6.0, 12.0, 24.0].map(sphere);
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.2..5.0).contains(&ratio), "{errors:?}");
    }
}

/// A part of a volume whose gradients see no border, and the rays in it.
fn inner(volume: &Volume) -> [DVec3; 2] {
    [DVec3::ONE, DVec3::from(volume.dims.map(|n| n as f64 - 2.0))]
}

fn cropped(volume: &Volume, scene: Scene) -> Scene {
    let [low, high] = inner(volume);
    Scene { crop: Some(Crop { min_voxel: low.to_array(), max_voxel: high.to_array() }), ..scene }
}

/// Light on a normal, after the model as the book has it.
fn lit(scene: &Scene, gradient: DVec3, ray: DVec3, rgb: [f64; 3]) -> [f64; 3] {
    let material = &scene.material;
    let normal = -gradient.normalize();
    let mut sum = rgb.map(|c| material.ambient * c);
    for light in &scene.lights {
        let towards = light.direction.map_or(-ray, |direction| DVec3::from(direction).normalize());
        let halfway = (towards - ray).normalize();
        let (mut facing, mut mirroring) = (normal.dot(towards), normal.dot(halfway));
        if material.two_sided {
            (facing, mirroring) = (facing.abs(), mirroring.abs());
        }
        let highlight = if facing > 0.0 { mirroring.max(0.0).powf(material.shininess) } else { 0.0 };
        for i in 0..3 {
            sum[i] += light.colour[i] * (material.diffuse * facing.max(0.0) * rgb[i] + material.specular * highlight);
        }
    }
    sum.map(|c| c.min(1.0))
}

/// Lights at the eye, from the side, from behind, and all of them.
fn lights() -> [Vec<Light>; 4] {
    let at = |direction: Option<[f64; 3]>, colour| Light { direction, colour };
    let (eye, side) = (at(None, [1.0, 0.7, 0.2]), at(Some([-1.0, -0.4, 0.6]), [0.3, 1.0, 0.5]));
    let behind = at(Some([0.5, 1.0, 0.2]), [0.9, 0.1, 0.6]);
    [vec![eye.clone()], vec![side.clone()], vec![behind.clone()], vec![eye, side, behind]]
}

fn materials() -> Vec<Material> {
    let of = |(shininess, specular, two_sided)| Material {
        shaded: true,
        ambient: 0.2,
        diffuse: 0.6,
        specular,
        shininess,
        two_sided,
    };
    [(10.0, 0.3, true), (7.0, 0.3, false), (1.0, 0.2, true), (0.6, 0.35, false), (300.0, 0.35, true), (2.0, 0.0, false)]
        .map(of)
        .to_vec()
}

#[test]
fn a_linear_field_in_fog_has_one_colour_of_phongs() {
    for (slope, spacing) in
        [([3.0, -5.0, 1.0], [1.0; 3]), ([-1.0, 0.5, 2.0], [1.0, 2.0, 0.5]), ([0.0, 1e-100, 0.0], [1.0; 3])]
    {
        let slope = DVec3::from(slope);
        let volume = volume([6, 7, 6], spacing, |at| at.dot(slope));
        let gradient = slope / DVec3::from(spacing);
        for view in views() {
            for (lights, material) in
                lights().iter().flat_map(|lights| materials().into_iter().map(move |m| (lights, m)))
            {
                let unlit = unlit(&view, vec![[0.0, 0.3]], &[(0.0, COLOUR)]);
                let scene = cropped(&volume, Scene { lights: lights.clone(), material, ..unlit });
                hold_to(
                    least(&scene),
                    &format!("{slope}, {lights:?}, {:?}", scene.material),
                    &volume,
                    &scene,
                    |pixel| {
                        let Some(chord) = Chord::new(&volume, &scene, pixel, inner(&volume)) else {
                            return (scene.background, 0.0);
                        };
                        let colour = lit(&scene, gradient, chord.world, COLOUR);
                        let (colour, left) = layered([(chord.length, 0.3, colour)]);
                        (over(colour, left, scene.background), rounded(&scene, &chord))
                    },
                );
            }
        }
    }
}

/// What rounding leaves of a bound: a root of a cosine of 0, on the side that is not lit, may be that of its rounding.
fn least(scene: &Scene) -> f64 {
    if scene.material.shininess < 1.0 { 5e-8 } else { LEAST }
}

/// A cosine is rounded, and its power by as many times as much, or by its root.
fn rounded(scene: &Scene, chord: &Chord) -> f64 {
    let s = scene.material.shininess;
    ROUNDED * (2.0 + s) + chord.slack + if s < 1.0 { ROUNDED.powf(s) } else { 0.0 }
}

#[test]
fn between_layers_of_gradients_opacity_is_between_theirs() {
    let slope = DVec3::new(3.0, -4.0, 12.0);
    let volume = volume([6, 7, 6], [1.0; 3], |at| 50.0 + at.dot(slope));
    for view in views() {
        for (gradients, share) in
            [([5.0, 25.0], 0.4), ([13.0, 20.0], 0.0), ([1.0, 13.0], 1.0), ([20.0, 30.0], 0.0), ([1.0, 2.0], 1.0)]
        {
            let alphas = [0.15, 0.7];
            let layer = |i: usize| Layer { gradient: gradients[i], opacity: vec![[0.0, alphas[i]]] };
            let mut scene = unlit(&view, Vec::new(), &[(0.0, COLOUR)]);
            scene.transfer.layers = vec![layer(0), layer(1)];
            let scene = cropped(&volume, scene);
            hold(&format!("layers {gradients:?}"), &volume, &scene, |pixel| {
                let Some(chord) = Chord::new(&volume, &scene, pixel, inner(&volume)) else {
                    return (scene.background, 0.0);
                };
                let alpha = alphas[0] + share * (alphas[1] - alphas[0]);
                let (colour, left) = layered([(chord.length, alpha, COLOUR)]);
                (over(colour, left, scene.background), ROUNDED + chord.slack)
            });
        }
    }
}

/// x·y·z about a place beyond the volume: trilinear in all of it, its gradient too, and a cubic along every ray.
struct Saddle {
    volume: Volume,
    shift: DVec3,
    most: f64,
}

impl Saddle {
    fn new(spacing: [f64; 3]) -> Saddle {
        let (dims, shift) = ([6, 7, 6], DVec3::new(1.0, 2.0, 0.5));
        let value = |at: DVec3| (at + shift).to_array().iter().product::<f64>();
        let most = value(DVec3::from(dims.map(|n| n as f64 - 1.0)));
        Saddle { volume: volume(dims, spacing, value), shift, most }
    }

    fn value(&self, at: DVec3) -> f64 {
        (at + self.shift).to_array().iter().product()
    }

    /// In values for the smallest spacing.
    fn gradient(&self, at: DVec3) -> DVec3 {
        let [x, y, z] = (at + self.shift).to_array();
        let spacing = DVec3::from(self.volume.spacing);
        DVec3::new(y * z, x * z, x * y) / spacing * spacing.min_element()
    }

    /// What is seen of it: by many panels.
    fn form(
        &self,
        scene: &Scene,
        pixel: [usize; 2],
        alpha: &dyn Fn(DVec3) -> f64,
        rgb: &dyn Fn(DVec3, DVec3) -> [f64; 3],
    ) -> Form {
        let Some(chord) = Chord::new(&self.volume, scene, pixel, inner(&self.volume)) else {
            return (scene.background, 0.0);
        };
        let at = |t: f64| chord.at(t);
        let (colour, left) = seen(|t| alpha(at(t)), |t| rgb(at(t), chord.world), chord.length, 60);
        (over(colour, left, scene.background), 1e-14 + rounded(scene, &chord))
    }
}

#[test]
fn a_saddle_of_opacity_and_colour_is_what_many_panels_give() {
    for spacing in [[1.0; 3], [1.0, 1.5, 0.7]] {
        let saddle = Saddle::new(spacing);
        for view in views() {
            for most in [1e-6, 0.4, 0.9] {
                let unlit = unlit(
                    &view,
                    vec![[0.0, 0.0], [saddle.most, most]],
                    &[(0.0, COLOUR), (saddle.most, [0.0, 1.0, 0.6])],
                );
                let scene = cropped(&saddle.volume, unlit);
                let share = |at: DVec3| saddle.value(at) / saddle.most;
                let rgb =
                    |at: DVec3, _: DVec3| [0, 1, 2].map(|i| COLOUR[i] + share(at) * ([0.0, 1.0, 0.6][i] - COLOUR[i]));
                hold(&format!("saddle to {most}, {spacing:?}"), &saddle.volume, &scene, |pixel| {
                    saddle.form(&scene, pixel, &|at| most * share(at), &rgb)
                });
            }
        }
    }
}

#[test]
fn a_lit_saddle_is_what_many_panels_give() {
    let saddle = Saddle::new([1.0, 1.5, 0.7]);
    let along = |direction| View::from_direction(direction, None);
    let near = Perspective { distance_voxel: Some(12.0), ..Perspective::new(15.0) };
    let near = View { perspective: Some(near), ..along([1.0, 0.8, 0.9]) };
    let mut held = 0;
    for view in [along([1.0, 0.8, 0.9]), along([-0.9, -1.0, -0.7]), near] {
        for towards in [None, Some([-1.0, -0.5, -0.8]), Some([0.6, 1.0, 0.7])] {
            let lights = vec![Light { direction: towards, colour: [1.0, 0.7, 0.2] }];
            for material in materials() {
                let unlit = unlit(&view, vec![[0.0, 0.05], [saddle.most, 0.5]], &[(0.0, COLOUR)]);
                let scene = cropped(&saddle.volume, Scene { lights: lights.clone(), material, ..unlit });
                if !smooth(&saddle, &scene) {
                    continue;
                }
                held += 1;
                let alpha = |at: DVec3| 0.05 + 0.45 * saddle.value(at) / saddle.most;
                let rgb = |at: DVec3, ray: DVec3| lit(&scene, saddle.gradient(at), ray, COLOUR);
                hold_to(
                    least(&scene),
                    &format!("lit saddle, {lights:?}, {:?}", scene.material),
                    &saddle.volume,
                    &scene,
                    |pixel| saddle.form(&scene, pixel, &alpha, &rgb),
                );
            }
        }
    }
    assert!(held >= 20, "{held}");
}

/// No normal of the saddle turns from a light or a halfway vector to the other side anywhere: panels know nothing of bends. One light alone
/// is never clamped.
fn smooth(saddle: &Saddle, scene: &Scene) -> bool {
    let ray = scene.view.frame().unwrap().direction;
    let corner = |i: usize| {
        inner(&saddle.volume)[i & 1].with_y(inner(&saddle.volume)[i >> 1 & 1].y).with_z(inner(&saddle.volume)[i >> 2].z)
    };
    let sides = |direction: DVec3| {
        let cosines = (0..8).map(|i| saddle.gradient(corner(i)).normalize().dot(direction));
        // Enough of a margin for the rays of a narrow perspective.
        cosines.clone().all(|c| c > 0.2) || cosines.clone().all(|c| c < -0.2)
    };
    scene.lights.iter().all(|light| {
        let towards = light.direction.map_or(-ray, |direction| DVec3::from(direction).normalize());
        sides(towards) && sides((towards - ray).normalize())
    })
}

#[test]
fn between_layers_a_saddle_is_what_many_panels_give() {
    let saddle = Saddle::new([1.0; 3]);
    let steepest = saddle.gradient(inner(&saddle.volume)[1]).length();
    for view in views() {
        let layer = |gradient: f64, alphas: [f64; 2]| Layer {
            gradient,
            opacity: vec![[0.0, alphas[0]], [saddle.most, alphas[1]]],
        };
        let mut scene = unlit(&view, Vec::new(), &[(0.0, COLOUR)]);
        scene.transfer.layers = vec![layer(0.0, [0.0, 0.2]), layer(steepest, [0.6, 0.3])];
        let scene = cropped(&saddle.volume, scene);
        let alpha = |at: DVec3| {
            let (share, weight) = (saddle.value(at) / saddle.most, saddle.gradient(at).length() / steepest);
            let (below, above) = (0.2 * share, 0.6 - 0.3 * share);
            below + weight * (above - below)
        };
        hold("layered saddle", &saddle.volume, &scene, |pixel| saddle.form(&scene, pixel, &alpha, &|_, _| COLOUR));
    }
}

#[test]
fn the_weighted_sum_of_a_saddle_is_a_polynomial_of_the_sixth_degree() {
    let saddle = Saddle::new([1.0; 3]);
    for view in views() {
        let unlit = unlit(&view, vec![[0.0, 0.1], [saddle.most, 0.6]], &[(0.0, [0.0; 3]), (saddle.most, WHITE)]);
        let scene = Scene { mode: Mode::WeightedSum, background: [0.0; 3], ..unlit };
        hold("weighted saddle", &saddle.volume, &scene, |pixel| {
            let Some(chord) = Chord::whole(&saddle.volume, &scene, pixel) else { return ([0.0; 3], 0.0) };
            let direction = scene.view.frame().unwrap().direction;
            // The axis along which it is largest, the last of equals.
            let axis = (0..3).max_by(|&a, &b| direction[a].abs().total_cmp(&direction[b].abs())).unwrap();
            let weight = chord.along[axis].abs() / (saddle.volume.dims[axis] - 1) as f64;
            let share = |t: f64| saddle.value(chord.at(t)) / saddle.most;
            let [sum] = integral(|t| [(0.1 + 0.5 * share(t)) * share(t)], [0.0, chord.length], 1);
            ([weight * sum; 3], ROUNDED + chord.slack)
        });
    }
}

#[test]
fn a_depth_cue_in_fog_is_the_integral_of_a_line_times_an_exponential() {
    for (dims, spacing) in [([6, 7, 5], [1.0; 3]), ([4, 5, 9], [1.0, 0.6, 2.0])] {
        let volume = volume(dims, spacing, |_| 7.0);
        for (front, back) in [(1.0, 0.5), (0.2, 0.9), (0.0, 1.0)] {
            for alpha in [0.02, 0.5, 0.99] {
                for view in views() {
                    let unlit = unlit(&view, vec![[0.0, alpha]], &[(0.0, COLOUR)]);
                    let scene = Scene { depth_cue: Some(DepthCue { front, back }), ..unlit };
                    hold(&format!("cue {front} to {back} in {alpha}"), &volume, &scene, |pixel| {
                        cued(&volume, &scene, pixel, [front, back, alpha])
                    });
                }
            }
        }
    }
}

/// ∫ (p + q·t)·μ·e^(−μ·t) dt = p·(1 − e^(−μL)) + q·((1 − e^(−μL))/μ − L·e^(−μL)).
fn cued(volume: &Volume, scene: &Scene, pixel: [usize; 2], [front, back, alpha]: [f64; 3]) -> Form {
    let Some(chord) = Chord::whole(volume, scene, pixel) else { return (scene.background, 0.0) };
    let (direction, spacing) = (scene.view.frame().unwrap().direction, DVec3::from(volume.spacing));
    let corner = |i: usize| {
        let voxel = [0, 1, 2].map(|axis| ((i >> axis & 1) * (volume.dims[axis] - 1)) as f64);
        (DVec3::from(voxel) * spacing).dot(direction)
    };
    let depths = (0..8).map(corner);
    let (near, far) = (depths.clone().fold(f64::INFINITY, f64::min), depths.fold(f64::NEG_INFINITY, f64::max));
    let depth = |t: f64| ((chord.at(t) * spacing).dot(direction) - near) / (far - near);
    let (p, q) = (front + (back - front) * depth(0.0), (back - front) * (depth(1.0) - depth(0.0)));
    let extinction = -(-alpha).ln_1p();
    let (hidden, left) = (-(-extinction * chord.length).exp_m1(), (-extinction * chord.length).exp());
    let factor = p * hidden + q * (hidden / extinction - chord.length * left);
    let rounded = ROUNDED * (1.0 + chord.length) + chord.slack * extinction;
    (over(COLOUR.map(|c| c * factor), left, scene.background), rounded)
}
