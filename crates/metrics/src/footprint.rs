//! Where the object is in a picture.

use bitvec::vec::BitVec;

use crate::MetricsError;
use cube3_picture::Picture;

/// The pixels where either picture differs from the background, one bit each, row by row.
///
/// The comparison is exact: a background that was converted to words and back must be given as it
/// came back.
///
/// # Errors
///
/// When a picture's fields disagree, the sizes differ, or a channel or the background is NaN or
/// infinite.
pub fn footprint(a: &Picture, b: &Picture, background: [f64; 3]) -> Result<BitVec, MetricsError> {
    Picture::check_pair(a, b)?;
    if let Some(index) = background.iter().position(|value| !value.is_finite()) {
        return Err(MetricsError::BadNumber {
            what: "background channel",
            index,
            value: background[index],
            expected: "a finite number is needed",
        });
    }
    let pairs = a.pixels.iter().zip(&b.pixels);
    Ok(pairs.map(|(p, q)| *p != background || *q != background).collect())
}
