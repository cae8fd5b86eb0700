//! A unit between two channels, and the smallest one.

use crate::{Account, Activity, Channel};

/// A unit with one input and one output.
pub trait Unit<I, O> {
    /// The unit's name in reports.
    fn name(&self) -> &'static str;

    /// One cycle.
    fn tick(&mut self, input: &mut Channel<I>, output: &mut Channel<O>);

    /// What it did with its cycles.
    fn account(&self) -> &Account;
}

/// A unit that turns each token into another, one a cycle.
#[derive(Clone, Debug)]
pub struct Pipe<F> {
    name: &'static str,
    function: F,
    account: Account,
}

impl<F> Pipe<F> {
    /// A unit that applies `function`.
    pub fn new(name: &'static str, function: F) -> Pipe<F> {
        Pipe { name, function, account: Account::default() }
    }
}

impl<I: Copy, O, F: FnMut(I) -> O> Unit<I, O> for Pipe<F> {
    fn name(&self) -> &'static str {
        self.name
    }

    #[inline]
    fn tick(&mut self, input: &mut Channel<I>, output: &mut Channel<O>) {
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

    fn account(&self) -> &Account {
        &self.account
    }
}
