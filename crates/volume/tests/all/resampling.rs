//! What lies between voxels, against closed forms, a dense solution and scipy; and where the new voxels lie.

use cube3_volume::{
    Filter, NewGrid, Resampling, Sample, SampleType, Samples, Space, Volume, VolumeError, World, resample,
};

const FILTERS: [Filter; 2] = [Filter::Linear, Filter::Cubic];

fn how(grid: NewGrid, filter: Filter) -> Resampling {
    Resampling { grid, filter, ..Resampling::default() }
}

fn to_size(volume: &Volume, size: [usize; 3], filter: Filter) -> Volume {
    resample(volume, &how(NewGrid::Size(size), filter)).unwrap().0
}

fn voxels([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
}

/// Where a voxel lies in the world.
fn world(volume: &Volume, voxel: [usize; 3]) -> [f64; 3] {
    let moved = volume.world.direction_of([0, 1, 2].map(|a| voxel[a] as f64 * volume.spacing[a]));
    [0, 1, 2].map(|i| volume.origin[i] + moved[i])
}

fn assert_close(value: f64, expected: f64, within: f64, what: &str) {
    assert!((value - expected).abs() <= within, "{what}: {value} for {expected}");
}

/// The function that the figures of scipy were computed for.
fn uneven(x: usize, y: usize, z: usize) -> f64 {
    ((7 * x * x + 3 * x * y + 11 * z * y + 5 * z) % 17) as f64
}

/// The volume with its axes in another order: new axis a is old axis `order[a]`.
fn permuted(volume: &Volume, order: [usize; 3]) -> Volume {
    let inverse = [0, 1, 2].map(|a| order.iter().position(|&o| o == a).unwrap());
    Volume::from_fn(order.map(|o| volume.dims[o]), order.map(|o| volume.spacing[o]), |x, y, z| {
        let [x, y, z] = inverse.map(|i| [x, y, z][i]);
        volume.value(x, y, z)
    })
    .unwrap()
}

/// The volume with the axes turned round that are `backward`.
fn flipped<S: Sample>(volume: &Volume, backward: [bool; 3]) -> Volume {
    Volume::from_fn(volume.dims, volume.spacing, |x, y, z| {
        let at = |a: usize, i: usize| if backward[a] { volume.dims[a] - 1 - i } else { i };
        S::nearest(volume.value(at(0, x), at(1, y), at(2, z)))
    })
    .unwrap()
}

#[test]
fn the_same_grid_has_the_same_bits() {
    let noise = |i: i32| (f64::from(i) * 12.9898).sin() * 43758.5453;
    let volumes = [
        Samples::U8((0..24).map(|i| (i * 11) as u8).collect()),
        Samples::I32((0..24).map(|i| i32::MIN + i * 77_777_777).collect()),
        Samples::F32((0..24).map(|i| noise(i) as f32).collect()),
        Samples::F64((0..24).map(noise).collect()),
    ];
    for samples in volumes {
        let before = Volume::new([2, 3, 4], [0.1, 0.7, 1.0 / 3.0], samples).unwrap();
        for filter in FILTERS {
            for grid in [NewGrid::Size([2, 3, 4]), NewGrid::Spacing(before.spacing)] {
                let (after, report) = resample(&before, &how(grid, filter)).unwrap();
                assert_eq!(after, before);
                assert_eq!((report.clipped, report.outside, report.coarser), (0, 0, false));
            }
        }
    }
    let cubes = Volume::from_fn([2, 3, 4], [0.3; 3], |x, y, z| uneven(x, y, z) / 7.0).unwrap();
    assert_eq!(resample(&cubes, &Resampling::default()).unwrap().0, cubes);
}

#[test]
fn the_linear_filter_keeps_linear_data() {
    let of = |x: f64, y: f64, z: f64| 3.0 * x - 0.5 * y + 0.25 * z - 7.0;
    let volume =
        Volume::from_fn([6, 5, 4], [1.0, 1.5, 2.0], |x, y, z| of(x as f64, 1.5 * y as f64, 2.0 * z as f64)).unwrap();
    for grid in [NewGrid::Size([17, 3, 9]), NewGrid::Spacing([0.3, 0.7, 1.1]), NewGrid::Cubes] {
        let (new, _) = resample(&volume, &how(grid, Filter::Linear)).unwrap();
        for v in voxels(new.dims) {
            let [x, y, z] = world(&new, v);
            assert_close(new.value(v[0], v[1], v[2]), of(x, y, z), 1e-12, &format!("{grid:?} {v:?}"));
        }
    }
}

#[test]
fn the_cubic_filter_goes_through_the_samples() {
    // 3·(n − 1) + 1: each third new voxel is an old one.
    for dims in [[7, 5, 2], [2, 3, 4], [90, 2, 3]] {
        let volume = Volume::from_fn(dims, [1.0; 3], uneven).unwrap();
        let new = to_size(&volume, dims.map(|n| 3 * n - 2), Filter::Cubic);
        for [x, y, z] in voxels(dims) {
            assert_close(new.value(3 * x, 3 * y, 3 * z), uneven(x, y, z), 1e-10, &format!("{dims:?} {x} {y} {z}"));
        }
    }
}

/// The basis function of the cubic B-spline.
fn basis(t: f64) -> f64 {
    let t = t.abs();
    match t {
        _ if t < 1.0 => 2.0 / 3.0 - t * t + t * t * t / 2.0,
        _ if t < 2.0 => (2.0 - t).powi(3) / 6.0,
        _ => 0.0,
    }
}

/// Coefficients by elimination: Σ c_m·β(k − k') over all images k' of m in the mirrors = sample k.
fn dense_coefficients(samples: &[f64]) -> Vec<f64> {
    let n = samples.len();
    let last = n as isize - 1;
    let mut rows: Vec<Vec<f64>> = samples.iter().map(|s| [vec![0.0; n], vec![*s]].concat()).collect();
    for (k, row) in rows.iter_mut().enumerate() {
        for image in k as isize - 1..=k as isize + 1 {
            let m = if image > last { 2 * last - image } else { image.abs() };
            row[m as usize] += basis((k as isize - image) as f64);
        }
    }
    for i in 0..n {
        let pivot = rows[i].clone();
        for row in &mut rows[i + 1..] {
            let factor = row[i] / pivot[i];
            row.iter_mut().zip(&pivot).for_each(|(number, above)| *number -= factor * above);
        }
    }
    let mut coefficients = vec![0.0; n];
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|c| rows[i][c] * coefficients[c]).sum();
        coefficients[i] = (rows[i][n] - sum) / rows[i][i];
    }
    coefficients
}

#[test]
fn the_cubic_filter_is_the_spline_of_a_dense_solution() {
    for (n, new_n) in [(2, 5), (3, 8), (9, 40), (50, 33)] {
        let samples: Vec<f64> = (0..n).map(|i| uneven(i, 3, 2)).collect();
        let coefficients = dense_coefficients(&samples);
        let mirrored = |k: isize| {
            let k = k.rem_euclid(2 * n as isize - 2) as usize;
            coefficients[if k < n { k } else { 2 * n - 2 - k }]
        };
        for axis in 0..3 {
            let mut dims = [1; 3];
            dims[axis] = n;
            let volume = Volume::new(dims, [1.0; 3], Samples::F64(samples.clone())).unwrap();
            dims[axis] = new_n;
            let new = to_size(&volume, dims, Filter::Cubic).to_f64();
            for (i, value) in new.into_iter().enumerate() {
                let place = (i * (n - 1)) as f64 / (new_n - 1) as f64;
                let cell = place as isize;
                let expected: f64 = (cell - 2..=cell + 3).map(|k| mirrored(k) * basis(place - k as f64)).sum();
                assert_close(value, expected, 1e-12, &format!("{n} to {new_n}, {i}"));
            }
        }
    }
}

#[test]
fn the_cubic_filter_is_that_of_scipy() {
    // scipy 1.17.1, ndimage.map_coordinates(order=3, mode='mirror').
    let figures = [
        ([0, 0, 0], 0.0),
        ([1, 1, 1], 7.925887830687833),
        ([3, 2, 1], 9.759160846560848),
        ([7, 4, 2], 10.20640317460319),
        ([8, 5, 3], 3.0),
        ([5, 3, 2], 12.370346428571438),
        ([1, 0, 0], 2.5357142857142856),
        ([0, 0, 2], 7.407407407407408),
    ];
    let volume = Volume::from_fn([5, 4, 3], [1.0; 3], uneven).unwrap();
    let new = to_size(&volume, [9, 6, 4], Filter::Cubic);
    for ([x, y, z], expected) in figures {
        assert_close(new.value(x, y, z), expected, 1e-12, &format!("({x}, {y}, {z})"));
    }
    assert_close(new.to_f64().iter().sum(), 1760.6998518518528, 1e-9, "sum");
}

#[test]
fn twice_the_slices_less_one_keeps_the_old_slices() {
    for filter in FILTERS {
        let volume =
            Volume::from_fn([9, 8, 7], [1.0, 1.0, 2.0], |x, y, z| (15 * (uneven(x, y, z) as u32)) as u8).unwrap();
        let (new, _) = resample(&volume, &how(NewGrid::Cubes, filter)).unwrap();
        assert_eq!((new.dims, new.spacing), ([9, 8, 13], [1.0; 3]));
        assert_eq!(to_size(&volume, [9, 8, 13], filter), new);
        for [x, y, z] in voxels(volume.dims) {
            assert_eq!(new.value(x, y, 2 * z), volume.value(x, y, z), "{filter} ({x}, {y}, {z})");
        }
        let halves = [0, 1].map(|z| new.value(3, 1, 2 * z + 1));
        assert!(halves != [0, 1].map(|z| volume.value(3, 1, z)), "{halves:?}");
    }
}

#[test]
fn sizes_keep_the_ends_and_spacings_the_origin() {
    let directions = [[0.0, 1.0, 0.0], [0.6, 0.0, 0.8], [0.0, 0.0, 1.0]];
    let placed = World { space: Space::Patient, directions, ..World::default() };
    let volume = Volume::from_fn([11, 1, 113], [0.5, 3.0, 2.0], |x, y, z| uneven(x, y, z) as i16).unwrap();
    let volume = volume.with_world([-10.0, 20.0, 30.5], placed).unwrap();
    let new = to_size(&volume, [5, 1, 225], Filter::Linear);
    assert_eq!((new.dims, new.spacing), ([5, 1, 225], [1.25, 3.0, 1.0]));
    assert_eq!((new.origin, new.world), (volume.origin, volume.world));
    assert_eq!(world(&new, [4, 0, 224]), world(&volume, [10, 0, 112]));
    let (new, report) = resample(&volume, &how(NewGrid::Spacing([0.7, 9.0, 0.25]), Filter::Cubic)).unwrap();
    // 5 mm hold 7 steps of 0.7, and 224 mm 896 of 0.25; the single voxel stays.
    assert_eq!((new.dims, new.spacing, new.origin), ([8, 1, 897], [0.7, 3.0, 0.25], volume.origin));
    assert!(report.coarser);
    // 3·0.7/0.1 is 20.999999999999996: the last step is not lost to rounding.
    let sevenths = Volume::from_fn([4, 2, 2], [0.7; 3], |x, _, _| x as f32).unwrap();
    let (new, _) = resample(&sevenths, &how(NewGrid::Spacing([0.1, 0.7, 0.7]), Filter::Linear)).unwrap();
    assert_eq!((new.dims, new.value(21, 0, 0)), ([22, 2, 2], 3.0));
}

#[test]
fn turning_axes_and_resampling_commute() {
    let volume = Volume::from_fn([5, 4, 6], [1.0, 2.0, 0.5], |x, y, z| uneven(x, y, z) - 3.5).unwrap();
    let size = [12, 9, 4];
    for filter in FILTERS {
        let new = to_size(&volume, size, filter);
        for order in [[0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let (there, back) =
                (permuted(&new, order), to_size(&permuted(&volume, order), order.map(|a| size[a]), filter));
            assert_eq!((there.dims, there.spacing), (back.dims, back.spacing));
            there.to_f64().iter().zip(back.to_f64()).for_each(|(a, b)| assert_close(*a, b, 1e-12, "permuted"));
        }
        for turned in [[true, false, false], [false, true, false], [false, false, true], [true; 3]] {
            let (there, back) = (flipped::<f64>(&new, turned), to_size(&flipped::<f64>(&volume, turned), size, filter));
            there.to_f64().iter().zip(back.to_f64()).for_each(|(a, b)| assert_close(*a, b, 1e-12, "flipped"));
        }
    }
    let bytes = volume.map::<u8>(|v| 17.0 * (v + 3.5));
    let new = to_size(&bytes, [9, 7, 11], Filter::Linear);
    assert_eq!(flipped::<u8>(&new, [true; 3]), to_size(&flipped::<u8>(&bytes, [true; 3]), [9, 7, 11], Filter::Linear));
}

/// Axes turned by 20° about z and then 30° about x, with the third one leaning by 15° as of a tilted gantry.
fn tilted() -> World {
    let (s, c) = 20f64.to_radians().sin_cos();
    let (t, d) = 30f64.to_radians().sin_cos();
    let about_x = |[x, y, z]: [f64; 3]| [x, d * y - t * z, t * y + d * z];
    let (u, e) = 15f64.to_radians().sin_cos();
    let directions = [[c, s, 0.0], [-s, c, 0.0], [0.0, u, e]].map(about_x);
    World { space: Space::Patient, directions, ..World::default() }
}

#[test]
fn a_straight_grid_shows_the_world_as_it_is() {
    let of = |[x, y, z]: [f64; 3]| 0.5 * x - 0.25 * y + 0.125 * z + 11.0;
    let volume = Volume::from_fn([20, 16, 12], [0.8, 1.0, 2.5], |_, _, _| 0f64).unwrap();
    let mut volume = volume.with_world([-7.0, 3.0, 100.0], tilted()).unwrap();
    let values = voxels(volume.dims).map(|v| of(world(&volume, v))).collect();
    volume.samples = Samples::F64(values);
    let straight = Resampling { straight: true, filter: Filter::Linear, outside: Some(-1e6), ..Resampling::default() };
    let (new, report) = resample(&volume, &straight).unwrap();
    assert_eq!((new.spacing, new.world.directions), ([0.8; 3], World::default().directions));
    assert_eq!(new.world.space, Space::Patient);
    // The box holds all corners and is a step longer at most.
    let corners = [0, 1, 2].map(|a| {
        let along = |v: [usize; 3]| world(&volume, v)[a];
        let all = voxels([2, 2, 2]).map(|c| along([19 * c[0], 15 * c[1], 11 * c[2]]));
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), c| (lo.min(c), hi.max(c)))
    });
    let last = world(&new, new.dims.map(|n| n - 1));
    for a in 0..3 {
        assert_close(new.origin[a], corners[a].0, 1e-9, "origin");
        assert!((0.0..0.8).contains(&(last[a] - corners[a].1 + 1e-6)), "{last:?} {corners:?}");
    }
    let (mut inside, mut outside) = (0, 0);
    for v in voxels(new.dims) {
        let value = new.value(v[0], v[1], v[2]);
        if value == -1e6 {
            outside += 1;
        } else {
            inside += 1;
            assert_close(value, of(world(&new, v)), 1e-9, &format!("{v:?}"));
        }
    }
    assert_eq!(outside, report.outside);
    // As much inside as the slanted block has volume, but for its surface.
    let slant = glam::DMat3::from_cols_array_2d(&tilted().directions).determinant();
    let block = 19.0 * 0.8 * 15.0 * 11.0 * 2.5 * slant / 0.8f64.powi(3);
    assert_close(f64::from(inside), block, 0.02 * block, "voxels inside");
}

#[test]
fn a_straight_grid_has_the_spline_of_scipy() {
    // scipy 1.17.1, ndimage.map_coordinates(order=3, mode='mirror') at the places of a grid of 0.7 × 0.8 × 0.9.
    let figures = [
        ([5, 2, 1], 11.900566313255544),
        ([5, 3, 3], 7.786072888835469),
        ([2, 2, 4], 13.999415126960914),
        ([5, 5, 6], 11.278493057068204),
    ];
    let volume = Volume::from_fn([5, 4, 3], [1.0, 1.5, 2.0], uneven).unwrap();
    let volume = volume.with_world([10.0, -20.0, 5.0], tilted()).unwrap();
    let grid = NewGrid::Spacing([0.7, 0.8, 0.9]);
    let straight = Resampling { straight: true, grid, outside: Some(0.0), ..Resampling::default() };
    let (new, report) = resample(&volume, &straight).unwrap();
    assert_eq!((new.dims, report.outside), ([9; 3], 9 * 9 * 9 - 140));
    let origin = [8.460909355034492, -21.035276180410083, 5.0];
    (0..3).for_each(|a| assert_close(new.origin[a], origin[a], 1e-12, "origin"));
    for ([x, y, z], expected) in figures {
        assert_close(new.value(x, y, z), expected, 1e-12, &format!("({x}, {y}, {z})"));
    }
    assert_close(new.to_f64().iter().sum(), 1218.2583830808244, 1e-9, "sum");
}

#[test]
fn what_lies_straight_already_stays() {
    let placed = World { space: Space::Patient, ..World::default() };
    let volume = Volume::from_fn([3, 1, 4], [1.0, 5.0, 2.0], |x, y, z| uneven(x, y, z) as u16).unwrap();
    let volume = volume.with_world([1.0, 2.0, 3.0], placed).unwrap();
    let (new, _) = resample(&volume, &Resampling { straight: true, ..Resampling::default() }).unwrap();
    assert_eq!((new.dims, new.spacing, new.origin, new.world), ([3, 1, 7], [1.0, 5.0, 1.0], volume.origin, placed));
}

#[test]
fn turned_axes_are_straight_without_a_new_value() {
    // x to the back, y to the head, z to the left.
    let directions = [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]];
    let placed = World { space: Space::Patient, directions, ..World::default() };
    let volume = Volume::from_fn([5, 4, 3], [2.0; 3], uneven).unwrap().with_world([10.0, 20.0, 30.0], placed).unwrap();
    for filter in FILTERS {
        let straight = Resampling { straight: true, filter, ..Resampling::default() };
        let (new, report) = resample(&volume, &straight).unwrap();
        assert_eq!((new.dims, new.origin, report.outside), ([3, 5, 4], [6.0, 12.0, 30.0], 0));
        for [x, y, z] in voxels(volume.dims) {
            assert_close(new.value(2 - z, 4 - x, y), uneven(x, y, z), 1e-12, "turned");
        }
    }
}

#[test]
fn integers_are_rounded_saturated_and_counted() {
    let step = Volume::from_fn([8, 1, 1], [1.0; 3], |x, _, _| if x < 4 { 0u8 } else { 255 }).unwrap();
    let (new, report) = resample(&step, &how(NewGrid::Size([15, 1, 1]), Filter::Cubic)).unwrap();
    let exact = to_size(&step.map::<f64>(|v| v), [15, 1, 1], Filter::Cubic).to_f64();
    assert!(exact.iter().any(|v| *v < -1.0) && exact.iter().any(|v| *v > 256.0), "{exact:?}");
    let beyond = exact.iter().filter(|v| !(0.0..=255.0).contains(&v.round())).count() as u64;
    assert_eq!(report.clipped, beyond);
    let expected: Vec<f64> = exact.iter().map(|v| v.round().clamp(0.0, 255.0)).collect();
    assert_eq!(new.to_f64(), expected);
    let halves = Volume::new([2, 1, 1], [1.0; 3], Samples::I8(vec![-2, -1])).unwrap();
    assert_eq!(to_size(&halves, [3, 1, 1], Filter::Linear).to_f64(), [-2.0, -2.0, -1.0]);
}

#[test]
fn outside_is_the_least_value_or_the_one_given() {
    let volume = Volume::from_fn([6, 6, 6], [1.0; 3], |x, y, z| (x + y + z) as u8 + 40).unwrap();
    let volume = volume.with_world([0.0; 3], tilted()).unwrap();
    let straight = Resampling { straight: true, filter: Filter::Linear, ..Resampling::default() };
    assert_eq!(resample(&volume, &straight).unwrap().0.range().unwrap().0, 40.0);
    let given = Resampling { outside: Some(7.0), ..straight };
    assert_eq!(resample(&volume, &given).unwrap().0.range().unwrap().0, 7.0);
    for outside in [-1.0, 256.0, 0.5, f64::NAN] {
        let error = resample(&volume, &Resampling { outside: Some(outside), ..straight }).unwrap_err().to_string();
        assert!(error.contains("outside") && error.contains("u8"), "{error}");
    }
}

#[test]
fn a_hole_stays_a_hole_with_the_linear_filter_and_is_refused_by_the_cubic_one() {
    let volume =
        Volume::from_fn([5, 4, 3], [1.0; 3], |x, y, z| if [x, y, z] == [2, 1, 1] { f32::NAN } else { 1.0 }).unwrap();
    let error = resample(&volume, &how(NewGrid::Size([9, 7, 5]), Filter::Cubic)).unwrap_err().to_string();
    assert!(error.contains("(2, 1, 1) is NaN") && error.contains("linear"), "{error}");
    let new = to_size(&volume, [9, 7, 5], Filter::Linear);
    for [x, y, z] in voxels(new.dims) {
        let beside = x.abs_diff(4) < 2 && y.abs_diff(2) < 2 && z.abs_diff(2) < 2;
        assert_eq!(new.value(x, y, z).is_nan(), beside, "({x}, {y}, {z})");
    }
    // 7 times 0.1/0.7 is 1.0000000000000002: that is voxel 1 all the same, and nothing of voxel 2.
    let samples = Samples::F64(vec![4.0, 5.0, f64::NAN, 6.0]);
    let line = Volume::new([4, 1, 1], [0.7, 1.0, 1.0], samples).unwrap();
    let (new, _) = resample(&line, &how(NewGrid::Spacing([0.1, 1.0, 1.0]), Filter::Linear)).unwrap();
    assert_eq!([0, 7, 21].map(|x| new.value(x, 0, 0)), [4.0, 5.0, 6.0]);
    assert_eq!((8..21).filter(|&x| new.value(x, 0, 0).is_nan()).count(), 13);
}

#[test]
fn grids_that_cannot_be_are_refused() {
    let volume = Volume::from_fn([5, 4, 1], [1.0; 3], |x, _, _| x as u8).unwrap();
    let cases = [
        (NewGrid::Spacing([0.0, 1.0, 1.0]), "spacing"),
        (NewGrid::Spacing([1.0, f64::NAN, 1.0]), "spacing"),
        (NewGrid::Spacing([1.0, 3.1, 1.0]), "single voxel along y"),
        (NewGrid::Size([0, 4, 1]), "size"),
        (NewGrid::Size([5, 1, 1]), "1 for an axis of 4, y"),
        (NewGrid::Size([5, 4, 2]), "2 for an axis of 1, z"),
    ];
    for (grid, words) in cases {
        let error = resample(&volume, &how(grid, Filter::Linear)).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let straight = Resampling { straight: true, ..Resampling::default() };
    let error = resample(&volume, &straight).unwrap_err().to_string();
    assert!(error.contains("straight") && error.contains("does not say"), "{error}");
    // More than 2^64 voxels.
    let fine = how(NewGrid::Spacing([1e-300, 1.0, 1.0]), Filter::Linear);
    assert!(matches!(resample(&volume, &fine), Err(VolumeError::TooLarge { .. })));
}

#[test]
fn memory_is_checked_before_it_is_taken() {
    let volume = Volume::from_fn([10, 10, 10], [1.0; 3], |x, _, _| x as u16).unwrap();
    // 10·10·19 samples of 2 bytes; on the way 10·10·10 reals of 8, and four voxels with their weights for each of 19 slices.
    let needs = 3800 + 8000 + 19 * 64;
    let with =
        |limit| Resampling { memory_limit_bytes: Some(limit), ..how(NewGrid::Size([10, 10, 19]), Filter::Cubic) };
    assert!(resample(&volume, &with(needs)).is_ok());
    let Err(VolumeError::TooLarge { needed, limit, sample_type, .. }) = resample(&volume, &with(needs - 1)) else {
        panic!("beyond the limit");
    };
    assert_eq!((needed, limit, sample_type), (needs.to_string(), needs - 1, SampleType::U16));
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    // Slices of more numbers than a thread takes at once.
    let volume = Volume::from_fn([200, 190, 5], [1.0, 1.0, 2.5], |x, y, z| uneven(x, y, z).sqrt()).unwrap();
    let oblique = volume.clone().with_world([0.0; 3], tilted()).unwrap();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let straight = Resampling { straight: true, grid: NewGrid::Spacing([3.0; 3]), ..Resampling::default() };
            (resample(&volume, &Resampling::default()).unwrap(), resample(&oblique, &straight).unwrap())
        })
    };
    assert_eq!(on(1), on(3));
}

/// Labels stay labels: each new voxel is an old one, the nearest, on every kind of grid.
#[test]
fn the_nearest_filter_makes_no_new_value() {
    let labels = [0u8, 3, 7, 200];
    let volume = Volume::from_fn([5, 4, 6], [1.0, 1.0, 2.0], |x, y, z| labels[(x * 7 + y * 3 + z * 5) % 4]).unwrap();
    let how = |grid| Resampling { grid, filter: Filter::Nearest, ..Resampling::default() };
    let (cubes, report) = resample(&volume, &how(NewGrid::Cubes)).unwrap();
    assert_eq!((cubes.dims, report.clipped), ([5, 4, 11], 0));
    for index in 0..cubes.len() {
        let [x, y, z] = cubes.position(index);
        // Half-way is forward.
        assert_eq!(cubes.value(x, y, z), volume.value(x, y, z.div_ceil(2)), "({x}, {y}, {z})");
    }
    let (sin, cos) = 20f64.to_radians().sin_cos();
    let directions = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]];
    let world = World { space: Space::Patient, directions, ..World::default() };
    let oblique = volume.with_world([0.0; 3], world).unwrap();
    let straight = resample(&oblique, &Resampling { straight: true, ..how(NewGrid::Cubes) }).unwrap().0;
    assert!(straight.to_f64().iter().all(|v| labels.iter().any(|&l| f64::from(l) == *v)));
}
