//! The front of a work-precision diagram.

use serde::{Deserialize, Serialize};

use crate::MetricsError;

/// One method at one setting: what it cost and what it gave.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WorkPrecision {
    /// What it cost, in one unit for all points of a diagram: seconds, or what else is paid.
    pub cost: f64,
    /// Error against the converged reference.
    pub error: f64,
}

/// The indices of the points that no other point dominates, by rising cost and falling error.
///
/// A point is dominated by one that is no worse in both cost and error and better in one. Equal
/// points do not dominate each other: all of them stay, in the order of the input.
///
/// # Errors
///
/// [`MetricsError::BadNumber`] when a cost or an error is NaN or infinite.
pub fn front(points: &[WorkPrecision]) -> Result<Vec<usize>, MetricsError> {
    for (index, point) in points.iter().enumerate() {
        for (what, value) in [("cost of point", point.cost), ("error of point", point.error)] {
            if !value.is_finite() {
                let expected = "a finite number is needed";
                return Err(MetricsError::BadNumber { what, index, value, expected });
            }
        }
    }
    // Adding 0 turns −0 into 0, which total_cmp would tell apart.
    let key = |index: usize| (points[index].cost + 0.0, points[index].error + 0.0);
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&i, &j| {
        let (p, q) = (key(i), key(j));
        p.0.total_cmp(&q.0).then(p.1.total_cmp(&q.1))
    });

    // In this order a point stays exactly when its error is below all before it, or when it equals
    // the last that stayed.
    let mut kept: Vec<usize> = Vec::new();
    for index in order {
        let stays =
            kept.last().is_none_or(|&last| points[index].error < points[last].error || points[index] == points[last]);
        if stays {
            kept.push(index);
        }
    }
    Ok(kept)
}
