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
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;
    use std::collections::VecDeque;

    #[test]
    fn a_token_arrives_after_its_latency_and_not_a_cycle_earlier() {
        for latency in 1..5 {
            let mut channel = Channel::new("c", 4, latency).unwrap();
            channel.push(7).unwrap();
            for _ in 0..latency {
                assert_eq!(channel.front(), None);
                channel.commit();
            }
            assert_eq!(channel.pop(), Some(7));
        }
    }

    #[test]
    fn a_token_that_takes_longer_keeps_its_place() {
        let mut channel = Channel::new("c", 4, 2).unwrap();
        *channel.push_slot_later(3).unwrap() = 1;
        channel.commit();
        channel.push(2).unwrap();
        for _ in 1..5 {
            assert_eq!(channel.front(), None);
            assert!(channel.in_flight());
            channel.commit();
        }
        assert_eq!(channel.pop(), Some(1));
        channel.commit();
        assert_eq!(channel.pop(), Some(2), "it has arrived long ago");
    }

    #[test]
    fn a_full_channel_refuses_and_the_credit_comes_back_with_the_commit() {
        let mut channel = Channel::new("c", 1, 1).unwrap();
        channel.push(1).unwrap();
        channel.commit();
        assert_eq!(channel.push(2), Err(2));
        assert_eq!(channel.pop(), Some(1));
        assert_eq!(channel.push(2), Err(2), "the credit of this cycle's pop");
        channel.commit();
        channel.push(2).unwrap();
    }

    #[test]
    fn one_push_and_one_pop_a_cycle() {
        let mut channel = Channel::new("c", 4, 1).unwrap();
        channel.push(1).unwrap();
        assert_eq!(channel.push(2), Err(2));
        channel.commit();
        channel.push(2).unwrap();
        channel.commit();
        assert_eq!(channel.pop(), Some(1));
        assert_eq!(channel.pop(), None);
    }

    #[test]
    fn a_full_rate_needs_a_capacity_of_latency_and_one() {
        for latency in 1..6 {
            for capacity in 1..9 {
                let mut channel = Channel::new("c", capacity, latency).unwrap();
                for _ in 0..1000 {
                    channel.pop();
                    let _ = channel.push(0_u8);
                    channel.commit();
                }
                let full = channel.counters().pushes == 1000;
                assert_eq!(full, capacity > latency as usize, "latency {latency}, capacity {capacity}");
            }
        }
    }

    #[test]
    fn tokens_can_be_seen_while_they_are_held() {
        let mut channel = Channel::new("c", 2, 2).unwrap();
        assert_eq!(channel.newest(), None);
        channel.push(5).unwrap();
        channel.commit();
        channel.push(6).unwrap();
        channel.commit();
        assert_eq!(channel.newest(), Some(&6));
        assert_eq!(channel.held().collect::<Vec<_>>(), [(&5, 0), (&6, 1)]);
        channel.pop();
        channel.commit();
        assert_eq!(channel.pop(), Some(6));
        assert_eq!(channel.newest(), None);
    }

    #[test]
    fn a_token_whose_words_wait_is_late_and_the_wait_has_its_name() {
        let waits = Activity::Waiting(Reason::Link);
        let mut channel = Channel::new("c", 4, 2).unwrap();
        channel.push(1).unwrap();
        assert_eq!(channel.pushed(), Some(&1));
        channel.delay(3);
        channel.commit();
        assert_eq!((channel.pushed(), channel.lack()), (None, Activity::Starved), "its latency is no wait");
        channel.push(2).unwrap();
        channel.commit();
        for _ in 2..5 {
            assert_eq!((channel.front(), channel.lack()), (None, waits));
            let bytes = Archive::save(&mut channel).unwrap();
            channel = Channel::new("c", 4, 2).unwrap();
            Archive::restore(&bytes, &mut channel).unwrap();
            channel.commit();
        }
        assert_eq!((channel.pop(), channel.lack()), (Some(1), Activity::Starved));
        channel.commit();
        assert_eq!(channel.pop(), Some(2), "it waited behind the first and not longer");
        channel.commit();
        assert_eq!(channel.lack(), Activity::Starved, "nothing is there");
    }

    #[test]
    fn a_shut_channel_takes_nothing_and_the_wait_has_its_name() {
        let mut channel = Channel::new("c", 1, 1).unwrap();
        channel.shut(true);
        channel.commit();
        assert!(!channel.can_push() && channel.push_slot().is_none());
        assert_eq!(channel.refusal(), Activity::Waiting(Reason::Link));
        channel.shut(false);
        channel.commit();
        channel.push(1).unwrap();
        channel.shut(true);
        channel.commit();
        assert_eq!(channel.refusal(), Activity::Blocked, "the channel itself is full");
        assert_eq!(channel.pop(), Some(1), "what is there can leave");
    }

    #[test]
    fn places_without_a_token_are_furnished() {
        let mut channel = Channel::new("c", 3, 1).unwrap();
        channel.push(vec![1]).unwrap();
        channel.commit();
        channel.furnish(|| vec![0; 7]);
        assert_eq!(channel.front(), Some(&vec![1]), "a token that is held stays");
        for _ in 0..3 {
            assert_eq!(channel.push_slot().map(|slot| slot.len()), Some(7));
            channel.commit();
            channel.pop_slot();
            channel.commit();
        }
    }

    #[test]
    fn more_tokens_than_fit_are_refused() {
        let mut wide = Channel::new("wide", 3, 1).unwrap();
        for token in 0..3 {
            wide.push(token).unwrap();
            wide.commit();
        }
        let bytes = Archive::save(&mut wide).unwrap();
        let mut narrow = Channel::<i32>::new("narrow", 2, 1).unwrap();
        let error = Archive::restore(&bytes, &mut narrow).unwrap_err();
        assert_eq!(error, ArchiveError::Tokens { name: "narrow", found: 3, capacity: 2 });
    }

    /// Counters that do not agree with the tokens would put them into wrong places.
    #[test]
    fn no_damaged_byte_gives_more_tokens_than_there_are() {
        let mut channel = Channel::new("c", 3, 1).unwrap();
        for token in 0..5 {
            channel.push(token).unwrap();
            channel.commit();
            if token < 3 {
                channel.pop();
            }
        }
        channel.commit();
        let bytes = Archive::save(&mut channel).unwrap();
        let mut refused = 0;
        for place in 0..bytes.len() {
            for bit in 0..8 {
                let mut damaged = bytes.clone();
                damaged[place] ^= 1 << bit;
                let mut other = Channel::<i32>::new("c", 3, 1).unwrap();
                match Archive::restore(&damaged, &mut other) {
                    Err(_) => refused += 1,
                    Ok(()) => assert_eq!(other.held().count(), channel.held().count(), "bit {bit} of byte {place}"),
                }
            }
        }
        assert!(refused > 0);
    }

    #[test]
    fn impossible_channels_are_refused() {
        assert!(matches!(Channel::<u8>::new("c", 0, 1), Err(ChannelError::Capacity { .. })));
        assert!(matches!(Channel::<u8>::new("c", 1, 0), Err(ChannelError::Latency { .. })));
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn a_channel_is_a_delayed_queue_that_counts(
            capacity in 1_usize..6, latency in 1_u64..5, wishes in proptest::collection::vec((any::<bool>(), any::<bool>(), any::<bool>()), 1..200),
        ) {
            let mut channel = Channel::new("c", capacity, latency).unwrap();
            let mut model: VecDeque<(u64, u32)> = VecDeque::new();
            let mut next = 0;
            for (now, (push, pop, push_first)) in wishes.into_iter().enumerate() {
                let now = now as u64;
                let held = model.len();
                let may_push = held < capacity;
                let expected = model.front().filter(|(ready, _)| pop && *ready <= now).map(|(_, token)| *token);
                let mut popped = None;
                if push_first && push {
                    prop_assert_eq!(channel.push(next).is_ok(), may_push);
                }
                if pop {
                    popped = channel.pop();
                }
                if !push_first && push {
                    prop_assert_eq!(channel.push(next).is_ok(), may_push);
                }
                prop_assert_eq!(popped, expected);
                if popped.is_some() {
                    model.pop_front();
                }
                if push && may_push {
                    model.push_back((now + latency, next));
                    next += 1;
                }
                channel.commit();
                let counters = channel.counters();
                prop_assert_eq!(counters.pushes, counters.pops + channel.occupancy() as u64);
                prop_assert_eq!(channel.occupancy(), model.len());
                // A new channel with the saved tokens goes on in the old one's place.
                let bytes = Archive::save(&mut channel).unwrap();
                channel = Channel::new("c", capacity, latency).unwrap();
                Archive::restore(&bytes, &mut channel).unwrap();
                prop_assert_eq!(channel.counters(), counters);
                let arrivals: Vec<(u32, u64)> = channel.held().map(|(token, cycles)| (*token, cycles)).collect();
                let expected: Vec<(u32, u64)> = model.iter().map(|(ready, token)| (*token, ready.saturating_sub(now + 1))).collect();
                prop_assert_eq!(arrivals, expected);
            }
        }
    }
}
