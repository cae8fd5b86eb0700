//! Ticks of the memory clock under the pipeline's.

use cube3_channel::ClockDomain;
use serde::{Deserialize, Serialize};

/// The ticks of a pipeline cycle: those from `now` on that are before `next`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Ticks {
    clock: ClockDomain,
    /// The first tick of this pipeline cycle.
    pub now: i64,
    /// The first tick of the next.
    pub next: i64,
}

impl Ticks {
    /// Those of the first pipeline cycle.
    pub fn new(mut clock: ClockDomain) -> Ticks {
        let next = clock.advance() as i64;
        Ticks { clock, now: 0, next }
    }

    /// Ends the pipeline cycle.
    #[inline]
    pub fn end_cycle(&mut self) {
        self.now = self.next;
        self.next += self.clock.advance() as i64;
    }
}
