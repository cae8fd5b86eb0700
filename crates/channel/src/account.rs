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

/// A resource that a unit waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// Several voxels of a beam are in one memory module, which gives one of them a cycle.
    BankConflict,
}

impl Reason {
    /// Every reason with its name in reports.
    pub const ALL: [(Reason, &'static str); 1] = [(Reason::BankConflict, "bank_conflict")];
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
    /// Counts a cycle; returns whether something moved in it or a timer ran.
    #[inline]
    pub fn record(&mut self, activity: Activity) -> bool {
        match activity {
            Activity::Busy => self.busy += 1,
            Activity::Starved => self.starved += 1,
            Activity::Blocked => self.blocked += 1,
            Activity::Waiting(reason) => self.waiting[reason as usize] += 1,
        }
        matches!(activity, Activity::Busy | Activity::Waiting(_))
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
