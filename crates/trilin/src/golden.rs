//! The interpolation of one sample. The definition.

use cube3_word::{Words, lerp};

/// Weights of a sample, fractions of the machine's weight bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Weights {
    /// Along w, the offset o: the same for every sample.
    pub w: u32,
    /// Along u.
    pub u: u32,
    /// Along v.
    pub v: u32,
}

/// A voxel in the sample format.
pub fn lift(voxel: u16, words: &Words) -> i32 {
    i32::from(voxel) << words.sample_fraction_bits
}

/// The sample in a sheared cell: `corners[w][v][u]` are voxels (lifted) of the front and the back plane on the discrete
/// rays (u, v), (u+1, v), (u, v+1), (u+1, v+1).
///
/// Four lerps along w, two along u, one along v, each rounded; no value leaves the range of the corners.
pub fn cell(corners: [[[i32; 2]; 2]; 2], weights: Weights, words: &Words) -> i32 {
    let lerp = |near, far, weight| lerp(near, far, weight, words.weight_bits, words.rounding);
    let along_w = |v: usize, u: usize| lerp(corners[0][v][u], corners[1][v][u], weights.w);
    let along_u = |v: usize| lerp(along_w(v, 0), along_w(v, 1), weights.u);
    lerp(along_u(0), along_u(1), weights.v)
}
