//! The ends of rays: registers for the parts of a step that the first and the last sample of a ray stand for.
//!
//! Sample k stands for the depths from k + o − ½ to k + o + ½, the first one of a ray from where the ray enters, the last one to where
//! it leaves: the box of voxel centres, in a label volume of whole voxels, the crop box, the half-spaces of the cuts; in perspective no ray begins before its eye. So the
//! parts of a ray's samples add up to its length.

use crate::{Geometry, HalfSpace, Linear, SLOPE_FRACTION_BITS};
use serde::{Deserialize, Serialize};

/// Registers for the ends of rays.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndRegisters {
    /// The six faces of the box of voxel centres, in a label volume of whole voxels; where the eye is behind the front one, the plane of the
    /// eye stands for it.
    pub faces: [HalfSpace; 6],
    /// Opacity tables before those of the ends: the classes of step lengths.
    pub first_class: u32,
    /// A step of each class of step lengths as a part of the longest, a fraction of [`EndRegisters::STEP_BITS`].
    pub steps: Vec<u32>,
}

impl EndRegisters {
    /// Fraction bits of a reach, in steps: as many as the finest offset has.
    pub const REACH_BITS: u32 = 12;
    /// Most steps of a reach, to either side. In a parallel frame a ray meets a face at most so far beyond its last sample: the sample after
    /// it lacks a voxel, and the one after that is outside.
    pub const MOST_REACH: u32 = 2;
    /// Fraction bits of a part of the longest step that has a table of its own.
    pub const PART_BITS: u32 = 5;
    /// Fraction bits of `steps`.
    pub const STEP_BITS: u32 = 12;
    /// Tables of the ends: one for each part from none to all that reaches on both sides can be.
    pub const CLASSES: u32 = ((2 * Self::MOST_REACH) << Self::PART_BITS) + 1;
}

impl Geometry {
    /// By how much a linear function changes from a sample of ray (u, v) to the next.
    pub fn step(&self, function: &Linear, [u, v]: [i64; 2]) -> i64 {
        let Some(pass) = &self.perspective else {
            return function.k;
        };
        let slopes = [pass.u.slopes[(u - pass.u.first) as usize], pass.v.slopes[(v - pass.v.first) as usize]];
        let across = i128::from(function.u) * i128::from(slopes[0]) + i128::from(function.v) * i128::from(slopes[1]);
        function.k + (across >> SLOPE_FRACTION_BITS) as i64
    }
}
