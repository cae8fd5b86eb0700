//! The header of an NRRD0005, attached.

use super::Packing;
use crate::{SampleType, Space, Volume};

/// All lines, with the empty one that ends them.
pub(super) fn header(volume: &Volume, packing: Packing) -> String {
    let [nx, ny, nz] = volume.dims;
    let sample_type = match volume.sample_type() {
        SampleType::U8 => "uint8",
        SampleType::I8 => "int8",
        SampleType::U16 => "uint16",
        SampleType::I16 => "int16",
        SampleType::U32 => "uint32",
        SampleType::I32 => "int32",
        SampleType::F32 => "float",
        SampleType::F64 => "double",
    };
    let space = match volume.world.space {
        Space::Unknown => "space dimension: 3",
        Space::Patient => "space: right-anterior-superior",
        Space::Room => "space: 3D-right-handed",
    };
    let encoding = match packing {
        Packing::Plain => "raw",
        Packing::Compressed => "gzip",
    };
    let step = |axis: usize| vector(volume.world.directions[axis].map(|c| c * volume.spacing[axis]));
    let [x, y, z] = [0, 1, 2].map(step);
    let origin = vector(volume.origin);
    format!(
        "NRRD0005\ntype: {sample_type}\ndimension: 3\n{space}\nsizes: {nx} {ny} {nz}\n\
         space directions: {x} {y} {z}\nspace origin: {origin}\n\
         kinds: domain domain domain\nendian: little\nencoding: {encoding}\n\n"
    )
}

/// "{}" writes the shortest decimal that reads back as the same number; there is no negative zero.
fn vector(components: [f64; 3]) -> String {
    let [x, y, z] = components.map(|c| c + 0.0);
    format!("({x},{y},{z})")
}
