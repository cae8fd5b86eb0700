//! What is written is read back, and what was there is never lost.

use cube3_volume::{
    Endian, Ordering, Packing, RawLayout, ReadOptions, SampleType, Samples, Space, Volume, World, check_name, read,
    write, write_packed, write_raw,
};

/// A volume of the type, with its extremes, at awkward spacing.
fn volume(sample_type: SampleType) -> Volume {
    let samples = match sample_type {
        SampleType::U8 => Samples::U8((0..24).map(|i| i * 11).collect()),
        SampleType::I8 => Samples::I8((0..24).map(|i| i8::MIN + i * 5).collect()),
        SampleType::U16 => Samples::U16((0..24).map(|i| i * 2849).collect()),
        SampleType::I16 => Samples::I16((0..24).map(|i| i16::MIN + i * 1400).collect()),
        SampleType::U32 => Samples::U32((0..24).map(|i| u32::MAX - i * 77_777_777).collect()),
        SampleType::I32 => Samples::I32((0..24).map(|i| i32::MIN + i * 77_777_777).collect()),
        SampleType::F32 => Samples::F32((0..24).map(|i| (i as f32).exp() * f32::MIN_POSITIVE).collect()),
        SampleType::F64 => Samples::F64((0..24).map(|i| (i as f64).exp() / 3.0).collect()),
    };
    Volume::new([2, 3, 4], [0.1, 1.0 / 3.0, 1e-7], samples).unwrap().with_origin([-1e9, 0.2, 3.5]).unwrap()
}

#[test]
fn nrrd_comes_back_with_every_bit() {
    let folder = tempfile::tempdir().unwrap();
    for sample_type in SampleType::ALL {
        for packing in [Packing::Plain, Packing::Compressed] {
            let path = folder.path().join("v.nrrd");
            let before = volume(sample_type);
            assert!(write_packed(&path, &before, packing).unwrap().is_empty());
            assert_eq!(read(&path, &ReadOptions::default()).unwrap(), before);
        }
    }
}

#[test]
fn raw_comes_back_in_both_byte_orders() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("v.raw");
    for sample_type in SampleType::ALL {
        for endian in [Endian::Little, Endian::Big] {
            let before = volume(sample_type);
            write_raw(&path, &before, endian).unwrap();
            let layout = RawLayout {
                endian,
                spacing: before.spacing,
                origin: before.origin,
                ..RawLayout::new(before.dims, sample_type)
            };
            let options = ReadOptions { raw: Some(layout), ..ReadOptions::default() };
            assert_eq!(read(&path, &options).unwrap(), before);
        }
    }
}

#[test]
fn the_same_volume_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a.nrrd", "b.nrrd"].map(|name| folder.path().join(name));
    write(&a, &volume(SampleType::F32)).unwrap();
    write(&b, &volume(SampleType::F32)).unwrap();
    assert_eq!(std::fs::read(a).unwrap(), std::fs::read(b).unwrap());
}

#[test]
fn a_refused_write_leaves_the_old_file_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("old.bin");
    std::fs::write(&path, "old").unwrap();
    let error = write(&path, &volume(SampleType::U8)).unwrap_err().to_string();
    assert!(error.contains("old.bin") && error.contains(".nrrd"), "{error}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
    // A folder in the file's place: the rename fails after all has been written.
    let taken = folder.path().join("taken.nrrd");
    std::fs::create_dir(&taken).unwrap();
    std::fs::write(taken.join("inside"), "old").unwrap();
    assert!(write(&taken, &volume(SampleType::U8)).is_err());
    assert!(write(folder.path().join("no/such/folder.nrrd"), &volume(SampleType::U8)).is_err());
    let mut names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["old.bin", "taken.nrrd"]);
}

#[test]
fn names_of_two_files_are_refused_with_the_one_that_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let names = [("v.nhdr", ".nrrd"), ("v.mhd", ".mha"), ("v.hdr", ".nii or .nii.gz"), ("v.img", ".nii or .nii.gz")];
    for (name, instead) in names {
        let error = write(folder.path().join(name), &volume(SampleType::U8)).unwrap_err().to_string();
        assert!(error.contains(name) && error.ends_with(&format!("give a name that ends in {instead}")), "{error}");
        assert_eq!(
            check_name(name).unwrap_err().to_string().split_once(": ").unwrap().1,
            error.split_once(": ").unwrap().1
        );
    }
    let error = write_packed(folder.path().join("v.nii.gz"), &volume(SampleType::U8), Packing::Plain).unwrap_err();
    assert!(error.to_string().ends_with("give a name that ends in .nii"), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A patient's grid of 2×1×2 bytes: x to the back, y to the head, z to the left; a left-handed one.
fn placed(space: Space) -> Volume {
    let directions = [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]];
    let directions = if space == Space::Patient { [directions[0], directions[1], [1.0, 0.0, 0.0]] } else { directions };
    let samples = Samples::U8(vec![1, 2, 3, 4]);
    let volume = Volume::new([2, 1, 2], [0.1, 2.5, 1.0], samples).unwrap();
    volume.with_world([-1.5, 20.0, 0.0], World { space, directions, ..World::default() }).unwrap()
}

/// What stands in the file, and the remarks.
fn written(name: &str, volume: &Volume) -> (Vec<u8>, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    let remarks = write_packed(&path, volume, Packing::Plain).unwrap();
    (std::fs::read(path).unwrap(), remarks)
}

#[test]
fn the_header_of_an_nrrd_to_the_byte() {
    let header = |space: &str| {
        format!(
            "NRRD0005\ntype: uint8\ndimension: 3\n{space}\nsizes: 2 1 2\n\
             space directions: (0,-0.1,0) (0,0,2.5) (SIDE,0,0)\nspace origin: (-1.5,20,0)\n\
             kinds: domain domain domain\nendian: little\nencoding: raw\n\n\u{1}\u{2}\u{3}\u{4}"
        )
    };
    let cases = [
        (Space::Patient, "space: right-anterior-superior", "1"),
        (Space::Room, "space: 3D-right-handed", "-1"),
        (Space::Unknown, "space dimension: 3", "-1"),
    ];
    for (space, line, side) in cases {
        let (bytes, remarks) = written("v.nrrd", &placed(space));
        assert_eq!(String::from_utf8(bytes).unwrap(), header(line).replace("SIDE", side));
        assert!(remarks.is_empty(), "{remarks:?}");
    }
}

#[test]
fn the_header_of_a_metaimage_to_the_byte() {
    let header = |place: &str| {
        format!(
            "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n\
             CompressedData = False\n{place}\nElementSpacing = 0.1 2.5 1\nDimSize = 2 1 2\n\
             ElementType = MET_UCHAR\nElementDataFile = LOCAL\n\u{1}\u{2}\u{3}\u{4}"
        )
    };
    // LPS, and each axis by the side that it comes from.
    let patient = "TransformMatrix = 0 1 0 0 0 1 -1 0 0\nOffset = 1.5 -20 0\nCenterOfRotation = 0 0 0\n\
                   AnatomicalOrientation = AIL";
    let other = "TransformMatrix = 0 1 0 0 0 1 1 0 0\nOffset = 1.5 -20 0\nCenterOfRotation = 0 0 0\n\
                 AnatomicalOrientation = AIR";
    for (space, place, words) in [
        (Space::Patient, patient, None),
        (Space::Room, other, Some("no room")),
        (Space::Unknown, other, Some("not known")),
    ] {
        let (bytes, remarks) = written("v.mha", &placed(space));
        assert_eq!(String::from_utf8(bytes).unwrap(), header(place));
        assert_eq!(remarks.len(), usize::from(words.is_some()), "{remarks:?}");
        words.iter().for_each(|words| assert!(remarks[0].contains(words), "{remarks:?}"));
    }
    let unknown = Volume { world: World::default(), ..placed(Space::Unknown) };
    let (bytes, remarks) = written("v.mha", &unknown);
    assert_eq!(String::from_utf8(bytes).unwrap(), header("Offset = -1.5 20 0\nCenterOfRotation = 0 0 0"));
    assert!(remarks.is_empty(), "{remarks:?}");
}

#[test]
fn a_compressed_metaimage_says_how_long_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("v.mha");
    write(&path, &placed(Space::Patient)).unwrap();
    let bytes = std::fs::read(path).unwrap();
    let end = bytes.windows(6).position(|w| w == b"LOCAL\n").unwrap() + 6;
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    let length = format!("CompressedData = True\nCompressedDataSize = {}\n", bytes.len() - end);
    assert!(header.contains(&length), "{header}");
}

/// A number of a NIfTI header.
fn f32_at(bytes: &[u8], at: usize) -> f32 {
    f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn i16_at(bytes: &[u8], at: usize) -> i16 {
    i16::from_le_bytes(bytes[at..at + 2].try_into().unwrap())
}

/// The rows of the 3×4 matrix that qfac, quaternion and offset stand for: the standard's own formula.
fn by_quaternion(bytes: &[u8]) -> [[f32; 4]; 3] {
    let [b, c, d] = [256, 260, 264].map(|at| f32_at(bytes, at));
    let a = (1.0 - b * b - c * c - d * d).max(0.0).sqrt();
    let turn = [
        [a * a + b * b - c * c - d * d, 2.0 * (b * c - a * d), 2.0 * (b * d + a * c)],
        [2.0 * (b * c + a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d - a * b)],
        [2.0 * (b * d - a * c), 2.0 * (c * d + a * b), a * a + d * d - c * c - b * b],
    ];
    let scale = [f32_at(bytes, 80), f32_at(bytes, 84), f32_at(bytes, 88) * f32_at(bytes, 76)];
    [0, 1, 2].map(|row| {
        let [x, y, z] = [0, 1, 2].map(|column| turn[row][column] * scale[column]);
        [x, y, z, f32_at(bytes, 268 + 4 * row)]
    })
}

fn by_rows(bytes: &[u8]) -> [[f32; 4]; 3] {
    [0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| f32_at(bytes, 280 + 16 * row + 4 * column)))
}

#[test]
fn the_header_of_a_nifti_to_the_byte() {
    let (bytes, remarks) = written("v.nii", &placed(Space::Patient));
    assert!(remarks.is_empty(), "{remarks:?}");
    let mut expected = vec![0; 352];
    let mut put = |at: usize, bytes: &[u8]| expected[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &348i32.to_le_bytes());
    for (axis, size) in [3i16, 2, 1, 2, 1, 1, 1, 1].into_iter().enumerate() {
        put(40 + 2 * axis, &size.to_le_bytes());
    }
    put(70, &2i16.to_le_bytes());
    put(72, &8i16.to_le_bytes());
    for (axis, number) in [-1f32, 0.1, 2.5, 1.0].into_iter().enumerate() {
        put(76 + 4 * axis, &number.to_le_bytes());
    }
    put(108, &352f32.to_le_bytes());
    put(112, &1f32.to_le_bytes());
    put(123, &[2]);
    put(252, &1i16.to_le_bytes());
    put(254, &1i16.to_le_bytes());
    // A third of a turn: (1, −1, −1)/2 with the third axis turned round.
    for (field, number) in [0.5f32, -0.5, -0.5, -1.5, 20.0, 0.0].into_iter().enumerate() {
        put(256 + 4 * field, &number.to_le_bytes());
    }
    let rows = [[0f32, 0.0, 1.0, -1.5], [-0.1, 0.0, 0.0, 20.0], [0.0, 2.5, 0.0, 0.0]];
    for (field, number) in rows.into_iter().flatten().enumerate() {
        put(280 + 4 * field, &number.to_le_bytes());
    }
    put(344, b"n+1\0");
    assert_eq!(by_quaternion(&bytes), rows);
    assert_eq!(bytes[..352], expected);
    assert_eq!(bytes[352..], [1, 2, 3, 4]);
}

#[test]
fn both_forms_of_a_nifti_say_the_same_and_a_slant_has_but_one() {
    let mut seen = 0;
    for (turn_x, turn_z) in [(0.1, 0.0), (3.0, 1.0), (-2.0, 3.1), (1.6, -1.6), (std::f64::consts::PI, 0.0)] {
        for side in [1.0, -1.0] {
            let turn = glam::DMat3::from_rotation_z(turn_z) * glam::DMat3::from_rotation_x(turn_x);
            let directions = [turn.x_axis, turn.y_axis, turn.z_axis * side].map(|d| d.to_array());
            let mut volume = placed(Space::Patient);
            volume.world.directions = directions;
            let (bytes, _) = written("v.nii", &volume);
            assert_eq!((i16_at(&bytes, 252), i16_at(&bytes, 254), f32_at(&bytes, 76)), (1, 1, side as f32));
            for (q, s) in by_quaternion(&bytes).into_iter().flatten().zip(by_rows(&bytes).into_iter().flatten()) {
                // Near half a turn the left-out part of the quaternion is the root of a small difference.
                assert!((q - s).abs() < 3e-3, "{q} {s}");
                seen += 1;
            }
            let slant = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.6, 0.8]];
            volume.world.directions = slant;
            let (bytes, _) = written("v.nii", &volume);
            assert_eq!((i16_at(&bytes, 252), i16_at(&bytes, 254)), (0, 1));
            assert_eq!(by_rows(&bytes)[1], [0.0, 2.5, 0.6, 20.0]);
        }
    }
    assert_eq!(seen, 120);
}

#[test]
fn nifti_says_what_it_cannot_keep() {
    let (bytes, remarks) = written("v.nii", &placed(Space::Room));
    assert_eq!((i16_at(&bytes, 252), i16_at(&bytes, 254)), (1, 1));
    assert!(remarks[0].contains("no room"), "{remarks:?}");
    let (bytes, remarks) = written("v.nii", &placed(Space::Unknown));
    assert_eq!((i16_at(&bytes, 252), i16_at(&bytes, 254), bytes[123]), (0, 0, 0));
    assert!(remarks[0].contains("lost"), "{remarks:?}");
    let nowhere = Volume { world: World::default(), origin: [0.0; 3], ..placed(Space::Unknown) };
    assert!(written("v.nii", &nowhere).1.is_empty());
}

#[test]
fn what_nifti_cannot_hold_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("v.nii");
    let refused = |volume: &Volume, words: &str| {
        let error = write(&path, volume).unwrap_err().to_string();
        assert!(error.contains(words) && error.contains(".nrrd"), "{error}");
    };
    let long = |n: usize| Volume::new([1, n, 1], [1.0; 3], Samples::U8(vec![0; n])).unwrap();
    refused(&long(32768), "32768");
    assert!(!path.exists());
    write(&path, &long(32767)).unwrap();
    refused(&Volume { spacing: [1e39, 1.0, 1.0], ..placed(Space::Patient) }, "1e39");
    refused(&Volume { spacing: [1.0, 1e-40, 1.0], ..placed(Space::Patient) }, "1e-40");
    refused(&Volume { origin: [0.0, -1e39, 0.0], ..placed(Space::Patient) }, "-1e39");
}

#[test]
fn raw_says_where_directions_are_lost() {
    assert!(written("v.raw", &placed(Space::Patient)).1[0].contains("would be drawn as stored"));
    assert!(written("v.raw", &placed(Space::Unknown)).1.is_empty());
    let drawn = Volume { world: World { space: Space::Patient, ..World::default() }, ..placed(Space::Patient) };
    let (bytes, remarks) = written("v.raw", &drawn);
    assert_eq!((bytes, remarks.len()), (vec![1, 2, 3, 4], 0));
}

/// World directions: along axes in another order, oblique and left-handed, oblique with a slant.
fn worlds() -> [[[f64; 3]; 3]; 3] {
    let turn = glam::DMat3::from_rotation_z(0.35) * glam::DMat3::from_rotation_x(0.52);
    let oblique = [turn.x_axis, turn.y_axis, -turn.z_axis].map(|d| d.to_array());
    let slant = [oblique[0], oblique[1], (turn.z_axis + 0.2 * turn.y_axis).normalize().to_array()];
    [[[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]], oblique, slant]
}

#[test]
fn every_format_comes_back_in_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let stored = ReadOptions { ordering: Ordering::AsStored, ..ReadOptions::default() };
    let numbers = |a: &Volume| [a.world.directions.concat(), a.origin.to_vec(), a.spacing.to_vec()].concat();
    let mut files = 0;
    for (name, within) in [("v.nrrd", 1e-15), ("v.mha", 1e-15), ("v.nii", 1e-7), ("v.nii.gz", 1e-7)] {
        let path = folder.path().join(name);
        for (sample_type, directions) in SampleType::ALL.into_iter().flat_map(|t| worlds().map(|w| (t, w))) {
            let before = volume(sample_type);
            let before = Volume { spacing: [0.1, 1.0 / 3.0, 2.5], origin: [-110.3, 0.2, 1e3], ..before };
            for space in [Space::Patient, Space::Room, Space::Unknown] {
                let before = Volume { world: World { space, directions, ..World::default() }, ..before.clone() };
                let remarks = write(&path, &before).unwrap();
                let after = read(&path, &stored).unwrap();
                assert_eq!((after.dims, &after.samples), (before.dims, &before.samples), "{name}");
                assert_eq!(remarks.is_empty(), name == "v.nrrd" || space == Space::Patient, "{name} {remarks:?}");
                let lost = space == Space::Unknown && name.starts_with("v.nii");
                let kept = if name == "v.nrrd" || lost { space } else { Space::Patient };
                assert_eq!(after.world.space, kept, "{name}");
                let expected = match lost {
                    true => Volume { world: World::default(), origin: [0.0; 3], ..before.clone() },
                    false => before.clone(),
                };
                for (a, b) in numbers(&after).into_iter().zip(numbers(&expected)) {
                    assert!((a - b).abs() <= within * b.abs().max(1.0), "{name} {space:?} {directions:?}: {a} {b}");
                }
                files += 1;
            }
        }
    }
    assert_eq!(files, 4 * 8 * 3 * 3);
}
