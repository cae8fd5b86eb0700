//! The smallest unit between two channels.

use crate::{Account, Activity, Channel};

/// A unit that turns each token into another, one a cycle.
#[derive(Clone, Debug)]
pub struct Pipe<F> {
    function: F,
    account: Account,
}

impl<F> Pipe<F> {
    /// A unit that applies `function`.
    pub fn new(function: F) -> Pipe<F> {
        Pipe { function, account: Account::default() }
    }

    /// What it did with its cycles.
    pub fn account(&self) -> &Account {
        &self.account
    }

    /// One cycle.
    #[inline]
    pub fn tick<I: Copy, O>(&mut self, input: &mut Channel<I>, output: &mut Channel<O>)
    where
        F: FnMut(I) -> O,
    {
        let activity = if input.front().is_none() {
            Activity::Starved
        } else if let Some(slot) = output.push_slot() {
            if let Some(token) = input.pop_slot() {
                *slot = (self.function)(*token);
            }
            Activity::Busy
        } else {
            Activity::Blocked
        };
        self.account.record(activity);
    }
}
