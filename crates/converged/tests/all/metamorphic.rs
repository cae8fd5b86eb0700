//! Pictures that must agree with each other, whatever they show: random scenes mirrored, turned, split, scaled, refined. And what is refused.

use crate::exact::{made, unlit, views, volume};
use crate::scenes::{Dice, random};
use cube3_converged::{ConvergedOptions, ConvergedRendering, converged};
use cube3_reference::RaycastError;
use cube3_scene::{Crop, Cut, Mode, Scene, View};
use cube3_volume::{Samples, Volume, with_samples};
use glam::DVec3;

const SEEDS: u64 = 150;

fn at(volume: &Volume, scene: &Scene, border: f64) -> ConvergedRendering {
    converged(volume, scene, &ConvergedOptions { tolerance: 1e-7, border, every: 1 }, None).unwrap()
}

/// Pixels differ by the sum of their bounds at most; `of` is the place of a pixel in the second picture.
fn agree(name: &str, a: &ConvergedRendering, b: &ConvergedRendering, of: impl Fn(usize) -> usize) {
    for (i, pixel) in a.picture.pixels.iter().enumerate() {
        let (other, bound) = (b.picture.pixels[of(i)], a.bounds[i] + b.bounds[of(i)]);
        let apart = (0..3).map(|k| (pixel[k] - other[k]).abs()).fold(0.0, f64::max);
        assert!(apart <= bound, "{name}, pixel {i}: {apart:e} apart, {bound:e} allowed; {pixel:?} {other:?}");
    }
}

/// A random scene with its axes given in words: the view by direction and up.
fn upright(seed: u64) -> (Volume, Scene) {
    let (volume, mut scene) = random(seed, 2);
    let frame = scene.view.frame().unwrap();
    scene.view.direction = Some(frame.direction.to_array());
    scene.view.up = Some(frame.up.to_array());
    (volume, scene)
}

/// The volume whose voxel is that of another at a place, and the scene with it: places and directions by `place` and `direction`.
fn moved(
    (volume, scene): (&Volume, &Scene),
    dims: [usize; 3],
    spacing: [f64; 3],
    from: impl Fn([usize; 3]) -> [usize; 3],
    place: impl Fn([f64; 3]) -> [f64; 3],
    direction: impl Fn([f64; 3]) -> [f64; 3],
) -> (Volume, Scene) {
    let voxel = |i: usize| {
        let [x, y, z] = from([i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]]);
        (z * volume.dims[1] + y) * volume.dims[0] + x
    };
    let samples =
        with_samples!(&volume.samples, v => (0..volume.samples.len()).map(|i| f64::from(v[voxel(i)])).collect());
    let mut scene = scene.clone();
    scene.view.direction = scene.view.direction.map(&direction);
    scene.view.up = scene.view.up.map(&direction);
    if let Some(perspective) = &mut scene.view.perspective {
        perspective.eye_voxel = perspective.eye_voxel.map(&place);
    }
    for light in &mut scene.lights {
        light.direction = light.direction.map(&direction);
    }
    for cut in &mut scene.cuts {
        *cut = Cut { normal: direction(cut.normal), through_voxel: place(cut.through_voxel) };
    }
    if let Some(crop) = &mut scene.crop {
        let [a, b] = [place(crop.min_voxel), place(crop.max_voxel)];
        let [min_voxel, max_voxel] = [f64::min, f64::max].map(|of| [0, 1, 2].map(|i| of(a[i], b[i])));
        *crop = Crop { min_voxel, max_voxel };
    }
    (Volume::new(dims, spacing, Samples::F64(samples)).unwrap(), scene)
}

#[test]
fn a_mirrored_scene_is_the_mirrored_picture() {
    for seed in 0..SEEDS {
        let (volume, scene) = upright(seed);
        let last = volume.dims[0] - 1;
        let (mirrored, turned) = moved(
            (&volume, &scene),
            volume.dims,
            volume.spacing,
            |[x, y, z]| [last - x, y, z],
            |[x, y, z]| [last as f64 - x, y, z],
            |[x, y, z]| [-x, y, z],
        );
        agree(&format!("mirrored {seed}"), &at(&volume, &scene, 3.0), &at(&mirrored, &turned, 3.0), |i| i ^ 1);
    }
}

#[test]
fn a_scene_with_its_axes_in_another_order_is_the_same_picture() {
    for seed in 0..SEEDS {
        let (volume, scene) = upright(seed);
        let dims = volume.dims;
        // A turn about the diagonal; a weighted sum goes by the axis nearest to the view, of equals by the last.
        let order = |[x, y, z]: [f64; 3]| [z, x, y];
        let (turned, other) = moved(
            (&volume, &scene),
            [dims[2], dims[0], dims[1]],
            order(volume.spacing),
            |[x, y, z]| [y, z, x],
            order,
            order,
        );
        let tied = scene.mode == Mode::WeightedSum && seen_along_two(&volume, &scene);
        if !tied {
            agree(&format!("turned {seed}"), &at(&volume, &scene, 3.0), &at(&turned, &other, 3.0), |i| i);
        }
    }
}

/// Whether two axes are as near to the view as each other.
fn seen_along_two(volume: &Volume, scene: &Scene) -> bool {
    let direction = scene.view.frame().unwrap().direction;
    let mut steps = [0, 1, 2].map(|i| (direction[i] / volume.spacing[i]).abs());
    steps.sort_by(f64::total_cmp);
    steps[2] - steps[1] < 1e-9 * steps[2]
}

#[test]
fn a_ray_that_is_cut_in_two_is_the_front_before_the_back() {
    for seed in 0..SEEDS {
        let (volume, scene) = random(seed, 2);
        let direction = scene.view.frame().unwrap().direction;
        if scene.mode == Mode::WeightedSum {
            // Nothing of it hides what is behind.
            continue;
        }
        // Along every ray it rises, in voxels that are no cubes too.
        let normal = (direction * DVec3::from(volume.spacing)).to_array();
        let through_voxel = volume.dims.map(|n| (n - 1) as f64 * 0.43);
        let half = |sign: f64, background: [f64; 3]| {
            let mut scene = Scene { background, ..scene.clone() };
            scene.cuts.truncate(5);
            scene.cuts.push(Cut { normal: normal.map(|x| x * sign), through_voxel });
            at(&volume, &scene, 3.0)
        };
        let whole = at(&volume, &scene, 3.0);
        let (black, white) = ([0.0; 3], [1.0; 3]);
        let (front, clear) = (half(1.0, black), half(1.0, white));
        let back = half(-1.0, scene.background);
        for (i, pixel) in whole.picture.pixels.iter().enumerate() {
            let bound = whole.bounds[i] + 2.0 * front.bounds[i] + clear.bounds[i] + back.bounds[i];
            let [front, clear, back] = [&front, &clear, &back].map(|made| made.picture.pixels[i]);
            let both = [0, 1, 2].map(|k| front[k] + (clear[k] - front[k]) * back[k]);
            let apart = (0..3).map(|k| (pixel[k] - both[k]).abs()).fold(0.0, f64::max);
            assert!(apart <= bound, "{seed}, pixel {i}: {pixel:?} {both:?}, {bound:e}");
        }
    }
}

#[test]
fn clips_that_remove_nothing_change_nothing() {
    for seed in 0..SEEDS {
        let (volume, scene) = random(seed, 2);
        let mut clipped = scene.clone();
        let far = volume.dims.map(|n| n as f64 + 0.5);
        clipped.crop.get_or_insert(Crop { min_voxel: [-0.5; 3], max_voxel: far });
        clipped.cuts.truncate(5);
        clipped.cuts.push(Cut { normal: [0.3, 0.5, 1.0], through_voxel: far });
        assert_eq!(at(&volume, &scene, 3.0), at(&volume, &clipped, 3.0), "{seed}");
    }
}

#[test]
fn the_unit_of_the_spacing_is_no_matter() {
    for seed in 0..SEEDS {
        let (volume, scene) = random(seed, 2);
        let plain = at(&volume, &scene, 3.0);
        for unit in [1e100, 1e-100, 3.7] {
            let scaled = Volume { spacing: volume.spacing.map(|s| s * unit), ..volume.clone() };
            agree(&format!("{seed} in {unit:e}"), &plain, &at(&scaled, &scene, 3.0), |i| i);
        }
    }
}

#[test]
fn threads_change_no_bit() {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let (one, two) = (pool(1), pool(2));
    for seed in 0..SEEDS {
        let (volume, scene) = random(seed, 3);
        let make = || at(&volume, &scene, 3.0);
        assert_eq!(one.install(make), two.install(make), "{seed}");
    }
}

/// A volume with voxels in the middles too, where interpolation puts them.
fn refined(volume: &Volume) -> Volume {
    let dims = volume.dims.map(|n| 2 * n - 1);
    let Samples::F64(samples) = &volume.samples else { unreachable!() };
    crate::exact::volume(dims, volume.spacing.map(|s| s / 2.0), |at| {
        let place = [0, 1, 2].map(|i| at[i] as usize);
        let corner = |i: usize| [0, 1, 2].map(|axis| (place[axis] + (i >> axis & 1)) / 2);
        let voxel = |[x, y, z]: [usize; 3]| samples[(z * volume.dims[1] + y) * volume.dims[0] + x];
        (0..8).map(|i| voxel(corner(i))).sum::<f64>() / 8.0
    })
}

#[test]
fn a_volume_that_is_refined_as_it_is_interpolated_is_the_same() {
    for seed in 0..40 {
        let dice = &mut Dice::new(seed);
        let values: Vec<f64> = (0..4 * 3 * 5).map(|_| dice.between(0.0, 256.0).floor()).collect();
        let coarse = volume([4, 3, 5], [1.0, 1.5, 1.0], |at| values[((at.z * 3.0 + at.y) * 4.0 + at.x) as usize]);
        let fine = refined(&coarse);
        let colour: Vec<(f64, [f64; 3])> =
            (0..4).map(|i| (f64::from(i) * 70.0, [0; 3].map(|_| dice.between(0.0, 1.0)))).collect();
        // Levels: of half a length opacity is 1 − √(1 − α), which no line between two is.
        let alphas = [0; 6].map(|_| dice.between(0.0, 1.0));
        let levels = |of: &dyn Fn(f64) -> f64| {
            let level = |i: usize| [i as f64, i as f64 + 1.0].map(|x| [x * 43.0, of(alphas[i])]);
            (0..6).flat_map(level).collect::<Vec<[f64; 2]>>()
        };
        for view in views().into_iter().take(4) {
            for mode in [Mode::Composite, Mode::WeightedSum] {
                let half = |alpha: f64| if mode == Mode::Composite { 1.0 - (1.0 - alpha).sqrt() } else { alpha };
                let scene = |of: &dyn Fn(f64) -> f64| Scene { mode, ..unlit(&view, levels(of), &colour) };
                let (whole, mut halves) = (scene(&|alpha| alpha), scene(&half));
                halves.image.pixel_size_voxel = whole.image.pixel_size_voxel.map(|size| 2.0 * size);
                agree(&format!("refined {seed}"), &made(&coarse, &whole, 1e-7), &made(&fine, &halves, 1e-7), |i| i);
            }
        }
    }
}

#[test]
fn every_so_many_pixels_are_those_of_the_whole_picture() {
    let (volume, scene) = random(5, 7);
    let of =
        |every: usize| converged(&volume, &scene, &ConvergedOptions { every, ..ConvergedOptions::default() }, None);
    let (whole, third) = (of(1).unwrap(), of(3).unwrap());
    assert_eq!((third.picture.width, third.picture.height), (3, 3));
    for i in 0..9 {
        let place = i / 3 * 3 * 7 + i % 3 * 3;
        assert_eq!((third.picture.pixels[i], third.bounds[i]), (whole.picture.pixels[place], whole.bounds[place]));
    }
}

#[test]
fn what_is_refused_says_where_why_and_what_would_be_right() {
    let volume = volume([3; 3], [1.0; 3], |_| 7.0);
    let scene = unlit(&View::default(), vec![[0.0, 0.5]], &[(0.0, [1.0; 3])]);
    let refused = |volume: &Volume, scene: &Scene, options: ConvergedOptions| {
        converged(volume, scene, &options, None).unwrap_err()
    };
    let with = |tolerance: f64| ConvergedOptions { tolerance, ..ConvergedOptions::default() };
    for tolerance in [9.9e-14, 0.0, -1.0, 0.51, f64::NAN, f64::INFINITY] {
        let error = refused(&volume, &scene, with(tolerance));
        assert!(matches!(error, RaycastError::Option { name: "tolerance", .. }), "{error:?}");
        let right = format!(
            "tolerance: {tolerance} is not a tolerance that can be held; give a number from 1e-13 to 0.5, of full scale"
        );
        assert_eq!(error.to_string(), right);
    }
    for tolerance in [1e-13, 0.5] {
        assert!(converged(&volume, &scene, &with(tolerance), None).is_ok());
    }
    for mode in [Mode::Maximum, Mode::Minimum, Mode::FirstOpaque, Mode::LastOpaque] {
        let error = refused(&volume, &Scene { mode, ..scene.clone() }, with(1e-6)).to_string();
        assert!(
            error.starts_with("mode: ") && error.ends_with("and no integral; give composite or weighted-sum"),
            "{error}"
        );
    }
    let mut samples = vec![7.0_f64; 27];
    samples[14] = f64::NAN;
    let broken = Volume::new([3; 3], [1.0; 3], Samples::F64(samples)).unwrap();
    let error = refused(&broken, &scene, with(1e-6));
    assert!(matches!(error, RaycastError::NonFinite(_)), "{error:?}");
    assert!(error.to_string().contains("(2, 1, 1)"), "{error}");
    let border = ConvergedOptions { border: f64::NAN, ..with(1e-6) };
    assert_eq!(
        refused(&volume, &scene, border).to_string(),
        "border: NaN is not a value; give the data value beyond the volume's border, a finite number"
    );
    let invalid = Scene { background: [2.0, 0.0, 0.0], ..scene };
    let error = refused(&volume, &invalid, with(1e-6));
    assert!(matches!(error, RaycastError::Scene(_)), "{error:?}");
}
