//! The errors of one picture against another.

use bitvec::slice::BitSlice;
use serde::{Deserialize, Serialize};

use crate::MetricsError;
use crate::compensated::CompensatedSum;
use cube3_picture::Picture;

/// A channel is off when it differs by more than this: one level of an 8-bit display.
///
/// Exactly one level is not off, and a slack of 10⁻⁹ levels keeps it so when the two levels were
/// divided by 255 before they were subtracted.
pub const OFF_THRESHOLD: f64 = 1.0 / 255.0;

const OFF_SLACK: f64 = 1e-9 * OFF_THRESHOLD;

/// How far two pictures are apart, over a set of at least one pixel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ImageError {
    /// Mean Euclidean distance in RGB over √3, the largest distance in the unit cube: 0 to 1 for
    /// channels in [0, 1]. The error of Pfister et al. 1995, section 6.
    pub mean_relative: f64,
    /// Root of the mean square difference over pixels and channels.
    pub rms: f64,
    /// Largest absolute difference of a channel.
    pub max: f64,
    /// Peak signal-to-noise ratio, 10·log₁₀(1/rms²) decibels for a peak of 1.
    ///
    /// Absent when the pixels are equal, where it is infinite: `null` in JSON, which has no infinity.
    pub psnr_db: Option<f64>,
    /// Fraction of the pixels with a channel off by more than [`OFF_THRESHOLD`], 0 to 1.
    pub fraction_off: f64,
    /// 99th percentile of the pixels' distances, by the nearest rank: the smallest distance, of those of which
    /// [`mean_relative`](Self::mean_relative) is the mean, that 99 of 100 pixels do not pass. Of fewer than 100 pixels it is the largest.
    pub percentile_99: f64,
    /// Mean signed difference over pixels and channels, the first picture less the second: above 0 where the first is brighter.
    pub bias: f64,
}

/// The error of equal pixels.
const EQUAL: ImageError = ImageError {
    mean_relative: 0.0,
    rms: 0.0,
    max: 0.0,
    psnr_db: None,
    fraction_off: 0.0,
    percentile_99: 0.0,
    bias: 0.0,
};

/// The errors over the whole image and over the object alone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ImageComparison {
    /// Over every pixel.
    pub whole: ImageError,
    /// Over the pixels of the footprint: an empty background cannot dilute it. Absent over a footprint of no pixels, where there is
    /// nothing that could be right or wrong.
    pub footprint: Option<ImageError>,
    /// The number of pixels in the footprint.
    pub footprint_pixels: usize,
}

/// Measures `a` against `b`. The order of the two matters to the sign of the bias alone.
///
/// `footprint` has one bit for each pixel, row by row; [`footprint`](crate::footprint) makes it from
/// a background colour. Without one, the footprint is the whole picture.
///
/// # Errors
///
/// When a picture's fields disagree, the sizes differ, a channel is NaN or infinite, or the mask has
/// another length.
pub fn compare(a: &Picture, b: &Picture, footprint: Option<&BitSlice>) -> Result<ImageComparison, MetricsError> {
    Picture::check_pair(a, b)?;
    let whole = measure(a, b, 0..a.pixels.len())?;
    let Some(mask) = footprint else {
        return Ok(ImageComparison { whole, footprint: Some(whole), footprint_pixels: a.pixels.len() });
    };
    if mask.len() != a.pixels.len() {
        return Err(MetricsError::MaskLength { expected: a.pixels.len(), found: mask.len() });
    }
    let footprint = mask.any().then(|| measure(a, b, mask.iter_ones())).transpose()?;
    Ok(ImageComparison { whole, footprint, footprint_pixels: mask.count_ones() })
}

/// Measures the pixels at `indices`.
///
/// Differences are divided by the largest before they are squared, so that neither the tiniest nor
/// the greatest is lost, and a constant difference d has an RMS of exactly d.
fn measure(a: &Picture, b: &Picture, indices: impl Iterator<Item = usize> + Clone) -> Result<ImageError, MetricsError> {
    let apart = |index: usize| {
        let (p, q) = (a.pixels[index], b.pixels[index]);
        std::array::from_fn::<f64, 3, _>(|channel| p[channel] - q[channel])
    };

    let mut max = 0.0_f64;
    let mut count = 0_usize;
    let mut off = 0_usize;
    for index in indices.clone() {
        let largest = apart(index).into_iter().map(f64::abs).fold(0.0, f64::max);
        if !largest.is_finite() {
            let [x, y] = a.place(index);
            return Err(MetricsError::DifferenceOverflow { x, y });
        }
        max = max.max(largest);
        count += 1;
        off += usize::from(largest > OFF_THRESHOLD + OFF_SLACK);
    }
    if max == 0.0 {
        return Ok(EQUAL);
    }

    let mut distances = CompensatedSum::default();
    let mut squares = CompensatedSum::default();
    let mut signed = CompensatedSum::default();
    let mut ranked = Vec::with_capacity(count);
    for index in indices {
        let channels = apart(index).map(|d| d / max);
        let square: f64 = channels.iter().map(|d| d * d).sum();
        let distance = (square / 3.0).sqrt();
        distances.add(distance);
        squares.add(square / 3.0);
        channels.iter().for_each(|&d| signed.add(d));
        ranked.push(distance);
    }
    let rms = max * squares.mean(count).sqrt();
    Ok(ImageError {
        mean_relative: max * distances.mean(count),
        rms,
        max,
        psnr_db: Some(-20.0 * rms.log10()),
        fraction_off: off as f64 / count as f64,
        percentile_99: max * percentile(&mut ranked, 99),
        bias: max * signed.mean(3 * count),
    })
}

/// The percentile of at least one value by the nearest rank: of n values in order the one at ⌈percent·n/100⌉, counted from 1. `percent` is 1 to
/// 100. The values are put into another order.
fn percentile(values: &mut [f64], percent: usize) -> f64 {
    let rank = (percent * values.len()).div_ceil(100);
    *values.select_nth_unstable_by(rank - 1, f64::total_cmp).1
}
