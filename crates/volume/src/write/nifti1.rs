//! The header of a NIfTI-1 in one file, little-endian; its numbers are single precision.
//!
//! `sform` has the steps of the axes, whatever they are; `qform`, a turn and a sign, is written where the axes are at right angles.

use glam::{DMat3, DQuat, DVec3};

use super::is_identity;
use crate::place::Place;
use crate::{SampleType, Space, Volume, VolumeError};

/// Bytes before the voxels: the header and four zeros, which say that no extension follows.
const BYTES: usize = 352;
/// Cosine of two axes that counts as a right angle: the rounding of single precision.
const RIGHT_ANGLE: f64 = 1e-5;

/// All bytes before the voxels.
///
/// # Errors
///
/// Sizes and numbers that the fields cannot hold.
pub(super) fn header(volume: &Volume, place: &Place) -> Result<[u8; BYTES], VolumeError> {
    let mut fields = Fields([0; BYTES]);
    fields.put(0, 348i32.to_le_bytes());
    fields.put(40, 3i16.to_le_bytes());
    for axis in 0..3 {
        fields.put(42 + 2 * axis, size(volume.dims[axis], place)?.to_le_bytes());
    }
    // The axes that are not there are 1 long.
    (4..8).for_each(|axis| fields.put(40 + 2 * axis, 1i16.to_le_bytes()));
    let (code, bits) = match volume.sample_type() {
        SampleType::U8 => (2i16, 8i16),
        SampleType::I16 => (4, 16),
        SampleType::I32 => (8, 32),
        SampleType::F32 => (16, 32),
        SampleType::F64 => (64, 64),
        SampleType::I8 => (256, 8),
        SampleType::U16 => (512, 16),
        SampleType::U32 => (768, 32),
    };
    fields.put(70, code.to_le_bytes());
    fields.put(72, bits.to_le_bytes());
    fields.put(76, 1f32.to_le_bytes());
    for axis in 0..3 {
        let spacing = single(volume.spacing[axis], "spacing", place)?;
        if spacing < f32::MIN_POSITIVE {
            return Err(unfit(volume.spacing[axis], "spacing", place));
        }
        fields.put(80 + 4 * axis, spacing.to_le_bytes());
    }
    fields.put(108, (BYTES as f32).to_le_bytes());
    fields.put(112, 1f32.to_le_bytes());
    fields.put(344, *b"n+1\0");
    if volume.world.space != Space::Unknown {
        // Units of millimetres.
        fields.put(123, [2]);
        sform(&mut fields, volume, place)?;
        qform(&mut fields, volume, place)?;
    }
    Ok(fields.0)
}

/// What the header cannot say of the volume.
pub(super) fn remarks(volume: &Volume) -> Vec<String> {
    let remark = match volume.world.space {
        Space::Patient => return Vec::new(),
        Space::Room => "NIfTI knows no room; coordinates are written as if they were the patient's",
        Space::Unknown if is_identity(&volume.world) && volume.origin == [0.0; 3] => return Vec::new(),
        Space::Unknown => "NIfTI keeps no place in a world that is not known; origin and directions are lost",
    };
    vec![remark.to_owned()]
}

/// Bytes at their places.
struct Fields([u8; BYTES]);

impl Fields {
    fn put<const N: usize>(&mut self, at: usize, bytes: [u8; N]) {
        self.0[at..at + N].copy_from_slice(&bytes);
    }
}

fn size(size: usize, place: &Place) -> Result<i16, VolumeError> {
    i16::try_from(size).map_err(|_| {
        place.unsupported(
            "dimensions",
            format!("a size of {size} in NIfTI-1, which ends at 32767,"),
            "give a name that ends in .nrrd",
        )
    })
}

fn unfit(number: f64, what: &'static str, place: &Place) -> VolumeError {
    place.unsupported(
        what,
        format!("{number:e} in NIfTI-1, whose numbers are single precision,"),
        "give a name that ends in .nrrd",
    )
}

fn single(number: f64, what: &'static str, place: &Place) -> Result<f32, VolumeError> {
    let single = number as f32;
    if single.is_finite() { Ok(single + 0.0) } else { Err(unfit(number, what, place)) }
}

/// Code 1 (the scanner's axes) and three rows: the components of the steps and of the origin.
fn sform(fields: &mut Fields, volume: &Volume, place: &Place) -> Result<(), VolumeError> {
    fields.put(254, 1i16.to_le_bytes());
    for row in 0..3 {
        let step = |axis: usize| volume.world.directions[axis][row] * volume.spacing[axis];
        for (column, number) in [step(0), step(1), step(2), volume.origin[row]].into_iter().enumerate() {
            fields.put(280 + 16 * row + 4 * column, single(number, "origin", place)?.to_le_bytes());
        }
    }
    Ok(())
}

/// Code 1, a quaternion with its real part positive and left out, and in `pixdim[0]` the sign of the third axis.
fn qform(fields: &mut Fields, volume: &Volume, place: &Place) -> Result<(), VolumeError> {
    let [x, y, z] = volume.world.directions.map(DVec3::from);
    if x.dot(y).abs().max(x.dot(z).abs()).max(y.dot(z).abs()) > RIGHT_ANGLE {
        return Ok(());
    }
    let sign = if x.cross(y).dot(z) < 0.0 { -1.0 } else { 1.0 };
    let turn = DQuat::from_mat3(&DMat3::from_cols(x, y, z * sign)).normalize();
    let turn = if turn.w < 0.0 { -turn } else { turn };
    fields.put(76, (sign as f32).to_le_bytes());
    fields.put(252, 1i16.to_le_bytes());
    for (field, number) in [turn.x, turn.y, turn.z].into_iter().chain(volume.origin).enumerate() {
        fields.put(256 + 4 * field, single(number, "origin", place)?.to_le_bytes());
    }
    Ok(())
}
