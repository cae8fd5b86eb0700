//! The picture of where two pictures differ.

use crate::MetricsError;
use cube3_picture::Picture;

/// The factors that a difference picture may be magnified by: round to the eye, and no greater than
/// 255, which makes one 8-bit level full white.
const FACTORS: [u32; 8] = [1, 2, 5, 10, 20, 50, 100, 200];

/// |a − b|·`factor`, channel by channel, clipped to [0, 1].
///
/// # Errors
///
/// When a picture's fields disagree, the sizes differ, a channel is NaN or infinite, or `factor` is
/// negative, NaN or infinite.
pub fn difference(a: &Picture, b: &Picture, factor: f64) -> Result<Picture, MetricsError> {
    Picture::check_pair(a, b)?;
    if !(factor >= 0.0 && factor.is_finite()) {
        return Err(MetricsError::BadNumber {
            what: "difference factor",
            index: 0,
            value: factor,
            expected: "a finite number of at least 0 is needed",
        });
    }
    let pairs = a.pixels.iter().zip(&b.pixels);
    let pixels = pairs
        .map(|(p, q)| {
            std::array::from_fn(|channel| {
                let apart = (p[channel] - q[channel]).abs();
                // An infinite difference times 0 would be NaN.
                if factor == 0.0 { 0.0 } else { (apart * factor).min(1.0) }
            })
        })
        .collect();
    Ok(Picture::new(a.width, a.height, pixels)?)
}

/// The factor to magnify a difference picture by: the largest of 1, 2, 5, 10, 20, 50, 100 and 200
/// that does not clip `max_difference`, the [`max`](crate::ImageError::max) of the comparison.
///
/// 1 for equal pictures, and for a difference that is clipped anyway. From 0.0025 up to 1 the largest
/// difference shows at 40 % of white or more. The series stops at 200, so that a difference below an
/// 8-bit level is not made to look like an error that a display could show.
pub fn suggested_factor(max_difference: f64) -> u32 {
    if !(max_difference > 0.0 && max_difference <= 1.0) {
        return 1;
    }
    let fits = |factor: &&u32| max_difference * f64::from(**factor) <= 1.0;
    FACTORS.iter().rev().find(fits).copied().unwrap_or(1)
}
