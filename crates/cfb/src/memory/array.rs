//! All modules under the scan of the frame buffer.

use super::{Chooser, MemoryCounters, Module, Served, Timing};
use crate::golden::{Placement, Skew, gcd};
use crate::unit::{CfbSpec, Scan, row};
use cube3_channel::{Activity, ClockDomain, Reason};
use cube3_host::{
    ControllerKind, FrameSetup, Geometry, LookAheadFreed, LookAheadUnit, MachineSpec, MemoryModel, MemoryType,
};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

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
    clock: ClockDomain,
    /// The first tick of this pipeline cycle, and of the next.
    now: i64,
    next: i64,
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
    /// The modules of a machine for a volume; none where they give any word in any cycle.
    pub fn new(machine: &MachineSpec, dims: [usize; 3]) -> Option<Modules> {
        let clock = ClockDomain::from_hertz(machine.memory_clock_hz(), machine.clock_hz);
        if machine.cfb.memory == MemoryType::Ideal && clock.ratio() == (1, 1) {
            return None;
        }
        let skew = Skew { coefficients: machine.cfb.skew, lanes: machine.lanes };
        let placement = Placement { skew, layout: machine.cfb.layout, dims };
        let terms = [0, 1, 2].map(|axis| (0..dims[axis]).map(|i| placement.term(axis, i) as u64).collect());
        let cfb = &machine.cfb;
        Some(Modules {
            timing: Timing::of(machine),
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
        let mut clock = self.clock;
        let next = clock.advance() as i64;
        MemoryState {
            clock,
            now: 0,
            next,
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
    pub(crate) fn ask(&self, state: &mut MemoryState, frames: &[FrameSetup], specs: &[CfbSpec], released: u32) {
        let last = released.min(specs.len() as u32);
        while self.room(state) && state.ahead.frame < last {
            let Scan { frame, plane, depth, spent } = state.ahead;
            let geometry = &frames[frame as usize].geometry;
            let row = row(geometry, plane, depth);
            let spec = specs[frame as usize];
            // Of a beam with two rows the second comes behind the first, if there is a first.
            let half = spec.cycles(row) / spec.rows;
            let (fetched, step) = if spent < half || spec.rows == 1 {
                (row.map(|row| row as usize), spent)
            } else {
                (row.and(geometry.row_below(plane as usize, depth as usize)), spent - half)
            };
            let asked = match fetched {
                Some(row) => self.serve(state, geometry, [row, depth as usize], step),
                None => Step { served: Served::AT_ONCE, missing: 0 },
            };
            state.asked.push_back(asked);
            if spent + 1 < spec.cycles(row) {
                state.ahead.spent += 1;
            } else {
                state.ahead.advance(geometry);
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
            LookAheadFreed::Column => step.missing > 0 || step.served.issued >= state.now,
        };
        let counted = || state.asked.iter().filter(counts);
        state.asked.len() < self.most
            && counted().filter(holds).count() < self.timing.look_ahead
            && (self.freed == LookAheadFreed::Word || counted().count() < 2 * self.timing.look_ahead)
    }

    /// Lets modules that choose issue what they issue in this pipeline cycle.
    fn choose(&self, state: &mut MemoryState) {
        let MemoryState { choosers, asked, taken, next, counters, .. } = state;
        for chooser in choosers {
            chooser.advance(&self.timing, *next, counters, |number, served| {
                let step = &mut asked[(number - *taken) as usize];
                step.served = step.served.and(served);
                step.missing -= 1;
            });
        }
    }

    /// Has the modules read their words of step `step` of the beam at row `v` and plane `w`.
    fn serve(&self, state: &mut MemoryState, geometry: &Geometry, [v, w]: [usize; 2], step: u64) -> Step {
        let Skew { lanes, coefficients } = self.placement.skew;
        let axis = geometry.axes.axis[0];
        let along = coefficients[axis].rem_euclid(lanes as i64) as usize;
        // Voxels u of the step: those of a piece of `lanes` voxels that are in different modules.
        let together = lanes / gcd(along as i64, lanes);
        let steps_of_piece = lanes / together;
        let first = step as usize / steps_of_piece * lanes + step as usize % steps_of_piece * together;
        let end = (first + together).min(geometry.size[0]);
        let start = geometry.axes.voxel(geometry.size, [first, v, w]);
        let base: u64 = (0..3).filter(|&a| a != axis).map(|a| self.terms[a][start[a]]).sum();
        // Against the axis the coordinates fall; which voxel of the step is taken first changes nothing.
        let low = if geometry.axes.reversed[0] { start[axis] + 1 - (end - first) } else { start[axis] };
        let terms = &self.terms[axis][low..low + (end - first)];
        let mut xyz = start.map(|i| i as i64);
        xyz[axis] = low as i64;
        let lowest = self.placement.skew.module(xyz);
        let MemoryState { modules, choosers, counters, ahead, now, asked, taken, .. } = state;
        let number = *taken + asked.len() as u64;
        if !choosers.is_empty() {
            let places = terms.iter().map(|term| self.timing.place(base + term));
            for (i, place) in places.enumerate() {
                choosers[(lowest + i * along) % lanes].ask(place, *now, number, ahead.frame);
            }
            return Step { served: Served::AT_ONCE, missing: terms.len() as u32 };
        }
        let mut counted = MemoryCounters::default();
        let no_address = self.timing.rows.is_none() && self.timing.burst == 1;
        let alike = terms.len() == lanes && (no_address || terms[0] == terms[lanes - 1]);
        let served = if modules.len() == 1 && alike {
            let served = modules[0].read(&self.timing, self.timing.place(base + terms[0]), *now, &mut counted);
            counted = counted.times(lanes as u64);
            served
        } else {
            if modules.len() < lanes {
                let one = modules[0].clone();
                modules.resize(lanes, one);
            }
            let mut module = lowest;
            let mut all = Served::AT_ONCE;
            for term in terms {
                all = all.and(modules[module].read(&self.timing, self.timing.place(base + term), *now, &mut counted));
                module += along;
                if module >= lanes {
                    module -= lanes;
                }
            }
            all
        };
        counters[ahead.frame as usize] += counted;
        Step { served, missing: 0 }
    }
}

impl MemoryState {
    /// What the frame buffer does in this cycle while the words of its step are not there; none where they are.
    #[inline]
    pub(crate) fn waits(&self) -> Option<Activity> {
        let &Step { served, missing } = self.asked.front()?;
        if missing == 0 && served.ready < self.next {
            return None;
        }
        let tick = self.next - 1;
        let mut until = [served.refresh_until, served.row_until];
        if missing > 0 {
            for waits in self.choosers.iter().filter_map(|chooser| chooser.waits(self.taken)) {
                until = [0, 1].map(|i| until[i].max(waits[i]));
            }
        }
        Some(if tick < until[0] {
            Activity::Waiting(Reason::Refresh)
        } else if tick < until[1] {
            Activity::Waiting(Reason::MemoryRow)
        } else {
            Activity::Busy
        })
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
        self.now = self.next;
        self.next += self.clock.advance() as i64;
    }

    /// What the modules have done, by frame, summed over the modules. Words ahead of the scan are counted when they are asked for.
    pub fn counters(&self) -> &[MemoryCounters] {
        &self.counters
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitvec::prelude::*;
    use cube3_host::{Cfb, Layout, MemoryModel, RaySlots, Rays, VolumeInfo, frame_setup, picture_setup};
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

    proptest! {
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
            let mut state = modules.start(1);
            let mut each = vec![Module::new(&modules.timing); lanes];
            let mut counters = MemoryCounters::default();
            for v in 0..geometry.size[1] {
                for w in 0..geometry.size[2] {
                    let expected = read_beam(&modules, &mut each, &geometry, [v, w], state.now, &mut counters);
                    for (step, expected) in expected.into_iter().enumerate() {
                        prop_assert_eq!(modules.serve(&mut state, &geometry, [v, w], step as u64).served, expected);
                    }
                    prop_assert_eq!(state.counters[0], counters);
                    state.now += pace;
                }
            }
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
            let specs: Vec<CfbSpec> = frames.iter().map(|setup| CfbSpec::new(&machine, &setup.geometry)).collect();
            let mut state = modules.start(frames.len());
            let mut each = vec![Module::new(&modules.timing); lanes];
            for (frame, setup) in frames.iter().enumerate() {
                let geometry = &setup.geometry;
                let fan = &geometry.perspective.as_ref().unwrap().v;
                let inside = |y: i32| usize::try_from(y).ok().filter(|&y| y < geometry.size[1]);
                let steps = (specs[frame].cycles(Some(0)) / specs[frame].rows) as usize;
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
