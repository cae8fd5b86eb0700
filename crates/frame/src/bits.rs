//! Bits of registers.

/// Most voxels along an axis: what slope and template registers are exact for.
pub const LARGEST_SIDE: usize = 4096;

/// Fraction bits of a slope register. 17 suffice for n = 512; these are exact for every side that the host takes (4096).
pub const SLOPE_FRACTION_BITS: u32 = 30;

/// Fraction bits of a sample's place in perspective; see [`Geometry::place`](crate::Geometry::place).
pub const PLACE_BITS: u32 = 16;
