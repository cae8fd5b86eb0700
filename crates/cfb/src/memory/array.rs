//! All modules under the scan of the frame buffer.

use super::ticks::Ticks;
use super::{Chooser, MemoryCounters, Module, Served, Timing, WordPlace};
use crate::golden::{Placement, Skew};
use crate::scan::{CfbSpec, Piece, Scan};
use cube3_channel::{Activity, ClockDomain};
use cube3_frame::{FrameSetup, Geometry};
use cube3_machine::{ControllerKind, LookAheadFreed, LookAheadUnit, MachineSpec, MemoryModel, MemoryType};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;

/// The memory modules of a frame buffer: timing and addresses.
///
/// The frame buffer reads a beam in steps, in each at most one word of each module. The scan is known, so each module is asked for
/// the words of the next steps, `look_ahead` of them from the one that the pipeline waits for; a step is over when the slowest of its
/// modules has given its word.
#[derive(Clone, Debug)]
pub struct Modules {
    timing: Timing,
    clock: ClockDomain,
    placement: Placement,
    /// What each coordinate adds to an address, for x, y, z.
    terms: [Vec<u64>; 3],
    /// The banks of the first rows.
    banks: Vec<u8>,
    unit: LookAheadUnit,
    freed: LookAheadFreed,
    /// Steps that can have been asked for and not taken.
    most: usize,
    /// Words among which a module chooses; none where it keeps their order.
    window: Option<usize>,
}

/// Where the modules are.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MemoryState {
    ticks: Ticks,
    /// The step that is asked for next.
    ahead: Scan,
    /// When the steps that have been asked for are over.
    asked: VecDeque<Step>,
    /// Steps that have been taken.
    taken: u64,
    /// The modules; a single one stands for all as long as nothing has told them apart.
    modules: Vec<Module>,
    /// The modules where they choose among their words.
    choosers: Vec<Chooser>,
    /// By frame.
    counters: Vec<MemoryCounters>,
}

/// A step that has been asked for: what is known of its words, and how many have no read yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Step {
    served: Served,
    missing: u32,
}

impl Modules {
    /// Most rows whose banks are kept.
    const MOST_ROWS: u64 = 1 << 16;

    /// The modules of a machine for a volume; none where they give any word in any cycle.
    pub fn new(machine: &MachineSpec, dims: [usize; 3]) -> Option<Modules> {
        let clock = ClockDomain::from_hertz(machine.memory_clock_hz(), machine.clock_hz);
        if machine.cfb.memory == MemoryType::Ideal && clock.ratio() == (1, 1) {
            return None;
        }
        let skew = Skew { coefficients: machine.cfb.skew, lanes: machine.lanes };
        let placement = Placement { skew, layout: machine.cfb.layout, dims };
        let terms: [Vec<u64>; 3] =
            [0, 1, 2].map(|axis| (0..dims[axis]).map(|i| placement.term(axis, i) as u64).collect());
        let cfb = &machine.cfb;
        let timing = Timing::of(machine);
        let last = terms.iter().filter_map(|terms| terms.iter().max()).sum();
        let rows = timing.rows.map_or(0, |_| (timing.place(last).row + 1).min(Modules::MOST_ROWS));
        Some(Modules {
            banks: (0..rows).map(|row| timing.bank(row) as u8).collect(),
            timing,
            clock,
            placement,
            terms,
            unit: cfb.look_ahead_unit,
            freed: cfb.look_ahead_freed,
            most: MemoryModel::words_held(cfb),
            window: match cfb.controller {
                ControllerKind::InOrder => None,
                ControllerKind::FrFcfs => Some(cfb.window.unwrap_or(MemoryModel::of_machine(cfb).look_ahead)),
            },
        })
    }

    /// The modules at the start of the first of some frames.
    pub fn start(&self, frames: usize) -> MemoryState {
        MemoryState {
            ticks: Ticks::new(self.clock),
            ahead: Scan::default(),
            asked: VecDeque::with_capacity(self.most),
            taken: 0,
            modules: vec![Module::new(&self.timing)],
            choosers: self
                .window
                .map_or(Vec::new(), |window| vec![Chooser::new(&self.timing, window); self.placement.skew.lanes]),
            counters: vec![MemoryCounters::default(); frames],
        }
    }

    /// Asks for words ahead of the scan, in frames before `released`.
    #[inline]
    pub(crate) fn ask(&self, state: &mut MemoryState, frames: &[Arc<FrameSetup>], specs: &[CfbSpec], released: u32) {
        let last = released.min(specs.len() as u32);
        while self.room(state) && state.ahead.frame < last {
            let Scan { frame, place, spent } = state.ahead;
            let geometry = &frames[frame as usize].geometry;
            let spec = &specs[frame as usize];
            let piece = Piece::at(place, geometry, &spec.schedule);
            let cycles = spec.piece_cycles(piece.as_ref());
            let row = piece.as_ref().map(|piece| piece.row as usize);
            // Of a beam with two rows the second comes behind the first, if there is a first.
            let half = cycles / spec.schedule.rows_of_beam();
            let (fetched, step) = if spent < half || !geometry.doubled() {
                (row, spent)
            } else {
                (row.and(geometry.row_below(place.plane as usize, place.depth as usize)), spent - half)
            };
            let asked = match piece.zip(fetched) {
                Some((piece, row)) => {
                    let voxels = spec.voxels_of_step(&piece, step as usize);
                    self.serve(state, geometry, [row, place.depth as usize], &voxels)
                }
                None => Step { served: Served::AT_ONCE, missing: 0 },
            };
            state.asked.push_back(asked);
            if spent + 1 < cycles {
                state.ahead.spent += 1;
            } else {
                state.ahead.advance(&spec.schedule);
            }
        }
        self.choose(state);
    }

    /// Whether one step more can be asked for.
    #[inline]
    fn room(&self, state: &MemoryState) -> bool {
        if (self.unit, self.freed) == (LookAheadUnit::Words, LookAheadFreed::Word) {
            return state.asked.len() < self.most;
        }
        let counts = |step: &&Step| match self.unit {
            LookAheadUnit::Words => true,
            LookAheadUnit::Bursts => step.missing > 0 || step.served.issued != Served::AT_ONCE.issued,
        };
        let holds = |step: &&Step| match self.freed {
            LookAheadFreed::Word => true,
            LookAheadFreed::Column => step.missing > 0 || step.served.issued >= state.ticks.now,
        };
        let counted = || state.asked.iter().filter(counts);
        state.asked.len() < self.most
            && counted().filter(holds).count() < self.timing.look_ahead
            && (self.freed == LookAheadFreed::Word || counted().count() < 2 * self.timing.look_ahead)
    }

    /// Lets modules that choose issue what they issue in this pipeline cycle.
    fn choose(&self, state: &mut MemoryState) {
        let MemoryState { ticks, choosers, asked, taken, counters, .. } = state;
        for chooser in choosers {
            chooser.advance(&self.timing, ticks.next, counters, |number, served| {
                let step = &mut asked[(number - *taken) as usize];
                step.served = step.served.and(served);
                step.missing -= 1;
            });
        }
    }

    /// Has the modules read their words of a step of the beam at row `v` and plane `w`: of voxels `u` in one range or two, which are in
    /// different modules.
    fn serve(&self, state: &mut MemoryState, geometry: &Geometry, [v, w]: [usize; 2], u: &[Range<usize>; 2]) -> Step {
        let Skew { lanes, coefficients } = self.placement.skew;
        let axis = geometry.axes.axis[0];
        let along = coefficients[axis].rem_euclid(lanes as i64) as usize;
        let first = self.row(geometry, [v, w], &u[0]);
        let second = if u[1].is_empty() { None } else { Some(self.row(geometry, [v, w], &u[1])) };
        let rows = || std::iter::once(first).chain(second);
        let base: u64 = (0..3).filter(|&a| a != axis).map(|a| self.terms[a][first.start[a] as usize]).sum();
        let MemoryState { ticks, modules, choosers, counters, ahead, asked, taken, .. } = state;
        let number = *taken + asked.len() as u64;
        if !choosers.is_empty() {
            for Row { start, terms } in rows() {
                let lowest = self.placement.skew.module(start);
                for (i, term) in terms.iter().enumerate() {
                    let module = (lowest + i * along) % lanes;
                    choosers[module].ask(self.timing.place(base + term), ticks.now, number, ahead.frame);
                }
            }
            return Step { served: Served::AT_ONCE, missing: (u[0].len() + u[1].len()) as u32 };
        }
        let mut counted = MemoryCounters::default();
        let no_address = self.timing.rows.is_none() && self.timing.burst == 1;
        let term = first.terms.first().copied().unwrap_or(0);
        // Terms rise with the coordinate.
        let level = |row: Row<'_>| row.terms.first() == Some(&term) && row.terms.last() == Some(&term);
        let alike = u[0].len() + u[1].len() == lanes && (no_address || rows().all(level));
        let served = if modules.len() == 1 && alike {
            let served = modules[0].read(&self.timing, self.timing.place(base + term), ticks.now, &mut counted);
            counted = counted.times(lanes as u64);
            served
        } else {
            if modules.len() < lanes {
                let one = modules[0].clone();
                modules.resize(lanes, one);
            }
            let mut all = Served::AT_ONCE;
            for Row { start, terms } in rows() {
                let mut module = self.placement.skew.module(start);
                for term in terms {
                    let place = self.place(base + term);
                    all = all.and(modules[module].read(&self.timing, place, ticks.now, &mut counted));
                    module += along;
                    if module >= lanes {
                        module -= lanes;
                    }
                }
            }
            all
        };
        counters[ahead.frame as usize] += counted;
        Step { served, missing: 0 }
    }

    /// Where a word is.
    #[inline(always)]
    fn place(&self, word: u64) -> WordPlace {
        let row = word >> self.timing.row_bits;
        match self.banks.get(row as usize) {
            Some(&bank) => WordPlace { word, bank: bank as usize, row },
            None => self.timing.place(word),
        }
    }

    /// Voxels `u` of the beam at row `v` and plane `w`.
    #[inline]
    fn row(&self, geometry: &Geometry, [v, w]: [usize; 2], u: &Range<usize>) -> Row<'_> {
        let axis = geometry.axes.axis[0];
        let mut start = geometry.axes.voxel(geometry.size, [u.start, v, w]);
        if geometry.axes.reversed[0] {
            // The coordinates fall; which voxel of a step is taken first changes nothing.
            start[axis] = start[axis] + 1 - u.len().max(1);
        }
        Row { start: start.map(|i| i as i64), terms: &self.terms[axis][start[axis]..start[axis] + u.len()] }
    }
}

/// Voxels of a beam that are read in a step: the one with the lowest coordinate, and what the coordinate of each adds to its address.
#[derive(Clone, Copy)]
struct Row<'a> {
    start: [i64; 3],
    terms: &'a [u64],
}

impl MemoryState {
    /// What the frame buffer does in this cycle while the words of its step are not there; none where they are.
    #[inline]
    pub(crate) fn waits(&self) -> Option<Activity> {
        let &Step { served, missing } = self.asked.front()?;
        if missing == 0 && served.ready < self.ticks.next {
            return None;
        }
        let held = self.choosers.iter().filter_map(|chooser| chooser.waits(self.taken));
        let served = if missing > 0 { held.fold(served, Served::and) } else { served };
        Some(served.activity(self.ticks.next - 1))
    }

    /// Takes the words of the step.
    #[inline]
    pub(crate) fn take(&mut self) {
        self.asked.pop_front();
        self.taken += 1;
    }

    /// Ends the pipeline cycle.
    #[inline]
    pub(crate) fn end_cycle(&mut self) {
        self.ticks.end_cycle();
    }

    /// What the modules have done, by frame, summed over the modules. Words ahead of the scan are counted when they are asked for.
    pub fn counters(&self) -> &[MemoryCounters] {
        &self.counters
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan;
    use bitvec::prelude::*;
    use cube3_cases::cases;
    use cube3_frame::{BeamPlace, Schedule};
    use cube3_host::{VolumeInfo, frame_setup, picture_setup};
    use cube3_machine::{Cfb, Layout, MemoryModel, RaySlots, Rays};
    use cube3_scene::{Perspective, Scene, View};
    use proptest::prelude::*;

    /// Has modules read a beam as the hardware would: `lanes` voxels at a time, in each cycle a word of each module that has one left.
    fn read_beam(
        modules: &Modules,
        each: &mut [Module],
        geometry: &Geometry,
        [v, w]: [usize; 2],
        now: i64,
        counters: &mut MemoryCounters,
    ) -> Vec<Served> {
        let mut steps = Vec::new();
        for first in (0..geometry.size[0]).step_by(each.len()) {
            let mut waiting: Vec<usize> = (first..(first + each.len()).min(geometry.size[0])).collect();
            while !waiting.is_empty() {
                let mut taken = bitvec![0; each.len()];
                let mut all = Served::AT_ONCE;
                waiting.retain(|&u| {
                    let xyz = geometry.axes.voxel(geometry.size, [u, v, w]);
                    let module = modules.placement.skew.module(xyz.map(|i| i as i64));
                    if taken.replace(module, true) {
                        return true;
                    }
                    let address = modules.placement.address(xyz) as u64;
                    all = all.and(each[module].read(&modules.timing, modules.timing.place(address), now, counters));
                    false
                });
                steps.push(all);
            }
        }
        steps
    }

    #[test]
    fn a_word_is_where_the_table_of_times_says_with_its_row_kept_or_not() {
        for (kind, kept) in [(MemoryType::Sdram, Modules::MOST_ROWS), (MemoryType::Vram, 0)] {
            let cfb = Cfb { memory: kind, ..Cfb::default() };
            let modules = Modules::new(&MachineSpec { lanes: 1, cfb, ..MachineSpec::default() }, [512; 3]).unwrap();
            assert_eq!(modules.banks.len() as u64, kept);
            for word in (0..1 << 27).step_by(509).chain([(1 << 27) - 1]) {
                assert_eq!(modules.place(word), modules.timing.place(word));
            }
        }
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn modules_that_nothing_tells_apart_are_one_and_the_others_read_their_voxels(
            lanes in 1_usize..7, dims in [1_usize..13, 1_usize..13, 1_usize..13], direction in [-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64],
            skew in prop_oneof![Just([1_i64; 3]), [-3_i64..4, -3_i64..4, -3_i64..4]], blocks: bool, pace in 0_i64..40,
            kind in proptest::sample::select(MemoryModel::TABLE.map(|model| model.kind).to_vec()),
        ) {
            prop_assume!(direction.iter().any(|x| x.abs() > 0.01));
            let layout = if blocks { Layout::Blocks } else { Layout::Rows };
            let cfb = Cfb { skew, memory: kind, memory_clock_hz: Some(20e6), layout, ..Cfb::default() };
            let machine = MachineSpec { lanes, cfb, rays: Rays { slots: RaySlots::Wrapped, ..Rays::default() }, ..MachineSpec::default() };
            let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
            let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
            let geometry = frame_setup(&scene, &machine, &volume, true).unwrap().setup.geometry;
            prop_assert_eq!(geometry.dims(), dims);
            let modules = Modules::new(&machine, dims).unwrap();
            let spec = CfbSpec::new(&machine, &geometry, Schedule::new(&machine, &geometry));
            let mut state = modules.start(1);
            let mut each = vec![Module::new(&modules.timing); lanes];
            let mut counters = MemoryCounters::default();
            for v in 0..geometry.size[1] {
                for w in 0..geometry.size[2] {
                    let expected = read_beam(&modules, &mut each, &geometry, [v, w], state.ticks.now, &mut counters);
                    for (step, expected) in expected.into_iter().enumerate() {
                        let piece = Piece { row: v as u32, columns: [0..geometry.size[0], 0..0] };
                        let voxels = spec.voxels_of_step(&piece, step);
                        prop_assert_eq!(modules.serve(&mut state, &geometry, [v, w], &voxels).served, expected);
                    }
                    prop_assert_eq!(state.counters[0], counters);
                    state.ticks.now += pace;
                }
            }
        }

        /// The voxels of a section's slots one behind another, over the end of the row to its start: in each step those that follow and are in
        /// different modules.
        #[test]
        fn pieces_of_beams_are_read_in_the_order_of_their_slots(
            lanes in 1_usize..7, dims in [1_usize..13, 1_usize..6, 1_usize..13], direction in [-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64],
            skew in prop_oneof![Just([1_i64; 3]), [-3_i64..4, -3_i64..4, -3_i64..4]], blocks: bool, padded: bool, section in 1_usize..14,
            kind in proptest::sample::select(MemoryModel::TABLE.map(|model| model.kind).to_vec()),
        ) {
            prop_assume!(direction.iter().any(|x| x.abs() > 0.01));
            let layout = if blocks { Layout::Blocks } else { Layout::Rows };
            let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
            let cfb = Cfb { skew, memory: kind, memory_clock_hz: Some(20e6), layout, ..Cfb::default() };
            let rays = Rays { slots, section: Some(section), ..Rays::default() };
            let machine = MachineSpec { lanes, cfb, rays, ..MachineSpec::default() };
            let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
            let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
            let frames = vec![Arc::new(frame_setup(&scene, &machine, &volume, true).unwrap().setup)];
            let geometry = &frames[0].geometry;
            let specs = vec![CfbSpec::new(&machine, geometry, Schedule::new(&machine, geometry))];
            let modules = Modules::new(&machine, dims).unwrap();
            let mut state = modules.start(1);
            let mut each = vec![Module::new(&modules.timing); lanes];
            let mut counters = MemoryCounters::default();
            let [_, planes] = geometry.slot_counts();
            let pieces: Vec<(BeamPlace, Piece)> = scan(geometry, &specs[0].schedule).collect();
            let (mut pieces, mut voxels) = (pieces.into_iter().peekable(), 0);
            for section in 0..specs[0].schedule.sections().count() as u32 {
                for (plane, depth) in (0..planes as u32).flat_map(|plane| (0..geometry.size[2] as u32).map(move |depth| (plane, depth))) {
                    let piece = pieces.next_if(|(at, _)| *at == BeamPlace { section, plane, depth }).map(|(_, piece)| piece);
                    let mut steps = Vec::new();
                    if let Some(piece) = &piece {
                        let mut taken = bitvec![1; lanes];
                        for u in piece.columns.iter().cloned().flatten() {
                            let xyz = geometry.axes.voxel(geometry.size, [u, piece.row as usize, depth as usize]);
                            let module = modules.placement.skew.module(xyz.map(|i| i as i64));
                            if taken[module] {
                                taken.fill(false);
                                steps.push(Served::AT_ONCE);
                            }
                            taken.set(module, true);
                            let place = modules.timing.place(modules.placement.address(xyz) as u64);
                            let served = each[module].read(&modules.timing, place, 0, &mut counters);
                            let step = steps.last_mut().unwrap();
                            *step = step.and(served);
                            voxels += 1;
                        }
                    }
                    prop_assert_eq!(specs[0].piece_cycles(piece.as_ref()), steps.len().max(1) as u64);
                    for expected in if steps.is_empty() { vec![Served::AT_ONCE] } else { steps } {
                        modules.ask(&mut state, &frames, &specs, u32::MAX);
                        prop_assert_eq!(state.asked.pop_front().map(|step| step.served), Some(expected));
                    }
                }
            }
            prop_assert_eq!((voxels, pieces.next()), (dims.iter().product::<usize>(), None));
            prop_assert_eq!(state.counters[0], counters);
        }

        /// Beams of two rows: the row of the plane first, then the one below, each as a beam of its own; outside of the volume nothing
        /// is read, in as many steps.
        #[test]
        fn a_near_eyes_beams_are_asked_for_row_behind_row(
            lanes in 1_usize..7, dims in [1_usize..9, 1_usize..9, 1_usize..9], eye in [-4.0..12.0_f64, -4.0..12.0_f64, -6.0..4.0_f64],
            skew in prop_oneof![Just([1_i64; 3]), [-3_i64..4, -3_i64..4, -3_i64..4]], blocks: bool,
            kind in proptest::sample::select(MemoryModel::TABLE.map(|model| model.kind).to_vec()),
        ) {
            let layout = if blocks { Layout::Blocks } else { Layout::Rows };
            let cfb = Cfb { skew, memory: kind, memory_clock_hz: Some(20e6), layout, ..Cfb::default() };
            let machine = MachineSpec { lanes, cfb, ..MachineSpec::default() };
            let perspective = Perspective { eye_voxel: Some(eye), ..Perspective::new(150.0) };
            let view = View { perspective: Some(perspective), ..View::from_direction([0.0, 0.0, 1.0], None) };
            let scene = Scene { view, ..Scene::default() };
            let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
            let frames = picture_setup(&scene, &machine, &volume, true).unwrap().setups;
            let modules = Modules::new(&machine, dims).unwrap();
            let specs: Vec<CfbSpec> = frames.iter().map(|setup| CfbSpec::new(&machine, &setup.geometry, Schedule::new(&machine, &setup.geometry))).collect();
            let mut state = modules.start(frames.len());
            let mut each = vec![Module::new(&modules.timing); lanes];
            for (frame, setup) in frames.iter().enumerate() {
                let geometry = &setup.geometry;
                let fan = &geometry.perspective.as_ref().unwrap().v;
                let inside = |y: i32| usize::try_from(y).ok().filter(|&y| y < geometry.size[1]);
                let steps = (specs[frame].cycles(Some(0)) / specs[frame].schedule.rows_of_beam()) as usize;
                let mut counters = MemoryCounters::default();
                for plane in 0..fan.count() {
                    for depth in 0..geometry.size[2] {
                        let mut read = |row: Option<usize>| match row {
                            Some(v) => read_beam(&modules, &mut each, geometry, [v, depth], 0, &mut counters),
                            None => vec![Served::AT_ONCE; steps],
                        };
                        let expected = match inside(fan.near(plane, depth)) {
                            None => vec![Served::AT_ONCE],
                            Some(v) if geometry.doubled() => {
                                [read(Some(v)), read(inside(fan.right(plane, depth)))].concat()
                            }
                            Some(v) => read(Some(v)),
                        };
                        for expected in expected {
                            modules.ask(&mut state, &frames, &specs, u32::MAX);
                            prop_assert_eq!(state.asked.pop_front().map(|step| step.served), Some(expected));
                        }
                    }
                }
                prop_assert_eq!(state.counters[frame], counters);
            }
            modules.ask(&mut state, &frames, &specs, u32::MAX);
            prop_assert!(state.asked.is_empty());
        }
    }
}
