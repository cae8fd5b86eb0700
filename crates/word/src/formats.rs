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

/// A word length outside of what the units can hold.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("words.{name} = {bits} is outside {low} to {high}{because}")]
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
        let check = |name, bits, low, high, because| {
            if (low..=high).contains(&bits) { Ok(()) } else { Err(WordError { name, bits, low, high, because }) }
        };
        check("voxel_bits", self.voxel_bits, 1, 16, "")?;
        check("weight_bits", self.weight_bits, 0, 12, "")?;
        check("sample_fraction_bits", self.sample_fraction_bits, 0, 8, "")?;
        let widest = (self.sample_bits() + 1).min(24);
        check(
            "gradient_bits",
            self.gradient_bits,
            2,
            widest,
            " (a sample difference has one bit more than a sample; 24 at most)",
        )?;
        check("normal_bits", self.normal_bits, 4, 15, "")?;
        let index = self.sample_bits().min(16);
        check("table_bits", self.table_bits, 1, index, " (no more than a sample has)")?;
        check("table_gradient_bits", self.table_gradient_bits, 1, 8, "")?;
        check("colour_bits", self.colour_bits, 1, 16, "")?;
        check("opacity_bits", self.opacity_bits, 1, 16, "")?;
        check("accumulator_bits", self.accumulator_bits, 1, 32, "")
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
    fn a_sample_has_the_fraction_and_a_gradient_drops_what_it_has_no_room_for() {
        let words = Words { voxel_bits: 12, sample_fraction_bits: 3, gradient_bits: 9, ..Words::default() };
        assert_eq!((words.sample_bits(), words.gradient_drop()), (15, 7));
        let whole = Words { gradient_bits: 16, ..words };
        assert_eq!(whole.gradient_drop(), 0);
    }
}
