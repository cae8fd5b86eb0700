//! The samples of a ray slot, block by block.

use cube3_word::{BLOCK_LANES, LaneBlock};
use serde::{Deserialize, Serialize};

/// The samples of a ray slot in order of depth, block by block. From here on each lane works for itself: the sample at depth k is in
/// lane `(slot + k) mod lanes`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RaySamples(pub Vec<SampleBlock>);

/// A block of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[repr(C, align(64))]
pub struct SampleBlock {
    /// Sample words; 0 where there is none.
    pub samples: LaneBlock<i32>,
    /// Which lanes hold a sample of the volume: a bit each, that of the first the lowest.
    pub present: u16,
}

impl RaySamples {
    /// The samples of a ray.
    pub fn new(samples: &[Option<i32>]) -> RaySamples {
        let block = |samples: &[Option<i32>]| {
            let mut block = SampleBlock::default();
            for (lane, sample) in samples.iter().enumerate() {
                block.samples[lane] = sample.unwrap_or(0);
                block.present |= u16::from(sample.is_some()) << lane;
            }
            block
        };
        RaySamples(samples.chunks(BLOCK_LANES).map(block).collect())
    }

    /// The sample at a depth, where there is one.
    pub fn at(&self, depth: usize) -> Option<i32> {
        let SampleBlock { samples, present } = &self.0[depth / BLOCK_LANES];
        let lane = depth % BLOCK_LANES;
        (present >> lane & 1 != 0).then_some(samples[lane])
    }
}
