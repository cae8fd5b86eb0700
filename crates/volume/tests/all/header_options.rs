//! What headers may say beside the usual, each with the smallest file that says it.

use std::io::Write;
use std::path::Path;

use cube3_volume::{FileFormat, ReadOptions, SampleType, Space, Volume, VolumeError, inspect, read, read_bytes};

/// Puts bytes into a header, at a place.
type Put<'a> = &'a mut dyn FnMut(usize, &[u8]);

/// Numbers 0, 1, 2 … as little-endian i16.
fn numbers(count: i16) -> Vec<u8> {
    (0..count).flat_map(i16::to_le_bytes).collect()
}

fn counted(volume: &Volume) -> bool {
    volume.to_f64().into_iter().enumerate().all(|(i, v)| v == i as f64)
}

const HEAD: &str = "NRRD0004\ntype: short\nendian: little\n";

fn nrrd(fields: &str, data: &[u8]) -> Result<Volume, VolumeError> {
    let encoding = if fields.contains("encoding") { "" } else { "encoding: raw\n" };
    let bytes = [HEAD.as_bytes(), encoding.as_bytes(), fields.as_bytes(), b"\n\n", data].concat();
    read_bytes(&bytes, Some(FileFormat::Nrrd), "t.nrrd", &ReadOptions::default())
}

fn metaimage(fields: &str, data: &[u8]) -> Result<Volume, VolumeError> {
    let header = format!("ObjectType = Image\n{fields}\nElementType = MET_SHORT\nElementDataFile = LOCAL\n");
    read_bytes(&[header.as_bytes(), data].concat(), Some(FileFormat::MetaImage), "t.mha", &ReadOptions::default())
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed.write_all(bytes).unwrap();
    packed.finish().unwrap()
}

/// A NIfTI-1 of i16 with these sizes; fields are put in by `change`.
fn nifti(sizes: &[i16], data: &[u8], change: &dyn Fn(Put)) -> Vec<u8> {
    let mut file = vec![0; 352];
    let mut put = |at: usize, bytes: &[u8]| file[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &348i32.to_le_bytes());
    put(40, &(sizes.len() as i16).to_le_bytes());
    for (i, size) in sizes.iter().enumerate() {
        put(42 + 2 * i, &size.to_le_bytes());
        put(80 + 4 * i, &1f32.to_le_bytes());
    }
    put(70, &4i16.to_le_bytes());
    put(72, &16i16.to_le_bytes());
    put(76, &1f32.to_le_bytes());
    put(108, &352f32.to_le_bytes());
    put(344, b"n+1\0");
    change(&mut put);
    [file, data.to_vec()].concat()
}

fn nifti_volume(sizes: &[i16], data: &[u8], change: &dyn Fn(Put)) -> Result<Volume, VolumeError> {
    read_bytes(&nifti(sizes, data, change), Some(FileFormat::Nifti), "t.nii", &ReadOptions::default())
}

#[test]
fn an_axis_of_one_component_is_no_axis_of_the_grid() {
    for kinds in ["scalar domain domain domain", "stub space space space", "complex ??? none domain"] {
        let volume = nrrd(&format!("dimension: 4\nsizes: 1 4 3 2\nkinds: {kinds}"), &numbers(24)).unwrap();
        assert_eq!(volume.dims, [4, 3, 2], "{kinds}");
        assert!(counted(&volume));
    }
    let directions = "dimension: 4\nsizes: 1 4 3 2\nspace: RAS\nspace directions: none (1,0,0) (0,1,0) (0,0,3)";
    let volume = nrrd(directions, &numbers(24)).unwrap();
    assert_eq!((volume.dims, volume.spacing), ([4, 3, 2], [1.0, 1.0, 3.0]));
    // Spacings belong to their own axes.
    let spaced = "dimension: 4\nsizes: 1 4 3 2\nkinds: scalar domain domain domain\nspacings: nan 2 3 4";
    assert_eq!(nrrd(spaced, &numbers(24)).unwrap().spacing, [2.0, 3.0, 4.0]);
    // Without a word about it the first axis is one of the grid, and the last a series.
    let silent = nrrd("dimension: 4\nsizes: 1 4 3 2", &numbers(24)).unwrap();
    assert_eq!((silent.dims, silent.value(0, 3, 2)), ([1, 4, 3], 11.0));
    let five = "dimension: 5\nsizes: 1 4 3 2 1\nkinds: scalar domain domain domain time";
    assert_eq!(nrrd(five, &numbers(24)).unwrap().dims, [4, 3, 2]);
}

#[test]
fn series_along_the_last_axis_the_first_and_time() {
    let at = |bytes: &[u8], frame| {
        let options = ReadOptions { frame, ..ReadOptions::default() };
        read_bytes(bytes, None, "t", &options).unwrap().to_f64()
    };
    let file = |fields: &str| [HEAD.as_bytes(), b"encoding: raw\n", fields.as_bytes(), b"\n\n", &numbers(24)].concat();
    for fields in [
        "dimension: 4\nsizes: 2 2 2 3",
        "dimension: 4\nsizes: 2 2 2 3\nkinds: domain domain domain list",
        "dimension: 4\nsizes: 2 2 2 3\nspace: right-anterior-superior-time\n\
         space directions: (1,0,0,0) (0,1,0,0) (0,0,1,0) (0,0,0,2.5)",
    ] {
        let bytes = file(fields);
        assert_eq!(at(&bytes, 1), [8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0], "{fields}");
    }
    // As Slicer writes sequences: the volumes voxel by voxel.
    let bytes = file("dimension: 4\nsizes: 3 2 2 2\nkinds: list domain domain domain");
    assert_eq!(at(&bytes, 2), [2.0, 5.0, 8.0, 11.0, 14.0, 17.0, 20.0, 23.0]);
    let bytes = nifti(&[2, 2, 2, 3], &numbers(24), &|_| {});
    assert_eq!(at(&bytes, 2)[0], 16.0);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.nii");
    std::fs::write(&path, &bytes).unwrap();
    assert_eq!(inspect(&path, &ReadOptions::default()).unwrap().volumes, 3);
    let error = read(&path, &ReadOptions { frame: 3, ..ReadOptions::default() }).unwrap_err().to_string();
    assert!(error.contains("volume 3 of a file of 3"), "{error}");
}

#[test]
fn unknown_spacing_and_that_of_a_single_slice_are_1() {
    let volume = nrrd("dimension: 3\nsizes: 4 3 2\nspacings: 1 2 nan", &numbers(24)).unwrap();
    assert_eq!(volume.spacing, [1.0, 2.0, 1.0]);
    let volume = nrrd("dimension: 3\nsizes: 4 3 1\nspacings: 1 2 0", &numbers(12)).unwrap();
    assert_eq!(volume.spacing, [1.0, 2.0, 1.0]);
    let slice = "dimension: 3\nsizes: 4 3 1\nspace: RAS\nspace directions: (2,0,0) (0,2,0) (0,0,0)";
    let volume = nrrd(slice, &numbers(12)).unwrap();
    assert_eq!((volume.spacing, volume.world.letters()), ([2.0, 2.0, 1.0], "RAS".into()));
    let volume = metaimage("NDims = 3\nDimSize = 4 3 1\nElementSpacing = 1 2 0", &numbers(12)).unwrap();
    assert_eq!(volume.spacing, [1.0, 2.0, 1.0]);
    assert!(metaimage("NDims = 3\nDimSize = 4 3 2\nElementSpacing = 1 2 0", &numbers(24)).is_err());
    for pixdim in [0f32, f32::NAN] {
        let volume = nifti_volume(&[4, 3, 1], &numbers(12), &|put| put(88, &pixdim.to_le_bytes())).unwrap();
        assert_eq!(volume.spacing, [1.0; 3]);
    }
    let volume = nifti_volume(&[4, 3, 2], &numbers(24), &|put| put(88, &f32::NAN.to_le_bytes())).unwrap();
    assert_eq!(volume.spacing, [1.0; 3]);
    let error = nifti_volume(&[4, 3, 2], &numbers(24), &|put| put(88, &0f32.to_le_bytes())).unwrap_err();
    assert!(error.to_string().contains("spacing"), "{error}");
}

#[test]
fn negative_spacing_turns_an_axis_round_but_not_in_nifti() {
    let volume = nrrd("dimension: 3\nsizes: 4 3 2\nspacings: 1 1 -2", &numbers(24)).unwrap();
    assert_eq!((volume.spacing, volume.origin), ([1.0, 1.0, 2.0], [0.0, 0.0, -2.0]));
    assert_eq!((volume.value(0, 0, 0), volume.value(3, 2, 1)), (12.0, 11.0));
    assert_eq!((volume.world.stored_letters(), volume.world.letters()), ("+x+y-z".into(), "+x+y+z".into()));
    let fields = "NDims = 3\nDimSize = 4 3 2\nElementSpacing = 1 1 -2";
    let volume = metaimage(fields, &numbers(24)).unwrap();
    assert_eq!((volume.spacing, volume.value(0, 0, 0)), ([1.0, 1.0, 2.0], 12.0));
    // In a known world the sign is the direction's: here x runs to the left, and z down.
    let volume = metaimage(&format!("{fields}\nTransformMatrix = 1 0 0 0 1 0 0 0 1"), &numbers(24)).unwrap();
    assert_eq!((volume.world.space, volume.world.stored_letters()), (Space::Patient, "LPI".into()));
    assert_eq!(volume.value(0, 0, 0), 23.0);
    let volume = nifti_volume(&[4, 3, 2], &numbers(24), &|put| put(88, &(-2f32).to_le_bytes())).unwrap();
    assert_eq!((volume.spacing, volume.value(0, 0, 0)), ([1.0, 1.0, 2.0], 0.0));
}

#[test]
fn spacing_of_the_ends_of_an_axis() {
    // Cells unless the header says nodes: four cells from 0 to 8 are 2 long, three nodes from 1 to 2 are ½ apart.
    let fields = "dimension: 3\nsizes: 4 3 2\naxis mins: 0 1 nan\naxis maxs: 8 2 nan\ncenters: cell node cell";
    let volume = nrrd(fields, &numbers(24)).unwrap();
    assert_eq!((volume.spacing, volume.origin), ([2.0, 0.5, 1.0], [1.0, 1.0, 0.0]));
    let backward = nrrd("dimension: 3\nsizes: 4 3 2\naxis mins: 8 0 0\naxis maxs: 0 3 2", &numbers(24)).unwrap();
    assert_eq!((backward.spacing, backward.origin), ([2.0, 1.0, 1.0], [1.0, 0.5, 0.5]));
    assert_eq!(backward.value(0, 0, 0), 3.0);
    // A spacing that is given counts before them.
    let given = "dimension: 3\nsizes: 4 3 2\nspacings: 3 3 3\naxis mins: 0 0 0\naxis maxs: 8 8 8";
    assert_eq!(nrrd(given, &numbers(24)).unwrap().spacing, [3.0; 3]);
}

fn files(folder: &Path, files: &[(&str, &[u8])]) {
    for (name, bytes) in files {
        std::fs::write(folder.join(name), bytes).unwrap();
    }
}

#[test]
fn voxels_in_a_list_of_files_or_in_numbered_ones() {
    let folder = tempfile::tempdir().unwrap();
    let (all, at) = (numbers(24), |name: &str| folder.path().join(name));
    let skipped = [b"line\nxx".as_slice(), &all[24..]].concat();
    files(folder.path(), &[("s1.raw", &all[..24]), ("s2.raw", &all[24..]), ("s02.gz", &gzip(&all[24..]))]);
    files(folder.path(), &[("s00.gz", &gzip(&all[..24])), ("t1", &[b"line\nxx".as_slice(), &all[..24]].concat())]);
    files(folder.path(), &[("t2", &skipped), ("r1", &all[..16]), ("r2", &all[16..32]), ("r3", &all[32..])]);
    let nrrd = |name: &str, encoding: &str, sizes: &str, more: &str| {
        let axes = sizes.split(' ').count();
        let header = format!("{HEAD}encoding: {encoding}\ndimension: {axes}\nsizes: {sizes}\n{more}\n");
        std::fs::write(at(name), header).unwrap();
        read(at(name), &ReadOptions::default())
    };
    for volume in [
        nrrd("list.nhdr", "raw", "4 3 2", "data file: LIST\ns1.raw\ns2.raw"),
        nrrd("axes.nhdr", "raw", "4 3 2", "data file: LIST 2\ns1.raw\n\ns2.raw"),
        nrrd("slab.nhdr", "raw", "4 1 6", "data file: LIST 3\nr1\nr2\nr3"),
        nrrd("rows.nhdr", "raw", "8 3", "data file: LIST 1\nr1\nr2\nr3"),
        nrrd("pattern.nhdr", "raw", "4 3 2", "data file: s%d.raw 1 2 1"),
        nrrd("packed.nhdr", "gzip", "4 3 2", "data file: s%02d.gz 0 2 2 2"),
        nrrd("skips.nhdr", "raw", "4 3 2", "line skip: 1\nbyte skip: 2\ndata file: t%d 1 2 1"),
        nrrd("ends.nhdr", "raw", "4 3 2", "byte skip: -1\ndata file: t%d 1 2 1"),
        nrrd("detached.nhdr", "raw", "4 3 1", "data file: s1.raw"),
    ] {
        assert!(counted(&volume.unwrap()));
    }
    // The second volume of a series is in files of its own; the first need not be opened.
    std::fs::remove_file(at("t1")).unwrap();
    nrrd("series.nhdr", "raw", "4 3 1 2", "line skip: 1\nbyte skip: 2\ndata file: t%d 1 2 1").unwrap_err();
    let second = read(at("series.nhdr"), &ReadOptions { frame: 1, ..ReadOptions::default() }).unwrap();
    assert_eq!(second.value(0, 0, 0), 12.0);
    let short = nrrd("short.nhdr", "raw", "4 3 2", "data file: LIST\ns1.raw\nr2").unwrap_err().to_string();
    assert!(short.contains("r2: voxel data: the header promises 24 bytes, the file holds 16"), "{short}");
    let header = "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_SHORT\nElementDataFile = ";
    for (name, tail) in [
        ("list.mhd", "LIST\ns1.raw\ns2.raw\n"),
        ("axes.mhd", "LIST 2D\ns1.raw\ns2.raw"),
        ("pattern.mhd", "s%d.raw 1 2 1\n"),
    ] {
        std::fs::write(at(name), format!("{header}{tail}")).unwrap();
        assert!(counted(&read(at(name), &ReadOptions::default()).unwrap()), "{name}");
    }
}

#[test]
fn files_that_are_gzipped_as_a_whole() {
    let folder = tempfile::tempdir().unwrap();
    let (data, at) = (numbers(24), |name: &str| folder.path().join(name));
    let text = |fields: &str| [HEAD.as_bytes(), b"encoding: raw\n", fields.as_bytes(), b"\n\n", &data].concat();
    let header = "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n";
    let three = "dimension: 3\nsizes: 4 3 2";
    files(
        folder.path(),
        &[
            ("a.nrrd.gz", &gzip(&text(three))),
            ("b.nrrd", &gzip(&text(three))),
            ("c.mha.gz", &gzip(&[header.as_bytes(), &data].concat())),
            ("d.nii.gz", &gzip(&nifti(&[4, 3, 2], &data, &|_| {}))),
            ("e.data", &gzip(&text(three))),
            ("f.raw.gz", &gzip(&data)),
            ("skip.nrrd.gz", &gzip(&text(&format!("{three}\nbyte skip: -1")))),
        ],
    );
    let raw = Some(cube3_volume::RawLayout::new([4, 3, 2], SampleType::I16));
    let options = ReadOptions { raw, ..ReadOptions::default() };
    for name in ["a.nrrd.gz", "b.nrrd", "c.mha.gz", "d.nii.gz", "e.data", "f.raw.gz"] {
        assert!(counted(&read(at(name), &options).unwrap()), "{name}");
    }
    // Padding behind a member is none of it; a second member is.
    let padded = [gzip(&text(three)), vec![0; 512]].concat();
    std::fs::write(at("padded.nrrd"), &padded).unwrap();
    let members = [gzip(&text(three)[..60]), gzip(&text(three)[60..])].concat();
    std::fs::write(at("members.nrrd"), &members).unwrap();
    for name in ["padded.nrrd", "members.nrrd"] {
        assert!(counted(&read(at(name), &options).unwrap()), "{name}");
    }
    let raw = Some(cube3_volume::RawLayout::new([4, 3, 1], SampleType::I16));
    let error = read(at("f.raw.gz"), &ReadOptions { raw, ..ReadOptions::default() }).unwrap_err().to_string();
    assert!(error.contains("more than the 24 bytes"), "{error}");
    let error = read(at("skip.nrrd.gz"), &options).unwrap_err().to_string();
    assert!(error.contains("gzipped as a whole"), "{error}");
    // Raw numbers that begin as a gzip stream does are numbers.
    let magic = 0x8b1fu16.to_le_bytes();
    std::fs::write(at("g.raw"), [&magic, &data[2..]].concat()).unwrap();
    assert_eq!(read(at("g.raw"), &options).unwrap().value(0, 0, 0), f64::from(0x8b1fu16 as i16));
}

#[test]
fn bytes_as_hexadecimal_digits_and_the_first_version_of_the_format() {
    let digits: String =
        numbers(24).iter().enumerate().map(|(i, b)| format!("{b:02X}{}", if i % 7 == 6 { "\n" } else { "" })).collect();
    let volume = nrrd("encoding: hex\ndimension: 3\nsizes: 4 3 2", digits.as_bytes()).unwrap();
    assert!(counted(&volume));
    assert!(nrrd("encoding: hex\ndimension: 3\nsizes: 4 3 2", &digits.as_bytes()[..90]).is_err());
    assert!(nrrd("encoding: hex\ndimension: 3\nsizes: 4 3 2", &[b'g'; 96]).is_err());
    let old = [
        b"NRRD00.01\ntype: short\nendian: little\nencoding: raw\ndimension: 3\nsizes: 4 3 2\n\n".as_slice(),
        &numbers(24),
    ]
    .concat();
    assert!(counted(&read_bytes(&old, None, "t", &ReadOptions::default()).unwrap()));
}

#[test]
fn analyze_is_nifti_without_directions() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let header = nifti(&[4, 3, 2], &[], &|put| {
        put(344, &[0; 4]);
        put(108, &0f32.to_le_bytes());
        // In NIfTI these would be a slope and a code of sform.
        put(112, &2f32.to_le_bytes());
        put(254, &1i16.to_le_bytes());
        put(88, &2.5f32.to_le_bytes());
    });
    files(folder.path(), &[("a.hdr", &header[..348]), ("a.img", &numbers(24)), ("b.hdr", &header[..348])]);
    files(folder.path(), &[("b.img.gz", &gzip(&numbers(24)))]);
    for name in ["a.hdr", "a.img", "b.hdr", "b.img.gz"] {
        let volume = read(at(name), &ReadOptions::default()).unwrap();
        assert!(counted(&volume), "{name}");
        assert_eq!((volume.spacing, volume.world.space), ([1.0, 1.0, 2.5], Space::Unknown));
    }
    files(folder.path(), &[("c.hdr", b"ENVI\nsamples = 4\n"), ("c.img", &numbers(24))]);
    let error = read(at("c.img"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("c.hdr"), "{error}");
}

#[test]
fn sform_counts_before_qform_and_places_the_voxels_where_pixdim_disagrees() {
    let both = |sform_code: i16, qform_code: i16, step: f32| {
        nifti_volume(&[4, 3, 2], &numbers(24), &|put| {
            put(252, &qform_code.to_le_bytes());
            put(254, &sform_code.to_le_bytes());
            // sform: x to the left. qform: half a turn about x, y to the back and z down.
            for (i, value) in [-step, 0.0, 0.0, 9.0, 0.0, 1.0, 0.0, 8.0, 0.0, 0.0, 1.0, 7.0].into_iter().enumerate() {
                put(280 + 4 * i, &value.to_le_bytes());
            }
            put(256, &1f32.to_le_bytes());
        })
        .unwrap()
    };
    assert_eq!(both(2, 1, 1.0).world.stored_letters(), "LAS");
    assert_eq!(both(0, 1, 1.0).world.stored_letters(), "RPI");
    assert_eq!(both(0, 0, 1.0).world.space, Space::Unknown);
    assert_eq!(both(1, 0, 1.0).origin, [6.0, 8.0, 7.0]);
    let stretched = both(1, 0, 2.0);
    assert_eq!((stretched.spacing, stretched.origin), ([2.0, 1.0, 1.0], [3.0, 8.0, 7.0]));
    // A matrix of zeros is none.
    assert_eq!(both(1, 1, 0.0).world.stored_letters(), "RPI");
    // Numbers of single precision are the decimals that were meant.
    let tenth = nifti_volume(&[4, 3, 2], &numbers(24), &|put| put(80, &0.7f32.to_le_bytes())).unwrap();
    assert_eq!(tenth.spacing[0], 0.7);
}

#[test]
fn lengths_of_nifti_in_metres_and_microns_become_millimetres() {
    for (unit, mm) in [(0u8, 1.0), (1, 1000.0), (2, 1.0), (3, 0.001), (10, 1.0), (9, 1000.0)] {
        let volume = nifti_volume(&[4, 3, 2], &numbers(24), &|put| {
            put(123, &[unit]);
            put(254, &1i16.to_le_bytes());
            for (i, value) in [1.0, 0.0, 0.0, 4.0, 0.0, 1.0, 0.0, 8.0, 0.0, 0.0, 1.0, 2.0f32].into_iter().enumerate() {
                put(280 + 4 * i, &value.to_le_bytes());
            }
        })
        .unwrap();
        assert_eq!((volume.spacing, volume.origin), ([mm; 3], [4.0 * mm, 8.0 * mm, 2.0 * mm]), "unit {unit}");
    }
}
