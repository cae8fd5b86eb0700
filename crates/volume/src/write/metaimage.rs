//! The header of a MetaImage as ITK writes it, with the voxels behind it.
//!
//! Coordinates are LPS: x to the left, y to the back, z to the head. `TransformMatrix` has the directions of the axes, one
//! behind the other. `AnatomicalOrientation` has the side that each axis comes from.

use super::is_identity;
use crate::world::letter;
use crate::{AxisOrder, SampleType, Space, Volume};

/// All lines; `packed_bytes` is the length of compressed voxels.
pub(super) fn header(volume: &Volume, packed_bytes: Option<usize>) -> String {
    let [nx, ny, nz] = volume.dims;
    let [sx, sy, sz] = volume.spacing;
    let element_type = match volume.sample_type() {
        SampleType::U8 => "MET_UCHAR",
        SampleType::I8 => "MET_CHAR",
        SampleType::U16 => "MET_USHORT",
        SampleType::I16 => "MET_SHORT",
        SampleType::U32 => "MET_UINT",
        SampleType::I32 => "MET_INT",
        SampleType::F32 => "MET_FLOAT",
        SampleType::F64 => "MET_DOUBLE",
    };
    let compression = match packed_bytes {
        Some(bytes) => format!("CompressedData = True\nCompressedDataSize = {bytes}"),
        None => "CompressedData = False".to_owned(),
    };
    let place = if places_nothing(volume) {
        format!("Offset = {}\nCenterOfRotation = 0 0 0", numbers(volume.origin))
    } else {
        let matrix = volume.world.directions.map(|direction| numbers(lps(direction))).join(" ");
        let offset = numbers(lps(volume.origin));
        let order = AxisOrder::closest(volume.world.directions);
        let from = |i: usize| letter(Space::Patient, order.axis[i], !order.backward[i]);
        let orientation: String = (0..3).map(from).collect();
        format!(
            "TransformMatrix = {matrix}\nOffset = {offset}\nCenterOfRotation = 0 0 0\n\
             AnatomicalOrientation = {orientation}"
        )
    };
    format!(
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n{compression}\n{place}\n\
         ElementSpacing = {sx} {sy} {sz}\nDimSize = {nx} {ny} {nz}\nElementType = {element_type}\n\
         ElementDataFile = LOCAL\n"
    )
}

/// What the header cannot say of the volume.
pub(super) fn remarks(volume: &Volume) -> Vec<String> {
    let what = match volume.world.space {
        Space::Patient => return Vec::new(),
        Space::Unknown if places_nothing(volume) => return Vec::new(),
        Space::Unknown => "the world's axes are not known; they are",
        Space::Room => "a MetaImage knows no room; coordinates are",
    };
    vec![format!("{what} written as if they were the patient's")]
}

/// Whether nothing but an offset is known: then there is no matrix, which would mean a patient.
fn places_nothing(volume: &Volume) -> bool {
    volume.world.space == Space::Unknown && is_identity(&volume.world)
}

fn lps([x, y, z]: [f64; 3]) -> [f64; 3] {
    // Not -x: there are no negative zeros.
    [0.0 - x, 0.0 - y, z]
}

/// Each the shortest decimal that reads back as the same number.
fn numbers(numbers: [f64; 3]) -> String {
    let [x, y, z] = numbers.map(|n| n + 0.0);
    format!("{x} {y} {z}")
}
