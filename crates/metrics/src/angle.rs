//! The angle between a gradient and the true normal.

use serde::{Deserialize, Serialize};

use crate::MetricsError;
use crate::compensated::CompensatedSum;

/// Angles over a set of pairs, in degrees from 0 to 180. The three are absent where no pair was measured: no angle is not an
/// angle of 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AngleError {
    /// Mean angle.
    pub mean_deg: Option<f64>,
    /// Largest angle.
    pub max_deg: Option<f64>,
    /// Root of the mean square angle.
    pub rms_deg: Option<f64>,
    /// Pairs that were measured.
    pub count: usize,
    /// Pairs left out because a vector has length zero, and so no direction.
    pub degenerate: usize,
}

/// The angles between the two vectors of each pair. Lengths do not matter, from the smallest to the
/// largest that an `f64` can hold.
///
/// # Errors
///
/// [`MetricsError::BadNumber`] when a component is NaN or infinite.
pub fn mean_angle_deg(pairs: impl IntoIterator<Item = ([f64; 3], [f64; 3])>) -> Result<AngleError, MetricsError> {
    let mut sum = CompensatedSum::default();
    let mut squares = CompensatedSum::default();
    let mut max_deg = 0.0_f64;
    let (mut count, mut degenerate) = (0, 0);
    for (index, (a, b)) in pairs.into_iter().enumerate() {
        if let Some(&value) = a.iter().chain(&b).find(|value| !value.is_finite()) {
            return Err(MetricsError::BadNumber {
                what: "vector pair",
                index,
                value,
                expected: "finite components are needed",
            });
        }
        let (Some(a), Some(b)) = (scaled(a), scaled(b)) else {
            degenerate += 1;
            continue;
        };
        let angle = angle_deg(a, b);
        sum.add(angle);
        squares.add(angle * angle);
        max_deg = max_deg.max(angle);
        count += 1;
    }
    let measured = |value: f64| (count > 0).then_some(value);
    Ok(AngleError {
        mean_deg: measured(sum.mean(count)),
        max_deg: measured(max_deg),
        rms_deg: measured(squares.mean(count).sqrt()),
        count,
        degenerate,
    })
}

/// The angle by atan2(|a×b|, a·b): full precision near 0° and 180°, where an arc cosine has half.
fn angle_deg(a: [f64; 3], b: [f64; 3]) -> f64 {
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let sine = cross[0].hypot(cross[1]).hypot(cross[2]);
    sine.atan2(dot).to_degrees()
}

/// The vector over its largest component, so that no product over- or underflows; none for zero.
fn scaled(vector: [f64; 3]) -> Option<[f64; 3]> {
    let largest = vector.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    (largest > 0.0).then(|| vector.map(|value| value / largest))
}
