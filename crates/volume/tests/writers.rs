//! What is written is read back, and what was there is never lost.

use cube3_volume::{
    Endian, NrrdEncoding, RawLayout, ReadOptions, SampleType, Samples, Volume, read, write, write_nrrd, write_raw,
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
        for encoding in [NrrdEncoding::Raw, NrrdEncoding::Gzip] {
            let path = folder.path().join("v.nrrd");
            let before = volume(sample_type);
            write_nrrd(&path, &before, encoding).unwrap();
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
    let path = folder.path().join("old.nii");
    std::fs::write(&path, "old").unwrap();
    let error = write(&path, &volume(SampleType::U8)).unwrap_err().to_string();
    assert!(error.contains("old.nii") && error.contains(".nrrd"), "{error}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
    // A folder in the file's place: the rename fails after all has been written.
    let taken = folder.path().join("taken.nrrd");
    std::fs::create_dir(&taken).unwrap();
    std::fs::write(taken.join("inside"), "old").unwrap();
    assert!(write(&taken, &volume(SampleType::U8)).is_err());
    assert!(write(folder.path().join("no/such/folder.nrrd"), &volume(SampleType::U8)).is_err());
    let mut names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["old.nii", "taken.nrrd"]);
}
