//! The word lengths of a machine, as data that a search can vary.

use crate::Rounding;
use serde::{Deserialize, Serialize};

/// Word lengths in bits, and the rounding of every shift.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Words {
    /// Voxel word, unsigned: 1 to 16.
    pub voxel_bits: u32,
    /// Fraction of interpolation weights: 0 to 12. A weight is 0 to 1 inclusive.
    pub weight_bits: u32,
    /// Bits that a sample has below the voxel's: 0 to 8.
    pub sample_fraction_bits: u32,
    /// Gradient component, signed: 2 to `voxel_bits + sample_fraction_bits + 1`, and 24 at most.
    pub gradient_bits: u32,
    /// Component of the normalised gradient, signed, one of the bits the sign: 4 to 15.
    pub normal_bits: u32,
    /// Index of the classification table, over the sample's leading bits: 1 to 16.
    pub table_bits: u32,
    /// Index over the gradient's magnitude, for two-dimensional tables: 1 to 8.
    pub table_gradient_bits: u32,
    /// Colour component, unit word: 1 to 16.
    pub colour_bits: u32,
    /// Opacity out of the table, unit word: 1 to 16.
    pub opacity_bits: u32,
    /// Colour and opacity in the cone, unit words: 1 to 32.
    pub accumulator_bits: u32,
    /// What happens to the bits that a multiplication drops.
    pub rounding: Rounding,
}

impl Default for Words {
    /// 16-bit voxels as in Cube-3; tables as in VolumePro 500 (4096 entries, 12 opacity bits), with the
    /// accumulator widened to 16 bits (truncating 12-bit accumulators lose 12/255 over 512 samples).
    fn default() -> Self {
        Words {
            voxel_bits: 16,
            weight_bits: 8,
            sample_fraction_bits: 0,
            gradient_bits: 17,
            normal_bits: 12,
            table_bits: 12,
            table_gradient_bits: 6,
            colour_bits: 12,
            opacity_bits: 12,
            accumulator_bits: 16,
            rounding: Rounding::Nearest,
        }
    }
}

/// One of the lengths: its range, and where it is.
#[derive(Clone, Copy, Debug)]
pub struct Length {
    /// The key.
    pub name: &'static str,
    /// The smallest length.
    pub low: u32,
    /// The largest length, where the other words are wide.
    pub high: u32,
    /// The largest length where the other words are as they are, if that is less.
    pub limit: fn(&Words) -> u32,
    /// Why, where another word sets the limit; else empty.
    pub because: &'static str,
    /// The length in bits.
    pub of: fn(&Words) -> u32,
    /// The same, to be set.
    pub of_mut: fn(&mut Words) -> &mut u32,
}

macro_rules! length {
    ($name:ident, $low:literal, $high:literal) => {
        length!($name, $low, $high, |_| $high, "")
    };
    ($name:ident, $low:literal, $high:literal, $limit:expr, $because:literal) => {
        Length {
            name: stringify!($name),
            low: $low,
            high: $high,
            limit: $limit,
            because: $because,
            of: |words| words.$name,
            of_mut: |words| &mut words.$name,
        }
    };
}

impl Length {
    /// The largest length among these words.
    pub fn largest(&self, words: &Words) -> u32 {
        self.high.min((self.limit)(words))
    }
}

/// A word length outside of what the units can hold.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("words.{name} = {bits} is outside {low} to {high}{}", if because.is_empty() { String::new() } else { format!(" ({because})") })]
pub struct WordError {
    /// The key.
    pub name: &'static str,
    /// The length asked for.
    pub bits: u32,
    /// The smallest length.
    pub low: u32,
    /// The largest length.
    pub high: u32,
    /// Why, where another word sets the limit.
    pub because: &'static str,
}

impl Words {
    /// Voxel word.
    pub const VOXEL: Length = length!(voxel_bits, 1, 16);
    /// Fraction of interpolation weights.
    pub const WEIGHT: Length = length!(weight_bits, 0, 12);
    /// Bits that a sample has below the voxel's.
    pub const SAMPLE_FRACTION: Length = length!(sample_fraction_bits, 0, 8);
    /// Gradient component.
    pub const GRADIENT: Length = length!(
        gradient_bits,
        2,
        24,
        |words| words.sample_bits() + 1,
        "a sample difference has one bit more than a sample; 24 at most"
    );
    /// Component of the normalised gradient.
    pub const NORMAL: Length = length!(normal_bits, 4, 15);
    /// Index of the classification table.
    pub const TABLE: Length = length!(table_bits, 1, 16, |words| words.sample_bits(), "no more than a sample has");
    /// Index over the gradient's magnitude.
    pub const TABLE_GRADIENT: Length = length!(table_gradient_bits, 1, 8);
    /// Colour component.
    pub const COLOUR: Length = length!(colour_bits, 1, 16);
    /// Opacity out of the table.
    pub const OPACITY: Length = length!(opacity_bits, 1, 16);
    /// Colour and opacity in the cone.
    pub const ACCUMULATOR: Length = length!(accumulator_bits, 1, 32);

    /// Every length, from the memory to the pixel.
    pub const LENGTHS: &'static [Length; 10] = &[
        Words::VOXEL,
        Words::WEIGHT,
        Words::SAMPLE_FRACTION,
        Words::GRADIENT,
        Words::NORMAL,
        Words::TABLE,
        Words::TABLE_GRADIENT,
        Words::COLOUR,
        Words::OPACITY,
        Words::ACCUMULATOR,
    ];

    /// Sample width: voxel and fraction bits.
    pub fn sample_bits(&self) -> u32 {
        self.voxel_bits + self.sample_fraction_bits
    }

    /// Low-order bits that a gradient component drops from a sample difference.
    pub fn gradient_drop(&self) -> u32 {
        self.sample_bits() + 1 - self.gradient_bits
    }

    /// Whether every length is one that the units can hold.
    ///
    /// # Errors
    /// The first length that is not.
    pub fn check(&self) -> Result<(), WordError> {
        Words::LENGTHS.iter().try_for_each(|length| {
            let &Length { name, low, because, .. } = length;
            let (bits, high) = ((length.of)(self), length.largest(self));
            if (low..=high).contains(&bits) { Ok(()) } else { Err(WordError { name, bits, low, high, because }) }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_words_are_legal_and_each_limit_is_named() {
        Words::default().check().unwrap();
        let error = Words { voxel_bits: 17, ..Words::default() }.check().unwrap_err();
        assert_eq!(error.to_string(), "words.voxel_bits = 17 is outside 1 to 16");
        let error = Words { gradient_bits: 18, ..Words::default() }.check().unwrap_err();
        assert_eq!((error.name, error.high), ("gradient_bits", 17));
        let narrow = Words { voxel_bits: 1, gradient_bits: 2, table_bits: 1, ..Words::default() };
        narrow.check().unwrap();
    }

    #[test]
    fn every_length_has_its_own_field_and_both_its_ends_are_legal() {
        let wide = Words { sample_fraction_bits: 8, gradient_bits: 24, table_bits: 16, ..Words::default() };
        for length in *Words::LENGTHS {
            let with = |bits| {
                let mut words = wide;
                *(length.of_mut)(&mut words) = bits;
                assert_eq!((length.of)(&words), bits);
                words.check().map_err(|error| error.name)
            };
            let outside = Err(length.name);
            assert_eq!((with(length.high), with(length.high + 1)), (Ok(()), outside));
            assert!(length.low == 0 || with(length.low - 1) == outside);
            let mut narrow = Words { voxel_bits: 16, gradient_bits: 2, table_bits: 1, ..Words::default() };
            *(length.of_mut)(&mut narrow) = length.low;
            assert_eq!(narrow.check(), Ok(()));
        }
    }

    #[test]
    fn a_sample_has_the_fraction_and_a_gradient_drops_what_it_has_no_room_for() {
        let words = Words { voxel_bits: 12, sample_fraction_bits: 3, gradient_bits: 9, ..Words::default() };
        assert_eq!((words.sample_bits(), words.gradient_drop()), (15, 7));
        let whole = Words { gradient_bits: 16, ..words };
        assert_eq!(whole.gradient_drop(), 0);
    }
}
