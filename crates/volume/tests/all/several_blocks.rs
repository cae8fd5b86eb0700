//! Files of more than a block: what is unpacked, turned round, chosen, scaled and refused there as in small ones.

use cube3_volume::{
    Endian, FileFormat, RawLayout, ReadOptions, SampleType, Samples, Volume, VolumeError, read, read_bytes, write_raw,
};
use std::io::Write;

/// Voxels along x, y and z: more than a block of half a megabyte, even of bytes.
const SIZE: [usize; 3] = [96, 80, 79];
const COUNT: usize = SIZE[0] * SIZE[1] * SIZE[2];

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(bytes).unwrap();
    packed.finish().unwrap()
}

/// An NRRD's bytes.
fn nrrd(fields: &str, data: &[u8]) -> Vec<u8> {
    [b"NRRD0004\n", fields.as_bytes(), b"\n\n", data].concat()
}

fn sizes() -> String {
    format!("dimension: 3\nsizes: {} {} {}", SIZE[0], SIZE[1], SIZE[2])
}

fn take(bytes: &[u8], frame: usize) -> Result<Volume, VolumeError> {
    read_bytes(bytes, None, "t", &ReadOptions { frame, ..ReadOptions::default() })
}

/// A number for each voxel, all bits of which change.
fn word(i: usize) -> u16 {
    (i as u32)
        .wrapping_mul(40_503)
        .to_be_bytes()
        .into_iter()
        .fold(7, |sum: u16, byte| sum * 5 % 52_001 + u16::from(byte))
}

fn words() -> Vec<u16> {
    (0..COUNT).map(word).collect()
}

#[test]
fn numbers_of_either_byte_order_packed_or_as_text() {
    let big: Vec<u8> = (0..COUNT).flat_map(|i| word(i).to_be_bytes()).collect();
    let text: String = (0..COUNT).map(|i| format!("{}\n", word(i))).collect();
    for (fields, data) in [
        ("type: ushort\nendian: big\nencoding: gzip", gzip(&big)),
        ("type: ushort\nendian: big\nencoding: raw", big.clone()),
        ("type: ushort\nencoding: text", text.into_bytes()),
    ] {
        let volume = take(&nrrd(&format!("{fields}\n{}", sizes()), &data), 0).unwrap();
        assert!(volume.samples == Samples::U16(words()), "{fields}");
    }
    let packed = gzip(&big);
    let cut =
        nrrd(&format!("type: ushort\nendian: big\nencoding: gzip\n{}", sizes()), &packed[..packed.len() * 9 / 10]);
    let error = take(&cut, 0).unwrap_err();
    assert!(matches!(error, VolumeError::Inflate { .. } | VolumeError::Truncated { .. }), "{error}");
}

#[test]
fn written_in_either_byte_order_and_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.raw");
    let volume = Volume::new(SIZE, [1.0; 3], Samples::U16(words())).unwrap();
    for (endian, bytes) in [(Endian::Little, word(1).to_le_bytes()), (Endian::Big, word(1).to_be_bytes())] {
        write_raw(&path, &volume, endian).unwrap();
        assert_eq!(std::fs::read(&path).unwrap()[2..4], bytes);
        let raw = Some(RawLayout { endian, ..RawLayout::new(SIZE, SampleType::U16) });
        let again = read(&path, &ReadOptions { raw, ..ReadOptions::default() }).unwrap();
        assert!(again.samples == volume.samples, "{endian}");
    }
}

#[test]
fn one_volume_of_a_series_that_lies_voxel_by_voxel() {
    for (name, bytes) in [("uchar", 1), ("ushort", 2), ("uint", 4), ("double", 8)] {
        let number = |i: usize, frame: usize| match bytes {
            1 => vec![(word(i) >> 8) as u8 ^ frame as u8],
            2 => (word(i) ^ frame as u16).to_le_bytes().into(),
            4 => (u32::from(word(i)) << 16 ^ frame as u32).to_le_bytes().into(),
            _ => (f64::from(word(i)) + frame as f64 * 1e6).to_le_bytes().to_vec(),
        };
        let data: Vec<u8> = (0..COUNT).flat_map(|i| (0..3).flat_map(move |frame| number(i, frame))).collect();
        let [nx, ny, nz] = SIZE;
        let fields = format!(
            "type: {name}\nendian: little\nencoding: gzip\ndimension: 4\nsizes: 3 {nx} {ny} {nz}\n\
             kinds: list domain domain domain"
        );
        let file = nrrd(&fields, &gzip(&data));
        for frame in 0..3 {
            let volume = take(&file, frame).unwrap();
            let same = |i: usize| match bytes {
                1 => (usize::from(word(i) >> 8) ^ frame) as f64,
                2 => f64::from(word(i) ^ frame as u16),
                4 => f64::from(u32::from(word(i)) << 16 ^ frame as u32),
                _ => f64::from(word(i)) + frame as f64 * 1e6,
            };
            assert!(volume.to_f64().into_iter().enumerate().all(|(i, value)| value == same(i)), "{name}, {frame}");
        }
    }
}

#[test]
fn numbers_that_are_kept_keep_their_bits_where_axes_turn() {
    // Every pattern there is of a sign, NaNs with a payload among them.
    let bits = |i: usize| (u32::from(word(i)) << 16) | 0x7F80_0001_u32.wrapping_mul(u32::from(i.is_multiple_of(3)));
    let data: Vec<u8> = (0..COUNT).flat_map(|i| bits(i).to_le_bytes()).collect();
    let [nx, ny, _] = SIZE;
    let at = |x: usize, y: usize, z: usize| (z * ny + y) * nx + x;
    for (directions, from) in [
        (
            "(-1,0,0) (0,-1,0) (0,0,1)",
            Box::new(|[x, y, z]: [usize; 3]| at(nx - 1 - x, ny - 1 - y, z)) as Box<dyn Fn([usize; 3]) -> usize>,
        ),
        ("(0,0,1) (1,0,0) (0,1,0)", Box::new(|[x, y, z]: [usize; 3]| at(z, x, y))),
    ] {
        let fields = format!(
            "type: float\nendian: little\nencoding: gzip\nspace: RAS\nspace directions: {directions}\n{}",
            sizes()
        );
        let volume = take(&nrrd(&fields, &gzip(&data)), 0).unwrap();
        let Samples::F32(samples) = &volume.samples else { panic!("{directions}") };
        let [mx, my, _] = volume.dims;
        let wrong = (0..COUNT).find(|&i| samples[i].to_bits() != bits(from([i % mx, i / mx % my, i / mx / my])));
        assert_eq!(wrong, None, "{directions}");
    }
}

#[test]
fn scaled_numbers_and_those_of_64_bits() {
    let mut header = vec![0; 352];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &348_i32.to_le_bytes());
    for (at, number) in [(40, 3), (42, SIZE[0]), (44, SIZE[1]), (46, SIZE[2]), (70, 512), (72, 16)] {
        put(at, &(number as i16).to_le_bytes());
    }
    for (at, number) in [(76, 1.0), (80, 1.0), (84, 1.0), (88, 1.0), (108, 352.0), (112, 0.5), (116, -3.0_f32)] {
        put(at, &number.to_le_bytes());
    }
    put(344, b"n+1\0");
    let data: Vec<u8> = (0..COUNT).flat_map(|i| word(i).to_le_bytes()).collect();
    let file = gzip(&[header, data].concat());
    let volume = read_bytes(&file, Some(FileFormat::Nifti), "t.nii.gz", &ReadOptions::default()).unwrap();
    assert_eq!(volume.sample_type(), SampleType::F32);
    assert!(volume.to_f64().into_iter().enumerate().all(|(i, value)| value == f64::from(word(i)) * 0.5 - 3.0));

    let long = |bad: Option<usize>| -> Vec<u8> {
        let number = |i: usize| if Some(i) == bad { -1 } else { u64::from(word(i)) as i64 };
        let data: Vec<u8> = (0..COUNT).flat_map(|i| number(i).to_le_bytes()).collect();
        nrrd(&format!("type: uint64\nendian: little\nencoding: gzip\n{}", sizes()), &gzip(&data))
    };
    assert!(take(&long(None), 0).unwrap().to_f64().into_iter().enumerate().all(|(i, v)| v == f64::from(word(i))));
    for bad in [0, COUNT / 2, COUNT - 1] {
        let error = take(&long(Some(bad)), 0).unwrap_err();
        assert!(matches!(error, VolumeError::DoesNotFit { index, .. } if index == bad as u64), "{error}");
    }
}
