//! Directions and lengths of gradients, a block at a time.

use super::around::blocks;
use crate::golden;
use cube3_frame::Normaliser;
use cube3_word::{BLOCK_LANES, LaneBlock, Words, put_block, vectorised};

/// Directions of a block of gradients; see [`golden::normalise`].
#[inline(always)]
pub(super) fn normalise(
    gradient: &[LaneBlock<i32>; 3],
    table: &Normaliser,
    words: &Words,
    out: &mut [LaneBlock<i32>; 3],
) {
    let root = table.root.as_slice();
    let Some(last) = root.len().checked_sub(1) else {
        return;
    };
    let bits = words.normal_bits;
    let into = 2 * bits - 2 - table.root_bits;
    let first = 1_u32 << table.root_bits;
    let one = 1_u32 << (bits - 1);
    let half = 1_u32 << (bits - 1);
    let [out_u, out_v, out_w] = out;
    for i in 0..BLOCK_LANES {
        let words = [gradient[0][i], gradient[1][i], gradient[2][i]];
        let (block, _) = floated(words, bits);
        let square = block[0] * block[0] + block[1] * block[1] + block[2] * block[2];
        let index = (square >> into).max(first) - first;
        let reciprocal = root[(index as usize).min(last)];
        let component = |axis: usize| {
            let size = ((block[axis] * reciprocal + half) >> bits).min(one) as i32;
            if words[axis] < 0 { -size } else { size }
        };
        out_u[i] = component(0);
        out_v[i] = component(1);
        out_w[i] = component(2);
    }
}

/// The leading bits of the components' sizes, with the largest's first at the top, and by how much they were moved.
#[inline(always)]
pub(super) fn floated(gradient: [i32; 3], bits: u32) -> ([u32; 3], u32) {
    let sizes = [gradient[0].unsigned_abs(), gradient[1].unsigned_abs(), gradient[2].unsigned_abs()];
    let zeros = (sizes[0] | sizes[1] | sizes[2] | 1).leading_zeros();
    let drop = 32 - bits;
    ([sizes[0] << zeros >> drop, sizes[1] << zeros >> drop, sizes[2] << zeros >> drop], zeros)
}

/// Magnitudes of a block of gradients with their directions; see [`golden::normalise`].
#[inline(always)]
pub(super) fn lengths(
    gradient: &[LaneBlock<i32>; 3],
    direction: &[LaneBlock<i32>; 3],
    words: &Words,
    out: &mut LaneBlock<u32>,
) {
    let bits = words.normal_bits;
    for i in 0..BLOCK_LANES {
        let (block, zeros) = floated([gradient[0][i], gradient[1][i], gradient[2][i]], bits);
        let product = |axis: usize| u64::from(block[axis]) * u64::from(direction[axis][i].unsigned_abs());
        out[i] = golden::magnitude(product(0) + product(1) + product(2), zeros, bits);
    }
}

/// Directions and magnitudes of a row of gradients; see [`golden::normalise`].
pub fn normalise_rows(gradient: [Vec<i32>; 3], table: &Normaliser, words: &Words) -> ([Vec<i32>; 3], Vec<u32>) {
    let n = gradient[0].len();
    let mut rows = [(); 3].map(|()| vec![0; n]);
    let mut magnitudes = vec![0; n];
    blocks(&gradient, |from, gradient| {
        let (mut direction, mut magnitude) = ([[0; BLOCK_LANES]; 3], [0; BLOCK_LANES]);
        vectorised(
            #[inline(always)]
            || {
                normalise(&gradient, table, words, &mut direction);
                lengths(&gradient, &direction, words, &mut magnitude);
            },
        );
        rows.iter_mut().zip(&direction).for_each(|(row, words)| put_block(words, row, from));
        put_block(&magnitude, &mut magnitudes, from);
    });
    (rows, magnitudes)
}
