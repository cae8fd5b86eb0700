//! A channel beside its definition.

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
