//! NIfTI-1 and NIfTI-2, in one file (`.nii`) or two (`.hdr` and `.img`), and Analyze 7.5, which NIfTI-1 was made from.
//!
//! <https://nifti.nimh.nih.gov>: nifti1.h, nifti2.h. The world is that of sform where its code is above 0, else that of qform
//! where its code is above 0, else not known. Spacing is the length of a step in that world, or `pixdim`, whose sign means nothing.
//! Lengths in metres or microns (`xyzt_units`) become mm.
//! Analyze 7.5 has neither, and says nothing of the sides of a patient that its writers agree on.
//!
//! Where the header scales (slope neither 0 nor NaN, and slope ≠ 1 or intercept ≠ 0) the samples become f32, or f64 from 32-bit
//! integers and f64.

use std::path::{Path, PathBuf};

use crate::described::Described;
use crate::layout::{Encoding, Layout, Series, Skip, StoredType};
use crate::parts::Data;
use crate::place::{Place, is_gz, without_gz};
use crate::source::{Source, read_full};
use crate::world::{Placed, Space};
use crate::{SampleType, VolumeError};

/// Bytes of a header of NIfTI-1 and Analyze, and of NIfTI-2.
const SIZES: [usize; 2] = [348, 540];

/// Which of the formats a header is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Version {
    Analyze,
    One,
    Two,
}

/// A header's fields, in either byte order.
struct Header {
    bytes: Vec<u8>,
    big: bool,
    version: Version,
    /// The voxels are in another file.
    pair: bool,
}

/// A field's place in a header of NIfTI-1 and of NIfTI-2.
type At = (usize, usize);

macro_rules! number {
    ($name:ident, $number:ident) => {
        fn $name(&self, at: usize) -> $number {
            let mut bytes = [0; size_of::<$number>()];
            bytes.copy_from_slice(&self.bytes[at..at + size_of::<$number>()]);
            if self.big { $number::from_be_bytes(bytes) } else { $number::from_le_bytes(bytes) }
        }
    };
}

impl Header {
    number!(i16, i16);
    number!(i32, i32);
    number!(i64, i64);
    number!(f32, f32);
    number!(f64, f64);

    fn parse(source: &mut Source, place: &Place) -> Result<Header, VolumeError> {
        let mut bytes = vec![0; SIZES[0]];
        let mut got = read_full(source, &mut bytes).map_err(|e| place.io("read", e))?;
        let size = |big: bool| Header { bytes: bytes[..4].to_vec(), big, version: Version::One, pair: false }.i32(0);
        let two = [size(false), size(true)].contains(&(SIZES[1] as i32));
        let big = [SIZES[0], SIZES[1]].contains(&(size(true) as usize));
        let one = [size(false), size(true)].contains(&(SIZES[0] as i32));
        if two {
            bytes.resize(SIZES[1], 0);
            got += read_full(source, &mut bytes[SIZES[0]..]).map_err(|e| place.io("read", e))?;
        }
        if got < bytes.len() {
            return Err(place.wrong(
                "header",
                format!("{got} bytes where a NIfTI header has {}", bytes.len()),
                "the file is cut short or of another format",
            ));
        }
        let magic = if two { &bytes[4..8] } else { &bytes[344..348] };
        let (version, pair) = match magic {
            b"n+1\0" if one => (Version::One, false),
            b"ni1\0" if one => (Version::One, true),
            b"n+2\0" if two => (Version::Two, false),
            b"ni2\0" if two => (Version::Two, true),
            // Analyze has no magic; a header of its size beside a file of voxels is one.
            _ if one && is_header(place) => (Version::Analyze, true),
            _ => {
                return Err(place.wrong(
                    "header",
                    "neither NIfTI-1, NIfTI-2 nor Analyze 7.5",
                    "a NIfTI-1 file has 348 in its first bytes and 'n+1' at byte 344; give the file's real format",
                ));
            }
        };
        Ok(Header { bytes, big, version, pair })
    }

    /// A number that NIfTI-1 keeps in single precision: the shortest decimal that stands for it, which is what its writer had.
    fn real(&self, at: At) -> f64 {
        if self.version == Version::Two {
            return self.f64(at.1);
        }
        let single = self.f32(at.0);
        single.to_string().parse().unwrap_or(f64::from(single))
    }

    fn short(&self, at: At) -> i16 {
        self.i16(if self.version == Version::Two { at.1 } else { at.0 })
    }

    fn code(&self, at: At) -> i32 {
        match self.version {
            Version::Analyze => 0,
            Version::One => self.i16(at.0).into(),
            Version::Two => self.i32(at.1),
        }
    }

    /// Millimetres of the header's unit of space; a millimetre where it names none.
    fn unit_mm(&self) -> f64 {
        let units = match self.version {
            Version::Analyze => 0,
            Version::One => i32::from(self.bytes[123]),
            Version::Two => self.i32(500),
        };
        match units & 7 {
            1 => 1000.0,
            3 => 0.001,
            _ => 1.0,
        }
    }

    fn dim(&self, axis: usize) -> i64 {
        if self.version == Version::Two { self.i64(16 + 8 * axis) } else { self.i16(40 + 2 * axis).into() }
    }

    /// A length in the header's unit, in mm.
    fn length(&self, at: At) -> f64 {
        self.real(at) * self.unit_mm()
    }

    fn pixdim(&self, axis: usize) -> f64 {
        self.length((76 + 4 * axis, 104 + 8 * axis))
    }
}

/// Whether a file is a header by its name.
fn is_header(place: &Place) -> bool {
    place.path().is_some_and(|path| has_extension(&without_gz(path), "hdr"))
}

fn has_extension(path: &Path, name: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(name))
}

/// Where the header of a file is: beside the voxels of a `.img`, else in the file itself.
pub(crate) fn header_path(path: &Path) -> Result<PathBuf, VolumeError> {
    if !has_extension(&without_gz(path), "img") {
        return Ok(path.to_owned());
    }
    twin(path, ["hdr", "HDR"]).ok_or_else(|| {
        Place::of_path(path).wrong(
            "header",
            format!("there is no {} beside it", without_gz(path).with_extension("hdr").display()),
            "a .img holds voxels alone; give its .hdr too",
        )
    })
}

/// The file of a pair that lies beside another, plain or gzipped.
fn twin(path: &Path, extensions: [&str; 2]) -> Option<PathBuf> {
    let bare = without_gz(path);
    let plain = extensions.map(|extension| bare.with_extension(extension));
    let packed = plain.clone().map(|path| {
        let mut name = path.into_os_string();
        name.push(".gz");
        PathBuf::from(name)
    });
    plain.into_iter().chain(packed).find(|path| path.is_file())
}

/// Reads the header from its first byte.
pub(crate) fn describe<'a>(mut source: Source<'a>, place: &Place) -> Result<Described<'a>, VolumeError> {
    let header = Header::parse(&mut source, place)?;
    let (dims, volumes) = dims(&header, place)?;
    let (stored, mut remarks) = (stored_type(&header, place)?, Vec::new());
    let placed = placed(&header, dims, place, &mut remarks)?;
    let offset = voxel_offset(&header, place)?;
    let data = if header.pair {
        let path = place.path().and_then(|path| twin(path, ["img", "IMG"])).ok_or_else(|| {
            place.wrong("voxel data", "there is no .img beside the header", "keep the two files of a pair together")
        })?;
        let unpack = is_gz(&path);
        Data::Beside { files: vec![path], unpack }
    } else {
        Data::Here(source)
    };
    let layout = Layout {
        dims,
        stored,
        big_endian: header.big,
        encoding: Encoding::Raw,
        lines: 0,
        skip: Skip::Bytes(offset),
        series: Series::After(volumes),
        scale: scale(&header, place)?,
        last: false,
    };
    Ok(Described { layout, placed, data, remarks })
}

fn dims(header: &Header, place: &Place) -> Result<([usize; 3], u64), VolumeError> {
    let remedy = "give 1 to 7 axes with sizes of at least 1";
    let axes = header.dim(0);
    if !(1..=7).contains(&axes) {
        return Err(place.wrong("field 'dim[0]'", format!("{axes} axes"), remedy));
    }
    let mut sizes = [1; 8];
    for (axis, known) in sizes.iter_mut().enumerate().skip(1).take(axes as usize) {
        let size = header.dim(axis);
        *known = usize::try_from(size)
            .ok()
            .filter(|&size| size > 0)
            .ok_or_else(|| place.wrong(format!("field 'dim[{axis}]'"), format!("a size of {size}"), remedy))?;
    }
    // The fifth axis is that of a vector's components; the sixth and seventh have no meaning of their own.
    let several: u64 = sizes[5..].iter().fold(1, |p, &s| p.saturating_mul(s as u64));
    if several > 1 {
        return Err(place.several("field 'dim[5]'", Some(several), "vector"));
    }
    Ok(([sizes[1], sizes[2], sizes[3]], sizes[4] as u64))
}

fn stored_type(header: &Header, place: &Place) -> Result<StoredType, VolumeError> {
    use SampleType::*;
    let code = header.short((70, 12));
    let several = |numbers, kind| Err(place.several("field 'datatype'", Some(numbers), kind));
    let stored = match code {
        2 => StoredType::Plain(U8),
        4 => StoredType::Plain(I16),
        8 => StoredType::Plain(I32),
        16 => StoredType::Plain(F32),
        64 => StoredType::Plain(F64),
        256 => StoredType::Plain(I8),
        512 => StoredType::Plain(U16),
        768 => StoredType::Plain(U32),
        1024 => StoredType::I64,
        1280 => StoredType::U64,
        32 | 1792 | 2048 => return several(2, "complex"),
        128 => return several(3, "RGB"),
        2304 => return several(4, "RGBA"),
        code => {
            return Err(place.unsupported(
                "field 'datatype'",
                format!("the type of code {code}"),
                "store one integer of 8 to 64 bits, or a 32- or 64-bit float, for each voxel",
            ));
        }
    };
    let (bits, said) = (stored.bytes() * 8, header.short((72, 14)));
    if said != bits as i16 {
        return Err(place.wrong(
            "field 'bitpix'",
            format!("{said} bits for a type of {bits}"),
            "datatype and bitpix must agree",
        ));
    }
    Ok(stored)
}

/// Bytes between the header and the voxels, or before the voxels of their own file.
fn voxel_offset(header: &Header, place: &Place) -> Result<u64, VolumeError> {
    let offset = match header.version {
        Version::Two => header.i64(168) as f64,
        _ => f64::from(header.f32(108)),
    };
    let own = if header.pair { 0 } else { header.bytes.len() as u64 };
    // 0 is common and means the least that the format allows: 4 bytes behind the header, which say that nothing follows.
    if offset == 0.0 {
        return Ok(if header.pair { 0 } else { 4 });
    }
    if offset >= own as f64 && offset < 1e15 && offset.fract() == 0.0 {
        return Ok(offset as u64 - own);
    }
    Err(place.wrong(
        "field 'vox_offset'",
        format!("voxels at byte {offset}"),
        format!("it must be a whole number from {own} on, usually {}", if own > 0 { own + 4 } else { 0 }),
    ))
}

fn scale(header: &Header, place: &Place) -> Result<Option<[f64; 2]>, VolumeError> {
    if header.version == Version::Analyze {
        return Ok(None);
    }
    let exact = |at: At| if header.version == Version::Two { header.f64(at.1) } else { f64::from(header.f32(at.0)) };
    let (slope, intercept) = (exact((112, 176)), exact((116, 184)));
    // Slope 0 means "not scaled"; nibabel writes NaN for the same.
    if slope == 0.0 || slope.is_nan() || (slope == 1.0 && intercept == 0.0) {
        return Ok(None);
    }
    if !slope.is_finite() || !intercept.is_finite() {
        return Err(place.wrong(
            "fields 'scl_slope' and 'scl_inter'",
            format!("value = number·{slope} + {intercept}"),
            "both must be finite; slope 0 means not scaled",
        ));
    }
    Ok(Some([slope, intercept]))
}

/// Where the grid lies: by sform, by qform, or by `pixdim` alone.
fn placed(header: &Header, dims: [usize; 3], place: &Place, remarks: &mut Vec<String>) -> Result<Placed, VolumeError> {
    let known = |s: f64| s.is_finite() && s > 0.0;
    let spacing = [0, 1, 2].map(|a| {
        let said = header.pixdim(a + 1).abs();
        let exists = a < header.dim(0) as usize;
        let single = dims[a] == 1 && !known(said);
        if exists && (single || said.is_nan()) {
            remarks.push(format!("pixdim[{}] is {said}: the spacing is taken as 1", a + 1));
        }
        if !exists || single || said.is_nan() { 1.0 } else { said }
    });
    let sform = (header.code((254, 348)) > 0).then(|| sform(header));
    let good = |columns: &[[f64; 3]; 3]| {
        let length = |c: &[f64; 3]| c.iter().map(|x| x * x).sum::<f64>().sqrt();
        (0..3).all(|a| dims[a] == 1 || known(length(&columns[a])))
    };
    if let Some((columns, origin)) = sform {
        let lengths = columns.map(|c| c.iter().map(|x| x * x).sum::<f64>().sqrt());
        let said = [0, 1, 2].map(|a| header.pixdim(a + 1).abs());
        let agrees = |a: usize| (lengths[a] - said[a]).abs() <= 1e-4 * said[a];
        // A single slice has no step that could be wrong.
        let by_steps = [0, 1, 2].map(|a| {
            let step = !agrees(a) && known(lengths[a]) && (dims[a] > 1 || known(said[a]));
            if step { lengths[a] } else { spacing[a] }
        });
        let steps = columns.map(|c| c.iter().any(|x| *x != 0.0).then_some(c));
        let placed = match good(&columns) {
            true => Placed::steps(Space::Patient, steps, by_steps, origin),
            false => Err("a step has no length"),
        };
        match placed {
            Ok(placed) => {
                for a in (0..3).filter(|&a| dims[a] > 1 && !agrees(a) && known(said[a])) {
                    let (said, length) = (said[a], lengths[a]);
                    remarks.push(format!("pixdim[{}] is {said}, a step of sform {length}: sform is taken", a + 1));
                }
                return Ok(placed);
            }
            Err(reason) => remarks.push(format!("sform: {reason}: it is passed over")),
        }
    }
    if header.code((252, 344)) > 0 {
        let (columns, origin) = qform(header);
        let steps = columns.map(Some);
        return Placed::steps(Space::Patient, steps, spacing, origin)
            .map_err(|reason| place.wrong("fields 'quatern_b' to 'quatern_d'", reason, "write a quaternion"));
    }
    Ok(Placed::unknown(spacing, [0.0; 3]))
}

/// The steps along the axes, and the place of the first voxel.
fn sform(header: &Header) -> ([[f64; 3]; 3], [f64; 3]) {
    let row = |r: usize| [0, 1, 2, 3].map(|c| header.length((280 + 16 * r + 4 * c, 400 + 32 * r + 8 * c)));
    let rows = [row(0), row(1), row(2)];
    ([0, 1, 2].map(|a| rows.map(|row| row[a])), rows.map(|row| row[3]))
}

/// The same of a quaternion, the steps of unit length.
fn qform(header: &Header) -> ([[f64; 3]; 3], [f64; 3]) {
    let [mut b, mut c, mut d] = [0, 1, 2].map(|i| header.real((256 + 4 * i, 352 + 8 * i)));
    let rest = 1.0 - (b * b + c * c + d * d);
    // A half turn, or numbers that rounding made a little too long.
    let a = if rest < 1e-7 {
        let length = (b * b + c * c + d * d).sqrt();
        [b, c, d] = [b / length, c / length, d / length];
        0.0
    } else {
        rest.sqrt()
    };
    let hand = if header.pixdim(0) < 0.0 { -1.0 } else { 1.0 };
    let columns = [
        [a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)],
        [2.0 * (b * c - a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d + a * b)],
        [hand * 2.0 * (b * d + a * c), hand * 2.0 * (c * d - a * b), hand * (a * a + d * d - b * b - c * c)],
    ];
    (columns, [0, 1, 2].map(|i| header.length((268 + 4 * i, 376 + 8 * i))))
}
