//! Files that other programs wrote, read and compared with their closed form, voxel by voxel.

use crate::common::{DIMS, ORIGIN, SPACING, assert_closed_form, assert_voxels, expected, fixture, pack};
use cube3_volume::{ReadOptions, SampleType, Volume, VolumeError, read, read_bytes};

fn bytes(pack_name: &str, name: &str) -> Result<Volume, VolumeError> {
    read_bytes(&fixture(pack_name, name), None, name, &ReadOptions::default())
}

fn frame(pack_name: &str, name: &str, frame: usize) -> Result<Volume, VolumeError> {
    let options = ReadOptions { frame, ..ReadOptions::default() };
    read_bytes(&fixture(pack_name, name), None, name, &options)
}

/// Puts all files of a pack into a folder, so that headers find their data files.
fn unpack(pack_name: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in pack(pack_name) {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

#[test]
fn nrrd_of_every_type_encoding_and_byte_order() {
    let mut files = 0;
    for (name, bytes) in pack("nrrd") {
        let numpy_type = name.split('_').next().unwrap();
        if name.ends_with(".nrrd") && (numpy_type.contains("int") || numpy_type.contains("float")) {
            let volume = read_bytes(&bytes, None, &name, &ReadOptions::default()).unwrap();
            assert_closed_form(&volume, numpy_type, true, &name);
            files += 1;
        }
    }
    assert_eq!(files, 60);
}

#[test]
fn nrrd_of_itk_and_with_data_files() {
    for name in ["uint8", "float64"] {
        for encoding in ["raw", "gzip"] {
            let file = format!("itk_{name}_{encoding}.nrrd");
            assert_closed_form(&bytes("nrrd", &file).unwrap(), name, true, &file);
        }
    }
    let folder = unpack("nrrd");
    for name in ["detached_raw.nhdr", "detached_gzip.nhdr"] {
        let volume = read(folder.path().join(name), &ReadOptions::default()).unwrap();
        assert_closed_form(&volume, "int16", true, name);
    }
}

#[test]
fn nrrd_of_two_and_four_axes_and_with_oblique_directions() {
    let slice = bytes("nrrd", "slice.nrrd").unwrap();
    assert_eq!((slice.dims, slice.spacing), ([3, 4, 1], [0.75, 1.25, 1.0]));
    assert_voxels(&slice, "slice", |x, y, _| expected("uint16", x, y, 0));
    for name in ["series_raw.nrrd", "series_gzip.nrrd", "series_ascii.nrrd"] {
        for f in [0, 1] {
            let volume = frame("nrrd", name, f).unwrap();
            assert_eq!(volume.dims, DIMS);
            assert_voxels(&volume, name, |x, y, z| expected("uint8", x, y, z) + 50.0 * f as f64);
        }
        let error = frame("nrrd", name, 2).unwrap_err().to_string();
        assert!(error.contains("volume 2 of a file of 2"), "{error}");
    }
    let oblique = bytes("nrrd", "oblique.nrrd").unwrap();
    // In RAS the stored axes lead to (0, -1, 0), (0.6, 0, 0.8) and (-0.8, 0, 0.6): back, up and left.
    assert_eq!((oblique.world.stored_letters(), oblique.world.letters()), ("PSL".into(), "RAS".into()));
    assert_eq!((oblique.dims, oblique.spacing), ([5, 3, 4], [2.5, 0.75, 1.25]));
    assert_voxels(&oblique, "oblique", |x, y, z| expected("uint8", 2 - y, z, 4 - x));
    let left = oblique.world.left_over();
    assert!((left.turned_deg - 0.8f64.acos().to_degrees()).abs() < 1e-9 && left.slanted_deg < 1e-9, "{left:?}");
    let [ox, oy, oz] = ORIGIN;
    for (got, wanted) in oblique.origin.iter().zip([-ox - 8.0, -oy - 1.5, oz + 6.0]) {
        assert!((got - wanted).abs() < 1e-12, "{:?}", oblique.origin);
    }
}

#[test]
fn nifti_of_every_type_and_byte_order_plain_and_compressed() {
    let mut files = 0;
    for (name, bytes) in pack("nifti") {
        let numpy_type = name.split('_').next().unwrap();
        if numpy_type.contains("int") || numpy_type.contains("float") {
            let volume = read_bytes(&bytes, None, &name, &ReadOptions::default()).unwrap();
            assert_closed_form(&volume, numpy_type, false, &name);
            files += 1;
        }
    }
    assert_eq!(files, 40);
}

#[test]
fn nifti_of_itk_is_turned_to_the_right_and_front() {
    for (name, numpy_type) in [("itk_float32.nii.gz", "float32"), ("itk_int16.nii", "int16")] {
        let volume = bytes("nifti", name).unwrap();
        assert_eq!((volume.dims, volume.spacing), (DIMS, SPACING));
        // ITK's x and y run to the left and back, and it says so in the file.
        assert_closed_form(&volume, numpy_type, true, name);
    }
}

#[test]
fn nifti_scales_numbers_and_keeps_them_exact() {
    for (numpy_type, kept) in [("uint8", SampleType::F32), ("int16", SampleType::F32), ("int32", SampleType::F64)] {
        let name = format!("scaled_{numpy_type}.nii.gz");
        let volume = bytes("nifti", &name).unwrap();
        assert_eq!(volume.sample_type(), kept);
        assert_voxels(&volume, &name, |x, y, z| expected(numpy_type, x, y, z) * 0.5 - 10.0);
    }
}

#[test]
fn nifti_of_two_and_four_axes() {
    let slice = bytes("nifti", "slice.nii").unwrap();
    assert_eq!(slice.dims, [3, 4, 1]);
    assert_voxels(&slice, "slice", |x, y, _| expected("uint16", x, y, 0));
    for name in ["series.nii", "series.nii.gz"] {
        for f in [0, 1] {
            let volume = frame("nifti", name, f).unwrap();
            assert_voxels(&volume, name, |x, y, z| expected("uint8", x, y, z) + 50.0 * f as f64);
        }
        assert!(frame("nifti", name, 2).is_err());
    }
}

#[test]
fn nifti_of_two_files_and_of_version_2() {
    let two = fixture("nifti", "two.nii");
    for name in ["two.nii", "two"] {
        let volume = read_bytes(&two, None, name, &ReadOptions::default()).unwrap();
        assert_closed_form(&volume, "uint8", false, name);
    }
    // The pack has both files under their names; either may be given.
    let folder = unpack("nifti");
    for name in ["pair.hdr", "pair.img"] {
        assert_closed_form(&read(folder.path().join(name), &ReadOptions::default()).unwrap(), "uint8", false, name);
    }
    std::fs::remove_file(folder.path().join("pair.hdr")).unwrap();
    let error = read(folder.path().join("pair.img"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("there is no") && error.contains("pair.hdr"), "{error}");
}

#[test]
fn metaimage_of_every_type_plain_and_compressed_with_and_without_a_data_file() {
    let folder = unpack("metaimage");
    let mut files = 0;
    for (name, _) in pack("metaimage") {
        let numpy_type = name.split('_').next().unwrap();
        let header = name.ends_with(".mha") || name.ends_with(".mhd");
        if header && name.contains('_') {
            let volume = read(folder.path().join(&name), &ReadOptions::default()).unwrap();
            assert_closed_form(&volume, numpy_type, true, &name);
            files += 1;
        }
    }
    assert_eq!(files, 40);
}

#[test]
fn metaimage_of_two_and_four_axes_and_colours() {
    let slice = bytes("metaimage", "slice.mha").unwrap();
    assert_eq!((slice.dims, slice.spacing), ([3, 4, 1], [0.75, 1.25, 1.0]));
    assert_voxels(&slice, "slice", |x, y, _| expected("uint16", 2 - x, 3 - y, 0));
    for f in [0, 1] {
        let volume = frame("metaimage", "series.mha", f).unwrap();
        assert_voxels(&volume, "series", |x, y, z| expected("uint8", 2 - x, 3 - y, z) + 50.0 * f as f64);
    }
    let error = bytes("metaimage", "colours.mha").unwrap_err().to_string();
    assert!(error.contains("a voxel of 3 numbers"), "{error}");
}

#[test]
fn content_decides_where_the_name_says_nothing() {
    for (pack_name, name, lps) in [
        ("nrrd", "uint16_gzip_big.nrrd", true),
        ("nifti", "uint16_big.nii", false),
        ("metaimage", "uint16_zlib.mha", true),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("volume.data");
        std::fs::write(&path, fixture(pack_name, name)).unwrap();
        assert_closed_form(&read(&path, &ReadOptions::default()).unwrap(), "uint16", lps, name);
    }
}
