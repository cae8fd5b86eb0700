//! A command bus: one command in a tick.

use serde::{Deserialize, Serialize};

/// Ticks of which a bit says whether they are taken, in words of 64.
const WORDS: i64 = 2;

/// Which ticks of a command bus are taken, from some tick on.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Bus {
    /// The first tick that is known, in words.
    first: i64,
    /// Bits of the ticks of word w in place w mod [`WORDS`].
    bits: [u64; WORDS as usize],
    /// Ticks behind them.
    far: Vec<i64>,
}

impl Bus {
    /// Forgets ticks before `tick`: nothing is booked there any more.
    #[inline(always)]
    pub fn forget(&mut self, tick: i64) {
        if tick >> 6 > self.first {
            self.turn(tick >> 6);
        }
    }

    fn turn(&mut self, first: i64) {
        let end = first.min(self.first + WORDS);
        for word in self.first..end {
            self.bits[(word & (WORDS - 1)) as usize] = 0;
        }
        self.first = first;
        for tick in std::mem::take(&mut self.far) {
            self.take(tick);
        }
    }

    /// The first tick from `tick` on that is not taken.
    #[inline(always)]
    pub fn free(&self, tick: i64) -> i64 {
        let word = tick >> 6;
        if word < self.first {
            return tick;
        }
        if word < self.first + WORDS {
            let later = !self.bits[(word & (WORDS - 1)) as usize] >> (tick & 63);
            if later != 0 {
                return tick + i64::from(later.trailing_zeros());
            }
        }
        self.search(tick)
    }

    #[cold]
    fn search(&self, mut tick: i64) -> i64 {
        while self.taken(tick) {
            tick += 1;
        }
        tick
    }

    fn taken(&self, tick: i64) -> bool {
        let word = tick >> 6;
        if word < self.first + WORDS {
            word >= self.first && self.bits[(word & (WORDS - 1)) as usize] >> (tick & 63) & 1 == 1
        } else {
            self.far.contains(&tick)
        }
    }

    /// Takes a tick.
    #[inline(always)]
    pub fn take(&mut self, tick: i64) {
        let word = tick >> 6;
        if word >= self.first + WORDS {
            self.far.push(tick);
        } else if word >= self.first {
            self.bits[(word & (WORDS - 1)) as usize] |= 1 << (tick & 63);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #[test]
        fn the_first_free_tick_is_that_of_a_set(steps in proptest::collection::vec((0_i64..40, 0_u8..20, 0_i64..700), 1..200)) {
            let (mut bus, mut set, mut now) = (Bus::default(), BTreeSet::new(), 0);
            for (pause, leap, ahead) in steps {
                now += if leap == 0 { 50 * pause } else { pause / 8 };
                bus.forget(now);
                let wish = now + if leap < 4 { ahead } else { ahead % 20 };
                let expected = (wish..).find(|tick| !set.contains(tick)).unwrap();
                prop_assert_eq!(bus.free(wish), expected);
                bus.take(expected);
                set.insert(expected);
            }
        }
    }
}
