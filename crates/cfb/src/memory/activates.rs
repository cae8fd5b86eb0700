//! The activates of a module that those far behind them must keep their distance from, before and behind.

use super::calendar::Calendar;
use super::timing::{Spacing, Timing};
use serde::{Deserialize, Serialize};

/// From so many on, those that are behind all to come are forgotten.
const FORGET_FROM: usize = 16;

/// Activates of a module in the order of their ticks.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Activates {
    /// The last tick.
    latest: i64,
    /// Tick and group of each.
    ticks: Vec<(i64, u8)>,
}

impl Activates {
    /// None so far; `never` is before every tick.
    pub fn new(never: i64) -> Activates {
        Activates { latest: never, ticks: Vec::new() }
    }

    /// The first tick from `tick` on at which an activate in a group can be booked and keeps all distances: behind the others, or in a gap
    /// between two that have been booked.
    #[inline(always)]
    pub fn free(&self, timing: &Timing, group: usize, tick: i64, calendar: &Calendar) -> i64 {
        if timing.spacings.is_empty() || tick >= self.latest + timing.reach {
            calendar.free_of_activates(timing, group, tick)
        } else {
            self.search(timing, group, tick, calendar)
        }
    }

    fn search(&self, timing: &Timing, group: usize, tick: i64, calendar: &Calendar) -> i64 {
        let before = self.ticks.iter().rposition(|booked| booked.0 <= tick).map_or(0, |last| last + 1);
        let mut gap = before;
        loop {
            let (mut first, mut last) = (tick, self.ticks.get(gap).map_or(i64::MAX, |booked| booked.0));
            for spacing in &timing.spacings {
                let (earliest, latest) = self.bounds(spacing, group as u8, gap);
                first = first.max(earliest);
                last = last.min(latest);
            }
            let free = calendar.free_of_activates(timing, group, first);
            if free <= last || gap == self.ticks.len() {
                return free;
            }
            gap += 1;
        }
    }

    /// The first and the last tick that a spacing allows in a gap, with `gap` activates before it; the last is before the first where it
    /// allows none.
    #[inline(always)]
    fn bounds(&self, spacing: &Spacing, group: u8, gap: usize) -> (i64, i64) {
        let (before, behind) = self.ticks.split_at(gap);
        if spacing.of_group {
            let same = |booked: &&(i64, u8)| booked.1 == group;
            let earliest = before.iter().rev().find(same).map_or(i64::MIN, |booked| booked.0 + spacing.ticks);
            let latest = behind.iter().find(same).map_or(i64::MAX, |booked| booked.0 - spacing.ticks);
            return (earliest, latest);
        }
        let nth = spacing.nth;
        let earliest = gap.checked_sub(nth).map_or(i64::MIN, |i| before[i].0 + spacing.ticks);
        let latest = behind.get(nth - 1).map_or(i64::MAX, |booked| booked.0 - spacing.ticks);
        // With one more between them, those that were nth − 1 apart are nth apart.
        let closer = |start: usize| {
            let end = self.ticks.get(start + nth - 1);
            start < gap && end.is_some_and(|end| end.0 - self.ticks[start].0 < spacing.ticks)
        };
        let close = nth > 1 && ((gap + 1).saturating_sub(nth)..gap).any(closer);
        (earliest, if close { i64::MIN } else { latest })
    }

    /// Books an activate. None to come is before `asked`.
    #[inline(always)]
    pub fn book(&mut self, timing: &Timing, group: usize, tick: i64, asked: i64) {
        if timing.spacings.is_empty() {
            return;
        }
        if self.ticks.len() >= FORGET_FROM {
            let old = self.ticks.partition_point(|booked| booked.0 + timing.reach <= asked);
            self.ticks.drain(..old);
        }
        if tick > self.latest {
            self.latest = tick;
            self.ticks.push((tick, group as u8));
        } else {
            let place = self.ticks.partition_point(|booked| booked.0 <= tick);
            self.ticks.insert(place, (tick, group as u8));
        }
    }
}
