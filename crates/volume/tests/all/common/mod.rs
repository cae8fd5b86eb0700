//! The fixtures and their closed form, for the tests of the readers.

use cube3_volume::{SampleType, Space, Volume};

pub const DIMS: [usize; 3] = [3, 4, 5];
pub const SPACING: [f64; 3] = [0.75, 1.25, 2.5];
pub const ORIGIN: [f64; 3] = [-3.5, 10.25, 7.0];

const PACKS: [(&str, &str); 3] = [
    ("nrrd", include_str!("../../fixtures/nrrd.b64")),
    ("nifti", include_str!("../../fixtures/nifti.b64")),
    ("metaimage", include_str!("../../fixtures/metaimage.b64")),
];

/// All files of a pack: name and bytes.
pub fn pack(name: &str) -> Vec<(String, Vec<u8>)> {
    let (_, text) = PACKS.iter().find(|p| p.0 == name).expect("a pack of that name");
    text.lines()
        .map(|line| {
            let (name, code) = line.split_once(' ').expect("name and code");
            (name.to_owned(), base64(code))
        })
        .collect()
}

/// One file of a pack.
pub fn fixture(pack_name: &str, name: &str) -> Vec<u8> {
    let found = pack(pack_name).into_iter().find(|f| f.0 == name);
    found.unwrap_or_else(|| panic!("{name} in {pack_name}")).1
}

fn base64(code: &str) -> Vec<u8> {
    let digits = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut bytes = Vec::new();
    let (mut bits, mut held) = (0u32, 0);
    for c in code.bytes().filter(|&c| c != b'=') {
        let digit = digits.iter().position(|&d| d == c).expect("a base64 digit");
        bits = bits << 6 | digit as u32;
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    bytes
}

/// The closed form of `make_fixtures.py`.
pub fn expected(numpy_type: &str, x: usize, y: usize, z: usize) -> f64 {
    let v = (x + 10 * y + 40 * z) as f64;
    match numpy_type {
        "uint8" => v,
        "int8" => v - 96.0,
        "uint16" => v * 300.0,
        "int16" => v * 300.0 - 30000.0,
        "uint32" | "uint64" => v * 2e7,
        "int32" | "int64" => (v - 96.0) * 2e7,
        "float32" => v * 0.5 - 20.25,
        "float64" => v / 3.0 - 10.0,
        other => panic!("{other}"),
    }
}

/// The type that a numpy type is kept as.
pub fn kept(numpy_type: &str) -> SampleType {
    match numpy_type {
        "uint8" => SampleType::U8,
        "int8" => SampleType::I8,
        "uint16" => SampleType::U16,
        "int16" => SampleType::I16,
        "uint32" | "uint64" => SampleType::U32,
        "int32" | "int64" => SampleType::I32,
        "float32" => SampleType::F32,
        "float64" => SampleType::F64,
        other => panic!("{other}"),
    }
}

/// Compares every voxel at its place in the world, the type and the spacing. The files' own coordinates run to the left and
/// back (`lps`), as ITK's do, or to the right and front, as NIfTI's do; the grid's axes run to the right, front and up.
pub fn assert_closed_form(volume: &Volume, numpy_type: &str, lps: bool, what: &str) {
    assert_eq!(volume.dims, DIMS, "{what}");
    assert_eq!(volume.spacing, SPACING, "{what}");
    assert_eq!(volume.sample_type(), kept(numpy_type), "{what}");
    assert_eq!((volume.world.space, volume.world.letters().as_str()), (Space::Patient, "RAS"), "{what}");
    assert_eq!(volume.world.stored_letters(), if lps { "LPS" } else { "RAS" }, "{what}");
    let [ox, oy, oz] = ORIGIN;
    let last = |axis: usize| (DIMS[axis] - 1) as f64 * SPACING[axis];
    assert_eq!(volume.origin, if lps { [-ox - last(0), -oy - last(1), oz] } else { ORIGIN }, "{what}");
    let stored = |axis: usize, at: usize| if lps { DIMS[axis] - 1 - at } else { at };
    assert_voxels(volume, what, |x, y, z| expected(numpy_type, stored(0, x), stored(1, y), z));
}

/// Compares every voxel.
pub fn assert_voxels(volume: &Volume, what: &str, value: impl Fn(usize, usize, usize) -> f64) {
    for z in 0..volume.dims[2] {
        for y in 0..volume.dims[1] {
            for x in 0..volume.dims[0] {
                assert_eq!(volume.value(x, y, z), value(x, y, z), "{what}, voxel ({x}, {y}, {z})");
            }
        }
    }
}
