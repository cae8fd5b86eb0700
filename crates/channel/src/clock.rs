//! Clocks beside the pipeline's: how many of their ticks fall into each pipeline cycle.

use serde::{Deserialize, Serialize};

/// A clock, or any steady rate, beside the pipeline's: `ticks / cycles` ticks a pipeline cycle, in whole numbers.
///
/// Both clocks start together. Before cycle c there have been `⌊c · ticks / cycles⌋` ticks, so nothing drifts however long a run
/// is. Plain data: a saved clock goes on where it was.
///
/// ```
/// use cube3_channel::ClockDomain;
/// let mut memory = ClockDomain::from_hertz(100e6, 40e6);
/// let ticks: Vec<u64> = (0..6).map(|_| memory.advance()).collect();
/// assert_eq!(ticks, [2, 3, 2, 3, 2, 3]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClockDomain {
    ticks: u64,
    cycles: u64,
    phase: u64,
}

/// Greatest common divisor; `gcd(0, n) = n`.
pub fn gcd(mut a: u64, mut b: u64) -> u64 {
    while a != 0 {
        (a, b) = (b % a, a);
    }
    b
}

impl ClockDomain {
    /// Parts of a hertz that [`ClockDomain::from_hertz`] tells apart.
    const PARTS_OF_HERTZ: f64 = 1e3;
    /// Parts of a tick a cycle that [`ClockDomain::from_rate`] tells apart.
    const PARTS_OF_RATE: f64 = 1e9;

    /// A clock of `ticks` in `cycles` pipeline cycles. Either is at least 1 and below 2⁶³; what is not is brought there.
    pub fn from_ratio(ticks: u64, cycles: u64) -> ClockDomain {
        let (ticks, cycles) = (ticks.clamp(1, i64::MAX as u64), cycles.clamp(1, i64::MAX as u64));
        let common = gcd(ticks, cycles);
        ClockDomain { ticks: ticks / common, cycles: cycles / common, phase: 0 }
    }

    /// A clock of `hertz` beside a pipeline of `pipeline_hertz`, both to the nearest millihertz and up to 10¹⁵ hertz.
    pub fn from_hertz(hertz: f64, pipeline_hertz: f64) -> ClockDomain {
        let whole = |hertz: f64| (hertz * Self::PARTS_OF_HERTZ).round() as u64;
        ClockDomain::from_ratio(whole(hertz), whole(pipeline_hertz))
    }

    /// A rate of so many ticks (words, bytes, slices) a pipeline cycle, to the nearest billionth and up to 10⁹.
    pub fn from_rate(rate: f64) -> ClockDomain {
        ClockDomain::from_ratio((rate * Self::PARTS_OF_RATE).round() as u64, Self::PARTS_OF_RATE as u64)
    }

    /// Ends a pipeline cycle: the ticks that were in it.
    #[inline]
    pub fn advance(&mut self) -> u64 {
        let (mut ticks, rest) = (self.ticks / self.cycles, self.ticks % self.cycles);
        self.phase += rest;
        if self.phase >= self.cycles {
            self.phase -= self.cycles;
            ticks += 1;
        }
        ticks
    }

    /// The ticks that [`ClockDomain::advance`] will give for this cycle.
    #[inline]
    pub fn peek(&self) -> u64 {
        let mut next = *self;
        next.advance()
    }

    /// The least number of pipeline cycles, from this one on, that have so many ticks.
    #[inline]
    pub fn cycles_of(&self, ticks: u64) -> u64 {
        // There are ⌊(phase + n · ticks) / cycles⌋ ticks in n cycles.
        let needed = u128::from(ticks) * u128::from(self.cycles);
        let ahead = needed.saturating_sub(u128::from(self.phase));
        match u64::try_from(ahead) {
            Ok(ahead) => ahead.div_ceil(self.ticks),
            Err(_) => u64::try_from(ahead.div_ceil(u128::from(self.ticks))).unwrap_or(u64::MAX),
        }
    }

    /// Ticks before pipeline cycle `cycle`, both counted from the start: `⌊cycle · ticks / cycles⌋`.
    pub fn ticks_before(&self, cycle: u64) -> u128 {
        u128::from(cycle) * u128::from(self.ticks) / u128::from(self.cycles)
    }

    /// Ticks, and the pipeline cycles in which there are so many, without common factors.
    pub fn ratio(&self) -> (u64, u64) {
        (self.ticks, self.cycles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    #[test]
    fn the_pipelines_own_clock_ticks_once_a_cycle() {
        let mut clock = ClockDomain::from_hertz(8e6, 8e6);
        assert_eq!(clock.ratio(), (1, 1));
        assert!((0..1000).all(|_| clock.advance() == 1));
    }

    #[test]
    fn extreme_clocks_are_exact() {
        assert_eq!(ClockDomain::from_hertz(1e15, 1.0).ratio(), (1_000_000_000_000_000, 1));
        assert_eq!(ClockDomain::from_hertz(1.0, 1e15).ratio(), (1, 1_000_000_000_000_000));
        assert_eq!(ClockDomain::from_rate(0.1).ratio(), (1, 10));
        assert_eq!(ClockDomain::from_rate(1e9).ratio(), (1_000_000_000, 1));
        assert_eq!(ClockDomain::from_hertz(1e8 / 3.0, 1e8).ratio(), (33_333_333_333, 100_000_000_000));
    }

    #[test]
    fn a_saved_clock_goes_on_where_it_was() {
        let mut clock = ClockDomain::from_ratio(7, 5);
        clock.advance();
        let mut copy = clock;
        let ticks: Vec<u64> = (0..10).map(|_| clock.advance()).collect();
        assert_eq!(ticks, (0..10).map(|_| copy.advance()).collect::<Vec<_>>());
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn so_many_ticks_take_so_many_cycles(ticks in 1_u64..40, cycles in 1_u64..40, start in 0_u64..40, wanted in 0_u64..200) {
            let mut clock = ClockDomain::from_ratio(ticks, cycles);
            (0..start).for_each(|_| _ = clock.advance());
            let needed = clock.cycles_of(wanted);
            let given: u64 = (0..needed).map(|_| clock.advance()).sum();
            prop_assert!(given >= wanted);
            // The last cycle was needed.
            let mut clock = ClockDomain::from_ratio(ticks, cycles);
            (0..start).for_each(|_| _ = clock.advance());
            prop_assert!(needed == 0 || (1..needed).map(|_| clock.advance()).sum::<u64>() < wanted);
        }

        #[test]
        fn nothing_drifts(ticks in 1_u64..1 << 62, cycles in 1_u64..1 << 62, start in 0_u64..1_000_000_000_000, count in 1_u64..200) {
            let mut clock = ClockDomain::from_ratio(ticks, cycles);
            let (ticks, cycles) = clock.ratio();
            clock.phase = (u128::from(start) * u128::from(ticks) % u128::from(cycles)) as u64;
            for cycle in start..start + count {
                let expected = clock.ticks_before(cycle + 1) - clock.ticks_before(cycle);
                prop_assert_eq!(u128::from(clock.peek()), expected);
                prop_assert_eq!(u128::from(clock.advance()), expected);
            }
        }
    }
}
