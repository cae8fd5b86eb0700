//! What a unit did with each of its cycles.

use serde::{Deserialize, Serialize};

/// What a unit did in one cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// It worked on a token.
    Busy,
    /// It had nothing to work on.
    Starved,
    /// It had no room for its result.
    Blocked,
    /// It had a token and room, and waited for a resource.
    Waiting(Reason),
}

impl Activity {
    /// Whether something moved or a timer ran.
    #[inline]
    pub fn is_active(self) -> bool {
        matches!(self, Activity::Busy | Activity::Waiting(_))
    }
}

/// A resource that a unit waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// Several voxels of a beam are in one memory module, which gives one of them a cycle.
    BankConflict,
    /// A memory module opens or closes a row.
    MemoryRow,
    /// Memory modules are refreshed.
    Refresh,
    /// The bus has fewer slices in a cycle than a beam has voxels.
    BusSlice,
    /// A buffer's or module's port is taken by another access.
    Port,
    /// Words on their way between boards.
    Link,
    /// The host takes pixels more slowly than they come.
    Host,
}

impl Reason {
    /// Every reason with its name in reports.
    pub const ALL: [(Reason, &'static str); 7] = [
        (Reason::BankConflict, "bank_conflict"),
        (Reason::MemoryRow, "memory_row"),
        (Reason::Refresh, "refresh"),
        (Reason::BusSlice, "bus_slice"),
        (Reason::Port, "port"),
        (Reason::Link, "link"),
        (Reason::Host, "host"),
    ];
}

/// The cycles of a unit, each in exactly one place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Account {
    /// Cycles of work.
    pub busy: u64,
    /// Cycles without a token.
    pub starved: u64,
    /// Cycles without room for the result.
    pub blocked: u64,
    /// Cycles of waiting, by reason.
    pub waiting: [u64; Reason::ALL.len()],
}

impl Account {
    /// Counts a cycle, and gives back what it was.
    #[inline]
    pub fn record(&mut self, activity: Activity) -> Activity {
        match activity {
            Activity::Busy => self.busy += 1,
            Activity::Starved => self.starved += 1,
            Activity::Blocked => self.blocked += 1,
            Activity::Waiting(reason) => self.waiting[reason as usize] += 1,
        }
        activity
    }

    /// All cycles counted.
    pub fn cycles(&self) -> u64 {
        self.busy + self.starved + self.blocked + self.waiting.iter().sum::<u64>()
    }

    /// Cycles in which something moved or a timer ran.
    pub fn active(&self) -> u64 {
        self.busy + self.waiting.iter().sum::<u64>()
    }
}
