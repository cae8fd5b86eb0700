//! Blocks of samples and what is around them.

use cube3_word::{BLOCK_LANES, LaneBlock, block};

/// The samples of a block and their 26 neighbours, `[9 w + 3 v + u]`, each index 0 to 2: the samples themselves at
/// [`HERE`].
pub type Around = [LaneBlock<i32>; 27];

/// The place of the samples themselves.
pub const HERE: usize = 13;

/// A neighbour of a sample: its place in [`Around`], and its indices, each 0 to 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Neighbour {
    /// `9 w + 3 v + u`.
    pub place: usize,
    /// Along the ray.
    pub w: usize,
    /// From plane to plane.
    pub v: usize,
    /// From ray to ray.
    pub u: usize,
}

/// Neighbours that are gathered together, so that the loop over their lanes is a long one. The last ones of a list may be the same.
pub type Neighbours = [Neighbour; 4];

/// A row, block by block.
pub(super) fn blocks<const N: usize>(rows: &[Vec<i32>; N], mut each: impl FnMut(usize, [LaneBlock<i32>; N])) {
    for from in (0..rows[0].len()).step_by(BLOCK_LANES) {
        each(from, rows.each_ref().map(|row| block(row, from)));
    }
}
