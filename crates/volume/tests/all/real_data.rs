//! Real volumes, where the folder with them is there.

use std::path::PathBuf;

use cube3_volume::{ReadOptions, SampleType, WordConversion, read};

#[test]
fn real_volumes_have_the_size_type_spacing_and_values_that_are_known_of_them() {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    let known = [
        ("cthead_256x256x99_u8.nrrd", [256, 256, 99], SampleType::U8, [1.0, 1.0, 2.0], (0.0, 255.0)),
        ("vhf_head_256x256x234_i16.nrrd", [256, 256, 234], SampleType::I16, [1.0, 1.0, 1.0], (0.0, 4087.0)),
        ("headsq_64x64x93_u16.nrrd", [64, 64, 93], SampleType::U16, [3.2, 3.2, 1.5], (0.0, 3926.0)),
        ("engine.nii.gz", [256, 256, 128], SampleType::U8, [1.0, 1.0, 1.0], (0.0, 255.0)),
        ("heptane.nii.gz", [302, 302, 302], SampleType::U8, [1.0, 1.0, 1.0], (0.0, 255.0)),
        ("fuel.nii.gz", [64, 33, 32], SampleType::U8, [1.0, 1.0, 1.0], (0.0, 255.0)),
    ];
    for (name, dims, sample_type, spacing, range) in known {
        let path = folder.join(name);
        if !path.exists() {
            println!("skipped: {name} is not there");
            continue;
        }
        let volume = read(&path, &ReadOptions::default()).unwrap();
        assert_eq!((volume.dims, volume.sample_type()), (dims, sample_type), "{name}");
        assert_eq!(volume.range().unwrap(), range, "{name}");
        assert_eq!(volume.spacing, spacing, "{name}");
        let (words, report) = volume.to_words(12, &WordConversion::default()).unwrap();
        assert_eq!(words.words.len(), volume.len());
        assert_eq!((report.clipped_below, report.clipped_above), (0, 0));
    }
}
