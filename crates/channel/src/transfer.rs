//! Tokens over something that carries so much a cycle and no more.

use crate::ClockDomain;
use serde::{Deserialize, Serialize};

/// The token in hand on its way over slices of a bus or bytes to a host: so many a cycle, in whole ones.
///
/// The rate starts with the first token after a rest. What the last cycle of a token has to spare serves the next token, if that
/// is there in the cycle after; so tokens that follow each other take the sum of their amounts over the rate, rounded up once.
///
/// ```
/// use cube3_channel::{ClockDomain, TokenTransfer};
/// let mut link = TokenTransfer::new(ClockDomain::from_rate(1.5));
/// let cycles = (0..4).map(|_| {
///     let mut cycles = 1;
///     while !link.completes(3) {
///         link.carry();
///         cycles += 1;
///     }
///     link.finish(3);
///     cycles
/// });
/// assert_eq!(cycles.collect::<Vec<_>>(), [2, 2, 2, 2]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TokenTransfer {
    rate: ClockDomain,
    clock: ClockDomain,
    carried: u64,
    spare: u64,
}

impl TokenTransfer {
    /// Nothing on its way. `rate` is at its start.
    pub fn new(rate: ClockDomain) -> TokenTransfer {
        TokenTransfer { rate, clock: rate, carried: 0, spare: 0 }
    }

    /// Whether the token in hand, of so many units, is over by the end of this cycle.
    #[inline]
    pub fn completes(&self, amount: u64) -> bool {
        self.carried + self.spare + self.clock.peek() >= amount
    }

    /// Ends a cycle in which the token stays.
    #[inline]
    pub fn carry(&mut self) {
        self.carried += self.spare + self.clock.advance();
        self.spare = 0;
    }

    /// Ends the cycle in which the token of so many units leaves.
    #[inline]
    pub fn finish(&mut self, amount: u64) {
        let last = self.clock.advance();
        self.spare = (self.carried + self.spare + last).saturating_sub(amount).min(last);
        self.carried = 0;
    }

    /// Ends a cycle without a token.
    #[inline]
    pub fn rest(&mut self) {
        *self = TokenTransfer::new(self.rate);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    /// Cycles that tokens take which follow each other.
    fn cycles(transfer: &mut TokenTransfer, amounts: &[u64]) -> Vec<u64> {
        let mut token = |&amount: &u64| {
            let mut cycles = 1;
            while !transfer.completes(amount) {
                transfer.carry();
                cycles += 1;
            }
            transfer.finish(amount);
            cycles
        };
        amounts.iter().map(&mut token).collect()
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn tokens_that_fill_their_cycles_take_their_sum_over_the_rate(
            ticks in 1_u64..50, every in 1_u64..50, extra in prop::collection::vec(0_u64..90, 1..40),
        ) {
            let rate = ClockDomain::from_ratio(ticks, every);
            // Not less than a cycle carries: else a token leaves room that no later one can fill.
            let amounts: Vec<u64> = extra.iter().map(|extra| ticks.div_ceil(every) + extra).collect();
            let mut transfer = TokenTransfer::new(rate);
            let taken: u64 = cycles(&mut transfer, &amounts).iter().sum();
            prop_assert_eq!(taken, (amounts.iter().sum::<u64>() * every).div_ceil(ticks));
            transfer.rest();
            prop_assert_eq!(transfer, TokenTransfer::new(rate));
        }
    }

    #[test]
    fn what_no_token_needs_is_lost_but_for_the_last_cycle() {
        let mut transfer = TokenTransfer::new(ClockDomain::from_ratio(4, 1));
        // Three, then four of each four are to spare; the first eight begin in the cycle before.
        assert_eq!(cycles(&mut transfer, &[1, 1, 1, 8, 8]), [1, 1, 1, 1, 2]);
        let mut transfer = TokenTransfer::new(ClockDomain::from_ratio(4, 1));
        assert_eq!(cycles(&mut transfer, &[1, 7, 5]), [1, 1, 2]);
    }
}
