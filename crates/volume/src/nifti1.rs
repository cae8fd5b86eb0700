//! NIfTI-1, one file (`.nii`), plain or compressed (`.nii.gz`).
//!
//! The header is read by the `nifti` crate. The voxels are not: that crate makes room for all that a
//! header promises before it has seen one voxel, and keeps the bytes beside the numbers.
//!
//! Where the header scales (slope neither 0 nor NaN, and slope ≠ 1 or intercept ≠ 0) the samples
//! become f32, or f64 from 32-bit integers and f64. Spacing is `pixdim`; the axes stay as stored.

use std::io::Read;

use flate2::bufread::MultiGzDecoder;
use nifti::{Endianness, NiftiHeader};

use crate::place::{Place, Source};
use crate::stream::{Encoding, Layout, Skip, StoredType, read_full};
use crate::volume::check_grid;
use crate::{ReadOptions, SampleType, Volume, VolumeError};

/// Bytes of a NIfTI-1 header.
const HEADER_BYTES: usize = 348;

/// Reads a NIfTI-1 file from its first byte.
pub(crate) fn read(source: &mut dyn Source, options: &ReadOptions, place: &Place) -> Result<Volume, VolumeError> {
    let (bytes, encoding) = header_bytes(source, place)?;
    let header = parse(&bytes, place)?;
    let (dims, frames) = dims(&header, place)?;
    let spacing = [0, 1, 2].map(|a| {
        let exists = a < usize::from(header.dim[0]);
        if exists { f64::from(header.pixdim[a + 1]) } else { 1.0 }
    });
    let origin = origin(&header);
    check_grid(dims, spacing, origin).map_err(|e| place.grid(e))?;
    let layout = Layout {
        dims,
        stored: stored_type(&header, place)?,
        big_endian: header.endianness == Endianness::Big,
        encoding,
        skip: Skip::Bytes(voxel_offset(&header, place)?),
        frames,
        scale: scale(&header, place)?,
    };
    source.rewind().map_err(|e| place.io("read", e))?;
    let samples = layout.read(source, options, place)?;
    Volume::new(dims, spacing, samples)?.with_origin(origin)
}

fn header_bytes(source: &mut dyn Source, place: &Place) -> Result<([u8; HEADER_BYTES], Encoding), VolumeError> {
    let mut magic = [0; 2];
    read_full(source, &mut magic).map_err(|e| place.io("read", e))?;
    source.rewind().map_err(|e| place.io("read", e))?;
    let mut bytes = [0; HEADER_BYTES];
    let compressed = magic == [0x1f, 0x8b];
    let length = if compressed {
        read_full(&mut MultiGzDecoder::new(source), &mut bytes)
            .map_err(|e| VolumeError::Inflate { file: place.file.clone(), reason: e.to_string() })?
    } else {
        read_full(&mut source.take(HEADER_BYTES as u64), &mut bytes).map_err(|e| place.io("read", e))?
    };
    if length < HEADER_BYTES {
        return Err(place.wrong(
            "header",
            format!("{length} bytes where a NIfTI-1 header has {HEADER_BYTES}"),
            "the file is cut short or of another format",
        ));
    }
    Ok((bytes, if compressed { Encoding::Gzip } else { Encoding::Raw }))
}

fn parse(bytes: &[u8; HEADER_BYTES], place: &Place) -> Result<NiftiHeader, VolumeError> {
    if bytes[344..348] == *b"ni1\0" {
        return Err(place.unsupported(
            "field 'magic'",
            "a NIfTI-1 header with its voxels in another file (.hdr and .img)",
            "convert it to .nii",
        ));
    }
    if bytes[..4] == 540i32.to_le_bytes() || bytes[..4] == 540i32.to_be_bytes() {
        return Err(place.unsupported("field 'sizeof_hdr'", "NIfTI-2", "convert it to NIfTI-1"));
    }
    NiftiHeader::from_reader(&bytes[..])
        .map_err(|e| place.wrong("header", e.to_string(), "a NIfTI-1 file has 'n+1' at byte 344"))
}

fn dims(header: &NiftiHeader, place: &Place) -> Result<([usize; 3], u64), VolumeError> {
    let remedy = "give 1 to 7 axes with sizes of 1 to 32767";
    let axes = usize::from(header.dim[0]);
    if !(1..=7).contains(&axes) {
        return Err(place.wrong("field 'dim[0]'", format!("{axes} axes"), remedy));
    }
    for axis in 1..=axes {
        // The crate reads these signed numbers as unsigned.
        let size = header.dim[axis] as i16;
        if size < 1 {
            return Err(place.wrong(format!("field 'dim[{axis}]'"), format!("a size of {size}"), remedy));
        }
    }
    let size = |axis: usize| if axis <= axes { usize::from(header.dim[axis]) } else { 1 };
    let frames = (4..=7).fold(1u64, |p, axis| p.saturating_mul(size(axis) as u64));
    Ok(([size(1), size(2), size(3)], frames))
}

fn stored_type(header: &NiftiHeader, place: &Place) -> Result<StoredType, VolumeError> {
    use SampleType::*;
    let stored = match header.datatype {
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
        code => {
            return Err(place.unsupported(
                "field 'datatype'",
                format!("the type of code {code}"),
                "store one integer of 8 to 64 bits, or a 32- or 64-bit float, for each voxel",
            ));
        }
    };
    let bits = stored.bytes() * 8;
    if header.bitpix != bits as i16 {
        return Err(place.wrong(
            "field 'bitpix'",
            format!("{} bits for a type of {bits}", header.bitpix),
            "datatype and bitpix must agree",
        ));
    }
    Ok(stored)
}

fn voxel_offset(header: &NiftiHeader, place: &Place) -> Result<u64, VolumeError> {
    let offset = header.vox_offset;
    // 0 is common and means the least that the format allows.
    if offset == 0.0 {
        return Ok(352);
    }
    if offset >= HEADER_BYTES as f32 && offset < 1e9 && offset.fract() == 0.0 {
        return Ok(offset as u64);
    }
    Err(place.wrong(
        "field 'vox_offset'",
        format!("voxels at byte {offset}"),
        "it must be a whole number from 348 on, usually 352",
    ))
}

fn scale(header: &NiftiHeader, place: &Place) -> Result<Option<[f64; 2]>, VolumeError> {
    let (slope, intercept) = (f64::from(header.scl_slope), f64::from(header.scl_inter));
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

fn origin(header: &NiftiHeader) -> [f64; 3] {
    let origin = if header.sform_code > 0 {
        [header.srow_x[3], header.srow_y[3], header.srow_z[3]]
    } else if header.qform_code > 0 {
        [header.quatern_x, header.quatern_y, header.quatern_z]
    } else {
        [0.0; 3]
    };
    origin.map(f64::from)
}
