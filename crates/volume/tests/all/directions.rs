//! Axes as files say that they run, and the grid that is drawn.

use cube3_cases::cases;
use cube3_volume::{
    AxisOrder, FileFormat, Ordering, RawLayout, ReadOptions, SampleType, Space, Volume, inspect, read, read_bytes,
};
use proptest::prelude::*;

/// Puts bytes into a header, at a place.
type Put<'a> = &'a mut dyn FnMut(usize, &[u8]);

/// A number for each voxel of a grid that is stored in the world's order, x fastest.
fn world_value([nx, ny, _]: [usize; 3], [x, y, z]: [usize; 3]) -> u16 {
    ((z * ny + y) * nx + x) as u16
}

/// The signed permutations of three axes.
fn orders() -> impl Iterator<Item = AxisOrder> {
    let axes = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    axes.into_iter()
        .flat_map(|axis| (0..8).map(move |flips| AxisOrder { axis, backward: [0, 1, 2].map(|i| flips >> i & 1 == 1) }))
}

/// The numbers of a grid of `dims` in the world's order, stored along `order`: little-endian, fastest stored axis first.
fn stored(dims: [usize; 3], order: AxisOrder) -> ([usize; 3], Vec<u8>) {
    let sizes = order.turn_back(dims);
    let mut bytes = Vec::new();
    for k in 0..sizes[2] {
        for j in 0..sizes[1] {
            for i in 0..sizes[0] {
                let along =
                    [0, 1, 2].map(|s| if order.backward[s] { sizes[s] - 1 - [i, j, k][s] } else { [i, j, k][s] });
                bytes.extend(world_value(dims, order.turn(along)).to_le_bytes());
            }
        }
    }
    (sizes, bytes)
}

const SPACING: [f64; 3] = [0.5, 1.25, 2.0];
/// Of the voxel with the least x, y and z.
const CORNER: [f64; 3] = [-20.0, 8.0, 3.5];

/// The steps along the stored axes in RAS, and where the first stored voxel lies.
fn steps(dims: [usize; 3], order: AxisOrder) -> ([[f64; 3]; 3], [f64; 3]) {
    let mut origin = CORNER;
    let steps = [0, 1, 2].map(|s| {
        let axis = order.axis[s];
        let mut step = [0.0; 3];
        step[axis] = if order.backward[s] { -SPACING[axis] } else { SPACING[axis] };
        if order.backward[s] {
            origin[axis] += SPACING[axis] * (dims[axis] - 1) as f64;
        }
        step
    });
    (steps, origin)
}

fn nrrd(space: &str, signs: [f64; 3], dims: [usize; 3], order: AxisOrder) -> Vec<u8> {
    let (sizes, numbers) = stored(dims, order);
    let (steps, origin) = steps(dims, order);
    let vector = |v: [f64; 3]| format!("({},{},{})", v[0] * signs[0], v[1] * signs[1], v[2] * signs[2]);
    let [a, b, c] = sizes;
    let header = format!(
        "NRRD0004\ntype: ushort\ndimension: 3\nspace: {space}\nsizes: {a} {b} {c}\nspace directions: {} {} {}\n\
         space origin: {}\nendian: little\nencoding: raw\n\n",
        vector(steps[0]),
        vector(steps[1]),
        vector(steps[2]),
        vector(origin)
    );
    [header.as_bytes(), &numbers].concat()
}

fn metaimage(dims: [usize; 3], order: AxisOrder) -> Vec<u8> {
    let (sizes, numbers) = stored(dims, order);
    let (steps, [x, y, z]) = steps(dims, order);
    let spacing = order.turn_back(SPACING);
    let mut matrix = String::new();
    for (step, s) in steps.iter().zip(spacing) {
        matrix += &format!(" {} {} {}", -step[0] / s, -step[1] / s, step[2] / s);
    }
    let three = |v: [f64; 3]| format!("{} {} {}", v[0], v[1], v[2]);
    let header = format!(
        "ObjectType = Image\nNDims = 3\nTransformMatrix ={matrix}\nOffset = {}\nElementSpacing = {}\nDimSize = {} {} {}\n\
         ElementType = MET_USHORT\nElementDataFile = LOCAL\n",
        three([-x, -y, z]),
        three(spacing),
        sizes[0],
        sizes[1],
        sizes[2]
    );
    [header.as_bytes(), &numbers].concat()
}

/// A NIfTI-1 header and what follows it; `sform` or a quaternion with its handedness.
fn nifti(sizes: [usize; 3], spacing: [f64; 3], numbers: &[u8], place: &dyn Fn(Put)) -> Vec<u8> {
    let mut file = vec![0; 352];
    let mut put = |at: usize, bytes: &[u8]| file[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &348i32.to_le_bytes());
    for (i, n) in [3, sizes[0], sizes[1], sizes[2], 1, 1, 1, 1].into_iter().enumerate() {
        put(40 + 2 * i, &(n as i16).to_le_bytes());
    }
    put(70, &512i16.to_le_bytes());
    put(72, &16i16.to_le_bytes());
    for (i, s) in [1.0, spacing[0], spacing[1], spacing[2]].into_iter().enumerate() {
        put(76 + 4 * i, &(s as f32).to_le_bytes());
    }
    put(108, &352f32.to_le_bytes());
    put(344, b"n+1\0");
    place(&mut put);
    file.extend(numbers);
    file
}

fn sform(dims: [usize; 3], order: AxisOrder) -> Vec<u8> {
    let (sizes, numbers) = stored(dims, order);
    let (steps, origin) = steps(dims, order);
    nifti(sizes, order.turn_back(SPACING), &numbers, &|put| {
        put(254, &1i16.to_le_bytes());
        for row in 0..3 {
            let values = [steps[0][row], steps[1][row], steps[2][row], origin[row]];
            for (i, value) in values.into_iter().enumerate() {
                put(280 + 16 * row + 4 * i, &(value as f32).to_le_bytes());
            }
        }
    })
}

fn qform(dims: [usize; 3], order: AxisOrder) -> Vec<u8> {
    let (sizes, numbers) = stored(dims, order);
    let (steps, origin) = steps(dims, order);
    let spacing = order.turn_back(SPACING);
    let mut unit = [0, 1, 2].map(|s| glam::DVec3::from(steps[s]) / spacing[s]);
    let left_handed = unit[0].cross(unit[1]).dot(unit[2]) < 0.0;
    if left_handed {
        unit[2] = -unit[2];
    }
    let mut turn = glam::DQuat::from_mat3(&glam::DMat3::from_cols(unit[0], unit[1], unit[2]));
    if turn.w < 0.0 {
        turn = -turn;
    }
    nifti(sizes, spacing, &numbers, &|put| {
        put(252, &1i16.to_le_bytes());
        put(76, &(if left_handed { -1f32 } else { 1.0 }).to_le_bytes());
        for (i, value) in [turn.x, turn.y, turn.z, origin[0], origin[1], origin[2]].into_iter().enumerate() {
            put(256 + 4 * i, &(value as f32).to_le_bytes());
        }
    })
}

fn take(bytes: &[u8], format: FileFormat) -> Volume {
    read_bytes(bytes, Some(format), "t", &ReadOptions::default()).unwrap()
}

/// The bits and the place are those of a volume that is stored in the world's order.
#[track_caller]
fn assert_in_world_order(volume: &Volume, dims: [usize; 3], order: AxisOrder, what: &str) {
    assert_eq!((volume.dims, volume.world.taken), (dims, order), "{what} {order:?}");
    let numbers: Vec<f64> = (0..dims.iter().product()).map(|i: usize| i as f64).collect();
    assert_eq!(volume.to_f64(), numbers, "{what} {order:?}");
    let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5);
    assert!(near(volume.spacing, SPACING) && near(volume.origin, CORNER), "{what} {order:?}: {:?}", volume.origin);
    assert!(volume.world.left_over().is_straight(), "{what} {order:?}");
}

#[test]
fn all_48_orders_of_axes_in_every_format_give_the_bits_of_the_worlds_order() {
    let dims = [4, 3, 2];
    for order in orders() {
        for (space, signs) in [
            ("right-anterior-superior", [1.0, 1.0, 1.0]),
            ("LPS", [-1.0, -1.0, 1.0]),
            ("left-anterior-superior", [-1.0, 1.0, 1.0]),
            ("scanner-xyz", [1.0, 1.0, 1.0]),
            ("3D-left-handed", [1.0, 1.0, -1.0]),
        ] {
            assert_in_world_order(&take(&nrrd(space, signs, dims, order), FileFormat::Nrrd), dims, order, space);
        }
        assert_in_world_order(&take(&metaimage(dims, order), FileFormat::MetaImage), dims, order, "metaimage");
        assert_in_world_order(&take(&sform(dims, order), FileFormat::Nifti), dims, order, "sform");
        assert_in_world_order(&take(&qform(dims, order), FileFormat::Nifti), dims, order, "qform");
        // As stored nothing moves in memory, and the letters say where the axes lead.
        let options = ReadOptions { ordering: Ordering::AsStored, ..ReadOptions::default() };
        let as_stored = read_bytes(&sform(dims, order), Some(FileFormat::Nifti), "t", &options).unwrap();
        let (sizes, bytes) = stored(dims, order);
        assert_eq!((as_stored.dims, as_stored.world.taken), (sizes, AxisOrder::default()));
        assert_eq!(as_stored.to_f64()[1], f64::from(u16::from_le_bytes([bytes[2], bytes[3]])));
        assert_eq!(as_stored.world.stored_letters(), order.letters(Space::Patient));
        assert_eq!(as_stored.world.letters(), order.letters(Space::Patient));
    }
}

#[test]
fn volumes_of_several_blocks_are_turned_alike() {
    // 5 MB: more than a block, and slices of which several fit into one.
    let dims = [150, 130, 140];
    let words = |x: usize, y: usize, z: usize| (x * 31 + y * 517 + z * 7919) as u16;
    for axis in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        let order = AxisOrder { axis, backward: [true, false, true] };
        let sizes = order.turn_back(dims);
        let mut bytes = nrrd("RAS", [1.0; 3], dims, order);
        let start = bytes.len() - 2 * sizes.iter().product::<usize>();
        for (index, number) in bytes[start..].chunks_exact_mut(2).enumerate() {
            let at = [index % sizes[0], index / sizes[0] % sizes[1], index / sizes[0] / sizes[1]];
            let [x, y, z] = order.turn([0, 1, 2].map(|s| if order.backward[s] { sizes[s] - 1 - at[s] } else { at[s] }));
            number.copy_from_slice(&words(x, y, z).to_le_bytes());
        }
        let volume = take(&bytes, FileFormat::Nrrd);
        assert_eq!((volume.dims, volume.world.taken), (dims, order));
        let wanted = Volume::from_fn(dims, SPACING, words).unwrap();
        assert!(volume.samples == wanted.samples, "{axis:?}");
    }
}

/// A number that does not fit is told by its place in the file, wherever its voxel goes.
#[test]
fn a_number_that_does_not_fit_is_counted_as_it_is_stored() {
    for directions in [
        "(1,0,0) (0,1,0) (0,0,1)",
        "(-1,0,0) (0,-1,0) (0,0,1)",
        "(0,0,-1) (1,0,0) (0,-1,0)",
        "(0,1,0) (0,0,1) (-1,0,0)",
    ] {
        for bad in 0..24 {
            let numbers = (0..24).flat_map(|i| if i == bad { 1i64 << 40 } else { i }.to_le_bytes());
            let header = format!(
                "NRRD0004\ntype: int64\ndimension: 3\nspace: RAS\nsizes: 4 3 2\nspace directions: {directions}\n\
                 endian: little\nencoding: raw\n\n"
            );
            let bytes: Vec<u8> = header.bytes().chain(numbers).collect();
            let error =
                read_bytes(&bytes, Some(FileFormat::Nrrd), "t", &ReadOptions::default()).unwrap_err().to_string();
            assert!(error.contains(&format!("1099511627776 at number {bad} ")), "{directions}: {error}");
        }
    }
}

/// A NIfTI-1 whose sform has these columns.
fn with_columns(columns: [[f64; 3]; 3]) -> Volume {
    let spacing = columns.map(|c| glam::DVec3::from(c).length());
    let numbers: Vec<u8> = (0..24u16).flat_map(u16::to_le_bytes).collect();
    let bytes = nifti([4, 3, 2], spacing, &numbers, &|put| {
        put(254, &2i16.to_le_bytes());
        for row in 0..3 {
            for (i, column) in columns.iter().enumerate() {
                put(280 + 16 * row + 4 * i, &(column[row] as f32).to_le_bytes());
            }
        }
    });
    take(&bytes, FileFormat::Nifti)
}

#[test]
fn what_a_turn_of_axes_leaves_over_is_named_with_its_angle() {
    let (sin, cos) = 20f64.to_radians().sin_cos();
    // Turned by 20° about z; x backward.
    let oblique = with_columns([[-cos, -sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 2.0]]);
    let left = oblique.world.left_over();
    assert!((left.turned_deg - 20.0).abs() < 1e-4 && left.slanted_deg < 1e-4, "{left:?}");
    assert_eq!(oblique.world.stored_letters(), "LAS");
    assert_eq!(oblique.world.letters(), "RAS");
    assert!(left.in_words().unwrap().contains("20.0°"), "{left:?}");
    // A gantry tilted by 15°: slices across z, each displaced along y.
    let (sin, cos) = 15f64.to_radians().sin_cos();
    let tilted = with_columns([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 3.0 * sin, 3.0 * cos]]);
    let left = tilted.world.left_over();
    assert!((left.slanted_deg - 15.0).abs() < 1e-4 && left.turned_deg < 1e-4, "{left:?}");
    assert!(left.in_words().unwrap().contains("gantry"), "{left:?}");
    assert!((tilted.spacing[2] - 3.0).abs() < 1e-6);
    // A half turn about an oblique axis is one of axes alone.
    let half = with_columns([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]);
    assert!(half.world.left_over().in_words().is_none());
}

#[test]
fn sides_of_a_direction() {
    let volume = with_columns([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    for (vector, side) in [
        ([1.0, 0.0, 0.0], "R"),
        ([0.0, -2.0, 0.0], "P"),
        ([0.0, 0.1, -1.0], "I"),
        ([-1.0, 0.8, 0.0], "LA"),
        ([0.5, 0.6, 0.7], "SAR"),
        ([0.0; 3], ""),
    ] {
        assert_eq!(volume.world.side(vector), side, "{vector:?}");
    }
}

#[test]
fn a_space_that_is_not_named_leaves_the_grid_as_it_is() {
    let bytes = nrrd("RAS", [1.0; 3], [4, 3, 2], AxisOrder { axis: [0, 1, 2], backward: [true, false, false] });
    let at = bytes.windows(11).position(|w| w == b"space: RAS\n").unwrap();
    let named: Vec<u8> = [&bytes[..at], b"space dimension: 3\n", &bytes[at + 11..]].concat();
    let volume = take(&named, FileFormat::Nrrd);
    assert_eq!((volume.world.space, volume.value(0, 0, 0)), (Space::Unknown, 3.0));
    assert_eq!(volume.world.directions[0], [-1.0, 0.0, 0.0]);
    let raw = ReadOptions { raw: Some(RawLayout::new([4, 3, 2], SampleType::U16)), ..ReadOptions::default() };
    let volume = read_bytes(&bytes[bytes.len() - 48..], Some(FileFormat::Raw), "t.raw", &raw).unwrap();
    assert_eq!((volume.world.space, volume.value(0, 0, 0)), (Space::Unknown, 3.0));
}

#[test]
fn a_header_is_enough_to_know_what_a_file_holds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.nrrd");
    let order = AxisOrder { axis: [1, 2, 0], backward: [true, false, true] };
    std::fs::write(&path, nrrd("RAS", [1.0; 3], [4, 3, 2], order)).unwrap();
    let (info, volume) =
        (inspect(&path, &ReadOptions::default()).unwrap(), read(&path, &ReadOptions::default()).unwrap());
    assert_eq!((info.dims, info.stored_dims), ([4, 3, 2], [3, 2, 4]));
    assert_eq!((info.spacing, info.origin, info.world), (volume.spacing, volume.origin, volume.world));
    assert_eq!((info.sample_type, info.volumes, info.bytes()), (SampleType::U16, 1, 48));
    assert_eq!(info.format, FileFormat::Nrrd);
}

proptest! {
    #![proptest_config(cases(256))]

    /// The grid's own place of every voxel is where the file's affine puts the stored one, whatever the directions.
    #[test]
    fn no_voxel_moves_in_the_world(
        turn in prop::array::uniform3(-3.2f64..3.2),
        slant in -0.4f64..0.4,
        spacing in prop::array::uniform3(0.3f64..4.0),
        flip in any::<bool>(),
    ) {
        let r = glam::DMat3::from_euler(glam::EulerRot::XYZ, turn[0], turn[1], turn[2]);
        let mut columns = [r.x_axis, r.y_axis, (r.z_axis + r.y_axis * slant).normalize()];
        if flip {
            columns[1] = -columns[1];
        }
        let steps = [0, 1, 2].map(|i| (columns[i] * spacing[i]).to_array());
        let volume = with_columns(steps);
        // Numbers are stored in the order 0, 1, 2 … of a grid of 4 × 3 × 2.
        for index in 0..24 {
            let [x, y, z] = volume.position(index);
            let number = volume.value(x, y, z) as usize;
            let stored = [number % 4, number / 4 % 3, number / 12];
            let wanted: glam::DVec3 = (0..3).map(|i| glam::DVec3::from(steps[i]) * stored[i] as f64).sum();
            let at = [x, y, z];
            let here: glam::DVec3 = glam::DVec3::from(volume.origin)
                + (0..3).map(|a| glam::DVec3::from(volume.world.directions[a]) * volume.spacing[a] * at[a] as f64).sum::<glam::DVec3>();
            prop_assert!((here - wanted).length() < 1e-4, "{here} for {wanted}");
        }
        // No other signed order of the axes is closer to the world's.
        let along = |order: &AxisOrder| (0..3).map(|s| {
            let d = volume.world.directions[order.axis[s]][s];
            if order.backward[s] { -d } else { d }
        }).sum::<f64>();
        let best = along(&AxisOrder::default());
        prop_assert!(orders().all(|order| along(&order) <= best + 1e-6));
    }
}
