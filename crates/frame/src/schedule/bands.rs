//! The frame without a clock: bands of rows of the base plane, and the depths at which there are samples.

use super::Schedule;
use crate::Geometry;
use std::ops::Range;

/// The rows of a base plane in bands of one height, the last as high as is left, and their depths.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bands {
    /// The first row: its number along v.
    first: i64,
    rows: usize,
    height: usize,
    depths: usize,
    sampled: Range<usize>,
}

impl Bands {
    /// Rows of a band: neighbouring bands make the rows at their edge twice, and too high a band leaves cores idle at the end.
    const HEIGHT: [usize; 2] = [8, 64];
}

impl Schedule {
    /// The frame of this geometry in about so many bands.
    pub fn bands(&self, geometry: &Geometry, pieces: usize) -> Bands {
        let [_, rows] = geometry.base_plane_size();
        let [least, most] = Bands::HEIGHT;
        let depths = self.shape.depths;
        let first = geometry.perspective.as_ref().map_or(0, |pass| pass.first_depth);
        Bands {
            first: geometry.first_ray().v,
            rows,
            height: rows.div_ceil(pieces.max(1)).clamp(least, most),
            depths,
            sampled: first..depths.saturating_sub(usize::from(geometry.offset != 0)).max(first),
        }
    }
}

impl Bands {
    /// Rows of all bands.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Rows of a band but the last.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The rows of a band, their numbers along v.
    pub fn band(&self, number: usize) -> Range<i64> {
        let row = |number: usize| self.first + (number * self.height).min(self.rows) as i64;
        row(number)..row(number + 1)
    }

    /// All depths.
    #[inline]
    pub fn depths(&self) -> Range<usize> {
        0..self.depths
    }

    /// The depths at which a ray of the frame can have a sample: the near and the far side of its cell are there.
    #[inline]
    pub fn sampled(&self) -> Range<usize> {
        self.sampled.clone()
    }

    /// The depths from the first to the last at which a ray of row `v` has a sample, an empty range where none has.
    pub fn sampled_in(&self, geometry: &Geometry, v: i64) -> Range<usize> {
        let has_samples = |&k: &usize| !geometry.valid_columns(v, k).is_empty();
        let first = self.sampled().find(has_samples).unwrap_or(self.sampled.end);
        let end = (first..self.sampled.end).rev().find(has_samples).map_or(first, |last| last + 1);
        first..end
    }
}
