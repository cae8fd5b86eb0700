//! Samples and gradients on an eye's rays, the warp, and what is at the limits.

use crate::common::passes::{frames, geometries, rays, seen_from};
use crate::common::{affine, assert_sane, constant, largest_difference, noise, one_voxel_a_pixel};
use cube3_cases::cases;
use cube3_frame::{BasePlane, DiscreteRay, Geometry};
use cube3_machine::{GradientMethod, TemplateRule};
use cube3_scene::{Image, Mode, Perspective, Scene, View};
use cube3_twin::{
    BaseRendering, DiscreteOptions, RealSamples, SampleCell, TwinError, discrete, surface_gradients, warp_passes,
};
use cube3_volume::Volume;
use glam::DVec3;
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

const CELLS: [SampleCell; 2] = [SampleCell::Exact, SampleCell::Sheared];
const RULES: [TemplateRule; 2] = [TemplateRule::SampleFloor, TemplateRule::PlaneFloor];

/// Far, where rays are a voxel apart and more; near; in the volume; on a voxel.
const EYES: [[f64; 3]; 5] =
    [[10.0, -40.0, 3.0], [-4.0, -6.5, 5.0], [4.3, 5.1, 5.7], [5.0, 5.0, 5.0], [30.0, 24.0, -17.0]];

/// In every cell an affine field comes out exact, and so does its gradient where all neighbours are there: of rays that are less than a voxel
/// from their neighbours, as many times smaller.
#[test]
fn affine_fields_and_their_gradients_come_out_exact() {
    let (slope, constant, dims) = ([1.25, -3.5, 0.7], 40.0, [13, 11, 12]);
    let spacing = [1.0, 0.8, 1.3];
    let volume = affine(dims, spacing, slope, constant);
    let gradient = DVec3::from_array([0, 1, 2].map(|i| slope[i] / spacing[i] * 0.8));
    for eye in EYES {
        let scene = seen_from(&Scene { image: one_voxel_a_pixel(31, 31), ..Scene::default() }, dims, eye, 75.0);
        for rule in RULES {
            let mut found = [0; 3];
            for geometry in geometries(&frames(&volume, &scene, GradientMethod::SixSheared, rule)) {
                for cell in CELLS {
                    check_affine(&volume, geometry, cell, (slope, constant, gradient), &mut found);
                }
            }
            let near = frames(&volume, &scene, GradientMethod::SixSheared, rule).setups[0].geometry.doubled();
            assert!(found[0] > 500 && found[1] > 100 && (near || found[2] > 100), "{found:?} from {eye:?}");
        }
    }
}

fn check_affine(
    volume: &Volume,
    geometry: &Geometry,
    cell: SampleCell,
    (slope, constant, gradient): ([f64; 3], f64, DVec3),
    found: &mut [usize; 3],
) {
    let samples = RealSamples::new(volume, geometry, cell, 0.0).unwrap();
    let pass = geometry.perspective.as_ref().unwrap();
    let within = |place: [f64; 3]| (0..3).all(|i| place[i] <= (geometry.size[i] - 1) as f64);
    for ray in rays(geometry) {
        for k in 0..geometry.size[2] {
            let Some(got) = samples.sample(ray, k as i64) else { continue };
            let place = geometry.sample_position(ray, k);
            // A sample may be beyond the last voxel by what a rounded weight hides.
            if !within(place) {
                continue;
            }
            let at = geometry.axes.voxel_position(geometry.size, place);
            let expected: f64 = constant + (0..3).map(|i| slope[i] * at[i]).sum::<f64>();
            let hidden = hides(geometry, ray, k);
            assert!(hidden || (got - expected).abs() < 1e-9, "{got}, not {expected} at {at:?}");
            found[0] += 1;
            let apart = i64::from(pass.reach_at(k as i64, geometry.offset, geometry.weight_bits));
            let there = |[i, j, l]: [i64; 3]| {
                let beside = DiscreteRay { u: ray.u + i * apart, v: ray.v + j * apart };
                geometry.has_sample(beside, k as i64 + l) && !hides(geometry, beside, (k as i64 + l) as usize)
            };
            let block = (0..27).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]);
            if hidden || !block.into_iter().all(there) {
                continue;
            }
            // The distance of neighbours, from where they are.
            let beside = geometry.sample_position(DiscreteRay { u: ray.u + apart, v: ray.v }, k);
            let smaller = (beside[0] - place[0]).min(1.0);
            for method in [GradientMethod::SixSheared, GradientMethod::TwentySixSheared, GradientMethod::Twelve] {
                // Rays of the strip where frames join are steeper than 45°, and near ones have no estimator 12.
                let after = geometry.sample_position(ray, k + 1);
                let steep = (0..2).any(|i| (after[i] - place[i]).abs() > 1.0);
                if steep || (method == GradientMethod::Twelve && geometry.doubled()) {
                    continue;
                }
                let got = samples.world_gradient(ray, k as i64, method);
                let off = (got - gradient * smaller).length();
                assert!(off < 1e-6, "{method:?}: {got}, not {gradient} times {smaller}");
                found[if method == GradientMethod::Twelve { 2 } else { 1 }] += 1;
            }
        }
    }
}

/// No ray goes on before its eye: there the difference along the ray is between the first sample and the next.
#[test]
fn before_the_first_sample_of_an_eye_in_the_volume_there_is_that_sample() {
    let dims = [12; 3];
    let volume = noise(dims, [1.0; 3], 3);
    let scene = seen_from(&Scene::default(), dims, [5.3, 4.6, 6.2], 60.0);
    let mut found = 0;
    for geometry in geometries(&frames(&volume, &scene, GradientMethod::Six, TemplateRule::PlaneFloor)) {
        let first = geometry.perspective.as_ref().unwrap().first_depth;
        assert!(first > 0);
        for cell in CELLS {
            let samples = RealSamples::new(&volume, geometry, cell, 9.0).unwrap();
            for ray in rays(geometry) {
                let [here, next] = [first, first + 1].map(|k| samples.sample(ray, k as i64));
                let (Some(here), Some(next)) = (here, next) else { continue };
                let pass = geometry.perspective.as_ref().unwrap();
                let apart = pass.neighbour_spacing(first as i64, geometry.offset, geometry.weight_bits);
                let got = samples.gradient(ray, first as i64, GradientMethod::Six)[2];
                assert!((got - 0.5 * (next - here) * apart.min(1.0)).abs() < 1e-6, "{got} from {here} to {next}");
                found += 1;
            }
        }
    }
    assert!(found > 100, "{found}");
}

/// Whether a corner of the cell of a sample is beyond the volume, and has no weight in words.
fn hides(geometry: &Geometry, ray: DiscreteRay, k: usize) -> bool {
    (0..8).any(|i| {
        (i >> 2 == 0 || geometry.offset != 0) && geometry.corner(ray, k, [i >> 2, i >> 1 & 1, i & 1]).is_none()
    })
}

proptest! {
    #![proptest_config(cases(100))]

    /// Two pieces of arithmetic: the twin looks for a pixel's ray among the frame's behind the volume, the host on the grid plane.
    #[test]
    fn pictures_are_warped_as_the_host_warps(
        eye in prop_oneof![
            2 => prop::array::uniform3(-9.0..49.0_f64), 1 => prop::array::uniform3(-200.0..200.0_f64),
            1 => (0_u8..36, 0_u8..36, 0_u8..36).prop_map(|(x, y, z)| [x, y, z].map(f64::from)),
        ],
        field in 20.0..130.0_f64, spacing in prop::array::uniform3(0.6..1.6_f64), seed: u64,
    ) {
        // Frames of so many planes and more join over some width.
        let dims = [40, 36, 44];
        let volume = Volume { spacing, ..constant(dims) };
        let scene = Scene { image: Image { width_px: 33, height_px: 27, pixel_size_voxel: None }, ..Scene::default() };
        let scene = seen_from(&scene, dims, eye, field);
        let frames = frames(&volume, &scene, GradientMethod::SixSheared, TemplateRule::PlaneFloor);
        prop_assume!(!frames.setups.is_empty());
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let bases: Vec<BasePlane> = geometries(&frames).into_iter().map(|geometry| {
            let mut base = BasePlane::empty(geometry, 16);
            base.pixels.iter_mut().flatten().for_each(|word| *word = random.next_u32() & 0xffff);
            base
        }).collect();
        let ours: Vec<BaseRendering> = bases.iter().map(|base| BaseRendering {
            width: base.width,
            height: base.height,
            pixels: base.pixels.iter().map(|pixel| pixel.map(|word| f64::from(word) / 65535.0)).collect(),
            samples: 0,
        }).collect();
        let (background, plane) = ([0.1, 0.5, 0.2], &frames.plane);
        let twin: Vec<_> = ours.iter().zip(geometries(&frames)).collect();
        let host: Vec<_> = bases.iter().zip(geometries(&frames)).collect();
        let got = warp_passes(&twin, plane, spacing, background);
        let expected = cube3_host::warp_passes(&host, plane, spacing, background);
        let off = largest_difference(&got, &expected);
        prop_assert!(off < 1e-6, "{off:e}");
        prop_assume!(got.iter().any(|pixel| *pixel != background));
    }
}

/// A base plane whose pixels are the places of their rays gives each pixel its own place, where frames join too: the warp is bilinear.
#[test]
fn where_base_planes_join_a_smooth_picture_has_no_step() {
    let dims = [32; 3];
    let volume = noise(dims, [1.0; 3], 1);
    let scene = Scene { image: Image { width_px: 90, height_px: 70, pixel_size_voxel: None }, ..Scene::default() };
    for eye in [[15.5, 15.5, 15.5], [3.2, 4.1, 28.0], [-20.0, -21.0, -19.0]] {
        let scene = seen_from(&scene, dims, eye, 70.0);
        let frames = frames(&volume, &scene, GradientMethod::SixSheared, TemplateRule::PlaneFloor);
        assert!(frames.setups.len() > 1);
        // What is shown is a function of the ray's direction alone.
        let shown = |along: DVec3| (along.normalize() + DVec3::ONE) / 2.0;
        let bases: Vec<BaseRendering> = geometries(&frames)
            .into_iter()
            .map(|geometry| {
                let [width, height] = geometry.base_plane_size();
                let pixel = |ray| {
                    let [near, far] =
                        [0, 64].map(|k| geometry.perspective.as_ref().unwrap().first_depth + k).map(|k| {
                            DVec3::from(geometry.axes.voxel_position(geometry.size, geometry.sample_position(ray, k)))
                        });
                    let [r, g, b] = shown(far - near).to_array();
                    [r, g, b, 1.0]
                };
                BaseRendering { width, height, pixels: rays(geometry).map(pixel).collect(), samples: 0 }
            })
            .collect();
        let passes: Vec<_> = bases.iter().zip(geometries(&frames)).collect();
        let [on_black, on_white] =
            [0.0, 1.0].map(|background| warp_passes(&passes, &frames.plane, [1.0; 3], [background; 3]));
        let mut seen = 0;
        for (place, (pixel, on_white)) in on_black.iter().zip(&on_white).enumerate() {
            let (_, along) = frames.plane.ray((place % 90) as f64, (place / 90) as f64);
            // Beyond the volume there are no rays, and at its edge a part of them.
            if on_white[0] - pixel[0] > 1e-9 {
                continue;
            }
            let off = (DVec3::from(*pixel) - shown(along)).abs().max_element();
            assert!(off < 2e-3, "{pixel:?}, not {} at {place}", shown(along));
            seen += 1;
        }
        assert!(seen > 900, "{seen} from {eye:?}");
    }
}

#[test]
fn labels_are_the_nearest_voxel_in_either_cell() {
    let dims = [9, 8, 7];
    let volume = Volume::from_fn(dims, [1.0; 3], |x, y, z| ((7 * x + 5 * y + 3 * z) % 11) as u8).unwrap();
    for eye in EYES {
        let mut scene = seen_from(&Scene { image: one_voxel_a_pixel(21, 21), ..Scene::default() }, dims, eye, 75.0);
        scene.volume.labels = true;
        scene.mode = Mode::WeightedSum;
        let mut count = 0;
        for geometry in geometries(&frames(&volume, &scene, GradientMethod::SixSheared, TemplateRule::PlaneFloor)) {
            assert!(geometry.nearest());
            let [exact, sheared] = CELLS.map(|cell| RealSamples::new(&volume, geometry, cell, 0.0).unwrap());
            for ray in rays(geometry) {
                for k in 0..geometry.size[2] {
                    let sample = exact.sample(ray, k as i64);
                    assert_eq!(sample, sheared.sample(ray, k as i64));
                    let place = geometry.axes.voxel_position(geometry.size, geometry.sample_position(ray, k));
                    // Half way between two voxels it is either.
                    if place.iter().any(|x| (x.fract().abs() - 0.5).abs() < 1e-6) {
                        continue;
                    }
                    let voxel = place.map(|x| x.round() as usize);
                    let value = ((7 * voxel[0] + 5 * voxel[1] + 3 * voxel[2]) % 11) as f64;
                    count += usize::from(sample.is_some());
                    assert!(sample.is_none_or(|sample| sample == value), "{sample:?}, not {value} at {place:?}");
                }
            }
            let options = DiscreteOptions { gradient: GradientMethod::SixSheared, ..DiscreteOptions::default() };
            let [a, b] = CELLS.map(|cell| discrete(&volume, &scene, geometry, cell, &options, None).unwrap());
            assert_eq!(a, b);
        }
        assert!(count > 200, "{count} from {eye:?}");
    }
}

#[test]
fn eyes_at_the_limits_are_rendered() {
    for dims in [[1; 3], [1, 1, 9], [2; 3], [3, 1, 2], [6; 3]] {
        let volume = Volume::from_fn(dims, [1.0, 3.0, 0.2], |x, y, z| (50 * (x + y + z) + 60) as f32).unwrap();
        let thick = volume.thickened();
        for place in
            [[0.0; 3], [0.5; 3], [2.0, 2.0, 2.0], [-1.0, 0.5, 0.5], [0.0, -1e12, 0.0], [1e12; 3], [5.0, 0.5, -1e-9]]
        {
            for field in [0.001, 40.0, 179.0] {
                for mode in Mode::ALL {
                    let scene = Scene { mode, image: one_voxel_a_pixel(9, 9), ..Scene::default() };
                    let scene = seen_from(&scene, dims, place, field);
                    let thickened = scene.thickened(dims.map(|n| n == 1));
                    for rule in RULES {
                        let frames = frames(&thick, &thickened, GradientMethod::Twelve, rule);
                        for geometry in geometries(&frames) {
                            for (gradient, cell) in [
                                (GradientMethod::Twelve, SampleCell::Exact),
                                (GradientMethod::TwentySix, SampleCell::Sheared),
                                (GradientMethod::SixSheared, SampleCell::Sheared),
                            ] {
                                let options = DiscreteOptions { gradient, ..DiscreteOptions::default() };
                                let base = discrete(&volume, &scene, geometry, cell, &options, None).unwrap();
                                assert_sane(base.pixels.into_iter().flatten());
                            }
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn rays_and_estimators_that_do_not_fit_are_refused() {
    let dims = [6; 3];
    let volume = noise(dims, [1.0; 3], 9);
    let parallel = Scene { view: View::from_angles(20.0, 10.0), ..Scene::default() };
    let eye =
        Scene { view: View { perspective: Some(Perspective::new(40.0)), ..parallel.view.clone() }, ..parallel.clone() };
    let of = |scene: &Scene| frames(&volume, scene, GradientMethod::Twelve, TemplateRule::PlaneFloor).setups.remove(0);
    let (of_parallel, of_eye) = (of(&parallel), of(&eye));
    let refused = |scene: &Scene, geometry: &Geometry, gradient| {
        let options = DiscreteOptions { gradient, ..DiscreteOptions::default() };
        discrete(&volume, scene, geometry, SampleCell::Exact, &options, None).unwrap_err()
    };
    let error = refused(&eye, &of_parallel.geometry, GradientMethod::Six);
    assert!(matches!(error, TwinError::Rays { geometry: false }));
    assert_eq!(
        error.to_string(),
        "geometry: its rays are parallel, the scene's are those of an eye; set the frame up for this scene"
    );
    let error = refused(&parallel, &of_eye.geometry, GradientMethod::Six);
    assert!(matches!(error, TwinError::Rays { geometry: true }), "{error}");
    for (gradient, name) in [(GradientMethod::Ten, "10"), (GradientMethod::TenNormalised, "10n")] {
        let error = refused(&eye, &of_eye.geometry, gradient);
        assert!(matches!(error, TwinError::Estimator { name: refused } if refused == name), "{error}");
        assert!(error.to_string().starts_with("gradient: estimator 10"));
        let options = DiscreteOptions { gradient, ..DiscreteOptions::default() };
        assert!(surface_gradients(&volume, &of_eye.geometry, SampleCell::Exact, 100.0, &options).is_err());
        // Where nothing is lit there is no gradient to refuse.
        let plain = Scene { mode: Mode::Maximum, ..eye.clone() };
        assert!(discrete(&volume, &plain, &of_eye.geometry, SampleCell::Exact, &options, None).is_ok());
    }
}
