//! Opacity and colour of a block from the tables.

use super::shaded::ShadedBlock;
use cube3_frame::Classification;
use cube3_word::{BLOCK_LANES, LaneBlock};
use std::sync::Arc;

/// The classification tables.
#[derive(Clone, Debug)]
pub struct ClassifyLanes {
    /// Red, green, blue in 16 bits each.
    colour: Vec<u64>,
    /// Opacity: `width` entries for each row, the rows of a class of step lengths behind one another. Copies of the lanes share it.
    opacity: Arc<[u32]>,
    width: u32,
    shift: u32,
    threshold: [u32; 2],
    /// How far a magnitude is shifted to its row, and the last row; where there is more than one.
    pub(super) rows: Option<(u32, u32)>,
    /// Whether there is one row in all.
    flat: bool,
    /// Whether the threshold lets all samples take part.
    pub(super) all: bool,
}

impl ClassifyLanes {
    /// Lanes for the tables of a frame.
    pub fn new(table: &Classification) -> ClassifyLanes {
        let pack = |colour: &[u32; 3]| u64::from(colour[0]) | u64::from(colour[1]) << 16 | u64::from(colour[2]) << 32;
        let last = (table.colour.len() as u32).wrapping_shl(table.index_shift).wrapping_sub(1);
        ClassifyLanes {
            colour: table.colour.iter().map(pack).collect(),
            opacity: table.opacity.as_slice().into(),
            width: table.colour.len() as u32,
            shift: table.index_shift,
            threshold: table.threshold,
            rows: table.gradient_rows.map(|rows| (rows.shift, rows.rows - 1)),
            flat: table.opacity.len() <= table.colour.len(),
            all: table.threshold[0] == 0 && table.threshold[1] >= last,
        }
    }

    /// Opacities of a block, and which samples take part: the others are 0. `magnitude` is read where the opacity depends on it; `class` is 0 where there
    /// is one class.
    #[inline(always)]
    pub fn opacity(&self, magnitude: &LaneBlock<u32>, class: &LaneBlock<u32>, out: &mut ShadedBlock) {
        if self.flat {
            self.opacity_in::<true>(magnitude, class, out);
        } else {
            self.opacity_in::<false>(magnitude, class, out);
        }
    }

    #[inline(always)]
    fn opacity_in<const FLAT: bool>(&self, magnitude: &LaneBlock<u32>, class: &LaneBlock<u32>, out: &mut ShadedBlock) {
        let shift = self.shift;
        let table = &*self.opacity;
        let Some(last) = table.len().checked_sub(1) else {
            return;
        };
        let [low, high] = self.threshold;
        let width = self.width;
        let (drop, top) = self.rows.unwrap_or((0, 0));
        // Copies, which nothing that is written can be part of.
        let (words, mut there, mut found) = (out.samples, out.present, [0; BLOCK_LANES]);
        let mut kept = [0; BLOCK_LANES];
        for i in 0..BLOCK_LANES {
            let word = words[i] as u32;
            let takes_part = there[i] != 0 && word >= low && word <= high;
            let row = if FLAT { 0 } else { (class[i] * (top + 1) + (magnitude[i] >> drop).min(top)) * width };
            let entry = table[((row + (word >> shift)) as usize).min(last)];
            there[i] = u32::from(takes_part);
            found[i] = if takes_part { entry } else { 0 };
            kept[i] = if takes_part { words[i] } else { 0 };
        }
        (out.samples, out.present, out.opacity) = (kept, there, found);
    }

    /// The opacity of a sample by the table of a class.
    pub(super) fn entry(&self, class: u32, sample: i32, magnitude: u32) -> u32 {
        let (drop, top) = self.rows.unwrap_or((0, 0));
        let row = class * (top + 1) + (magnitude >> drop).min(top);
        self.opacity[row as usize * self.width as usize + (sample as u32 >> self.shift) as usize]
    }

    /// Colours of a block, to be cleared where the opacity is 0.
    #[inline(always)]
    pub fn colour(&self, out: &mut ShadedBlock) {
        let shift = self.shift;
        let table = self.colour.as_slice();
        let Some(last) = table.len().checked_sub(1) else {
            return;
        };
        let ShadedBlock { samples, colour: [red, green, blue], .. } = out;
        for i in 0..BLOCK_LANES {
            let entry = table[((samples[i] as u32 >> shift) as usize).min(last)];
            red[i] = entry as u32 & 0xffff;
            green[i] = (entry >> 16) as u32 & 0xffff;
            blue[i] = (entry >> 32) as u32;
        }
    }
}
