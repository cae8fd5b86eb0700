//! A bounded pipelined channel with credits.

use crate::{Activity, Archive, ArchiveError, Archived, Payload, Reason};
use serde::{Deserialize, Serialize};

/// A first-in first-out channel of `capacity` tokens, each of which takes `latency` cycles from push to pop.
///
/// One token is pushed and one popped in a cycle at most. A token on its way counts towards the
/// capacity, and the credit of a popped token comes back with the commit, so a full rate needs a capacity of
/// `latency + 1`.
///
/// What a token needs beside the channel, its words on links between boards, can make it later ([`Channel::delay`]) or keep the
/// next one out ([`Channel::shut`]); both are said between the last tick and the commit.
#[derive(Clone, Debug)]
pub struct Channel<T> {
    name: &'static str,
    /// A ring of a power of two of places: tokens take them in the order in which they are pushed, and `counters` says which are held.
    slots: Box<[Slot<T>]>,
    mask: u64,
    capacity: u64,
    /// The capacity, or 0 where links have no room for the words of a token.
    room: u64,
    latency: u64,
    now: u64,
    /// Tokens pushed in all once one has been pushed in this cycle, and the same of pops; 0 where none can be.
    push_limit: u64,
    pop_limit: u64,
    counters: ChannelCounters,
}

/// The place of a token.
#[derive(Clone, Debug)]
struct Slot<T> {
    /// The first cycle in which it can be popped.
    ready: u64,
    /// Cycles of those that it waits for words on links.
    late: u64,
    token: T,
}

/// What a channel has counted. `pushes = pops + occupancy` at all times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChannelCounters {
    /// Tokens pushed.
    pub pushes: u64,
    /// Tokens popped.
    pub pops: u64,
    /// Most tokens held at a commit.
    pub max_occupancy: u64,
    /// Tokens held, summed over the commits.
    pub occupancy_cycles: u64,
}

/// A channel that cannot be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChannelError {
    /// No room for a token.
    #[error("channel {name}: a capacity of 0 can hold nothing; give at least 1")]
    Capacity {
        /// The channel.
        name: &'static str,
    },
    /// A token would be seen in the cycle in which it is pushed, and the order of ticks would matter.
    #[error("channel {name}: a latency of 0 cycles makes the order of units matter; give at least 1")]
    Latency {
        /// The channel.
        name: &'static str,
    },
}

impl<T: Default> Channel<T> {
    /// An empty channel.
    ///
    /// # Errors
    /// A capacity or a latency of 0.
    pub fn new(name: &'static str, capacity: usize, latency: u64) -> Result<Channel<T>, ChannelError> {
        if capacity == 0 {
            return Err(ChannelError::Capacity { name });
        }
        if latency == 0 {
            return Err(ChannelError::Latency { name });
        }
        let ring = capacity.next_power_of_two();
        Ok(Channel {
            name,
            slots: (0..ring).map(|_| Slot { ready: 0, late: 0, token: T::default() }).collect(),
            mask: ring as u64 - 1,
            capacity: capacity as u64,
            room: capacity as u64,
            latency,
            now: 0,
            push_limit: 1,
            pop_limit: 0,
            counters: ChannelCounters::default(),
        })
    }

    /// Pops the oldest token that has arrived.
    #[inline]
    pub fn pop(&mut self) -> Option<T> {
        self.pop_slot().map(std::mem::take)
    }
}

impl<T> Channel<T> {
    /// Puts a token into every place that has none, so that its memory is there before the first is pushed.
    pub fn furnish(&mut self, mut token: impl FnMut() -> T) {
        let ChannelCounters { pushes, pops, .. } = self.counters;
        for behind in pushes..pops + self.slots.len() as u64 {
            self.slots[place(self.mask, behind)].token = token();
        }
    }

    /// Whether a token can be pushed in this cycle: a credit is there, nothing has been pushed yet, and links have room for its words.
    #[inline]
    pub fn can_push(&self) -> bool {
        self.counters.pushes < self.push_limit
    }

    /// What a unit does that has a token and cannot push it: it waits for room on links, or is blocked by the channel.
    #[inline]
    pub fn refusal(&self) -> Activity {
        let held_before = if self.pop_limit == 0 { 0 } else { self.counters.pushes - (self.pop_limit - 1) };
        if self.room == 0 && held_before < self.capacity { Activity::Waiting(Reason::Link) } else { Activity::Blocked }
    }

    /// What a unit does that finds no token at the front: it waits for the words of one that is there, or has nothing to work on.
    #[inline]
    pub fn lack(&self) -> Activity {
        let slot = &self.slots[place(self.mask, self.counters.pops)];
        let waits = self.counters.pops < self.pop_limit && slot.ready > self.now && slot.ready - slot.late <= self.now;
        if waits { Activity::Waiting(Reason::Link) } else { Activity::Starved }
    }

    #[inline]
    fn has_pushed(&self) -> bool {
        self.push_limit > 0 && self.counters.pushes == self.push_limit
    }

    /// The token that was pushed in this cycle.
    #[inline]
    pub fn pushed(&self) -> Option<&T> {
        if self.has_pushed() { self.newest() } else { None }
    }

    /// Makes the token that was pushed in this cycle so many cycles later: its words wait on links.
    #[inline]
    pub fn delay(&mut self, cycles: u64) {
        if self.has_pushed() {
            let slot = &mut self.slots[place(self.mask, self.counters.pushes - 1)];
            slot.ready += cycles;
            slot.late = cycles;
        }
    }

    /// Whether links have no room for the words of a token of the next cycle.
    #[inline]
    pub fn shut(&mut self, shut: bool) {
        self.room = if shut { 0 } else { self.capacity };
    }

    /// Pushes a token; gives it back where there is no credit.
    ///
    /// # Errors
    /// The token.
    #[inline]
    pub fn push(&mut self, token: T) -> Result<(), T> {
        match self.push_slot() {
            Some(slot) => {
                *slot = token;
                Ok(())
            }
            None => Err(token),
        }
    }

    /// The place of a new token, which holds an old one whose memory can be used again.
    #[inline]
    pub fn push_slot(&mut self) -> Option<&mut T> {
        self.push_slot_later(0)
    }

    /// The same for a token that takes `extra` cycles more than the channel's latency. Tokens stay in order: one behind it that
    /// takes less waits for it.
    #[inline]
    pub fn push_slot_later(&mut self, extra: u64) -> Option<&mut T> {
        if !self.can_push() {
            return None;
        }
        let slot = &mut self.slots[place(self.mask, self.counters.pushes)];
        self.counters.pushes += 1;
        slot.ready = self.now + self.latency + extra;
        slot.late = 0;
        Some(&mut slot.token)
    }

    /// The oldest token, where it has arrived and none has been popped in this cycle.
    #[inline]
    pub fn front(&self) -> Option<&T> {
        if self.counters.pops >= self.pop_limit {
            return None;
        }
        let slot = &self.slots[place(self.mask, self.counters.pops)];
        (slot.ready <= self.now).then_some(&slot.token)
    }

    /// Pops the oldest token in place; its memory stays with the channel and may be swapped out.
    #[inline]
    pub fn pop_slot(&mut self) -> Option<&mut T> {
        self.front()?;
        let place = place(self.mask, self.counters.pops);
        self.counters.pops += 1;
        Some(&mut self.slots[place].token)
    }

    /// Ends the cycle: what was pushed is on its way, and the credit of what was popped is back.
    #[inline]
    pub fn commit(&mut self) {
        self.now += 1;
        let held = self.counters.pushes - self.counters.pops;
        self.counters.occupancy_cycles += held;
        if held > self.counters.max_occupancy {
            self.counters.max_occupancy = held;
        }
        self.open();
    }

    /// Sets what can be pushed and popped in a new cycle: one token, where there is room and where there is one.
    #[inline]
    fn open(&mut self) {
        let ChannelCounters { pushes, pops, .. } = self.counters;
        self.push_limit = if pushes - pops < self.room { pushes + 1 } else { 0 };
        self.pop_limit = if pushes > pops { pops + 1 } else { 0 };
    }

    /// Whether a token was on its way in the cycle that the last commit ended, so that time alone will change, or has just
    /// changed, what can be popped.
    pub fn in_flight(&self) -> bool {
        self.slots_held().any(|slot| slot.ready >= self.now)
    }

    /// The places of the tokens held, oldest first.
    fn slots_held(&self) -> impl Iterator<Item = &Slot<T>> {
        let ChannelCounters { pushes, pops, .. } = self.counters;
        (pops..pushes).map(|token| &self.slots[place(self.mask, token)])
    }

    #[inline]
    fn newest_slot(&self) -> Option<&Slot<T>> {
        let ChannelCounters { pushes, pops, .. } = self.counters;
        (pushes > pops).then(|| &self.slots[place(self.mask, pushes - 1)])
    }

    /// The token that was pushed last, while it is held.
    #[inline]
    pub fn newest(&self) -> Option<&T> {
        self.newest_slot().map(|slot| &slot.token)
    }

    /// Cycles that the token pushed last waits for words on links, while it is held.
    #[inline]
    pub fn newest_late(&self) -> u64 {
        self.newest_slot().map_or(0, |slot| slot.late)
    }

    /// The tokens held, oldest first, each with the cycles until it can be popped.
    pub fn held(&self) -> impl Iterator<Item = (&T, u64)> {
        self.slots_held().map(|slot| (&slot.token, slot.ready.saturating_sub(self.now)))
    }

    /// Tokens held, those on their way included.
    pub fn occupancy(&self) -> usize {
        (self.counters.pushes - self.counters.pops) as usize
    }

    /// Tokens that fit.
    pub fn capacity(&self) -> usize {
        self.capacity as usize
    }

    /// Cycles from push to pop.
    pub fn latency(&self) -> u64 {
        self.latency
    }

    /// The channel's name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The counters.
    pub fn counters(&self) -> ChannelCounters {
        self.counters
    }
}

/// The place of a token of a ring, counted from the first that was pushed.
#[inline(always)]
fn place(mask: u64, token: u64) -> usize {
    (token & mask) as usize
}

/// Tokens held are archived, and not the memory of those that have left. Between two cycles only: nothing pushed or popped.
impl<T: Payload> Archived for Channel<T> {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let Channel { name, slots, mask, capacity, room, latency: _, now, push_limit: _, pop_limit: _, counters } =
            self;
        let (mut shut, mut held) = (*room == 0, counters.pushes - counters.pops);
        archive.item(now)?;
        archive.item(&mut shut)?;
        archive.item(counters)?;
        archive.item(&mut held)?;
        if held > *capacity || counters.pushes.checked_sub(counters.pops) != Some(held) {
            return Err(ArchiveError::Tokens { name, found: held as usize, capacity: *capacity as usize });
        }
        for token in counters.pops..counters.pushes {
            let slot = &mut slots[place(*mask, token)];
            archive.item(&mut slot.ready)?;
            archive.item(&mut slot.late)?;
            archive.item(&mut slot.token)?;
        }
        self.shut(shut);
        self.open();
        Ok(())
    }
}

#[cfg(test)]
mod tests;
