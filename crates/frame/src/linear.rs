//! Functions that are linear over the samples of a frame: distances, factors, half-spaces.

use crate::PLACE_BITS;
use cube3_scene::MOST_CUTS;
use serde::{Deserialize, Serialize};

/// A linear function of ray and depth, `a·u + b·v + c·k + d`, in fixed point; in perspective of the place u, v, w in the volume.
///
/// [`Geometry::evaluate`](crate::Geometry::evaluate) gives its value at a sample of either.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Linear {
    /// Step from a ray to the next along u.
    pub u: i64,
    /// Step along v.
    pub v: i64,
    /// Step along the ray.
    pub k: i64,
    /// Value at ray (0, 0), sample 0.
    pub constant: i64,
}

impl Linear {
    /// Largest step of a parallel frame, either way: sums over any volume stay within 64 bits.
    pub const STEEPEST: i64 = 1 << 46;
    /// Largest step of a perspective frame, whose places have [`PLACE_BITS`] more bits than rays and depths.
    pub const STEEPEST_BY_PLACE: i64 = 1 << (48 - PLACE_BITS);
    /// Largest constant, either way. A plane farther away than this decides nothing.
    pub const FARTHEST: i64 = 1 << 60;
}

/// Samples where the function is 0 or more are kept. Fractions of [`HalfSpace::FRACTION_BITS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HalfSpace {
    /// Signed distance from the plane, in voxels.
    pub distance: Linear,
}

impl HalfSpace {
    /// Fraction bits of the distance.
    pub const FRACTION_BITS: u32 = 32;
    /// Most half-spaces of a frame: those of the cuts, and the six faces of the crop box.
    pub const MOST: usize = MOST_CUTS + 6;
}

/// A factor 0 to 1, a fraction of [`LinearFactor::FRACTION_BITS`] of which the unit uses the leading
/// [`LinearFactor::WORD_BITS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinearFactor {
    /// The factor before it is clamped to 0..1.
    pub factor: Linear,
}

impl LinearFactor {
    /// Fraction bits of the linear function.
    pub const FRACTION_BITS: u32 = 28;
    /// Fraction bits of the factor that multiplies.
    pub const WORD_BITS: u32 = 12;
}
