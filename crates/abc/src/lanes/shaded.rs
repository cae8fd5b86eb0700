//! Rows and blocks of shaded samples.

use crate::ends::End;
use crate::golden;
use cube3_word::LaneBlock;
use serde::{Deserialize, Serialize};

/// A row of shaded samples; see [`golden::Shaded`].
#[derive(Clone, Debug, Default)]
pub struct ShadedRow {
    /// 1 where the sample takes part, 0 where not. Set before, cleared where a sample is outside of the threshold.
    pub present: Vec<u8>,
    /// Opacity.
    pub opacity: Vec<u32>,
    /// Red, green, blue; 0 where the opacity is.
    pub colour: [Vec<u32>; 3],
    /// The first lane with an opacity above 0, and one past the last; beyond them opacity and colour are 0.
    pub span: (usize, usize),
    /// Saturated words.
    pub overflows: u64,
    /// Lanes whose opacity is that of an end of a ray, in order. Set before.
    pub ends: Vec<End>,
}

/// A block of shaded samples: a word for each part of [`golden::Shaded`] and lane. Each row is a line of the cache.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[repr(C, align(64))]
pub struct ShadedBlock {
    /// 1 where the sample takes part, 0 where not. To be shaded, where it is in the volume.
    pub present: LaneBlock<u32>,
    /// Sample words.
    pub samples: LaneBlock<i32>,
    /// Opacity.
    pub opacity: LaneBlock<u32>,
    /// Red, green, blue; 0 where the opacity is.
    pub colour: [LaneBlock<u32>; 3],
}

impl ShadedBlock {
    /// The sample of a lane.
    #[inline]
    pub fn at(&self, lane: usize) -> golden::Shaded {
        golden::Shaded {
            present: self.present[lane] != 0,
            sample: self.samples[lane],
            opacity: self.opacity[lane],
            colour: [self.colour[0][lane], self.colour[1][lane], self.colour[2][lane]],
        }
    }

    /// Puts a sample into a lane.
    pub(crate) fn put(&mut self, lane: usize, shaded: &golden::Shaded) {
        self.present[lane] = shaded.present.into();
        self.samples[lane] = shaded.sample;
        self.opacity[lane] = shaded.opacity;
        self.colour.iter_mut().zip(shaded.colour).for_each(|(row, word)| row[lane] = word);
    }
}
