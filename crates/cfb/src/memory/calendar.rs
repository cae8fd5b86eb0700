//! The ticks that a module's commands have taken: one command a tick on a bus, and activates that keep their distance.

use super::timing::Timing;
use cube3_machine::MemoryModel;
use serde::{Deserialize, Serialize};

/// Which ticks are taken, from some tick on, for any command and for activates.
///
/// Distances between neighbouring activates are marked here where they are short ([`Timing::near`]): each takes the ticks around it from other
/// activates. Those between an activate and one farther on, and long ones, are [`super::activates`]'s.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[repr(C)]
pub(super) struct Calendar {
    /// The first tick that is known.
    first: i64,
    /// Of 64 ticks those with a command.
    commands: u64,
    /// Of 64 ticks those that are too near an activate of the module.
    near: u64,
    /// Whether anything is taken behind them.
    farther: bool,
    later: Later,
}

/// What is taken of later ticks.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Later {
    /// As in [`Calendar`], of the next 64 ticks.
    commands: u64,
    near: u64,
    /// Ticks that are too near an activate of a group.
    group_near: [u128; MemoryModel::MOST_GROUPS],
    /// What was booked and does not lie within the bits with all that it takes.
    far: Vec<Booked>,
}

/// A command of a tick; with its group where it is an activate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Booked {
    tick: i64,
    activate: Option<u8>,
}

/// Ticks that have a bit.
const TICKS: i64 = 128;

/// The bits of 128 ticks.
fn both(low: u64, high: u64) -> u128 {
    u128::from(high) << 64 | u128::from(low)
}

/// The 64 ticks of a calendar while some commands are booked in them, by their places from its first tick. What does not fit is told in the end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Draft {
    commands: u64,
    near: u64,
    /// The latest place that was taken.
    latest: u64,
}

impl Draft {
    /// Places from here on are not looked at.
    const END: u64 = 63;

    #[inline(always)]
    fn first_of(&mut self, taken: u64, place: i64) -> i64 {
        // The last place stands for what is not looked at.
        let free = !taken.wrapping_shr(place as u32) | 1 << Draft::END;
        let place = place + i64::from(free.trailing_zeros());
        self.latest = self.latest.max(place as u64);
        place
    }

    /// The first place from one on without a command, for a command that is no activate.
    #[inline(always)]
    pub fn take(&mut self, place: i64) -> i64 {
        let place = self.first_of(self.commands, place);
        self.commands |= 1_u64.wrapping_shl(place as u32);
        place
    }

    /// The first place for an activate from one on, in a module with one group of banks.
    #[inline(always)]
    pub fn activate(&mut self, timing: &Timing, place: i64) -> i64 {
        let place = self.first_of(self.commands | self.near, place);
        self.commands |= 1_u64.wrapping_shl(place as u32);
        let [before, span] = timing.around();
        let start = (place - before as i64) as u64;
        self.latest = if start > 64 - span { Draft::END } else { self.latest };
        self.near |= ((1 << span) - 1_u64).wrapping_shl(start as u32);
        place
    }

    /// Whether all that was booked fits.
    #[inline(always)]
    pub fn fits(&self) -> bool {
        self.latest < Draft::END
    }
}

impl Calendar {
    /// The first tick that is known, and the 64 from it on.
    #[inline(always)]
    pub fn draft(&self) -> (i64, Draft) {
        (self.first, Draft { commands: self.commands, near: self.near, latest: 0 })
    }

    /// Books what was booked in a draft that fits.
    #[inline(always)]
    pub fn book(&mut self, Draft { commands, near, .. }: Draft) {
        (self.commands, self.near) = (commands, near);
    }

    /// Forgets ticks before `tick`: nothing is booked there any more.
    #[inline(always)]
    pub fn forget(&mut self, timing: &Timing, tick: i64) {
        let ticks = tick - self.first;
        if ticks <= 0 {
            return;
        }
        if self.farther || timing.groups > 1 || ticks >= 64 {
            return self.forget_far(timing, tick);
        }
        self.commands >>= ticks;
        self.near >>= ticks;
        self.first = tick;
    }

    #[inline(never)]
    fn forget_far(&mut self, timing: &Timing, tick: i64) {
        let ticks = tick - self.first;
        let Calendar { first, commands, near, farther, later } = self;
        let forget = |bits: u128| if ticks < TICKS { bits >> ticks } else { 0 };
        let halves = |bits: u128| (bits as u64, (bits >> 64) as u64);
        (*commands, later.commands) = halves(forget(both(*commands, later.commands)));
        (*near, later.near) = halves(forget(both(*near, later.near)));
        later.group_near = later.group_near.map(forget);
        *first = tick;
        let far = std::mem::take(&mut later.far);
        *farther = later.commands | later.near != 0;
        for Booked { tick, activate } in far {
            match activate {
                Some(group) => self.activate(timing, group as usize, tick),
                None => self.take(tick),
            }
        }
    }

    /// The first tick from `tick` on without a command.
    #[inline(always)]
    pub fn free(&self, timing: &Timing, tick: i64) -> i64 {
        self.first_of(self.commands, tick).unwrap_or_else(|| self.search(timing, tick, None))
    }

    /// The first tick from `tick` on that has no command and is near no activate, for one in a group.
    #[inline(always)]
    pub fn free_of_activates(&self, timing: &Timing, group: usize, tick: i64) -> i64 {
        let group_near = if timing.groups > 1 { self.later.group_near[group] as u64 } else { 0 };
        let found = self.first_of(self.commands | self.near | group_near, tick);
        found.unwrap_or_else(|| self.search(timing, tick, Some(group as u8)))
    }

    /// The first of the 64 ticks that is not taken.
    #[inline(always)]
    fn first_of(&self, taken: u64, tick: i64) -> Option<i64> {
        let place = tick.wrapping_sub(self.first) as u64;
        let free = if place < 64 { !taken >> place } else { 0 };
        (free != 0).then(|| tick + i64::from(free.trailing_zeros()))
    }

    #[inline(never)]
    fn search(&self, timing: &Timing, tick: i64, activate: Option<u8>) -> i64 {
        let Calendar { first, commands, near, later, .. } = self;
        let mut taken = both(*commands, later.commands);
        if let Some(group) = activate {
            taken |= both(*near, later.near) | later.group_near[group as usize];
        }
        let place = tick - first;
        if place < 0 {
            return tick;
        }
        let free = if place < TICKS { !taken >> place } else { 0 };
        if free != 0 {
            return tick + i64::from(free.trailing_zeros());
        }
        let far = |tick: &i64| !later.far.iter().any(|booked| booked.takes(timing, *tick, activate));
        (tick.max(first + TICKS)..).find(far).unwrap_or(i64::MAX)
    }

    /// Takes a tick for a command that is no activate.
    #[inline(always)]
    pub fn take(&mut self, tick: i64) {
        let place = tick.wrapping_sub(self.first) as u64;
        if place < 64 {
            self.commands |= 1 << place;
        } else {
            self.take_far(tick);
        }
    }

    #[inline(never)]
    fn take_far(&mut self, tick: i64) {
        match tick - self.first {
            ..0 => return,
            place @ 0..TICKS => self.later.commands |= 1 << (place - 64),
            _ => self.later.far.push(Booked { tick, activate: None }),
        }
        self.farther = true;
    }

    /// Takes a tick for an activate in a group, and those around it from other activates.
    #[inline(always)]
    pub fn activate(&mut self, timing: &Timing, group: usize, tick: i64) {
        let place = tick - self.first;
        let [before, span] = timing.around();
        let start = (place - before as i64) as u64;
        if timing.groups > 1 || start > 64 - span {
            return self.activate_far(timing, group, tick);
        }
        self.commands |= 1 << place;
        self.near |= ((1 << span) - 1_u64) << start;
    }

    #[inline(never)]
    fn activate_far(&mut self, timing: &Timing, group: usize, tick: i64) {
        let place = tick - self.first;
        let around = |ticks: i64| {
            let (start, span) = (place - (ticks - 1), (1_u128 << (2 * ticks - 1)) - 1);
            match start {
                0..TICKS => span << start,
                _ if start < 0 && start > -TICKS => span >> -start,
                _ => 0,
            }
        };
        let Calendar { commands, near, farther, later, .. } = self;
        let take = |low: &mut u64, high: &mut u64, bits: u128| {
            *low |= bits as u64;
            *high |= (bits >> 64) as u64;
        };
        take(commands, &mut later.commands, around(1));
        take(near, &mut later.near, around(timing.near[0]));
        if timing.groups > 1 {
            later.group_near[group] |= around(timing.near[1]);
        }
        if place >= TICKS - Timing::NEAR {
            later.far.push(Booked { tick, activate: Some(group as u8) });
        }
        *farther = !later.far.is_empty() || later.commands | later.near != 0;
    }
}

impl Booked {
    /// Whether another command, an activate of a group or none, cannot be issued at a tick.
    fn takes(&self, timing: &Timing, tick: i64, activate: Option<u8>) -> bool {
        let least = match self.activate.zip(activate) {
            None => 1,
            Some((one, other)) if one == other => timing.near[0].max(timing.near[1]),
            Some(_) => timing.near[0],
        };
        (self.tick - tick).abs() < least
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use cube3_machine::MemoryType;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn the_first_free_tick_is_that_of_a_list(
            near in [1..=Timing::NEAR, 1..=Timing::NEAR], grouped: bool,
            steps in proptest::collection::vec((0_i64..40, 0_u8..20, 0_i64..700, 0_usize..5), 1..200),
        ) {
            let model = MemoryModel::of(if grouped { MemoryType::Hbm } else { MemoryType::Sdram });
            let near = [near[0], if grouped { near[1] } else { near[0] }];
            let timing = Timing { near, ..Timing::new(model, 100e6) };
            let (mut calendar, mut list, mut now) = (Calendar::default(), Vec::<(i64, Option<usize>)>::new(), 0);
            for (pause, leap, ahead, group) in steps {
                now += if leap == 0 { 50 * pause } else { pause / 8 };
                calendar.forget(&timing, now);
                let wish = now + if leap < 4 { ahead } else { ahead % 20 };
                let group = if grouped { group.checked_sub(1) } else { (group > 1).then_some(0) };
                let taken = |tick: i64| list.iter().any(|&(booked, other)| {
                    let distance = (booked - tick).abs();
                    let activates = group.is_some() && other.is_some();
                    distance == 0 || activates && (distance < near[0] || group == other && distance < near[1])
                });
                let expected = (wish..).find(|&tick| !taken(tick)).unwrap();
                match group {
                    Some(group) => {
                        prop_assert_eq!(calendar.free_of_activates(&timing, group, wish), expected);
                        calendar.activate(&timing, group, expected);
                    }
                    None => {
                        prop_assert_eq!(calendar.free(&timing, wish), expected);
                        calendar.take(expected);
                    }
                }
                list.push((expected, group));
            }
        }
    }
}
