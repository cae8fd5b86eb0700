//! Pictures in linear RGB.

use crate::PictureError;

/// A picture in linear RGB, one `f64` for each channel, row by row from the top left.
///
/// Channels nominally lie in [0, 1]. Finite values outside stay as they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Pixel (x, y) is at `y * width + x`.
    pub pixels: Vec<[f64; 3]>,
}

impl Picture {
    /// A picture from its pixels.
    ///
    /// # Errors
    ///
    /// [`PictureError::EmptyPicture`] without a pixel, [`PictureError::TooLarge`] when width times
    /// height overflows, [`PictureError::WrongLength`] when `pixels` has another length.
    pub fn new(width: usize, height: usize, pixels: Vec<[f64; 3]>) -> Result<Self, PictureError> {
        let picture = Self { width, height, pixels };
        picture.check_size()?;
        Ok(picture)
    }

    /// A picture of one colour.
    ///
    /// # Errors
    ///
    /// As [`Picture::new`].
    pub fn filled(width: usize, height: usize, colour: [f64; 3]) -> Result<Self, PictureError> {
        let count = pixel_count(width, height)?;
        Self::new(width, height, vec![colour; count])
    }

    /// Checks that the public fields still agree with each other.
    pub fn check_size(&self) -> Result<(), PictureError> {
        let (width, height) = (self.width, self.height);
        let expected = pixel_count(width, height)?;
        let found = self.pixels.len();
        if found != expected {
            return Err(PictureError::WrongLength { width, height, expected, found });
        }
        Ok(())
    }

    /// Checks that both pictures are whole, of one size, and finite everywhere.
    pub fn check_pair(a: &Self, b: &Self) -> Result<(), PictureError> {
        a.check_size()?;
        b.check_size()?;
        if (a.width, a.height) != (b.width, b.height) {
            return Err(PictureError::SizeMismatch { a: [a.width, a.height], b: [b.width, b.height] });
        }
        a.check_finite()?;
        b.check_finite()
    }

    fn check_finite(&self) -> Result<(), PictureError> {
        for (index, pixel) in self.pixels.iter().enumerate() {
            if let Some(channel) = pixel.iter().position(|value| !value.is_finite()) {
                let [x, y] = self.place(index);
                let value = pixel[channel];
                return Err(PictureError::PixelNotFinite { x, y, channel, value });
            }
        }
        Ok(())
    }

    /// Column and row of the pixel at `index`.
    pub fn place(&self, index: usize) -> [usize; 2] {
        [index % self.width, index / self.width]
    }
}

fn pixel_count(width: usize, height: usize) -> Result<usize, PictureError> {
    if width == 0 || height == 0 {
        return Err(PictureError::EmptyPicture { width, height });
    }
    width.checked_mul(height).ok_or(PictureError::TooLarge { width, height })
}
