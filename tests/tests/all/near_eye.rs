//! An eye in the volume: gradients over about a voxel however close the rays are, and no step where base planes join.

use cube3_frame::{BasePlane, FrameSetup, Geometry};
use cube3_function::{CanonicalVolume, render};
use cube3_host::{PictureFrames, VolumeInfo, picture_setup, warp_passes};
use cube3_machine::MachineSpec;
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_scene::{ColourPoint, Image, Perspective, Scene, View};
use cube3_volume::{Phantom, PhantomParams, Samples, Volume, VoxelWords, WordConversion};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use std::sync::Arc;

const N: usize = 64;
const SIDE: u32 = 256;

/// A volume, as words and as data.
struct Input {
    data: Volume,
    words: VoxelWords,
}

impl Input {
    fn new(data: Volume) -> Input {
        let words = data.to_words(16, &WordConversion::identity(16)).unwrap().0;
        Input { data, words }
    }

    fn phantom(phantom: Phantom) -> Input {
        let volume = phantom.generate(N, &PhantomParams::default()).unwrap();
        match &volume.samples {
            // Eight bits on the scale of sixteen.
            Samples::U8(bytes) => {
                let samples = Samples::U16(bytes.iter().map(|&byte| 257 * u16::from(byte)).collect());
                Input::new(Volume { samples, ..volume })
            }
            _ => Input::new(volume),
        }
    }

    fn noise() -> Input {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let words = (0..N * N * N).map(|_| random.next_u32() as u16);
        let fog = Phantom::Fog.generate(N, &PhantomParams::default()).unwrap();
        Input::new(Volume { samples: Samples::U16(words.collect()), ..fog })
    }

    /// What the machine shows of it.
    fn picture(&self, scene: &Scene, machine: &MachineSpec) -> (Vec<[f64; 3]>, PictureFrames) {
        let words = &self.words;
        let info = VolumeInfo { dims: words.dims, spacing: words.spacing, window: words.window };
        let frames = picture_setup(scene, machine, &info, true).unwrap();
        let base = |setup: &Arc<FrameSetup>| {
            render(setup, &CanonicalVolume::new(&setup.geometry.axes, words.dims, &words.words), true, &|_, _| {}).base
        };
        let bases: Vec<BasePlane> = frames.setups.iter().map(base).collect();
        let passes: Vec<(&BasePlane, &Geometry)> =
            bases.iter().zip(frames.setups.iter().map(|setup| &setup.geometry)).collect();
        (warp_passes(&passes, &frames.plane, words.spacing, scene.background), frames)
    }
}

/// The view from an eye in the volume, 90° wide; white samples of the given opacities.
fn scene(yaw: f64, tilt: f64, eye: [f64; 3], opacity: &[[f64; 2]]) -> Scene {
    let mut scene = Scene { view: View::from_angles(yaw, tilt), background: [0.0; 3], ..Scene::default() };
    scene.view.perspective = Some(Perspective { eye_voxel: Some(eye), ..Perspective::new(90.0) });
    scene.image = Image { width_px: SIDE, height_px: SIDE, ..Image::default() };
    scene.transfer.opacity = opacity.to_vec();
    scene.transfer.colour = vec![ColourPoint { value: 0.0, rgb: [1.0; 3] }];
    scene
}

/// Steps from pixel to pixel at a joint: the mean of those across it, and the median of the means of those so many pixels beside it, up to
/// [`BESIDE`] to either side.
struct Joint {
    across: f64,
    beside: f64,
    pixels: usize,
}

const BESIDE: i64 = 12;

/// Those of neighbours in a row and of neighbours in a column.
fn joints(pixels: &[[f64; 3]], frames: &PictureFrames) -> [Joint; 2] {
    let side = i64::from(SIDE);
    let pass: Vec<usize> = (0..side * side)
        .map(|i| {
            let (_, d) = frames.plane.ray((i % side) as f64, (i / side) as f64);
            let axis = (0..3).fold(0, |best, axis| if d[axis].abs() > d[best].abs() { axis } else { best });
            2 * axis + usize::from(d[axis] < 0.0)
        })
        .collect();
    let at = |[x, y]: [i64; 2]| (y * side + x) as usize;
    [[1, 0], [0, 1]].map(|by| {
        let next = |p: [i64; 2], times: i64| [p[0] + times * by[0], p[1] + times * by[1]];
        let inside = |p: [i64; 2]| p.iter().all(|c| (0..side).contains(c));
        let (mut sums, mut counts) = ([0.0; 2 * BESIDE as usize + 1], [0; 2 * BESIDE as usize + 1]);
        for here in (0..side * side).map(|i| [i % side, i / side]) {
            if !inside(next(here, 1)) || pass[at(here)] == pass[at(next(here, 1))] {
                continue;
            }
            for offset in -BESIDE..=BESIDE {
                let (a, b) = (next(here, offset), next(here, offset + 1));
                if inside(a) && inside(b) && (offset == 0 || pass[at(a)] == pass[at(b)]) {
                    let step = (0..3).map(|c| (pixels[at(a)][c] - pixels[at(b)][c]).abs()).sum::<f64>() / 3.0;
                    sums[(offset + BESIDE) as usize] += step;
                    counts[(offset + BESIDE) as usize] += 1;
                }
            }
        }
        let middle = BESIDE as usize;
        let mean = |i: usize| sums[i] / f64::from(counts[i].max(1));
        let mut beside: Vec<f64> = (0..sums.len()).filter(|&i| i != middle).map(mean).collect();
        beside.sort_by(f64::total_cmp);
        let half = beside.len() / 2;
        Joint {
            across: mean(middle),
            beside: f64::midpoint(beside[half - 1], beside[half]),
            pixels: counts[middle] as usize,
        }
    })
}

/// Across a joint the picture steps by at most 1.25 times the median of the steps beside it.
#[test]
fn base_planes_join_without_a_step_around_an_eye_in_the_volume() {
    let machine = MachineSpec::default();
    let cases = [
        ("fog", Input::phantom(Phantom::Fog), vec![[0.0, 0.0], [6553.0, 0.2]], true),
        ("ball", Input::phantom(Phantom::Sphere), vec![[10_000.0, 0.0], [32_768.0, 0.4], [55_000.0, 0.0]], true),
        ("head", Input::phantom(Phantom::Head), vec![[80.0 * 257.0, 0.0], [100.0 * 257.0, 0.75]], true),
        ("noise", Input::noise(), vec![[0.0, 0.0], [65_535.0, 0.9]], false),
    ];
    for (name, input, opacity, lit) in cases {
        for eye in [[32.0; 3], [30.3, 33.1, 29.7]] {
            for (yaw, tilt) in [(45.0, 0.0), (30.0, 7.0)] {
                let mut scene = scene(yaw, tilt, eye, &opacity);
                scene.material.shaded = lit;
                if !lit {
                    scene.transfer.colour = [[0.0; 3], [1.0; 3]]
                        .into_iter()
                        .zip([0.0, 65_535.0])
                        .map(|(rgb, value)| ColourPoint { value, rgb })
                        .collect();
                }
                let (pixels, frames) = input.picture(&scene, &machine);
                assert!(frames.setups.len() >= 3, "{name}");
                for (along, joint) in ["rows", "columns"].into_iter().zip(joints(&pixels, &frames)) {
                    let Joint { across, beside, pixels } = joint;
                    println!("{name} {eye:?} {yaw}° {along}: {across:.5} / {beside:.5} = {:.2}", across / beside);
                    assert!(pixels > 100, "{name}");
                    assert!(across <= 1.25 * beside, "{name} {eye:?} {yaw}°, {along}: {across} against {beside}");
                }
            }
        }
    }
}

/// The light on white noise from within: rays that are closer than a voxel see single cells, whose differences across are larger than
/// those along, and normals lie across the view.
#[test]
fn white_noise_around_the_eye_is_lighter_where_gradients_are_taken_over_a_voxel() {
    let input = Input::noise();
    let scene = scene(45.0, 0.0, [32.0; 3], &[[0.0, 0.1], [65_535.0, 0.1]]);
    let mean = |pixels: &[[f64; 3]]| pixels.iter().map(|pixel| pixel[0]).sum::<f64>() / pixels.len() as f64;
    let reference =
        mean(&image_order(&input.data, &scene, &ImageOrderOptions::default(), None).unwrap().picture.pixels);
    let part = |reach: u32| {
        let mut machine = MachineSpec::default();
        machine.abc.reach = reach;
        mean(&input.picture(&scene, &machine).0) / reference
    };
    let [next, voxel] = [part(1), part(8)];
    println!("white noise: {next:.3} of the reference with the next rays, {voxel:.3} over a voxel");
    assert!(voxel > 0.74 && voxel > 1.12 * next, "{next} {voxel}");
}

/// Neighbours are about a voxel away wherever the machine's reach has as many rays.
#[test]
fn neighbours_are_about_a_voxel_away() {
    let input = Input::phantom(Phantom::Fog);
    let scene = scene(30.0, 7.0, [30.3, 33.1, 29.7], &[[0.0, 0.0], [6553.0, 0.2]]);
    for most in [1, 4, 8] {
        let mut machine = MachineSpec::default();
        machine.abc.reach = most;
        let words = &input.words;
        let info = VolumeInfo { dims: words.dims, spacing: words.spacing, window: words.window };
        for setup in &picture_setup(&scene, &machine, &info, true).unwrap().setups {
            let geometry = &setup.geometry;
            let pass = geometry.perspective.as_ref().unwrap();
            assert!(pass.doubled);
            assert_eq!(setup.most_reach(), most as usize);
            assert_eq!(setup.ring(machine.abc.planes), machine.abc.planes + 2 * (most as usize - 1));
            for k in pass.first_depth..geometry.size[2] {
                let away = pass.spacing_at(k as i64, geometry.offset, geometry.weight_bits) * setup.reach(k) as f64;
                assert!((2.0 / 3.0..=4.0 / 3.0).contains(&away) || setup.reach(k) == i64::from(most), "{k}: {away}");
                assert!(away < 1.5);
            }
        }
    }
}

/// Around an eye in solid matter there is no surface: light is ambient alone, in all directions.
#[test]
fn solid_matter_around_the_eye_has_no_faces() {
    let words = vec![40_000_u16; N * N * N];
    let solid = Input::new(Volume {
        samples: Samples::U16(words),
        ..Phantom::Fog.generate(N, &PhantomParams::default()).unwrap()
    });
    for eye in [[32.0; 3], [30.3, 33.1, 29.7]] {
        let seen = scene(30.0, 7.0, eye, &[[0.0, 0.75]]);
        let (pixels, _) = solid.picture(&seen, &MachineSpec::default());
        // Ambient light is a tenth, in words of 12 bits.
        let off = pixels.iter().flatten().map(|channel| (channel - 0.1).abs()).fold(0.0, f64::max);
        assert!(off < 1e-3, "{off} from {eye:?}");
    }
}
