//! What memory modules have done.

use serde::{Deserialize, Serialize};
use std::ops::AddAssign;

/// What memory modules have done. `reads + writes = row_hits + row_misses + row_conflicts`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MemoryCounters {
    /// Words read.
    pub words: u64,
    /// Read commands; the other words came with an earlier burst.
    pub reads: u64,
    /// Words written.
    pub writes: u64,
    /// Reads and writes that found their row open.
    pub row_hits: u64,
    /// Reads and writes that found their bank closed.
    pub row_misses: u64,
    /// Reads and writes that found another row open.
    pub row_conflicts: u64,
    /// Refreshes.
    pub refreshes: u64,
}

impl MemoryCounters {
    /// The same in `modules` modules.
    pub fn times(self, modules: u64) -> MemoryCounters {
        MemoryCounters {
            words: self.words * modules,
            reads: self.reads * modules,
            writes: self.writes * modules,
            row_hits: self.row_hits * modules,
            row_misses: self.row_misses * modules,
            row_conflicts: self.row_conflicts * modules,
            refreshes: self.refreshes * modules,
        }
    }
}

impl AddAssign for MemoryCounters {
    fn add_assign(&mut self, other: MemoryCounters) {
        self.words += other.words;
        self.reads += other.reads;
        self.writes += other.writes;
        self.row_hits += other.row_hits;
        self.row_misses += other.row_misses;
        self.row_conflicts += other.row_conflicts;
        self.refreshes += other.refreshes;
    }
}
