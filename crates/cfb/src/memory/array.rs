//! All modules under the scan of the frame buffer.

use super::{MemoryCounters, Module, Served, Timing};
use crate::golden::{Placement, Skew, gcd};
use crate::unit::{CfbSpec, Scan, row};
use cube3_channel::{Activity, ClockDomain, Reason};
use cube3_host::{FrameSetup, Geometry, MachineSpec, MemoryType};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// The memory modules of a frame buffer: timing and addresses.
///
/// The frame buffer reads a beam in steps, in each at most one word of each module. The scan is known, so each module is asked for
/// the words of the next steps, `look_ahead` of them; a step is over when the slowest of its modules has given its word.
#[derive(Clone, Debug)]
pub struct Modules {
    timing: Timing,
    clock: ClockDomain,
    placement: Placement,
    /// What each coordinate adds to an address, for x, y, z.
    terms: [Vec<u64>; 3],
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
    asked: VecDeque<Served>,
    /// The modules; a single one stands for all as long as nothing has told them apart.
    modules: Vec<Module>,
    /// By frame.
    counters: Vec<MemoryCounters>,
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
        Some(Modules { timing: Timing::of(machine), clock, placement, terms })
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
            asked: VecDeque::with_capacity(self.timing.look_ahead),
            modules: vec![Module::new(&self.timing)],
            counters: vec![MemoryCounters::default(); frames],
        }
    }

    /// Asks for words ahead of the scan, in frames before `released`.
    #[inline]
    pub(crate) fn ask(&self, state: &mut MemoryState, frames: &[FrameSetup], specs: &[CfbSpec], released: u32) {
        let last = released.min(specs.len() as u32);
        while state.asked.len() < self.timing.look_ahead && state.ahead.frame < last {
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
            let served = fetched.map(|row| self.serve(state, geometry, [row, depth as usize], step));
            state.asked.push_back(served.unwrap_or(Served::AT_ONCE));
            if spent + 1 < spec.cycles(row) {
                state.ahead.spent += 1;
            } else {
                state.ahead.advance(geometry);
            }
        }
    }

    /// Has the modules read their words of step `step` of the beam at row `v` and plane `w`.
    fn serve(&self, state: &mut MemoryState, geometry: &Geometry, [v, w]: [usize; 2], step: u64) -> Served {
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
        let MemoryState { modules, counters, ahead, now, .. } = state;
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
        served
    }
}

impl MemoryState {
    /// What the frame buffer does in this cycle while the words of its step are not there; none where they are.
    #[inline]
    pub(crate) fn waits(&self) -> Option<Activity> {
        let step = self.asked.front()?;
        if step.ready < self.next {
            return None;
        }
        let tick = self.next - 1;
        Some(if tick < step.refresh_until {
            Activity::Waiting(Reason::Refresh)
        } else if tick < step.row_until {
            Activity::Waiting(Reason::MemoryRow)
        } else {
            Activity::Busy
        })
    }

    /// Takes the words of the step.
    #[inline]
    pub(crate) fn take(&mut self) {
        self.asked.pop_front();
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
                        prop_assert_eq!(modules.serve(&mut state, &geometry, [v, w], step as u64), expected);
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
                            prop_assert_eq!(state.asked.pop_front(), Some(expected));
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
