//! Files that are wrong, each in one way, and the error that says so.

use std::io::Write;

use crate::common::fixture;
use cube3_volume::{
    Endian, FileFormat, RawLayout, ReadOptions, SampleType, Samples, Volume, VolumeError, read, read_bytes,
};

fn nrrd(header: &str, data: &[u8]) -> Result<Volume, VolumeError> {
    let bytes = [header.as_bytes(), b"\n", data].concat();
    read_bytes(&bytes, Some(FileFormat::Nrrd), "t.nrrd", &ReadOptions::default())
}

fn metaimage(header: &str, data: &[u8]) -> Result<Volume, VolumeError> {
    let bytes = [header.as_bytes(), data].concat();
    read_bytes(&bytes, Some(FileFormat::MetaImage), "t.mha", &ReadOptions::default())
}

/// Fields with their values.
type Changes = &'static [(&'static str, &'static str)];

/// Replaces the fields of a good NRRD header: `""` leaves one out.
fn nrrd_with(changes: &[(&str, &str)]) -> String {
    let mut fields = vec![
        ("type", "uint8"),
        ("dimension", "3"),
        ("sizes", "2 2 2"),
        ("spacings", "1 1 1"),
        ("endian", "little"),
        ("encoding", "raw"),
    ];
    for &(name, value) in changes {
        fields.retain(|f| f.0 != name);
        fields.push((name, value));
    }
    let lines: String = fields.iter().filter(|f| !f.1.is_empty()).map(|(n, v)| format!("{n}: {v}\n")).collect();
    format!("NRRD0004\n{lines}")
}

#[track_caller]
fn assert_says(result: Result<Volume, VolumeError>, parts: &[&str]) {
    let message = result.expect_err("a refusal").to_string();
    for part in parts {
        assert!(message.contains(part), "'{part}' in: {message}");
    }
}

#[test]
fn the_good_header_is_good() {
    let volume = nrrd(&nrrd_with(&[]), &[1, 2, 3, 4, 5, 6, 7, 8]).unwrap();
    assert_eq!(volume.value(1, 0, 1), 6.0);
}

#[test]
fn nrrd_fields_that_cannot_be() {
    let data = [0; 64];
    let cases: [(Changes, &[&str]); 27] = [
        (&[("type", "")], &["'type' is missing", "add a line"]),
        (&[("sizes", "")], &["'sizes' is missing"]),
        (&[("encoding", "")], &["'encoding' is missing"]),
        (&[("type", "short"), ("endian", "")], &["'endian' is missing"]),
        (&[("sizes", "2 2")], &["'sizes'", "2 values for 3 axes"]),
        (&[("sizes", "2 2 2 2")], &["4 values for 3 axes"]),
        (&[("sizes", "2 0 2")], &["a size of 0"]),
        (&[("sizes", "2 -2 2")], &["cannot use '-2'"]),
        (&[("sizes", "2 99999999999999999999999 2")], &["cannot use '99999"]),
        (&[("spacings", "1 inf 1")], &["spacing", "positive and finite"]),
        (&[("spacings", "1 0 1")], &["spacing"]),
        (&[("space directions", "(1,0,0) (0,1,0) (1,1,0)")], &["'space directions'", "lie in one plane"]),
        (&[("space", "inside-out"), ("space directions", "(1,0,0) (0,1,0) (0,0,1)")], &["'inside-out' is no space"]),
        (&[("spacings", "1 1")], &["2 values for 3 axes"]),
        (&[("space directions", "(1,0,0) (0,1,0)")], &["is no vector"]),
        (&[("space directions", "(1,0,0) (0,1,0) (0,0,0)")], &["spacing"]),
        (&[("space origin", "(0,0,inf)")], &["origin"]),
        (&[("type", "block")], &["the type 'block' is not supported"]),
        (&[("encoding", "bzip2")], &["the encoding 'bzip2' is not supported", "raw, gzip or ascii"]),
        (&[("dimension", "5"), ("sizes", "2 2 2 2 2"), ("spacings", "")], &["a grid of 5 axes"]),
        (
            &[("dimension", "4"), ("sizes", "2 2 2 2"), ("kinds", "domain list domain domain"), ("spacings", "")],
            &["a series along axis 1"],
        ),
        (&[("byte skip", "-2")], &["cannot skip -2 bytes"]),
        (&[("data file", "LIST")], &["'data file'", "1 files of 2 axes for a grid of 2×2×2"]),
        (&[("data file", "slice%03d.raw 1 9 1 2")], &["9 files of 2 axes for a grid of 2×2×2"]),
        (&[("data file", "slice%03d.raw 1 9 -1 2")], &["no way from 1 to 9"]),
        (&[("data file", "slice%f.raw 1 2 1 2")], &["no place for one whole number"]),
        (&[("kinds", "RGB-color domain domain")], &["a voxel of 2 numbers (RGB-color)"]),
    ];
    for (changes, parts) in cases {
        assert_says(nrrd(&nrrd_with(changes), &data), parts);
    }
    assert_says(nrrd("NRRD0009\n", &data), &["line 1", "NRRD version 9"]);
    assert_says(nrrd("NRRD\n", &data), &["line 1"]);
    assert_says(nrrd(&format!("{}what is this\n", nrrd_with(&[])), &data), &["line 8", "is no field"]);
    assert_says(nrrd(&format!("{}sizes: 2 2 2\n", nrrd_with(&[])), &data), &["line 8", "stands on line 4 already"]);
    assert_says(nrrd(&nrrd_with(&[("data file", "x.raw")]), &data), &["beside bytes in memory"]);
}

#[test]
fn line_and_byte_skips_come_in_this_order() {
    let data = [b"one\ntwo\n".as_slice(), &[9, 9, 1, 2, 3, 4, 5, 6, 7, 8]].concat();
    let skips = [("line skip", "2"), ("byte skip", "2")];
    assert_eq!(nrrd(&nrrd_with(&skips), &data).unwrap().value(0, 0, 0), 1.0);
    assert_eq!(nrrd(&nrrd_with(&[("byte skip", "-1")]), &data).unwrap().value(0, 0, 0), 1.0);
    assert_eq!(nrrd(&nrrd_with(&[("lineskip", "2"), ("byteskip", "2")]), &data).unwrap().value(1, 1, 1), 8.0);
    assert_says(nrrd(&nrrd_with(&[("line skip", "9")]), &data), &["9 lines to skip"]);
    assert_says(nrrd(&nrrd_with(&[("byte skip", "99999")]), &data), &["promises 99999 bytes to skip", "holds 18"]);
}

#[test]
fn headers_that_promise_more_than_the_file_holds() {
    assert_says(nrrd(&nrrd_with(&[]), &[0; 7]), &["promises 8 bytes", "holds 7"]);
    // 2^40 bytes promised, 8 there: refused by the file's length or the memory limit, at once.
    for encoding in ["raw", "gzip", "ascii"] {
        let header = nrrd_with(&[("sizes", "65536 65536 256"), ("encoding", encoding)]);
        assert_says(nrrd(&header, &[0; 8]), &["1099511627776 bytes of memory", "limit"]);
    }
    let overflow = nrrd_with(&[("sizes", "4294967296 4294967296 4294967296")]);
    assert_says(nrrd(&overflow, &[0; 8]), &["more than 2^64"]);
    assert_says(nrrd(&nrrd_with(&[("encoding", "ascii")]), b"1 2 3"), &["promises 8 numbers", "holds 3"]);
    assert_says(nrrd(&nrrd_with(&[("encoding", "ascii")]), b"1 2 3 300 5 6 7 8"), &["300 at number 3 does not fit u8"]);
}

#[test]
fn a_compressed_stream_costs_only_the_memory_that_it_fills() {
    // 8 GiB promised within a limit of 16 GiB, of a file that is too short for it however well it is compressed; one that is not
    // ends where its stream does.
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(&[7; 100]).unwrap();
    let data = packed.finish().unwrap();
    let header = nrrd_with(&[("sizes", "2048 2048 2048"), ("encoding", "gzip")]);
    let bytes = [header.as_bytes(), b"\n", &data].concat();
    let options = ReadOptions { memory_limit_bytes: Some(16 << 30), ..ReadOptions::default() };
    let result = read_bytes(&bytes, None, "t.nrrd", &options);
    assert_says(result, &["promises 8589934592 bytes", &format!("holds {} at most", 1032 * data.len())]);
    let header = nrrd_with(&[("sizes", "16 16 16"), ("encoding", "gzip")]);
    let bytes = [header.as_bytes(), b"\n", &data].concat();
    assert_says(read_bytes(&bytes, None, "t.nrrd", &options), &["promises 4096 bytes", "holds 100"]);
}

#[test]
fn damaged_gzip_is_noticed_wherever_it_is() {
    let good = fixture("nrrd", "uint16_gzip_little.nrrd");
    let data = good.windows(2).position(|w| w == b"\n\n").unwrap() + 2;
    let refused = |bytes: &[u8]| read_bytes(bytes, None, "t.nrrd", &ReadOptions::default());
    // Each byte of the trailer: checksum and length; the stream cut at each place.
    for byte in good.len() - 8..good.len() {
        let mut bad = good.clone();
        bad[byte] ^= 0x10;
        assert_says(refused(&bad), &["compressed stream is damaged"]);
    }
    for length in data..good.len() {
        assert!(refused(&good[..length]).is_err(), "cut at {length} of {}", good.len());
    }
}

#[test]
fn every_prefix_of_every_kind_is_refused() {
    for (pack, name) in [
        ("nrrd", "int32_raw_big.nrrd"),
        ("nrrd", "float32_gzip_little.nrrd"),
        ("nifti", "int16_big.nii"),
        ("nifti", "float64_little.nii.gz"),
        ("metaimage", "uint32_raw.mha"),
        ("metaimage", "float32_zlib.mha"),
    ] {
        let good = fixture(pack, name);
        for length in 0..good.len() {
            let result = read_bytes(&good[..length], FileFormat::of_path(name.as_ref()), name, &ReadOptions::default());
            assert!(result.is_err(), "{name} cut at {length} of {}", good.len());
        }
    }
}

#[test]
fn memory_is_limited_before_it_is_taken() {
    let good = fixture("nrrd", "uint16_raw_little.nrrd");
    let with = |limit| ReadOptions { memory_limit_bytes: Some(limit), ..ReadOptions::default() };
    assert!(read_bytes(&good, None, "t.nrrd", &with(120)).is_ok());
    assert_says(read_bytes(&good, None, "t.nrrd", &with(119)), &["need 120 bytes", "limit is 119"]);
}

#[test]
fn sixty_four_bit_integers_must_fit_thirty_two() {
    let header = nrrd_with(&[("type", "int64"), ("sizes", "1 1 2"), ("encoding", "ascii")]);
    assert_eq!(nrrd(&header, b"-2147483648 2147483647").unwrap().range().unwrap(), (-2147483648.0, 2147483647.0));
    assert_says(nrrd(&header, b"1 2147483648"), &["2147483648 at number 1 does not fit i32", "f64"]);
    let header = nrrd_with(&[("type", "uint64"), ("sizes", "1 1 2"), ("endian", "big")]);
    let data = [0u64.to_be_bytes(), (1u64 << 32).to_be_bytes()].concat();
    assert_says(nrrd(&header, &data), &["4294967296 at number 1 does not fit u32"]);
}

#[test]
fn type_names_of_nrrd_and_their_synonyms() {
    let names = [
        ("signed char,int8,int8_t", SampleType::I8),
        ("uchar,unsigned char,uint8,uint8_t", SampleType::U8),
        ("short,short int,signed short,signed short int,int16,int16_t", SampleType::I16),
        ("ushort,unsigned short,unsigned short int,uint16,uint16_t", SampleType::U16),
        ("int,signed int,int32,int32_t,longlong,long long,long long int,signed long long", SampleType::I32),
        ("signed long long int,int64,int64_t", SampleType::I32),
        ("uint,unsigned int,uint32,uint32_t,ulonglong,unsigned long long", SampleType::U32),
        ("unsigned long long int,uint64,uint64_t", SampleType::U32),
        ("float", SampleType::F32),
        ("double", SampleType::F64),
    ];
    for (list, kept) in names {
        for name in list.split(',') {
            let volume = nrrd(&nrrd_with(&[("type", name)]), &[0; 64]).unwrap();
            assert_eq!(volume.sample_type(), kept, "{name}");
        }
    }
}

const METAIMAGE: &str = "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_SHORT\n";

#[test]
fn metaimage_by_hand() {
    let data: Vec<u8> = (0..8i16).flat_map(|v| (v * 1000).to_be_bytes()).collect();
    let header = format!(
        "{METAIMAGE}ElementSpacing = 1 2 3\nPosition = 4 5 6\nBinaryDataByteOrderMSB = True\nStranger = 7\n\
         ElementDataFile = LOCAL\n"
    );
    let volume = metaimage(&header, &data).unwrap();
    assert_eq!((volume.spacing, volume.origin), ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]));
    assert_eq!(volume.value(1, 1, 1), 7000.0);
    let header = format!("{METAIMAGE}BinaryData = False\nElementDataFile = LOCAL\n");
    assert_eq!(metaimage(&header, b"1 2 3 4 5 6 7 -8").unwrap().value(1, 1, 1), -8.0);
    let header = format!("{METAIMAGE}HeaderSize = -1\nElementByteOrderMSB = True\nElementDataFile = LOCAL\n");
    assert_eq!(metaimage(&header, &[b"xxxx", &data[..]].concat()).unwrap().value(1, 0, 0), 1000.0);
}

#[test]
fn metaimage_keys_that_cannot_be() {
    let local = "ElementDataFile = LOCAL\n";
    let cases = [
        (format!("{METAIMAGE}nonsense\n{local}"), "line 5"),
        (format!("{METAIMAGE}ElementSpacing = 1 0 1\n{local}"), "spacing"),
        (format!("{METAIMAGE}ElementNumberOfChannels = 3\n{local}"), "a voxel of 3 numbers"),
        (format!("{METAIMAGE}CompressedData = Perhaps\n{local}"), "'perhaps' is no flag"),
        (format!("{METAIMAGE}CompressedData = True\n{local}"), "compressed stream is damaged"),
        (format!("{METAIMAGE}ElementDataFile = LIST\n"), "an empty list"),
        (format!("{METAIMAGE}ElementDataFile = s%03d.raw 1 2 1\n"), "beside bytes in memory"),
        (format!("{METAIMAGE}ElementDataFile = s%03d.raw 1 3 1\n"), "3 files of 2 axes for a grid of 2×2×2"),
        (format!("{METAIMAGE}TransformMatrix = 1 0 0 0 1 0\n{local}"), "6 numbers for 3 axes"),
        (format!("{METAIMAGE}TransformMatrix = 1 0 0 0 1 0 0 0 0\n{local}"), "lie in one plane"),
        (METAIMAGE.replace("MET_SHORT", "MET_SHORT_ARRAY") + local, "several numbers (MET_SHORT_ARRAY)"),
        (METAIMAGE.to_owned(), "'ElementDataFile' is missing"),
        (METAIMAGE.replace("MET_SHORT", "MET_STRING") + local, "the type 'MET_STRING'"),
        (METAIMAGE.replace("2 2 2", "2 2") + local, "2 values for 3 axes"),
        (METAIMAGE.replace("2 2 2", "2 2 3") + local, "promises 24 bytes"),
        (METAIMAGE.replace("Image", "Tube") + local, "a 'Tube'"),
    ];
    for (header, part) in cases {
        assert_says(metaimage(&header, &[b'\n'; 16]), &[part]);
    }
}

#[test]
fn nifti_fields_that_cannot_be() {
    let good = fixture("nifti", "int16_little.nii");
    let with = |at: usize, bytes: &[u8]| {
        let mut bad = good.clone();
        bad[at..at + bytes.len()].copy_from_slice(bytes);
        read_bytes(&bad, Some(FileFormat::Nifti), "t.nii", &ReadOptions::default())
    };
    assert_says(with(42, &(-1i16).to_le_bytes()), &["'dim[1]'", "a size of -1"]);
    assert_says(with(44, &0i16.to_le_bytes()), &["'dim[2]'", "a size of 0"]);
    assert_says(with(40, &0i16.to_le_bytes()), &["'dim[0]'"]);
    assert_says(with(42, &30000i16.to_le_bytes()), &["promises 1200000 bytes", "holds 120"]);
    assert_says(with(70, &128i16.to_le_bytes()), &["a voxel of 3 numbers (RGB)"]);
    assert_says(with(70, &32i16.to_le_bytes()), &["a voxel of 2 numbers (complex)"]);
    assert_says(with(70, &1i16.to_le_bytes()), &["the type of code 1 "]);
    assert_says(with(72, &32i16.to_le_bytes()), &["'bitpix'", "32 bits for a type of 16"]);
    assert_says(with(108, &17.5f32.to_le_bytes()), &["'vox_offset'"]);
    assert_says(with(112, &f32::INFINITY.to_le_bytes()), &["'scl_slope'"]);
    assert_says(with(344, b"what"), &["header"]);
}

#[test]
fn raw_files_must_be_described_and_of_that_length() {
    let data: Vec<u8> = (0..24u16).flat_map(|v| (v * 300).to_be_bytes()).collect();
    let from = |raw: Option<RawLayout>| {
        read_bytes(&data, Some(FileFormat::Raw), "t.raw", &ReadOptions { raw, ..ReadOptions::default() })
    };
    let layout = RawLayout { endian: Endian::Big, ..RawLayout::new([2, 3, 4], SampleType::U16) };
    assert_eq!(from(Some(layout.clone())).unwrap().value(1, 2, 3), 6900.0);
    let skipped = RawLayout { skip_bytes: 24, dims: [2, 3, 2], ..layout.clone() };
    assert_eq!(from(Some(skipped)).unwrap().value(0, 0, 0), 3600.0);
    assert_says(from(None), &["dimensions", "sample type", "endian"]);
    let wrong = RawLayout { dims: [2, 3, 3], ..layout.clone() };
    assert_says(from(Some(wrong)), &["2×3×3 of u16", "needs 36 bytes", "holds 48"]);
    let huge = RawLayout { dims: [usize::MAX; 3], ..layout.clone() };
    assert!(from(Some(huge)).is_err());
    assert_says(from(Some(RawLayout { spacing: [0.0; 3], ..layout })), &["spacing"]);
}

#[test]
fn files_that_are_not_there_or_not_volumes() {
    let folder = tempfile::tempdir().unwrap();
    let options = ReadOptions::default();
    assert_says(read(folder.path().join("no.nrrd"), &options), &["no.nrrd", "cannot open", "give the path"]);
    assert_says(read(folder.path(), &options), &["not a file", "give the path"]);
    let path = folder.path().join("letter.txt");
    std::fs::write(&path, "Dear reader").unwrap();
    assert_says(read(&path, &options), &["letter.txt", "unknown volume format", ".nii"]);
    let path = folder.path().join("alone.nhdr");
    std::fs::write(&path, nrrd_with(&[("data file", "gone.raw")])).unwrap();
    assert_says(read(&path, &options), &["gone.raw", "cannot open", "give the path"]);
}

/// What the system refuses says what to do, in each of the three things that are done with files.
#[test]
fn the_systems_refusals_have_a_remedy() {
    let volume = Volume::new([1; 3], [1.0; 3], Samples::U8(vec![0])).unwrap();
    for name in ["volume.raw", "volume.nrrd", "volume.nii", "volume.nii.gz", "volume.mha"] {
        let path = format!("no such folder/{name}");
        let message = cube3_volume::write(&path, &volume).unwrap_err().to_string();
        assert!(message.starts_with(&format!("{path}: cannot write: ")), "{message}");
        assert!(
            message.ends_with("; give a path in a folder that is there and may be written to, with room for the file")
        );
    }
    let io = |action| VolumeError::Io { file: "a.raw".into(), action, source: std::io::Error::other("broken") };
    assert_eq!(
        io("read").to_string(),
        "a.raw: cannot read: broken; look whether the file is whole and its drive still answers"
    );
    assert_eq!(
        io("open").to_string(),
        "a.raw: cannot open: broken; give the path of a file that is there and may be read"
    );
}
