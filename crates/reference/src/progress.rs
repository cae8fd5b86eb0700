//! How far a caster is.

use std::sync::atomic::{AtomicU64, Ordering};

/// Called after each row of pixels with the number of rows done so far, from any thread; the last call has
/// all of them, but calls may overtake each other.
pub type Progress<'a> = &'a (dyn Fn(u64) + Sync);

/// Counts rows for a [`Progress`], from any thread.
pub struct RowCount<'a> {
    done: AtomicU64,
    report: Option<Progress<'a>>,
}

impl<'a> RowCount<'a> {
    /// None done; without a `report` nothing is counted.
    pub fn new(report: Option<Progress<'a>>) -> Self {
        RowCount { done: AtomicU64::new(0), report }
    }

    /// One more row is done.
    #[inline]
    pub fn row_done(&self) {
        if let Some(report) = self.report {
            report(self.done.fetch_add(1, Ordering::Relaxed) + 1);
        }
    }
}
