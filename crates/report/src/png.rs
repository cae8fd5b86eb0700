//! Pictures as 8-bit PNG files.

use cube3_picture::Picture;
use png::{BitDepth, ColorType, Compression, Encoder, Filter};

use crate::ReportError;

/// A picture as three bytes a pixel: 255·v, rounded to nearest, clipped to 0 to 255; NaN is 0.
///
/// Values are taken as display-referred, as the machine's own words are: no gamma is applied.
pub fn to_rgb8(picture: &Picture) -> Vec<u8> {
    let byte = |value: f64| (255.0 * value).round() as u8;
    picture.pixels.iter().flat_map(|pixel| pixel.map(byte)).collect()
}

/// An 8-bit RGB picture as a PNG file, rows from the top, three bytes a pixel.
///
/// # Errors
///
/// [`ReportError::PictureSize`] when `rgb` has not 3 · width · height bytes or there is no pixel,
/// [`ReportError::Png`] when the encoder refuses.
pub fn png_rgb8(width: usize, height: usize, rgb: &[u8]) -> Result<Vec<u8>, ReportError> {
    let wrong_size = || ReportError::PictureSize { width, height, found: rgb.len() };
    let expected = width.checked_mul(height).and_then(|pixels| pixels.checked_mul(3));
    if expected != Some(rgb.len()) || rgb.is_empty() {
        return Err(wrong_size());
    }
    let columns = u32::try_from(width).map_err(|_| wrong_size())?;
    let rows = u32::try_from(height).map_err(|_| wrong_size())?;
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, columns, rows);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Adaptive);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    writer.finish()?;
    Ok(file)
}

/// Width and height that a PNG file declares: the first fields after its signature.
pub(crate) fn png_size(file: &[u8]) -> Option<[u32; 2]> {
    let header = file.get(..24)?;
    (header.starts_with(b"\x89PNG\r\n\x1a\n") && &header[12..16] == b"IHDR").then(|| {
        let field = |at: usize| u32::from_be_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
        [field(16), field(20)]
    })
}
