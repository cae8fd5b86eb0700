//! A module whose controller chooses among the words that it has been asked for: first ready, first come (Rixner et al. 2000).
//!
//! ```text
//!   words asked for ──► queue: the oldest `window` without a read ──► one command a tick on each bus ──► words, in order
//! ```
//! In each tick a bus takes, of what the constraints allow in it: the oldest read of an open row, else the oldest activate or precharge that
//! a word needs. The oldest word of a bank decides which row is opened there, so that no row is closed while an older word needs it. A read
//! serves every word of the window in its burst. Words leave in order, so that a word is passed over by those at most that can be asked for
//! before it leaves. When a refresh has fallen due, nothing else is issued before it. Commands are decided tick by tick, none is booked ahead.

use super::module::{CLOSED, Column, NEVER};
use super::{MemoryCounters, Module, Served, Timing, WordPlace};
use cube3_machine::Command;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// A module and the words that it has been asked for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Chooser {
    pub(super) module: Module,
    window: usize,
    /// Words that have no read yet, in the order in which they were asked for.
    queue: VecDeque<Word>,
    /// Commands are decided up to here.
    now: i64,
}

/// A word that waits for its read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Word {
    word: u64,
    bank: usize,
    row: u64,
    asked: i64,
    /// The step that it is for, and its frame.
    step: u64,
    frame: u32,
    /// What was found in its bank, once a command has been issued for it.
    found: Option<Found>,
    refresh_until: i64,
}

/// What a word finds in its bank.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Found {
    Closed,
    OtherRow,
}

impl Word {
    fn place(&self) -> WordPlace {
        WordPlace { word: self.word, bank: self.bank, row: self.row }
    }
}

impl Chooser {
    /// A module with nothing to do, which chooses among `window` words.
    pub fn new(timing: &Timing, window: usize) -> Chooser {
        Chooser { module: Module::new(timing), window, queue: VecDeque::new(), now: 0 }
    }

    /// Asks for a word at a tick that has not been decided.
    pub fn ask(&mut self, WordPlace { word, bank, row }: WordPlace, asked: i64, step: u64, frame: u32) {
        let word = Word { word, bank, row, asked, step, frame, found: None, refresh_until: NEVER };
        self.queue.push_back(word);
    }

    /// Decides the commands of all ticks before `end`; `served` is told of each word that has its read, by step. All words that are asked for
    /// before `end` have been asked for.
    pub fn advance(
        &mut self,
        timing: &Timing,
        end: i64,
        counters: &mut [MemoryCounters],
        mut served: impl FnMut(u64, Served),
    ) {
        self.module.calendar.forget(timing, self.now.min(self.module.refresh_due));
        loop {
            self.take_word_at_output(timing, counters, &mut served);
            let Some(oldest) = self.queue.front().copied() else { break };
            let Some((tick, command, chosen)) = self.next(timing) else { break };
            let counted = &mut counters[oldest.frame as usize];
            if tick.min(self.module.refresh_due) >= end {
                break;
            }
            if tick >= self.module.refresh_due {
                self.module.refresh(timing, self.now.max(oldest.asked), counted);
                self.queue.iter_mut().for_each(|word| word.refresh_until = self.module.refreshed);
                continue;
            }
            self.now = tick;
            self.issue(timing, tick, command, chosen, counters, &mut served);
        }
        self.now = self.now.max(end);
    }

    /// The words of the window that need no read: their burst is at the output.
    fn take_word_at_output(
        &mut self,
        timing: &Timing,
        counters: &mut [MemoryCounters],
        served: &mut impl FnMut(u64, Served),
    ) {
        let mut i = 0;
        while i < self.queue.len().min(self.window) {
            let Word { asked, step, frame, refresh_until, .. } = self.queue[i];
            match self.module.word_at_output(timing, self.queue[i].place(), asked) {
                Some(there) => {
                    counters[frame as usize].words += 1;
                    self.queue.remove(i);
                    served(step, Served { refresh_until: there.refresh_until.max(refresh_until), ..there });
                }
                None => i += 1,
            }
        }
    }

    /// The next command, with its tick and the place of its word in the queue.
    fn next(&self, timing: &Timing) -> Option<(i64, Command, usize)> {
        let mut claimed = 0_u32;
        // The earliest tick; then reads before rows, then the oldest.
        let mut best: Option<((i64, bool, usize), Command)> = None;
        for (i, word) in self.queue.iter().take(self.window).enumerate() {
            let open = self.module.open_row(word.bank);
            let command = if timing.rows.is_none() || open == word.row {
                Command::Read
            } else if claimed >> word.bank & 1 == 1 {
                continue;
            } else if open == CLOSED {
                Command::Activate
            } else {
                Command::Precharge
            };
            claimed |= 1 << word.bank;
            let tick = self.module.free(timing, command, word.bank, word.asked.max(self.now));
            let rank = (tick, command != Command::Read, i);
            if best.is_none_or(|(earlier, _)| rank < earlier) {
                best = Some((rank, command));
            }
        }
        best.map(|((tick, _, i), command)| (tick, command, i))
    }

    fn issue(
        &mut self,
        timing: &Timing,
        tick: i64,
        command: Command,
        chosen: usize,
        counters: &mut [MemoryCounters],
        served: &mut impl FnMut(u64, Served),
    ) {
        let word = &mut self.queue[chosen];
        match command {
            Command::Read => {
                let Word { step, found, refresh_until, frame, .. } = *word;
                let column = Column { tick, opened: found.is_some(), refresh_until };
                self.module.issue(timing, command, word.bank, tick, self.now);
                let there = self.module.read_out(timing, word.place(), &column);
                let counted = &mut counters[frame as usize];
                counted.words += 1;
                counted.reads += 1;
                *match found {
                    None => &mut counted.row_hits,
                    Some(Found::Closed) => &mut counted.row_misses,
                    Some(Found::OtherRow) => &mut counted.row_conflicts,
                } += 1;
                self.queue.remove(chosen);
                served(step, there);
            }
            Command::Activate => {
                word.found = word.found.or(Some(Found::Closed));
                self.module.set_row(word.bank, word.row);
                self.module.issue(timing, command, word.bank, tick, self.now);
            }
            _ => {
                word.found = Some(Found::OtherRow);
                self.module.set_row(word.bank, CLOSED);
                self.module.issue(timing, command, word.bank, tick, self.now);
            }
        }
    }

    /// What holds the word of a step that has no read yet.
    pub fn waits(&self, step: u64) -> Option<Served> {
        let &Word { bank, row, refresh_until, .. } = self.queue.iter().find(|word| word.step == step)?;
        let row_until = if self.module.open_row(bank) == row { NEVER } else { i64::MAX };
        Some(Served { refresh_until, row_until, ..Served::AT_ONCE })
    }
}
