//! What a unit did with each of its cycles.

use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

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
    /// How many there are.
    pub const COUNT: usize = 3 + Reason::ALL.len();

    /// Its place among all, from 0.
    #[inline]
    pub fn code(self) -> u8 {
        match self {
            Activity::Busy => 0,
            Activity::Starved => 1,
            Activity::Blocked => 2,
            Activity::Waiting(reason) => 3 + reason as u8,
        }
    }

    /// The activity at a place, where there is one.
    pub fn from_code(code: u8) -> Option<Activity> {
        match code {
            0 => Some(Activity::Busy),
            1 => Some(Activity::Starved),
            2 => Some(Activity::Blocked),
            _ => Reason::ALL.get(usize::from(code) - 3).copied().map(Activity::Waiting),
        }
    }

    /// Its name in traces.
    pub fn name(self) -> &'static str {
        match self {
            Activity::Busy => "busy",
            Activity::Starved => "starved",
            Activity::Blocked => "blocked",
            Activity::Waiting(reason) => reason.name(),
        }
    }

    /// Whether something moved or a timer ran.
    #[inline]
    pub fn is_active(self) -> bool {
        matches!(self, Activity::Busy | Activity::Waiting(_))
    }
}

/// A resource that a unit waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
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
    /// Every reason.
    pub const ALL: &'static [Reason] = Reason::VARIANTS;

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        self.into()
    }
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
        if activity == Activity::Busy {
            self.busy += 1;
        } else {
            self.record_rest(activity);
        }
        activity
    }

    /// Counts a cycle without work.
    #[inline(never)]
    fn record_rest(&mut self, activity: Activity) {
        match activity {
            Activity::Busy => {}
            Activity::Starved => self.starved += 1,
            Activity::Blocked => self.blocked += 1,
            Activity::Waiting(reason) => self.waiting[reason as usize] += 1,
        }
    }

    /// What the unit did in the one cycle since `before`.
    #[inline]
    pub fn since(&self, before: &Account) -> Activity {
        if self.busy != before.busy {
            return Activity::Busy;
        }
        if self.blocked != before.blocked {
            return Activity::Blocked;
        }
        let waited = Reason::ALL.iter().copied().find(|&reason| {
            let i = reason as usize;
            self.starved == before.starved && self.waiting[i] != before.waiting[i]
        });
        waited.map_or(Activity::Starved, Activity::Waiting)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_activity_has_its_own_code_and_name() {
        let all: Vec<Activity> = (0..Activity::COUNT as u8).filter_map(Activity::from_code).collect();
        assert_eq!(all.len(), Activity::COUNT);
        let mut account = Account::default();
        for (code, activity) in all.iter().enumerate() {
            assert_eq!(usize::from(activity.code()), code);
            let before = account;
            account.record(*activity);
            assert_eq!(account.since(&before), *activity);
        }
        for (place, &reason) in Reason::ALL.iter().enumerate() {
            assert_eq!(reason as usize, place);
            assert_eq!(serde_json::to_string(&reason).unwrap(), format!("\"{}\"", reason.name()));
        }
        assert_eq!(Activity::from_code(Activity::COUNT as u8), None);
    }
}
