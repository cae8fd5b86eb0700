//! Many lanes at once: the widest vectors that this processor has, and the lerp of whole rows.

use crate::{Rounding, Shift};

/// Runs `work` compiled for the processor's widest vector instructions (chosen once, at run time).
///
/// Everything that `work` calls must be `#[inline(always)]`, or it is compiled for the baseline. The
/// arithmetic is integer, so the result does not depend on the choice.
#[inline(always)]
pub fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    match pulp::Arch::new() {
        pulp::Arch::Scalar => without_vectors(work),
        arch => arch.dispatch(work),
    }
}

/// Of its own, so that what is seldom run is not part of every caller.
#[cold]
#[inline(never)]
fn without_vectors<R>(work: impl FnOnce() -> R) -> R {
    work()
}

/// Lanes of a block: as many words of 32 bits as the widest vectors hold. Loops over the lanes of a block have no rest.
pub const BLOCK_LANES: usize = 16;

/// A word for each lane of a block.
pub type LaneBlock<T> = [T; BLOCK_LANES];

/// The lanes of a row from `from` on, which is not beyond its end; lanes that it lacks hold zeros.
#[inline(always)]
pub fn block<T: Copy + Default>(row: &[T], from: usize) -> LaneBlock<T> {
    match row[from..].first_chunk() {
        Some(block) => *block,
        None => rest(&row[from..]),
    }
}

/// A block that is not whole. Of its own, so that whole ones are moved as such and not as many words as there are.
#[cold]
fn rest<T: Copy + Default>(row: &[T]) -> LaneBlock<T> {
    let mut block = [T::default(); BLOCK_LANES];
    block[..row.len()].copy_from_slice(row);
    block
}

/// Puts a block into the lanes of a row from `from` on, which is not beyond its end; lanes that it lacks are dropped.
#[inline(always)]
pub fn put_block<T: Copy>(block: &LaneBlock<T>, row: &mut [T], from: usize) {
    match row[from..].first_chunk_mut() {
        Some(lanes) => *lanes = *block,
        None => put_rest(block, &mut row[from..]),
    }
}

/// See [`rest`].
#[cold]
fn put_rest<T: Copy>(block: &LaneBlock<T>, row: &mut [T]) {
    row.copy_from_slice(&block[..row.len()]);
}

/// A ring of lanes, turned by less than its length: what was in lane l is in `(l + by) mod n`. Both rows have n words.
#[inline]
pub fn turn<T: Copy>(from: &[T], by: usize, to: &mut [T]) {
    #[inline(never)]
    fn fixed<T: Copy, const N: usize>(from: &[T], by: usize, to: &mut [T]) {
        if let (Ok(from), Ok(to)) = (<&[T; N]>::try_from(from), <&mut [T; N]>::try_from(to)) {
            to.copy_from_slice(&[*from; 2].as_flattened()[N - by..][..N]);
        }
    }
    match from.len() {
        8 => fixed::<T, 8>(from, by, to),
        16 => fixed::<T, 16>(from, by, to),
        32 => fixed::<T, 32>(from, by, to),
        n => {
            to[by..].copy_from_slice(&from[..n - by]);
            to[..by].copy_from_slice(&from[n - by..]);
        }
    }
}

/// [`lerp`](crate::lerp) of whole rows: weights of `fraction_bits`, one rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LerpLanes {
    shift: Shift,
    narrow: bool,
}

impl LerpLanes {
    /// For operands whose difference has a magnitude below `2^operand_bits`.
    pub fn new(operand_bits: u32, fraction_bits: u32, rounding: Rounding) -> LerpLanes {
        LerpLanes { shift: rounding.by(fraction_bits), narrow: operand_bits + fraction_bits <= 30 }
    }

    #[inline(always)]
    fn narrow(self, near: i32, far: i32, weight: i32) -> i32 {
        near + self.shift.apply32((far - near) * weight)
    }

    #[inline(always)]
    fn wide(self, near: i32, far: i32, weight: i32) -> i32 {
        (i64::from(near) + self.shift.apply((i64::from(far) - i64::from(near)) * i64::from(weight))) as i32
    }

    /// [`lerp`](crate::lerp) of one lane.
    #[inline(always)]
    pub fn one(self, near: i32, far: i32, weight: u32) -> i32 {
        if self.narrow { self.narrow(near, far, weight as i32) } else { self.wide(near, far, weight as i32) }
    }

    /// `out[i] = lerp(near[i], far[i], weight)`; a weight of 0 or 1 copies. All of `out` is written; `far` is not read
    /// at weight 0, nor `near` at weight 1, and they may then be shorter.
    #[inline(always)]
    pub fn uniform(self, near: &[i32], far: &[i32], weight: u32, out: &mut [i32]) {
        let n = out.len();
        if weight == 0 {
            out.copy_from_slice(&near[..n]);
        } else if weight == 1 << self.shift.bits {
            out.copy_from_slice(&far[..n]);
        } else {
            let (near, far, weight) = (&near[..n], &far[..n], weight as i32);
            if self.narrow {
                for i in 0..n {
                    out[i] = self.narrow(near[i], far[i], weight);
                }
            } else {
                for i in 0..n {
                    out[i] = self.wide(near[i], far[i], weight);
                }
            }
        }
    }

    /// `out[i] = lerp(near[i], far[i], weights[i])` of a block.
    #[inline(always)]
    pub fn block(
        self,
        near: &LaneBlock<i32>,
        far: &LaneBlock<i32>,
        weights: &LaneBlock<u32>,
        out: &mut LaneBlock<i32>,
    ) {
        if self.narrow {
            for i in 0..BLOCK_LANES {
                out[i] = self.narrow(near[i], far[i], weights[i] as i32);
            }
        } else {
            for i in 0..BLOCK_LANES {
                out[i] = self.wide(near[i], far[i], weights[i] as i32);
            }
        }
    }

    /// `out[i] = lerp(near[i], far[i], weights[i])`.
    #[inline(always)]
    pub fn varying(self, near: &[i32], far: &[i32], weights: &[u32], out: &mut [i32]) {
        let n = out.len();
        let (near, far, weights) = (&near[..n], &far[..n], &weights[..n]);
        if self.narrow {
            for i in 0..n {
                out[i] = self.narrow(near[i], far[i], weights[i] as i32);
            }
        } else {
            for i in 0..n {
                out[i] = self.wide(near[i], far[i], weights[i] as i32);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lerp;
    use cube3_cases::cases;
    use proptest::prelude::*;

    #[test]
    fn blocks_are_taken_from_rows_and_put_back() {
        for n in 0..40 {
            let row: Vec<u16> = (1..=n as u16).collect();
            for from in 0..=n {
                let taken = block(&row, from);
                for (lane, word) in taken.iter().enumerate() {
                    assert_eq!(*word, row.get(from + lane).copied().unwrap_or(0));
                }
                let mut put = vec![0; n];
                put_block(&taken, &mut put, from);
                for (place, word) in put.iter().enumerate() {
                    let within = (from..from + BLOCK_LANES).contains(&place);
                    assert_eq!(
                        *word,
                        if within { row[place] } else { 0 },
                        "{n} words, {place} of the block from {from}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_ring_is_turned_by_any_number_of_lanes() {
        for n in (1..20).chain([32, 33]) {
            let from: Vec<u16> = (0..n as u16).collect();
            for by in 0..n {
                let mut to = vec![0; n];
                turn(&from, by, &mut to);
                assert!(from.iter().enumerate().all(|(lane, word)| to[(lane + by) % n] == *word), "{n} by {by}");
            }
        }
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn rows_are_lerped_as_single_words(
            operand_bits in 1_u32..=24, fraction_bits in 0_u32..=12, truncate: bool, part in 0.0..=1.0_f64,
            pairs in proptest::collection::vec((0.0..1.0_f64, 0.0..1.0_f64, 0.0..=1.0_f64), 0..40),
        ) {
            let rounding = if truncate { Rounding::Truncate } else { Rounding::Nearest };
            let top = f64::from(1_u32 << operand_bits);
            let one = f64::from(1_u32 << fraction_bits);
            let near: Vec<i32> = pairs.iter().map(|pair| (pair.0 * top) as i32).collect();
            let far: Vec<i32> = pairs.iter().map(|pair| (pair.1 * top) as i32).collect();
            let weights: Vec<u32> = pairs.iter().map(|pair| (pair.2 * one).round() as u32).collect();
            let lanes = LerpLanes::new(operand_bits, fraction_bits, rounding);
            let mut out = vec![0; pairs.len()];
            vectorised(|| lanes.varying(&near, &far, &weights, &mut out));
            for i in 0..out.len() {
                prop_assert_eq!(out[i], lerp(near[i], far[i], weights[i], fraction_bits, rounding));
                prop_assert_eq!(out[i], lanes.one(near[i], far[i], weights[i]));
            }
            for from in (0..out.len()).step_by(BLOCK_LANES) {
                let mut lerped = [0; BLOCK_LANES];
                lanes.block(&block(&near, from), &block(&far, from), &block(&weights, from), &mut lerped);
                prop_assert_eq!(&lerped[..BLOCK_LANES.min(out.len() - from)], &out[from..out.len().min(from + BLOCK_LANES)]);
            }
            let weight = (part * one).round() as u32;
            vectorised(|| lanes.uniform(&near, &far, weight, &mut out));
            for i in 0..out.len() {
                prop_assert_eq!(out[i], lerp(near[i], far[i], weight, fraction_bits, rounding));
            }
        }
    }

    #[test]
    fn a_row_that_has_no_weight_is_not_read() {
        for fraction_bits in 0..=12 {
            let lanes = LerpLanes::new(16, fraction_bits, Rounding::Nearest);
            let mut out = [0; 3];
            lanes.uniform(&[7, 8, 9], &[], 0, &mut out);
            assert_eq!(out, [7, 8, 9]);
            lanes.uniform(&[], &[4, 5, 6], 1 << fraction_bits, &mut out);
            assert_eq!(out, [4, 5, 6]);
        }
    }
}
