//! What brings words to the beams of the frame buffer.

use super::rows::At;
use super::{BlockModules, BlockState, MemoryCounters, MemoryState, Modules, ReorderCounters, ReorderError};
use crate::scan::{CfbSpec, Piece, Scan};
use cube3_channel::Activity;
use cube3_frame::{FrameSetup, Geometry};
use cube3_machine::{Layout, MachineSpec};
use serde::{Deserialize, Serialize};
use std::borrow::Borrow;
use std::sync::Arc;

/// Memory modules that do not give any word in any cycle, and how they are read.
#[derive(Clone, Debug)]
pub enum Supply {
    /// By beams: in each step at most a word of each module.
    Beams(Modules),
    /// By mini-blocks, through a reorder buffer.
    Blocks(BlockModules),
}

/// Where they are.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum SupplyState {
    Beams(MemoryState),
    Blocks(BlockState),
}

impl Supply {
    /// The modules of a machine for some frames of one volume; none where they give any word in any cycle.
    ///
    /// # Errors
    /// A reorder buffer that is too small for a frame.
    pub fn new(machine: &MachineSpec, frames: &[impl Borrow<FrameSetup>]) -> Result<Option<Supply>, ReorderError> {
        let Some(dims) = frames.first().map(|setup| setup.borrow().geometry.dims()) else {
            return Ok(None);
        };
        Ok(match machine.cfb.layout {
            Layout::Rows | Layout::Blocks => Modules::new(machine, dims).map(Supply::Beams),
            Layout::MiniBlocks => Some(Supply::Blocks(BlockModules::new(machine, frames, dims)?)),
        })
    }

    pub(crate) fn start(&self, frames: usize) -> SupplyState {
        match self {
            Supply::Beams(modules) => SupplyState::Beams(modules.start(frames)),
            Supply::Blocks(modules) => SupplyState::Blocks(modules.start(frames)),
        }
    }

    /// Has the modules ask for words ahead of the scan, in frames before `released`.
    #[inline(never)]
    pub(crate) fn ask(&self, state: &mut SupplyState, frames: &[Arc<FrameSetup>], specs: &[CfbSpec], released: u32) {
        match (self, state) {
            (Supply::Beams(modules), SupplyState::Beams(state)) => modules.ask(state, frames, specs, released),
            (Supply::Blocks(modules), SupplyState::Blocks(state)) => modules.ask(state, frames, specs, released),
            _ => {}
        }
    }

    /// What the frame buffer does in this cycle while the words of its step are not there; else it takes them.
    #[inline]
    pub(crate) fn take(
        &self,
        state: &mut SupplyState,
        geometry: &Geometry,
        spec: &CfbSpec,
        scan: &Scan,
    ) -> Option<Activity> {
        match (self, state) {
            (Supply::Beams(_), SupplyState::Beams(state)) => {
                let activity = state.waits();
                if activity.is_none() {
                    state.take();
                }
                activity
            }
            (Supply::Blocks(modules), SupplyState::Blocks(state)) => {
                let Scan { frame, place, spent } = *scan;
                let piece = Piece::at(place, geometry, &spec.schedule)?;
                // Of a beam with two rows the second comes behind the first, if there is one.
                let half = spec.piece_cycles(Some(&piece)) / spec.schedule.rows_of_beam();
                let (v, step) = if spent < half {
                    (piece.row as usize, spent)
                } else {
                    (geometry.row_below(place.plane as usize, place.depth as usize)?, spent - half)
                };
                let at = At { geometry, schedule: &spec.schedule, place };
                modules.waits(state, frame, &at, v, &spec.voxels_of_step(&piece, step as usize))
            }
            _ => None,
        }
    }

    /// A beam is over.
    #[inline(never)]
    pub(crate) fn end_beam(&self, state: &mut SupplyState, geometry: &Geometry, spec: &CfbSpec, scan: &Scan) {
        if let (Supply::Blocks(modules), SupplyState::Blocks(state)) = (self, state) {
            modules.leave(state, scan.frame, &At { geometry, schedule: &spec.schedule, place: scan.place });
        }
    }
}

impl SupplyState {
    /// Ends the pipeline cycle.
    #[inline]
    pub(crate) fn end_cycle(&mut self) {
        match self {
            SupplyState::Beams(state) => state.end_cycle(),
            SupplyState::Blocks(state) => state.end_cycle(),
        }
    }

    pub(crate) fn counters(&self) -> &[MemoryCounters] {
        match self {
            SupplyState::Beams(state) => state.counters(),
            SupplyState::Blocks(state) => state.counters(),
        }
    }

    pub(crate) fn reorder(&self) -> Option<ReorderCounters> {
        match self {
            SupplyState::Beams(_) => None,
            SupplyState::Blocks(state) => Some(state.reorder()),
        }
    }
}
