//! Files that other programs wrote, read and compared with their closed form, voxel by voxel.

mod common;

use common::{DIMS, ORIGIN, SPACING, assert_closed_form, assert_voxels, expected, fixture, pack};
use cube3_volume::{Format, ReadOptions, SampleType, Volume, VolumeError, read, read_bytes};

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
            assert_closed_form(&volume, numpy_type, &name);
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
            assert_closed_form(&bytes("nrrd", &file).unwrap(), name, &file);
        }
    }
    let folder = unpack("nrrd");
    for name in ["detached_raw.nhdr", "detached_gzip.nhdr"] {
        let volume = read(folder.path().join(name), &ReadOptions::default()).unwrap();
        assert_closed_form(&volume, "int16", name);
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
        assert!(error.contains("frame 2 of a file of 2"), "{error}");
    }
    let oblique = bytes("nrrd", "oblique.nrrd").unwrap();
    assert_eq!(oblique.spacing, SPACING);
    assert_eq!(oblique.origin, ORIGIN);
}

#[test]
fn nifti_of_every_type_and_byte_order_plain_and_compressed() {
    let mut files = 0;
    for (name, bytes) in pack("nifti") {
        let numpy_type = name.split('_').next().unwrap();
        if numpy_type.contains("int") || numpy_type.contains("float") {
            let volume = read_bytes(&bytes, None, &name, &ReadOptions::default()).unwrap();
            assert_closed_form(&volume, numpy_type, &name);
            files += 1;
        }
    }
    assert_eq!(files, 40);
}

#[test]
fn nifti_of_itk_keeps_values_spacing_and_the_origin_of_its_own_axes() {
    for (name, numpy_type) in [("itk_float32.nii.gz", "float32"), ("itk_int16.nii", "int16")] {
        let volume = bytes("nifti", name).unwrap();
        assert_eq!((volume.dims, volume.spacing), (DIMS, SPACING));
        // ITK's x and y run to the left and back, NIfTI's to the right and front.
        assert_eq!(volume.origin, [3.5, -10.25, 7.0]);
        assert_voxels(&volume, name, |x, y, z| expected(numpy_type, x, y, z));
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
fn nifti_of_other_kinds_is_refused_by_name() {
    let error = bytes("nifti", "pair.hdr").unwrap_err().to_string();
    assert!(error.contains("another file (.hdr and .img)"), "{error}");
    let two = fixture("nifti", "two.nii");
    let error = read_bytes(&two, Some(Format::Nifti), "two.nii", &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("NIfTI-2"), "{error}");
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
            assert_closed_form(&volume, numpy_type, &name);
            files += 1;
        }
    }
    assert_eq!(files, 40);
}

#[test]
fn metaimage_of_two_and_four_axes_and_colours() {
    let slice = bytes("metaimage", "slice.mha").unwrap();
    assert_eq!((slice.dims, slice.spacing), ([3, 4, 1], [0.75, 1.25, 1.0]));
    assert_voxels(&slice, "slice", |x, y, _| expected("uint16", x, y, 0));
    for f in [0, 1] {
        let volume = frame("metaimage", "series.mha", f).unwrap();
        assert_voxels(&volume, "series", |x, y, z| expected("uint8", x, y, z) + 50.0 * f as f64);
    }
    let error = bytes("metaimage", "colours.mha").unwrap_err().to_string();
    assert!(error.contains("3 numbers for each voxel"), "{error}");
}

#[test]
fn content_decides_where_the_name_says_nothing() {
    for (pack_name, name) in
        [("nrrd", "uint16_gzip_big.nrrd"), ("nifti", "uint16_big.nii"), ("metaimage", "uint16_zlib.mha")]
    {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("volume.data");
        std::fs::write(&path, fixture(pack_name, name)).unwrap();
        assert_closed_form(&read(&path, &ReadOptions::default()).unwrap(), "uint16", name);
    }
}
