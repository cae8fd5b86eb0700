//! Modules that read mini-blocks into a reorder buffer.
//!
//! ```text
//!   rows of mini-blocks, in the order ──► module 0:  bursts, in order ──┐
//!   of their first use by the scan    ──► …                             ├──► reorder buffer ──► any `lanes` voxels a cycle ──► beam
//!                                     ──► module n−1                    ┘
//! ```
//! The pipeline behind goes by beams. A row of mini-blocks is asked for when the buffer has room for it, each module then reads those of its
//! mini-blocks one behind another, as far ahead of the first that is not there as the look-ahead lets it. A step of a beam goes on when the
//! mini-blocks of its voxels are there whole, and a row leaves the buffer with the last beam that uses it.

use super::places::{Mini, Round};
use super::reorder::{Arrival, ReorderCounters, ReorderError, Row, reorder_words};
use super::rows::{At, along, number, of_voxels, pair, words_of};
use super::ticks::Ticks;
use super::{MemoryCounters, Module, Served, Timing, WordPlace};
use crate::golden::{Placement, Skew};
use crate::scan::{CfbSpec, Scan};
use cube3_channel::{Activity, ClockDomain};
use cube3_frame::{FrameSetup, Geometry};
use cube3_machine::{Layout, LookAheadFreed, LookAheadUnit, MachineSpec};
use serde::{Deserialize, Serialize};
use std::borrow::Borrow;
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;

/// Modules that read mini-blocks: timing, addresses and the size of the reorder buffer.
#[derive(Clone, Debug)]
pub struct BlockModules {
    timing: Timing,
    clock: ClockDomain,
    lanes: usize,
    /// Words that the reorder buffer holds.
    words: u64,
    /// For x, y, z, what each mini-block along the axis adds.
    minis: [Vec<Mini>; 3],
    /// For x, y, z, how rows of mini-blocks along the axis and against it go round the modules.
    rounds: [[Round; 2]; 3],
    unit: LookAheadUnit,
    freed: LookAheadFreed,
}

/// Where the modules and the reorder buffer are.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BlockState {
    ticks: Ticks,
    /// The beam whose rows are asked for next, and in `spent` which of them.
    ahead: Scan,
    /// The tick before which each module cannot ask, and the least of them; the end of time where no row is left to ask for, or no room.
    wakes: Vec<i64>,
    wake: i64,
    /// Frames that had been released then, where some module has come to that.
    held: Option<u32>,
    readers: Vec<Reader>,
    /// Rows in the buffer, and places for others.
    rows: Vec<Row>,
    free: Vec<u32>,
    /// By mini-blocks along w, the rows there, the oldest first: one that comes for the second time may be on its way before it has left.
    by_pair: Vec<Vec<u32>>,
    /// Rows that some module has yet to ask for, in order, and the number of the first since the start.
    line: VecDeque<u32>,
    first: u64,
    /// Words of the rows in the buffer.
    words: u64,
    /// By frame.
    counters: Vec<MemoryCounters>,
    reorder: ReorderCounters,
}

/// A module and what it reads.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Reader {
    module: Module,
    /// The number of its row.
    row: u64,
    /// Its next mini-block there, once it has begun the row.
    mini: Option<u32>,
    /// Bursts of that mini-block that it has asked for.
    bursts: u32,
    /// Bursts that are not there yet.
    open: VecDeque<Open>,
}

/// A burst that has been asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Open {
    /// The tick in which its first word is there; the last is at `served.ready`.
    first: i64,
    served: Served,
}

impl BlockModules {
    /// The modules of a machine with this layout for some frames of a volume.
    ///
    /// # Errors
    /// A reorder buffer that cannot hold what a beam of some frame needs.
    pub fn new(
        machine: &MachineSpec,
        frames: &[impl Borrow<FrameSetup>],
        dims: [usize; 3],
    ) -> Result<BlockModules, ReorderError> {
        let (words, timing) = (reorder_words(machine, frames)?, Timing::of(machine));
        let (lanes, banks) = (machine.lanes, timing.banks());
        let skew = Skew { coefficients: machine.cfb.skew, lanes };
        let placement = Placement { skew, layout: Layout::MiniBlocks, dims };
        let minis = [0, 1, 2].map(|axis| Mini::all(&placement, axis, banks));
        let rounds = skew.coefficients.map(|a| [a, -a].map(|stride| Round::new(stride, lanes)));
        let clock = ClockDomain::from_hertz(machine.memory_clock_hz(), machine.clock_hz);
        let (unit, freed) = (machine.cfb.look_ahead_unit, machine.cfb.look_ahead_freed);
        Ok(BlockModules { timing, clock, lanes, words, minis, rounds, unit, freed })
    }

    /// The modules at the start of the first of some frames.
    pub fn start(&self, frames: usize) -> BlockState {
        let reader = || Reader {
            module: Module::new(&self.timing),
            row: 0,
            mini: None,
            bursts: 0,
            open: VecDeque::with_capacity(self.timing.look_ahead),
        };
        let pairs = self.minis.iter().map(Vec::len).max().unwrap_or(0);
        BlockState {
            ticks: Ticks::new(self.clock),
            ahead: Scan::default(),
            wakes: vec![i64::MIN; self.lanes],
            wake: i64::MIN,
            held: None,
            readers: (0..self.lanes).map(|_| reader()).collect(),
            rows: Vec::new(),
            free: Vec::new(),
            by_pair: vec![Vec::new(); pairs],
            line: VecDeque::new(),
            first: 0,
            words: 0,
            counters: vec![MemoryCounters::default(); frames],
            reorder: ReorderCounters { words: self.words, ..ReorderCounters::default() },
        }
    }

    /// Words of a burst that belong to one mini-block.
    fn burst_words(&self) -> usize {
        self.timing.burst.min(Placement::MINI_WORDS)
    }

    /// Has each module ask for bursts as far ahead as it may, in frames before `released`.
    #[inline]
    pub(crate) fn ask(&self, state: &mut BlockState, frames: &[Arc<FrameSetup>], specs: &[CfbSpec], released: u32) {
        let released = released.min(frames.len() as u32);
        if state.held.is_some_and(|held| held != released) {
            state.wake_all();
        }
        if state.ticks.now < state.wake {
            return;
        }
        state.wake = i64::MAX;
        for module in 0..self.lanes {
            if state.wakes[module] <= state.ticks.now {
                state.wakes[module] = self.ask_of(state, module, frames, specs, released);
            }
            state.wake = state.wake.min(state.wakes[module]);
        }
    }

    /// Has a module ask for bursts as far ahead as it may. The tick before which it cannot ask for more.
    fn ask_of(
        &self,
        state: &mut BlockState,
        module: usize,
        frames: &[Arc<FrameSetup>],
        specs: &[CfbSpec],
        released: u32,
    ) -> i64 {
        loop {
            let open = &mut state.readers[module].open;
            while open.front().is_some_and(|burst| burst.served.ready < state.ticks.now) {
                open.pop_front();
            }
            if let Some(tick) = self.held_until(open, state.ticks.now) {
                return tick;
            }
            let Some((place, mini)) = self.next_mini(state, module, frames, specs, released) else {
                state.held = Some(released);
                return i64::MAX;
            };
            let frame = state.rows[place].frame as usize;
            self.read(state, module, place, mini, &frames[frame].geometry);
        }
    }

    /// A tick before which a module that has asked for these bursts cannot ask for another one, if there is any behind `now`.
    #[inline]
    fn held_until(&self, open: &VecDeque<Open>, now: i64) -> Option<i64> {
        let (burst, rate) = (self.burst_words() as i64, self.timing.words_per_tick as i64);
        let missing = |open: &Open| match (self.freed, self.unit) {
            (LookAheadFreed::Column, _) if open.served.issued < now => 0,
            (_, LookAheadUnit::Bursts) => 1,
            (LookAheadFreed::Word, LookAheadUnit::Words) if open.first < now => {
                burst.min((open.served.ready - now + 1) * rate)
            }
            (_, LookAheadUnit::Words) => burst,
        };
        if (self.unit, self.freed) == (LookAheadUnit::Bursts, LookAheadFreed::Word) {
            let front = open.front().filter(|_| open.len() >= self.timing.look_ahead)?;
            return Some(front.served.ready + 1);
        }
        (open.iter().map(missing).sum::<i64>() >= self.timing.look_ahead as i64).then_some(now + 1)
    }

    /// The row and mini-block that a module reads from next, if there is any.
    #[inline]
    fn next_mini(
        &self,
        state: &mut BlockState,
        module: usize,
        frames: &[Arc<FrameSetup>],
        specs: &[CfbSpec],
        released: u32,
    ) -> Option<(usize, usize)> {
        loop {
            let number = (state.readers[module].row - state.first) as usize;
            if number == state.line.len() && !self.admit(state, frames, specs, released) {
                return None;
            }
            let place = state.line[number] as usize;
            let row = &mut state.rows[place];
            let reader = &mut state.readers[module];
            let geometry = &frames[row.frame as usize].geometry;
            let mini = match reader.mini {
                Some(mini) => Some(mini as usize),
                None => {
                    let first = self.round(geometry).first(self.lanes, self.start_module(geometry, row), module);
                    first.map(|first| first + row.minis[0] as usize)
                }
            };
            if let Some(mini) = mini.filter(|&mini| mini < row.minis[1] as usize) {
                reader.mini = Some(mini as u32);
                return Some((place, mini));
            }
            (reader.row, reader.mini) = (reader.row + 1, None);
            row.passed += 1;
            while let Some(&front) = state.line.front()
                && state.rows[front as usize].passed as usize == self.lanes
            {
                state.line.pop_front();
                state.first += 1;
                if state.rows[front as usize].left {
                    state.free.push(front);
                }
            }
        }
    }

    /// Puts the next row, or part of one, that some beam uses first into the line, where there is one and the buffer has room for it.
    fn admit(&self, state: &mut BlockState, frames: &[Arc<FrameSetup>], specs: &[CfbSpec], released: u32) -> bool {
        while state.ahead.frame < released {
            let frame = state.ahead.frame as usize;
            let (geometry, schedule) = (&frames[frame].geometry, &specs[frame].schedule);
            let at = At { geometry, schedule, place: state.ahead.place };
            // In order: the rows of mini-blocks, and of each up to two parts.
            let begun = state.ahead.spent as usize;
            for (i, j) in at.used().into_iter().enumerate().skip(begun / 2) {
                let Some(j) = j.filter(|&j| at.is_first(j)) else { continue };
                for (part, minis) in at.brought().into_iter().enumerate() {
                    if 2 * i + part < begun || minis.is_empty() {
                        continue;
                    }
                    state.ahead.spent = (2 * i + part) as u64;
                    let words = words_of(minis.len());
                    if state.words + words > self.words {
                        return false;
                    }
                    state.ahead.spent += 1;
                    state.words += words;
                    state.reorder.rows += 1;
                    state.reorder.mini_blocks += minis.len() as u64;
                    state.reorder.peak_words = state.reorder.peak_words.max(state.words);
                    self.place_row(state, frame as u32, &at, j, minis);
                    return true;
                }
            }
            state.ahead.advance(schedule);
        }
        false
    }

    /// Gives mini-blocks of a row a place in the buffer.
    fn place_row(&self, state: &mut BlockState, frame: u32, at: &At<'_>, j: usize, minis: Range<usize>) {
        let place = state.free.pop().unwrap_or_else(|| {
            state.rows.push(Row::default());
            state.rows.len() as u32 - 1
        });
        let k = pair(at.geometry, at.place.depth);
        let [_, v, w] = at.geometry.axes.axis;
        let missing = (Placement::MINI_WORDS / self.burst_words()) as u32;
        let row = &mut state.rows[place as usize];
        (row.frame, row.section, row.j) = (frame, at.place.section, j as u32);
        row.base = self.minis[v][j].plus(self.minis[w][k]);
        row.minis = [minis.start as u32, minis.end as u32];
        (row.passed, row.left, row.there) = (0, false, 0);
        row.arrivals.clear();
        row.arrivals.resize(minis.len(), Arrival { missing, served: Served::AT_ONCE });
        state.by_pair[k].push(place);
        state.line.push_back(place);
    }

    /// Has a module read the next burst of its mini-block.
    #[inline]
    fn read(&self, state: &mut BlockState, module: usize, place: usize, mini: usize, geometry: &Geometry) {
        let row = &mut state.rows[place];
        let axis = geometry.axes.axis[0];
        let at = row.base.plus(self.minis[axis][along(geometry, mini)]);
        let reader = &mut state.readers[module];
        let words = self.burst_words() as u64;
        let first = u64::from(reader.bursts) * words;
        let (bank, row_of_bank) = self.timing.rows.map_or((0, 0), |rows| {
            (at.block as usize & (rows.banks - 1), (at.word + first) >> rows.words.trailing_zeros())
        });
        let word = |i: u64| WordPlace { word: at.address + first + i, bank, row: row_of_bank };
        let counters = &mut state.counters[row.frame as usize];
        let mut served = reader.module.read(&self.timing, word(0), state.ticks.now, counters);
        let first_word = served.ready;
        if words > 1 {
            served = served.and(reader.module.read(&self.timing, word(words - 1), state.ticks.now, counters));
            counters.words += words - 2;
        }
        let arrival = &mut row.arrivals[mini - row.minis[0] as usize];
        arrival.missing -= 1;
        arrival.served = arrival.served.and(served);
        reader.open.push_back(Open { first: first_word, served });
        reader.bursts += 1;
        if arrival.missing == 0 {
            reader.bursts = 0;
            reader.mini = Some((mini + self.round(geometry).period) as u32);
        }
    }

    /// How rows along u go round the modules.
    fn round(&self, geometry: &Geometry) -> Round {
        self.rounds[geometry.axes.axis[0]][usize::from(geometry.axes.reversed[0])]
    }

    /// The module of a row's first mini-block that is read.
    fn start_module(&self, geometry: &Geometry, row: &Row) -> usize {
        let first = self.minis[geometry.axes.axis[0]][along(geometry, row.minis[0] as usize)];
        (first.module + row.base.module) as usize % self.lanes
    }

    /// What the frame buffer does in this cycle while mini-blocks of its step are not there; none where all are. The step is that of the
    /// beam at `at` and its row `v` of voxels, and of these voxels along u.
    #[inline(never)]
    pub(crate) fn waits(
        &self,
        state: &mut BlockState,
        frame: u32,
        at: &At<'_>,
        v: usize,
        voxels: &[Range<usize>; 2],
    ) -> Option<Activity> {
        let j = of_voxels(at.geometry, v) as u32;
        let mut waiting = None;
        for minis in at.brought().into_iter().filter(|minis| !minis.is_empty()) {
            for voxels in voxels.iter().filter(|voxels| !voxels.is_empty()) {
                let [first, last] = [voxels.start, voxels.end - 1].map(|u| number(at.geometry, u));
                // What is not among these has come with the section before.
                let needed = [first.max(minis.start), last.min(minis.end - 1)].map(|mini| mini as u32);
                if needed[0] <= needed[1]
                    && let Some(served) = self.waits_for(state, at, [frame, j, minis.start as u32], needed)
                {
                    waiting = Some(waiting.unwrap_or(Served::AT_ONCE).and(served));
                }
            }
        }
        waiting.map(|served| served.activity(state.ticks.next - 1))
    }

    /// What is waited for, of the mini-blocks of a row from number `first` to number `last`.
    #[inline]
    fn waits_for(
        &self,
        state: &mut BlockState,
        at: &At<'_>,
        [frame, j, start]: [u32; 3],
        [first, last]: [u32; 2],
    ) -> Option<Served> {
        let here = &state.by_pair[pair(at.geometry, at.place.depth)];
        let key = [frame, at.place.section, j, start];
        let Some(&place) = here.iter().find(|&&place| state.rows[place as usize].key() == key) else {
            let slowest = state.readers.iter().filter_map(|reader| reader.open.front());
            return Some(slowest.fold(Served::AT_ONCE, |all, burst| all.and(burst.served)));
        };
        let row = &mut state.rows[place as usize];
        let [first, last] = [first, last].map(|mini| mini - start);
        if row.there > last {
            return None;
        }
        let next = state.ticks.next;
        let missing = |row: &Row, mini: u32| {
            let arrival = row.arrivals[mini as usize];
            arrival.missing > 0 || arrival.served.ready >= next
        };
        while row.there <= last && !missing(row, row.there) {
            row.there += 1;
        }
        if row.there > last {
            if row.there as usize == row.arrivals.len() {
                row.arrivals.clear();
            }
            return None;
        }
        let (row, round) = (&state.rows[place as usize], self.round(at.geometry));
        let start = self.start_module(at.geometry, row);
        let needed = first.max(row.there)..=last;
        if !needed.clone().any(|mini| missing(row, mini)) {
            return None;
        }
        let mut served = Served::AT_ONCE;
        for mini in needed {
            let arrival = row.arrivals[mini as usize];
            served = served.and(arrival.served);
            if arrival.missing > 0 {
                let module = (start + mini as usize * round.stride) % self.lanes;
                // It comes behind what its module has been asked for.
                served = state.readers[module].open.front().map_or(served, |burst| served.and(burst.served));
            }
        }
        Some(served)
    }

    /// A beam is over: the rows that no beam of this plane or the next uses leave the buffer.
    pub(crate) fn leave(&self, state: &mut BlockState, frame: u32, at: &At<'_>) {
        for j in at.used().into_iter().flatten().filter(|&j| at.is_last(j)) {
            for minis in at.brought().into_iter().filter(|minis| !minis.is_empty()) {
                let BlockState { rows, by_pair, free, words, .. } = state;
                let here = &mut by_pair[pair(at.geometry, at.place.depth)];
                let key = [frame, at.place.section, j as u32, minis.start as u32];
                let Some(oldest) = here.iter().position(|&place| rows[place as usize].key() == key) else { continue };
                let place = here.remove(oldest);
                rows[place as usize].left = true;
                if rows[place as usize].passed as usize == self.lanes {
                    free.push(place);
                }
                *words -= words_of(minis.len());
            }
            state.wake_all();
        }
    }
}

impl BlockState {
    /// Modules for which no row was left, or no room, look again.
    fn wake_all(&mut self) {
        if self.held.take().is_some() {
            self.wakes.iter_mut().filter(|wake| **wake == i64::MAX).for_each(|wake| *wake = i64::MIN);
            self.wake = i64::MIN;
        }
    }

    /// Ends the pipeline cycle.
    #[inline]
    pub(crate) fn end_cycle(&mut self) {
        self.ticks.end_cycle();
    }

    /// What the modules have done, by frame, summed over the modules. Words are counted when they are asked for.
    pub fn counters(&self) -> &[MemoryCounters] {
        &self.counters
    }

    /// What the reorder buffer has done.
    pub fn reorder(&self) -> ReorderCounters {
        self.reorder
    }
}
