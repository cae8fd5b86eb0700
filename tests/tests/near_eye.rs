//! An eye in the volume: where two base planes join, the picture steps no more than beside the joint.

use cube3::function::{CanonicalVolume, render};
use cube3_host::{BasePlane, Geometry, MachineSpec, PictureFrames, VolumeInfo, picture_setup, warp_passes};
use cube3_scene::{Image, Perspective, Scene, View};
use cube3_volume::{Phantom, PhantomParams, Samples, Volume, VoxelWords, WordConversion};

/// What the machine shows of a volume.
fn picture(words: &VoxelWords, scene: &Scene, machine: &MachineSpec) -> (Vec<[f64; 3]>, PictureFrames) {
    let info = VolumeInfo { dims: words.dims, spacing: words.spacing, window: words.window };
    let frames = picture_setup(scene, machine, &info, true).unwrap();
    let base = |setup: &cube3_host::FrameSetup| {
        render(setup, &CanonicalVolume::new(&setup.geometry.axes, words.dims, &words.words), true, &|_, _| {}).base
    };
    let bases: Vec<BasePlane> = frames.setups.iter().map(base).collect();
    let passes: Vec<(&BasePlane, &Geometry)> =
        bases.iter().zip(frames.setups.iter().map(|setup| &setup.geometry)).collect();
    (warp_passes(&passes, &frames.plane, words.spacing, scene.background), frames)
}

/// Steps from pixel to pixel at a joint: the mean of those across it, and the median of the means of those as many pixels beside it, up to
/// 12 to either side; along rows, and along columns.
struct Joint {
    across: f64,
    beside: f64,
    pixels: usize,
}

const BESIDE: i64 = 12;

fn joints(pixels: &[[f64; 3]], frames: &PictureFrames, spacing: [f64; 3]) -> [Joint; 2] {
    let (width, height) = (frames.plane.width as i64, frames.plane.height as i64);
    let pass: Vec<usize> = (0..width * height)
        .map(|i| {
            let (_, d) = frames.plane.ray((i % width) as f64, (i / width) as f64);
            let d = [0, 1, 2].map(|axis| d[axis] / spacing[axis]);
            let axis = (0..3).fold(0, |best, axis| if d[axis].abs() > d[best].abs() { axis } else { best });
            2 * axis + usize::from(d[axis] < 0.0)
        })
        .collect();
    [[1, 0], [0, 1]].map(|[right, down]| {
        let inside = |x: i64, y: i64| (0..width).contains(&x) && (0..height).contains(&y);
        let at = |x: i64, y: i64| (y * width + x) as usize;
        let (mut sums, mut counts) = ([0.0; 2 * BESIDE as usize + 1], [0; 2 * BESIDE as usize + 1]);
        for y in 0..height - down {
            for x in 0..width - right {
                if pass[at(x, y)] == pass[at(x + right, y + down)] {
                    continue;
                }
                for offset in -BESIDE..=BESIDE {
                    let (x, y) = (x + offset * right, y + offset * down);
                    if !inside(x, y) || !inside(x + right, y + down) {
                        continue;
                    }
                    let (here, next) = (at(x, y), at(x + right, y + down));
                    if offset != 0 && pass[here] != pass[next] {
                        continue;
                    }
                    let step: f64 = (0..3).map(|c| (pixels[here][c] - pixels[next][c]).abs()).sum::<f64>() / 3.0;
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
        Joint { across: mean(middle), beside: (beside[half - 1] + beside[half]) / 2.0, pixels: counts[middle] as usize }
    })
}

fn scene(yaw: f64, tilt: f64, eye: [f64; 3], opacity: &[[f64; 2]], shaded: bool) -> Scene {
    let mut scene = Scene { view: View::from_angles(yaw, tilt), ..Scene::default() };
    scene.view.perspective = Some(Perspective { eye_voxel: Some(eye), ..Perspective::new(90.0) });
    scene.image = Image { width_px: 256, height_px: 256, ..Image::default() };
    scene.transfer.opacity = opacity.to_vec();
    scene.transfer.colour.iter_mut().for_each(|point| point.rgb = [1.0; 3]);
    scene.material.shaded = shaded;
    scene.background = [0.0; 3];
    scene
}

fn words(volume: &Volume) -> VoxelWords {
    let bits = if matches!(volume.samples, Samples::U8(_)) { 8 } else { 16 };
    volume.to_words(16, &WordConversion::identity(bits)).unwrap().0
}

#[test]
fn explore() {
    let mut machine = MachineSpec::default();
    machine.abc.reach = std::env::var("J").map_or(8, |j| j.parse().unwrap());
    let method = std::env::var("G").unwrap_or("12".into());
    machine.abc.gradient = cube3_host::GradientMethod::ALL.iter().find(|(_, name)| *name == method).unwrap().0;
    let n = std::env::var("N").map_or(64, |n| n.parse().unwrap());
    let phantom = |phantom: Phantom, params: &PhantomParams| words(&phantom.generate(n, params).unwrap());
    let fog = phantom(Phantom::Fog, &PhantomParams::default());
    let ball = phantom(Phantom::Sphere, &PhantomParams::default());
    let head = phantom(Phantom::Head, &PhantomParams::default());
    let mut noise = fog.clone();
    let mut state = 1_u64;
    for word in &mut noise.words {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        *word = (state >> 48) as u16;
    }
    let s = n as f64 / 64.0;
    let eyes = [
        [32.0 * s; 3],
        [30.3 * s, 33.1 * s, 29.7 * s],
        [32.0 * s, 32.0 * s, 12.0 * s],
        [31.5 * s + 0.2, 14.0 * s, 20.0 * s],
    ];
    for (name, words, opacity, lit) in [
        ("fog", &fog, vec![[0.0, 0.0], [6553.0, 0.2]], true),
        ("fogthin", &fog, vec![[0.0, 0.0], [6553.0, 0.03]], true),
        ("ball", &ball, vec![[10000.0, 0.0], [32768.0, 0.4], [55000.0, 0.0]], true),
        ("head", &head, vec![[80.0, 0.0], [100.0, 0.75]], true),
        ("head0", &head, vec![[80.0, 0.0], [100.0, 0.75]], false),
        ("noise0", &noise, vec![[0.0, 0.0], [65535.0, 0.1]], false),
        ("noise0thick", &noise, vec![[0.0, 0.0], [65535.0, 0.9]], false),
        ("noise", &noise, vec![[0.0, 0.0], [65535.0, 0.1]], true),
    ] {
        for eye in eyes {
            for (yaw, tilt) in [(45.0, 0.0), (30.0, 7.0)] {
                let mut scene = scene(yaw, tilt, eye, &opacity, lit);
                if !lit {
                    let top = opacity.last().unwrap()[0];
                    scene.transfer.colour = vec![
                        cube3_scene::ColourPoint { value: 0.0, rgb: [0.0; 3] },
                        cube3_scene::ColourPoint { value: top, rgb: [1.0; 3] },
                    ];
                }
                let (pixels, frames) = picture(words, &scene, &machine);
                let mean = pixels.iter().map(|p| p[0]).sum::<f64>() / pixels.len() as f64 * 255.0;
                let joints = joints(&pixels, &frames, [1.0; 3]);
                let line: String = joints
                    .iter()
                    .map(|j| format!("  {:.5}/{:.5} = {:.2} ({})", j.across, j.beside, j.across / j.beside, j.pixels))
                    .collect();
                println!(
                    "{name} {eye:?} {yaw} mean {mean:.1} {}: {line}",
                    frames.setups[0].gradient.map_or("none", |g| g.method.name())
                );
            }
        }
    }
}
