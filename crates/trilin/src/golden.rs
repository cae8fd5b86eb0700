//! The interpolation of one sample. The definition.

use cube3_word::{Probe, Words, lerp_wires};

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
    cell_wires(corners, weights, words, &mut ())
}

/// [`cell`], and what its wires carry.
pub fn cell_wires(corners: [[[i32; 2]; 2]; 2], weights: Weights, words: &Words, probe: &mut impl Probe) -> i32 {
    let mut lerp = |part, place, near, far, weight| {
        probe.within(part, place, |probe| lerp_wires(near, far, weight, words.weight_bits, words.rounding, probe))
    };
    let mut along_w = |v: usize, u: usize| lerp("along_w", 2 * v + u, corners[0][v][u], corners[1][v][u], weights.w);
    let edges = [[along_w(0, 0), along_w(0, 1)], [along_w(1, 0), along_w(1, 1)]];
    let mut along_u = |v: usize| lerp("along_u", v, edges[v][0], edges[v][1], weights.u);
    let sides = [along_u(0), along_u(1)];
    lerp("along_v", 0, sides[0], sides[1], weights.v)
}
