//! The fast bus on several boards: the words of a beam queue at the links, it is taken when the last is over, and it waits for room on
//! them; and which reason its account has for a cycle in which slices lack as well.

use crate::common::setup;
use cube3_cases::cases;
use cube3_cfb::Beam;
use cube3_channel::{Account, Channel, Reason};
use cube3_dsb::Links;
use cube3_dsb::bus::{BusUnit, NoBus};
use cube3_frame::Schedule;
use cube3_machine::{Boards, Bus, MachineSpec};
use proptest::prelude::*;

/// So many full beams of plane 0 behind each other through the bus and over the links, into a channel with room for all: cycles in which they
/// could be taken, the bus, and the links.
fn over_the_links(machine: &MachineSpec, n: usize) -> (Vec<u64>, BusUnit<NoBus>, Links) {
    let setup = setup(machine, [n, n, 1]);
    let mut bus = BusUnit::new(machine, [Schedule::new(machine, &setup.geometry)], NoBus);
    let mut links = Links::new(machine).unwrap();
    let mut input = Channel::<Beam<()>>::new("beams", 2, 1).unwrap();
    let mut aligned = Channel::<Beam<()>>::new("aligned", n + 1, 1).unwrap();
    let (mut offered, mut taken) = (0, Vec::new());
    for cycle in 0.. {
        if offered < n as u32
            && let Some(beam) = input.push_slot()
        {
            (beam.plane, beam.depth, beam.row) = (0, 0, Some(offered));
            offered += 1;
        }
        bus.tick(std::slice::from_ref(&setup), &mut input, &mut aligned, Some(&links));
        if aligned.pop().is_some() {
            taken.push(cycle);
        }
        links.carry();
        if let Some(words) = bus.sent() {
            aligned.delay(links.put(words));
        }
        input.commit();
        aligned.commit();
        if taken.len() == n {
            break;
        }
        assert!(cycle < 10_000, "stuck");
    }
    (taken, bus, links)
}

#[test]
fn beams_are_taken_when_their_words_are_over_and_not_a_cycle_earlier() {
    // Row v of plane 0 at depth 0 is turned back by v lanes: v words go back over every link, from half of the circle on 16 − v words on.
    let n = 16_usize;
    let words = |v: usize| if v < n / 2 { [0, v as u64] } else { [(n - v) as u64, 0] };
    // Cycles of a word.
    for every in [1, 2, 5] {
        let boards = Boards { count: 4, link_words_per_cycle: Some(1.0 / every as f64), ..Boards::default() };
        let machine = MachineSpec { lanes: n, boards, ..MachineSpec::default() };
        let (taken, bus, links) = over_the_links(&machine, n);
        // Beam v is put in cycle v + 1, the first words in cycle 2. A direction begins with the first tick after its first words, and then
        // never rests.
        let begins = |first: usize| (first + 1 - 2) as u64 / every * every + 2;
        let mut expected = Vec::new();
        let (mut on, mut back) = (0, 0);
        for v in 0..n {
            on += words(v)[0];
            back += words(v)[1];
            let over = if v == 0 {
                2
            } else if v < n / 2 {
                2 + back * every
            } else {
                begins(n / 2) + on * every
            };
            expected.push(over.max(expected.last().map_or(0, |last| last + 1)));
        }
        assert_eq!(taken, expected, "a word in {every} cycles");
        assert_eq!((bus.account().busy, bus.account().waiting), (n as u64, Default::default()));
        let counters = bus.counters();
        assert_eq!((counters.link_words, counters.link_peak), (4 * (28 + 36), n as u64 / 2));
        for link in links.readings() {
            assert_eq!((link.words, link.waiting), (if link.backwards { 28 } else { 36 }, 0));
        }
    }
    // As wide as the beams that send the most, and wider, nothing waits.
    for rate in [Some(8.0), Some(100.0), None] {
        let boards = Boards { count: 4, link_words_per_cycle: rate, ..Boards::default() };
        let (taken, _, links) = over_the_links(&MachineSpec { lanes: n, boards, ..MachineSpec::default() }, n);
        assert_eq!(taken, (2..=17).collect::<Vec<u64>>());
        assert_eq!(links.readings().iter().map(|link| link.peak).max(), Some(if rate.is_some() { 8 } else { 0 }));
    }
}

#[test]
fn a_bus_waits_for_room_on_a_full_link() {
    let boards = Boards { count: 4, link_words_per_cycle: Some(1.0), link_capacity_words: 2, ..Boards::default() };
    let n = 16;
    let (taken, bus, links) = over_the_links(&MachineSpec { lanes: n, boards, ..MachineSpec::default() }, n);
    // A link of two words takes a token when two are there, of which one goes in the same cycle: it never rests, and beams are taken as
    // before.
    assert_eq!(taken[n / 2 - 1], 2 + 28);
    let account = bus.account();
    assert!(account.waiting[Reason::Link as usize] > 20, "{account:?}");
    assert_eq!(account.busy, n as u64);
    assert_eq!(
        links.readings().iter().map(|link| link.peak).max(),
        Some(8),
        "what a token has beyond the capacity stays with the bus"
    );
}

/// Words that the beam of row v sends over every link, forwards and backwards: it is turned back by v lanes, and the shorter way is taken.
fn turned(n: u64, v: u64) -> [u64; 2] {
    if v < n / 2 { [0, v] } else { [n - v, 0] }
}

/// A rate of `ticks` in `every` cycles: how many come in cycle `number` of those from its start, from 1 on.
fn ticks_in(number: u64, [ticks, every]: [u64; 2]) -> u64 {
    number * ticks / every - (number - 1) * ticks / every
}

/// The cycles of n beams that follow each other, by reason, counted beam by beam: a cycle for its lanes; as many for its slices as are
/// left of the cycles in which all slices so far come, whatever the links do, since the bus stands still while it waits for them; and for
/// links those between, in which one that it crosses has no room.
fn counted(n: u64, slices: u64, bus: [u64; 2], link: [u64; 2], capacity: u64) -> (u64, [u64; 2]) {
    let (mut cycles, mut waiting) = (0, [0; 2]);
    let (mut queues, mut clock) = ([0_u64; 2], 0);
    let carry = |queues: &mut [u64; 2], clock: &mut u64| {
        if *queues != [0; 2] {
            *clock += 1;
            *queues = queues.map(|words| words.saturating_sub(ticks_in(*clock, link)));
        }
        *clock = if *queues == [0; 2] { 0 } else { *clock };
    };
    for v in 0..n {
        let over = |beams: u64| (beams * slices * bus[1]).div_ceil(bus[0]);
        let own = over(v + 1) - over(v);
        for _ in 1..own {
            carry(&mut queues, &mut clock);
        }
        let words = turned(n, v);
        let room = |queues: &[u64; 2], clock: u64| {
            (0..2).all(|way| words[way] == 0 || queues[way] < ticks_in(clock + 1, link) + capacity)
        };
        let mut full = 0;
        while !room(&queues, clock) {
            carry(&mut queues, &mut clock);
            full += 1;
        }
        carry(&mut queues, &mut clock);
        queues = [0, 1].map(|way| queues[way] + words[way]);
        cycles += own + full;
        waiting = [waiting[0] + own - 1, waiting[1] + full];
    }
    (cycles, waiting)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(256) })]

    #[test]
    fn where_slices_and_links_lack_each_cycle_has_one_reason_and_slices_come_first(
        quarter in 1_usize..6, channels in 1_usize..20,
        bus in prop::sample::select(vec![[1, 1], [1, 2], [2, 3], [3, 4], [1, 5]]),
        link in prop::sample::select(vec![[1, 1], [1, 2], [1, 4], [3, 4], [3, 2], [4, 1]]), capacity in 1_usize..9,
    ) {
        let n = 4 * quarter;
        let channels = channels.min(n);
        let [rate, hertz] = [link, bus].map(|[ticks, every]: [u64; 2]| ticks as f64 / every as f64);
        let boards = Boards {
            count: 2, link_words_per_cycle: Some(rate), link_capacity_words: capacity, ..Boards::default()
        };
        let machine = MachineSpec {
            lanes: n,
            clock_hz: 60e6,
            bus: Bus { channels: Some(channels), clock_hz: Some(60e6 * hertz), ..Bus::default() },
            boards,
            ..MachineSpec::default()
        };
        let (_, unit, _) = over_the_links(&machine, n);
        let slices = n.div_ceil(channels) as u64;
        let (cycles, [for_slices, for_links]) = counted(n as u64, slices, bus, link, capacity as u64);
        let mut expected = Account { busy: n as u64, ..Account::default() };
        expected.waiting[Reason::BusSlice as usize] = for_slices;
        expected.waiting[Reason::Link as usize] = for_links;
        let got = Account { starved: 0, ..*unit.account() };
        prop_assert_eq!(got, expected);
        prop_assert_eq!(got.cycles(), cycles);
    }
}
