//! The reorder buffer: what is in it, and how large it must be.

use super::Served;
use super::places::Mini;
use super::rows::ReorderNeed;
use cube3_frame::FrameSetup;
use cube3_machine::MachineSpec;
use serde::{Deserialize, Serialize};
use std::borrow::Borrow;

/// A reorder buffer that is too small.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "cfb.reorder_words = {words} is too small for this view: a beam needs {least} words in the buffer at once; give at least as many, or leave \
     it out ({steady} then)"
)]
pub struct ReorderError {
    /// Words given.
    pub words: u64,
    /// The fewest that would do.
    pub least: u64,
    /// Words that hold nothing up.
    pub steady: u64,
}

/// What the reorder buffer has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReorderCounters {
    /// Words that it holds.
    pub words: u64,
    /// Most words that rows in the buffer, or asked for, have taken.
    pub peak_words: u64,
    /// Rows of mini-blocks that have been asked for.
    pub rows: u64,
    /// Mini-blocks of these.
    pub mini_blocks: u64,
}

/// A row of mini-blocks, or a part of one, in the buffer or on its way there.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Row {
    pub frame: u32,
    pub section: u32,
    pub j: u32,
    /// Its mini-blocks, from the first to behind the last.
    pub minis: [u32; 2],
    /// What j and k give to places.
    pub base: Mini,
    /// Modules that have asked for all of theirs.
    pub passed: u32,
    /// Whether its last beam is over.
    pub left: bool,
    /// Mini-blocks from the first on that are there.
    pub there: u32,
    /// When each is, until all are.
    pub arrivals: Vec<Arrival>,
}

impl Row {
    /// What tells it from the others at its depths: frame, section, row, first mini-block.
    pub fn key(&self) -> [u32; 4] {
        [self.frame, self.section, self.j, self.minis[0]]
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Arrival {
    /// Bursts that have not been asked for.
    pub missing: u32,
    pub served: Served,
}

/// Words of the reorder buffer of a machine with mini-blocks for some frames: those of the machine file, or what the frames need.
///
/// # Errors
/// Fewer than a beam needs.
pub fn reorder_words(machine: &MachineSpec, frames: &[impl Borrow<FrameSetup>]) -> Result<u64, ReorderError> {
    let mut most = ReorderNeed::default();
    for setup in frames {
        let need = ReorderNeed::new(machine, &setup.borrow().geometry);
        (most.least, most.steady) = (most.least.max(need.least), most.steady.max(need.steady));
    }
    let words = machine.cfb.reorder_words.unwrap_or(most.steady);
    if words < most.least {
        return Err(ReorderError { words, least: most.least, steady: most.steady });
    }
    Ok(words)
}
