//! The memory modules behind the frame buffer, where they cannot give any word in any cycle.
//!
//! ```text
//!   look-ahead scan ──► module 0: banks, open rows, one command a tick ──┐
//!                  ──► …                                                 ├──► a word of each module, in order ──► beam
//!                  ──► module n−1                                        ┘
//! ```
//! [`MemoryModel`](cube3_machine::MemoryModel) is the table of constraints, [`Timing`] the table at a clock, [`Module`] the controller of one module,
//! [`Modules`] all of them under the scan of the frame buffer, [`BlockModules`] all of them with mini-blocks, which go through a reorder buffer.

mod activates;
mod array;
mod blocks;
mod calendar;
mod chooser;
mod counters;
mod module;
#[cfg(test)]
mod oracle;
#[cfg(test)]
mod outside;
mod places;
mod reorder;
mod rows;
mod supply;
#[cfg(test)]
mod tests;
mod ticks;
mod timing;

pub use array::{MemoryState, Modules};
pub use blocks::{BlockModules, BlockState};
use chooser::Chooser;
pub use counters::MemoryCounters;
pub use module::{Module, Served};
pub use reorder::{ReorderCounters, ReorderError, reorder_words};
pub use rows::{ReorderNeed, edge_words};
pub use supply::Supply;
pub(crate) use supply::SupplyState;
pub use timing::{Timing, WordPlace};
