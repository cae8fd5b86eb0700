//! The links between boards: queues of words, one for each link and direction.
//!
//! ```text
//!   bus, dsb.read, trilin, abc ──words of a token──► queue ──so many a cycle──► the next board
//! ```
//! A link carries the oldest words first: those of a token in the order in which tokens were put, and within a cycle those of the
//! later unit of the pipeline first. Words are seen by the link in the cycle after that in which they are put.
//!
//! Nothing overtakes, so when a token's last word is over is known when it is put. A link is therefore not a list of words but the
//! place in the stream of its ticks at which it will be empty: with `now` ticks given so far, a token of W words moves it from E to
//! `max(E, now) + W`, and its words are over when so many ticks have been given. One clock serves all links; it starts afresh when
//! no word waits anywhere.

use crate::BoardSpec;
use cube3_channel::{Archive, ArchiveError, Archived, ClockDomain};
use cube3_machine::MachineSpec;
use serde::{Deserialize, Serialize};

/// The links of a machine of several boards.
#[derive(Clone, Debug)]
pub struct Links {
    /// Words a cycle over a link in a direction, where they are limited; at its start.
    rate: Option<ClockDomain>,
    /// With so many words that the cycle does not carry a link has no room for a token.
    capacity: u64,
    state: State,
    /// Words put on each link, forwards and backwards.
    put: Vec<[u64; 2]>,
    queues: Vec<[Queue; 2]>,
}

/// The clock of the links.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    clock: ClockDomain,
    /// Ticks given while words waited.
    now: u64,
    /// The latest end of all queues.
    latest: u64,
}

/// A link in a direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Queue {
    /// Ticks after which it is empty.
    end: u64,
    peak: u64,
}

/// What a link has done in a direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkReading {
    /// The link: b is between boards b − 1 and b.
    pub link: usize,
    /// From board b to b − 1.
    pub backwards: bool,
    /// Words put.
    pub words: u64,
    /// Words that still wait.
    pub waiting: u64,
    /// Most words that were there at the end of a cycle.
    pub peak: u64,
}

impl LinkReading {
    /// Words carried.
    pub fn carried(&self) -> u64 {
        self.words - self.waiting
    }

    /// The direction in words.
    pub fn direction(&self) -> &'static str {
        if self.backwards { "backwards" } else { "forwards" }
    }
}

impl Links {
    /// Empty links; none on a machine of one board.
    pub fn new(machine: &MachineSpec) -> Option<Links> {
        let boards = BoardSpec::new(machine).boards;
        let rate = machine.boards.link_words_per_cycle.map(ClockDomain::from_rate);
        (boards > 1).then(|| Links {
            rate,
            capacity: machine.boards.link_capacity_words as u64,
            state: State { clock: rate.unwrap_or(ClockDomain::from_ratio(1, 1)), now: 0, latest: 0 },
            put: vec![[0; 2]; boards],
            queues: vec![Default::default(); boards],
        })
    }

    /// Whether links carry so many words a cycle, and not any number.
    #[inline]
    pub fn limited(&self) -> bool {
        self.rate.is_some()
    }

    /// Whether each link that a token's words cross (link b forwards and backwards at place b) has room for it: fewer words are there than this
    /// cycle carries and its capacity. What the token has beyond that stays in the registers of the unit that sends it.
    #[inline]
    pub fn has_room(&self, words: &[[u64; 2]]) -> bool {
        let full = self.state.now.saturating_add(self.state.clock.peek()).saturating_add(self.capacity);
        if self.rate.is_none() || self.state.latest < full {
            return true;
        }
        let mut crossed = self.queues.iter().flatten().zip(words.iter().flatten()).filter(|(_, words)| **words > 0);
        crossed.all(|(queue, _)| queue.end < full)
    }

    /// Puts the words of a token that was pushed in this cycle, behind [`Links::carry`] of the cycle. By how many cycles the last of them is
    /// later than the next cycle.
    #[inline]
    pub fn put(&mut self, words: &[[u64; 2]]) -> u64 {
        for (put, words) in self.put.iter_mut().zip(words) {
            put[0] += words[0];
            put[1] += words[1];
        }
        if self.rate.is_none() {
            return 0;
        }
        let State { clock, now, latest } = &mut self.state;
        let mut last = *now;
        for (queue, &words) in self.queues.iter_mut().flatten().zip(words.iter().flatten()) {
            let end = queue.end.max(*now) + words;
            queue.end = end;
            queue.peak = queue.peak.max(end - *now);
            last = last.max(if words > 0 { end } else { 0 });
        }
        *latest = last.max(*latest);
        let ahead = last - *now;
        if ahead <= clock.peek() { 0 } else { clock.cycles_of(ahead) - 1 }
    }

    /// The words that links carry in this cycle: of those put before it.
    #[inline]
    pub fn carry(&mut self) {
        let Some(rate) = self.rate else {
            return;
        };
        let State { clock, now, latest } = &mut self.state;
        if now < latest {
            *now = now.saturating_add(clock.advance()).min(*latest);
        }
        if now >= latest {
            *clock = rate;
        }
    }

    /// Each link, forwards and backwards.
    pub fn readings(&self) -> Vec<LinkReading> {
        let reading = |link: usize, backwards: usize| {
            let Queue { end, peak } = self.queues[link][backwards];
            let waiting = end.saturating_sub(self.state.now);
            LinkReading { link, backwards: backwards == 1, words: self.put[link][backwards], waiting, peak }
        };
        (0..self.queues.len()).flat_map(|link| [reading(link, 0), reading(link, 1)]).collect()
    }
}

impl Archived for Links {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let Links { rate: _, capacity: _, state, put, queues } = self;
        archive.item(state)?;
        archive.list(put)?;
        archive.list(queues)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use cube3_machine::Boards;
    use proptest::prelude::*;
    use std::collections::VecDeque;

    fn links(boards: usize, rate: Option<f64>, capacity: usize) -> Links {
        let boards =
            Boards { count: boards, link_words_per_cycle: rate, link_capacity_words: capacity, ..Boards::default() };
        Links::new(&MachineSpec { boards, ..MachineSpec::default() }).unwrap()
    }

    #[test]
    fn one_board_has_no_links() {
        assert!(Links::new(&MachineSpec::default()).is_none());
    }

    #[test]
    fn words_move_in_the_cycle_after_and_a_token_waits_for_its_last() {
        let mut links = links(2, Some(2.0), 5);
        assert_eq!(links.put(&[[2, 0], [0, 0]]), 0, "over in the next cycle");
        assert_eq!(links.put(&[[1, 0], [0, 3]]), 1, "behind the first, or two cycles of its own");
        assert_eq!(links.put(&[[0, 0], [1, 0]]), 0, "a link of its own");
        assert_eq!(links.put(&[[0, 0], [0, 0]]), 0, "nothing to carry");
        assert!(links.has_room(&[[1, 0], [0, 1]]));
        links.carry();
        let waiting: Vec<u64> = links.readings().iter().map(LinkReading::carried).collect();
        assert_eq!(waiting, [2, 0, 1, 2]);
        assert_eq!(links.put(&[[4, 0], [0, 0]]), 2, "a word waits already: five in three cycles");
        assert!(links.has_room(&[[1, 0], [0, 0]]), "three of the five will be left");
        assert_eq!(links.put(&[[2, 0], [0, 0]]), 3);
        assert!(!links.has_room(&[[1, 0], [0, 0]]), "five will be left, and fill it");
        assert!(links.has_room(&[[0, 1], [1, 1]]), "other links are not full");
        links.carry();
        assert!(links.has_room(&[[1, 0], [0, 0]]), "five are left, and two of them go in this cycle");
    }

    #[test]
    fn links_of_any_width_count_and_nothing_waits() {
        let mut links = links(3, None, 1);
        for _ in 0..4 {
            assert!(links.has_room(&[[9, 9]; 3]));
            assert_eq!(links.put(&[[7, 0], [0, 1 << 40], [3, 3]]), 0);
            links.carry();
        }
        let readings = links.readings();
        assert_eq!(readings[0], LinkReading { link: 0, backwards: false, words: 28, waiting: 0, peak: 0 });
        assert_eq!(readings[3], LinkReading { link: 1, backwards: true, words: 4 << 40, waiting: 0, peak: 0 });
    }

    /// The clock of links: it is compared with the model's by when words are over.
    fn clock_of(links: &Links) -> ClockDomain {
        links.state.clock
    }

    /// A word of a token in a queue.
    type Word = usize;

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(256) })]

        /// Each link a list of words that leave one by one, oldest first.
        #[test]
        fn links_are_lists_of_words(
            ticks in 1_u64..9, every in 1_u64..9, capacity in 1_usize..30, boards in 2_usize..5,
            tokens in proptest::collection::vec((0_u64..5, proptest::collection::vec(0_u64..9, 8)), 1..60),
        ) {
            let rate = ticks as f64 / every as f64;
            let mut links = links(boards, Some(rate), capacity);
            let fresh = ClockDomain::from_rate(rate);
            let mut clock = fresh;
            let mut queues: Vec<VecDeque<Word>> = vec![VecDeque::new(); 2 * boards];
            let (mut put, mut peak) = (vec![0; 2 * boards], vec![0; 2 * boards]);
            // For each token the cycle in which its words are over, as told and as seen.
            let (mut told, mut seen) = (Vec::new(), Vec::new());
            let mut cycle = 0_u64;
            let mut step = |links: &mut Links, queues: &mut Vec<VecDeque<Word>>, seen: &mut Vec<u64>, cycle: u64| {
                links.carry();
                if queues.iter().all(VecDeque::is_empty) {
                    clock = fresh;
                    return;
                }
                let ticks = clock.advance();
                for queue in queues {
                    for _ in 0..ticks {
                        if let Some(token) = queue.pop_front() {
                            seen[token] = cycle;
                        }
                    }
                }
            };
            for (pause, words) in &tokens {
                for _ in 0..*pause {
                    cycle += 1;
                    step(&mut links, &mut queues, &mut seen, cycle);
                }
                if queues.iter().all(VecDeque::is_empty) {
                    // The clock of the model starts afresh with the first word, too.
                    step(&mut links, &mut queues, &mut seen, cycle);
                }
                let token = told.len();
                let words: Vec<[u64; 2]> = words.chunks(2).take(boards).map(|pair| [pair[0], pair[1]]).collect();
                let left = capacity + clock_of(&links).peek() as usize;
                let room = words.iter().flatten().zip(&queues).all(|(words, queue)| *words == 0 || queue.len() < left);
                prop_assert_eq!(links.has_room(&words), room);
                for (i, &count) in words.iter().flatten().enumerate() {
                    queues[i].extend((0..count).map(|_| token));
                    put[i] += count;
                    peak[i] = peak[i].max(if count > 0 { queues[i].len() as u64 } else { 0 });
                }
                // Without a word the token is there in the next cycle.
                seen.push(cycle + 1);
                told.push(cycle + 1 + links.put(&words));
                let readings = links.readings();
                for (i, reading) in readings.iter().enumerate() {
                    prop_assert_eq!((reading.link, usize::from(reading.backwards)), (i / 2, i % 2));
                    let expected = (put[i], queues[i].len() as u64, peak[i]);
                    prop_assert_eq!((reading.words, reading.waiting, reading.peak), expected);
                    prop_assert_eq!(reading.words, reading.carried() + reading.waiting);
                }
                // Saved and resumed between any two tokens.
                let bytes = Archive::save(&mut links).unwrap();
                let mut resumed = Links { queues: vec![Default::default(); boards], ..links.clone() };
                Archive::restore(&bytes, &mut resumed).unwrap();
                prop_assert_eq!(resumed.readings(), readings);
                links = resumed;
            }
            while queues.iter().any(|queue| !queue.is_empty()) {
                cycle += 1;
                step(&mut links, &mut queues, &mut seen, cycle);
            }
            prop_assert_eq!(told, seen);
            prop_assert!(links.readings().iter().all(|reading| reading.waiting == 0));
        }
    }
}
