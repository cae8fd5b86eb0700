//! What can be wrong with a picture.

/// Why a picture was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PictureError {
    /// A picture with no pixel.
    #[error("a picture needs at least one pixel, but this one is {width} x {height}")]
    EmptyPicture {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
    },
    /// The number of pixels does not fit in a machine word.
    #[error("a picture of {width} x {height} pixels is too large to address")]
    TooLarge {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
    },
    /// The pixel data does not have width times height entries.
    #[error("a picture of {width} x {height} pixels needs {expected} pixels, but {found} were given")]
    WrongLength {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
        /// Width times height.
        expected: usize,
        /// The number of pixels given.
        found: usize,
    },
    /// The two pictures have different sizes.
    #[error("the pictures differ in size: {}x{} and {}x{}", .a[0], .a[1], .b[0], .b[1])]
    SizeMismatch {
        /// Width and height of the first picture.
        a: [usize; 2],
        /// Width and height of the second picture.
        b: [usize; 2],
    },
    /// A colour is NaN or infinite.
    #[error("channel {channel} of pixel ({x}, {y}) is {value}, and not a finite number")]
    PixelNotFinite {
        /// Column, from 0 at the left.
        x: usize,
        /// Row, from 0 at the top.
        y: usize,
        /// 0 for red, 1 for green, 2 for blue.
        channel: usize,
        /// What was found.
        value: f64,
    },
}
