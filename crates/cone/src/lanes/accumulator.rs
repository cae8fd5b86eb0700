//! Words of the accumulators in lanes.

use cube3_word::UnitMul;

/// A word of the accumulators in a lane: 32 bits where the accumulators have 16 at most, else 64.
pub trait Accumulator: Copy + Default + PartialEq + Send + Sync {
    /// From a word of at most 32 bits.
    fn of(word: u32) -> Self;
    /// As a wide word.
    fn wide(self) -> u64;
    /// Sum.
    fn plus(self, other: Self) -> Self;
    /// Product of unit words.
    fn unit_mul(self, other: Self, product: UnitMul) -> Self;
    /// `full − self`.
    fn complement(self, full: u32) -> Self;
}

macro_rules! accumulator {
    ($word:ty, $product:ident) => {
        impl Accumulator for $word {
            #[inline(always)]
            fn of(word: u32) -> Self {
                word as $word
            }
            #[inline(always)]
            fn wide(self) -> u64 {
                self as u64
            }
            #[inline(always)]
            fn plus(self, other: Self) -> Self {
                self + other
            }
            #[inline(always)]
            fn unit_mul(self, other: Self, product: UnitMul) -> Self {
                product.$product(self, other)
            }
            #[inline(always)]
            fn complement(self, full: u32) -> Self {
                full as $word - self
            }
        }
    };
}

accumulator!(u32, narrow);
accumulator!(u64, wide);
