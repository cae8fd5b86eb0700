//! An animation as one file: a PNG of several frames (APNG), which every browser plays and every reader of PNG opens at its
//! first frame.

use cube3::sequence::playback_fps;
use png::{BitDepth, ColorType, Encoder, EncodingError, Writer};
use std::io::Write;

/// An animation that is being written, frame by frame.
pub struct Animation<W: Write> {
    writer: Writer<W>,
}

impl<W: Write> Animation<W> {
    /// An animation of `frames` frames, shown without end at `fps` from 1 to 30 frames per second.
    ///
    /// # Errors
    /// What the encoder or the writer refuses.
    pub fn new(out: W, width: usize, height: usize, frames: usize, fps: f64) -> Result<Animation<W>, EncodingError> {
        let side = |pixels: usize| u32::try_from(pixels).unwrap_or(0);
        let mut encoder = Encoder::new(out, side(width), side(height));
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_animated(u32::try_from(frames).unwrap_or(0), 0)?;
        encoder.set_frame_delay(1000, (1000.0 * playback_fps(fps)).round() as u16)?;
        Ok(Animation { writer: encoder.write_header()? })
    }

    /// The next frame: rows from the top, three bytes a pixel.
    ///
    /// # Errors
    /// Too few bytes, too many frames, and what the writer refuses.
    pub fn push(&mut self, rgb: &[u8]) -> Result<(), EncodingError> {
        self.writer.write_image_data(rgb)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// Missing frames, and what the writer refuses.
    pub fn finish(self) -> Result<(), EncodingError> {
        self.writer.finish()
    }
}
