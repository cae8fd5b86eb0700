//! What can be wrong with the input of a measurement.

use cube3_picture::PictureError;

/// Why a measurement was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MetricsError {
    /// The pictures themselves.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The footprint mask does not have one bit for each pixel.
    #[error("the footprint has {found} bits, but the pictures have {expected} pixels")]
    MaskLength {
        /// The number of pixels.
        expected: usize,
        /// The number of bits in the mask.
        found: usize,
    },
    /// Two colours are so far apart that their difference is not a finite number.
    #[error("pixel ({x}, {y}) holds colours too far apart to subtract")]
    DifferenceOverflow {
        /// Column, from 0 at the left.
        x: usize,
        /// Row, from 0 at the top.
        y: usize,
    },
    /// A factor, background, vector or point is NaN, infinite or out of its range.
    #[error("{what} {index} is {value}: {expected}")]
    BadNumber {
        /// What the number is.
        what: &'static str,
        /// Its place in the input, from 0.
        index: usize,
        /// What was found.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
}
