//! Modules that read mini-blocks, against a reorder buffer written from its rules voxel by voxel; and what closed forms say of both.

use cube3_cases::cases;
use cube3_cfb::golden::{Placement, Skew};
use cube3_cfb::memory::{
    MemoryCounters, Module, ReorderCounters, ReorderNeed, Served, Supply, Timing, WordPlace, edge_words,
};
use cube3_cfb::{Beam, CfbSpec, CfbUnit, NoVoxels, scan};
use cube3_channel::{Account, Activity, Channel, ClockDomain, Reason};
use cube3_frame::{FrameSetup, Geometry, Schedule};
use cube3_host::{VolumeInfo, frame_setup, picture_setup};
use cube3_machine::{Cfb, Layout, LookAheadFreed, LookAheadUnit, MachineSpec, MemoryModel, MemoryType, RaySlots, Rays};
use cube3_scene::{Perspective, Scene, View};
use proptest::prelude::*;
use std::collections::{BTreeMap, HashMap, HashSet, VecDeque};
use std::sync::Arc;

/// What a run of the frame buffer shows: the cycles in which beams were sent, the account, and what modules and buffer have done.
#[derive(Debug, PartialEq)]
struct Seen {
    sent: Vec<u64>,
    account: Account,
    counters: Vec<MemoryCounters>,
    reorder: ReorderCounters,
}

fn run(machine: &MachineSpec, setups: &[Arc<FrameSetup>]) -> Seen {
    let modules = Supply::new(machine, setups).unwrap();
    let specs = setups
        .iter()
        .map(|setup| CfbSpec::new(machine, &setup.geometry, Schedule::new(machine, &setup.geometry)))
        .collect();
    let mut cfb = CfbUnit::new(specs, NoVoxels).with_modules(modules);
    let mut beams = Channel::<Beam<()>>::new("beams", 4, 2).unwrap();
    let (mut sent, mut cycle) = (Vec::new(), 0);
    while !cfb.done() {
        beams.pop_slot();
        let before = beams.counters().pushes;
        cfb.tick(setups, u32::MAX, &mut beams);
        if beams.counters().pushes > before {
            sent.push(cycle);
        }
        beams.commit();
        cycle += 1;
        assert!(cycle < 1_000_000, "stuck");
    }
    let reorder = cfb.reorder_counters().unwrap();
    Seen { sent, account: *cfb.account(), counters: cfb.memory_counters().to_vec(), reorder }
}

/// A beam, or a section's part of one, as its rows of voxels: for each, the mini-block of each voxel. None is a row below that is outside of
/// the volume; no row at all a beam outside of it.
struct NaiveBeam {
    frame: usize,
    section: usize,
    plane: u32,
    depth: u32,
    rows: Vec<Option<Vec<[usize; 3]>>>,
}

fn naive_beams(machine: &MachineSpec, setups: &[Arc<FrameSetup>]) -> Vec<NaiveBeam> {
    let mut beams = Vec::new();
    for (frame, setup) in setups.iter().enumerate() {
        let geometry = &setup.geometry;
        let whole = Schedule::of(geometry, machine.lanes, None);
        let inside: HashMap<(u32, u32), u32> =
            scan(geometry, &whole).map(|(at, piece)| ((at.plane, at.depth), piece.row)).collect();
        let sections = *Schedule::new(machine, geometry).sections();
        for section in 0..sections.count() {
            for plane in 0..geometry.slot_counts()[1] as u32 {
                for depth in 0..geometry.size[2] as u32 {
                    let columns: Vec<usize> = if sections.is_whole() {
                        (0..geometry.size[0]).collect()
                    } else {
                        let ray = |slot| geometry.ray_in_slot(0, slot, depth as usize).u;
                        let slots = sections.slots(section);
                        slots.filter_map(|slot| geometry.column_at(ray(slot), depth as usize)).collect()
                    };
                    let minis = |v: usize| {
                        let voxel = |&u: &usize| geometry.axes.voxel(geometry.size, [u, v, depth as usize]);
                        columns.iter().map(|u| voxel(u).map(|i| i / 2)).collect::<Vec<_>>()
                    };
                    let mut rows = Vec::new();
                    if let Some(&v) = inside.get(&(plane, depth)).filter(|_| !columns.is_empty()) {
                        rows.push(Some(minis(v as usize)));
                        if geometry.doubled() {
                            rows.push(geometry.row_below(plane as usize, depth as usize).map(minis));
                        }
                    }
                    beams.push(NaiveBeam { frame, section, plane, depth, rows });
                }
            }
        }
    }
    beams
}

/// A stay of a row of mini-blocks, or of what a section brings of one, in the buffer.
struct Stay {
    frame: usize,
    minis: Vec<[usize; 3]>,
    first: usize,
    last: usize,
}

/// Frame, section and place across the beams of a row of mini-blocks.
type RowKey = [usize; 4];

fn row_of(setups: &[Arc<FrameSetup>], beam: &NaiveBeam, mini: [usize; 3]) -> RowKey {
    let axis = setups[beam.frame].geometry.axes.axis;
    [beam.frame, beam.section, mini[axis[1]], mini[axis[2]]]
}

/// The mini-blocks of each row that a section uses, in the order of slots: those of the nearer depth begin first.
fn naive_touched(setups: &[Arc<FrameSetup>], beams: &[NaiveBeam]) -> HashMap<RowKey, Vec<[usize; 3]>> {
    let mut by_depth: HashMap<RowKey, BTreeMap<u32, Vec<[usize; 3]>>> = HashMap::new();
    for beam in beams {
        for row in beam.rows.iter().flatten() {
            by_depth.entry(row_of(setups, beam, row[0])).or_default().entry(beam.depth).or_insert_with(|| row.clone());
        }
    }
    let in_order = |depths: BTreeMap<u32, Vec<[usize; 3]>>| {
        let mut met = HashSet::new();
        depths.into_values().flatten().filter(|&mini| met.insert(mini)).collect()
    };
    by_depth.into_iter().map(|(key, depths)| (key, in_order(depths))).collect()
}

/// The stays in the order in which they begin, from sets of mini-blocks: a stay goes on as long as the same plane or the next uses it. What
/// the section before has had of the row is not brought again; what goes on from the row's end to its start are two stays.
fn naive_stays(setups: &[Arc<FrameSetup>], beams: &[NaiveBeam]) -> Vec<Stay> {
    let touched = naive_touched(setups, beams);
    let mut stays: Vec<Stay> = Vec::new();
    // By row: its stays, and the last plane that has used them.
    let mut here: HashMap<RowKey, (Vec<usize>, u32)> = HashMap::new();
    for (at, beam) in beams.iter().enumerate() {
        for row in beam.rows.iter().flatten() {
            let key = row_of(setups, beam, row[0]);
            let before = key[1].checked_sub(1).and_then(|section| touched.get(&[key[0], section, key[2], key[3]]));
            let (current, last_plane) = here.entry(key).or_insert((Vec::new(), u32::MAX));
            if *last_plane == u32::MAX || beam.plane > *last_plane + 1 {
                current.clear();
                let Geometry { axes, .. } = setups[beam.frame].geometry;
                let mut minis: Vec<[usize; 3]> = Vec::new();
                for &mini in touched[&key].iter().filter(|mini| before.is_none_or(|before| !before.contains(mini))) {
                    let [low, high] = if axes.reversed[0] { [1, 0] } else { [0, 1] };
                    let goes_on = |last: &[usize; 3]| last[axes.axis[0]] + high == mini[axes.axis[0]] + low;
                    if minis.last().is_some_and(|last| !goes_on(last)) {
                        current.push(stays.len());
                        stays.push(Stay { frame: beam.frame, minis: std::mem::take(&mut minis), first: at, last: at });
                    }
                    minis.push(mini);
                }
                if !minis.is_empty() {
                    current.push(stays.len());
                    stays.push(Stay { frame: beam.frame, minis, first: at, last: at });
                }
            }
            *last_plane = beam.plane;
            current.iter().for_each(|&stay| stays[stay].last = at);
        }
    }
    stays
}

fn all_of(words: &[Served]) -> Served {
    words.iter().fold(Served::AT_ONCE, |all, &word| all.and(word))
}

/// A module of the slow twin: what it is to read, as (stay, mini-block, burst), and what of it is under way.
struct NaiveModule {
    module: Module,
    list: VecDeque<(usize, [usize; 3], u64)>,
    /// Words of each burst.
    open: VecDeque<Vec<Served>>,
}

/// The same as the unit, cycle by cycle from lists of voxels.
fn naive(machine: &MachineSpec, setups: &[Arc<FrameSetup>], words: u64) -> Seen {
    let timing = &Timing::of(machine);
    let geometries: Vec<&Geometry> = setups.iter().map(|setup| &setup.geometry).collect();
    let dims = geometries[0].dims();
    let lanes = machine.lanes;
    let placement =
        Placement { skew: Skew { coefficients: machine.cfb.skew, lanes }, layout: Layout::MiniBlocks, dims };
    let (beams, chunk) = (naive_beams(machine, setups), timing.burst.min(8) as u64);
    let stays = naive_stays(setups, &beams);
    let mut modules: Vec<NaiveModule> = (0..lanes)
        .map(|_| NaiveModule { module: Module::new(timing), list: VecDeque::new(), open: VecDeque::new() })
        .collect();
    for (number, stay) in stays.iter().enumerate() {
        for &mini in &stay.minis {
            let list = &mut modules[placement.module(mini.map(|i| 2 * i))].list;
            list.extend((0..8 / chunk).map(|burst| (number, mini, burst)));
        }
    }
    let mut clock = ClockDomain::from_hertz(machine.memory_clock_hz(), machine.clock_hz);
    let (mut now, mut next) = (0, clock.advance() as i64);
    let (mut admitted, mut held) = (0, 0_u64);
    let mut arrived: HashMap<(usize, [usize; 3]), (u64, Served)> = HashMap::new();
    let mut seen = Seen {
        sent: Vec::new(),
        account: Account::default(),
        counters: vec![MemoryCounters::default(); setups.len()],
        reorder: ReorderCounters { words, ..ReorderCounters::default() },
    };
    let (mut at, mut spent, mut cycle) = (0, 0, 0);
    while at < beams.len() {
        for NaiveModule { module, list, open } in &mut modules {
            loop {
                // The oldest gives its place free first: the halves of a burst may come in either order.
                while open.front().is_some_and(|burst| all_of(burst).ready < now) {
                    open.pop_front();
                }
                let freed = |burst: &&Vec<Served>| {
                    machine.cfb.look_ahead_freed == LookAheadFreed::Word || all_of(burst).issued >= now
                };
                let of_burst = |burst: &Vec<Served>| match machine.cfb.look_ahead_freed {
                    LookAheadFreed::Word => burst.iter().filter(|word| word.ready >= now).count(),
                    LookAheadFreed::Column => burst.len(),
                };
                let counted = open.iter().filter(freed);
                let ahead = match machine.cfb.look_ahead_unit {
                    LookAheadUnit::Bursts => counted.count(),
                    LookAheadUnit::Words => counted.map(of_burst).sum::<usize>(),
                };
                if ahead >= timing.look_ahead {
                    break;
                }
                let wanted = list.front().map_or(stays.len(), |&(stay, ..)| stay + 1);
                while admitted < wanted && held + 8 * stays[admitted].minis.len() as u64 <= words {
                    held += 8 * stays[admitted].minis.len() as u64;
                    seen.reorder.peak_words = seen.reorder.peak_words.max(held);
                    seen.reorder.rows += 1;
                    seen.reorder.mini_blocks += stays[admitted].minis.len() as u64;
                    admitted += 1;
                }
                if admitted < wanted || list.is_empty() {
                    break;
                }
                let Some((stay, mini, burst)) = list.pop_front() else { break };
                let counters = &mut seen.counters[stays[stay].frame];
                let voxel = mini.map(|i| 2 * i);
                let sum = |of: &dyn Fn(usize, usize) -> usize| (0..3).map(|axis| of(axis, voxel[axis])).sum::<usize>();
                let bank = sum(&|axis, i| placement.block(axis, i)) % timing.banks();
                let word = sum(&|axis, i| placement.bank_term(axis, i, timing.banks()));
                let mut burst_words = Vec::new();
                for i in burst * chunk..(burst + 1) * chunk {
                    let place = match timing.rows {
                        Some(rows) => WordPlace {
                            word: placement.address(voxel) as u64 + i,
                            bank,
                            row: (word as u64 + i) / rows.words as u64,
                        },
                        None => WordPlace { word: placement.address(voxel) as u64 + i, bank: 0, row: 0 },
                    };
                    burst_words.push(module.read(timing, place, now, counters));
                }
                let all = all_of(&burst_words);
                open.push_back(burst_words);
                let entry = arrived.entry((stay, mini)).or_insert((0, Served::AT_ONCE));
                *entry = (entry.0 + 1, entry.1.and(all));
            }
        }
        let beam = &beams[at];
        let steps = beam.rows.first().and_then(|row| row.as_ref()).map_or(1, |row| row.len().div_ceil(lanes));
        let mut activity = Activity::Busy;
        let mut over = beam.rows.is_empty();
        if !over {
            over = spent + 1 == steps * beam.rows.len();
            if let Some(row) = &beam.rows[spent / steps] {
                let needed = &row[spent % steps * lanes..row.len().min((spent % steps + 1) * lanes)];
                let (mut there, mut served) = (true, Served::AT_ONCE);
                for &mini in needed {
                    let uses = |stay: &Stay| (stay.first..=stay.last).contains(&at) && stay.minis.contains(&mini);
                    // The section before has brought what no stay has.
                    let Some(stay) = stays.iter().position(uses) else { continue };
                    let (bursts, last) = arrived.get(&(stay, mini)).copied().unwrap_or((0, Served::AT_ONCE));
                    there &= bursts == 8 / chunk && last.ready < next;
                    served = served.and(last);
                    if bursts < 8 / chunk && stay < admitted {
                        let module = &modules[placement.module(mini.map(|i| 2 * i))];
                        served = module.open.front().map_or(served, |burst| served.and(all_of(burst)));
                    }
                    if stay >= admitted {
                        let open = modules.iter().filter_map(|module| module.open.front());
                        served = open.fold(served, |all, one| all.and(all_of(one)));
                    }
                }
                if !there {
                    over = false;
                    activity = if next - 1 < served.refresh_until {
                        Activity::Waiting(Reason::Refresh)
                    } else if next - 1 < served.row_until {
                        Activity::Waiting(Reason::MemoryRow)
                    } else {
                        Activity::Busy
                    };
                    spent = spent.wrapping_sub(1);
                }
            }
        }
        spent = spent.wrapping_add(1);
        seen.account.record(activity);
        if over {
            seen.sent.push(cycle);
            held -= stays.iter().filter(|stay| stay.last == at).map(|stay| 8 * stay.minis.len() as u64).sum::<u64>();
            (at, spent) = (at + 1, 0);
        }
        now = next;
        next += clock.advance() as i64;
        cycle += 1;
        assert!(cycle < 1_000_000, "stuck");
    }
    seen
}

/// Look-ahead, its unit, when it is freed, and the length of SDRAM's bursts.
fn ahead() -> impl Strategy<Value = (usize, LookAheadUnit, LookAheadFreed, usize)> {
    let unit = proptest::sample::select(vec![LookAheadUnit::Words, LookAheadUnit::Bursts]);
    let freed = proptest::sample::select(vec![LookAheadFreed::Word, LookAheadFreed::Column]);
    (1_usize..30, unit, freed, proptest::sample::select(vec![1, 2, 4, 8]))
}

/// Machines with this layout, and frames: one or two parallel ones, or the passes of an eye.
fn blocked() -> impl Strategy<Value = (MachineSpec, Vec<Arc<FrameSetup>>)> {
    let kinds = proptest::sample::select(MemoryModel::TABLE.map(|model| model.kind).to_vec());
    let machine = (1_usize..7, [-3_i64..4, -3_i64..4, -3_i64..4], kinds, 0.3..3.0_f64, any::<bool>(), ahead());
    let view =
        (prop::array::uniform3(-1.0..1.0_f64), prop::option::of(prop::array::uniform3(-6.0..12.0_f64)), 1_usize..3);
    let section = prop::option::of(1_usize..14);
    (machine, [1_usize..12, 1_usize..12, 1_usize..12], view, section).prop_filter_map(
        "a skew and a view",
        |(
            (lanes, skew, memory, speed, padded, (look_ahead, unit, freed, burst)),
            dims,
            (direction, eye, frames),
            section,
        )| {
            if !Layout::MiniBlocks.takes(skew, lanes) || direction.iter().all(|x| x.abs() < 0.01) {
                return None;
            }
            let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
            let rays = Rays { slots, section: section.filter(|_| eye.is_none()), ..Rays::default() };
            let cfb = Cfb {
                skew,
                memory,
                layout: Layout::MiniBlocks,
                burst_words: (memory == MemoryType::Sdram).then_some(burst),
                look_ahead: Some(look_ahead),
                look_ahead_unit: unit,
                look_ahead_freed: freed,
                ..Cfb::default()
            };
            let mut machine = MachineSpec { lanes, cfb, rays, ..MachineSpec::default() };
            machine.clock_hz = machine.memory_clock_hz() * speed;
            machine.cfb.memory_clock_hz = Some(machine.clock_hz / speed);
            let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
            let mut view = View::from_direction(direction, None);
            view.perspective = eye.map(|eye| Perspective { eye_voxel: Some(eye), ..Perspective::new(150.0) });
            let scene = Scene { view, ..Scene::default() };
            let setups = match eye {
                None => vec![frame_setup(&scene, &machine, &volume, true).ok()?.setup.into(); frames],
                Some(_) => picture_setup(&scene, &machine, &volume, true).ok()?.setups,
            };
            (!setups.is_empty()).then_some((machine, setups))
        },
    )
}

/// Most of what frames need.
fn need(machine: &MachineSpec, setups: &[Arc<FrameSetup>]) -> ReorderNeed {
    let needs = setups.iter().map(|setup| ReorderNeed::new(machine, &setup.geometry));
    needs.fold(ReorderNeed::default(), |all, one| ReorderNeed {
        least: all.least.max(one.least),
        steady: all.steady.max(one.steady),
        rows: all.rows + one.rows,
        words: all.words + one.words,
    })
}

proptest! {
    #![proptest_config(cases(300))]

    /// Any capacity from the least on; with a word less the machine is refused. Every mini-block is read whole, and as often as sets of
    /// mini-blocks say.
    #[test]
    fn the_frame_buffer_does_in_every_cycle_what_its_rules_say(
        (mut machine, setups) in blocked(), room in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0_f64],
    ) {
        let need = need(&machine, &setups);
        let words = need.least + (room * (need.steady - need.least) as f64) as u64;
        machine.cfb.reorder_words = Some(words);
        let seen = run(&machine, &setups);
        prop_assert_eq!(&seen, &naive(&machine, &setups, words));
        let stays = naive_stays(&setups, &naive_beams(&machine, &setups));
        let minis: usize = stays.iter().map(|stay| stay.minis.len()).sum();
        prop_assert_eq!((need.rows, need.words), (stays.len() as u64, 8 * minis as u64));
        prop_assert_eq!((seen.reorder.rows, seen.reorder.mini_blocks), (stays.len() as u64, minis as u64));
        let mut sum = MemoryCounters::default();
        seen.counters.iter().for_each(|&counters| sum += counters);
        prop_assert_eq!(sum.words, 8 * minis as u64);
        let burst = Timing::of(&machine).burst;
        let reads = (8 / burst.min(8) * minis) as u64;
        // What is at the output is not read again: the other half of a long burst, or a mini-block that comes up to four times running.
        prop_assert!(sum.reads <= reads && sum.reads * burst as u64 >= sum.words / 4);
        prop_assert!((need.least..=words).contains(&seen.reorder.peak_words));
        machine.cfb.reorder_words = Some(need.least - 1);
        let refused = Supply::new(&machine, &setups).unwrap_err();
        prop_assert_eq!((refused.words, refused.least), (need.least - 1, need.least));
    }

    /// A row of mini-blocks of a parallel view is read once or twice, and every mini-block at least once. Sections read no more of each row
    /// again than the mini-block in which the last slot meets the first.
    #[test]
    fn rows_of_a_parallel_view_are_read_once_or_twice((mut machine, setups) in blocked()) {
        if setups[0].geometry.perspective.is_some() {
            return Ok(());
        }
        let minis = |stays: &[Stay]| stays.iter().map(|stay| stay.minis.len()).sum::<usize>();
        let beams = naive_beams(&machine, &setups[..1]);
        let in_sections = naive_stays(&setups[..1], &beams);
        // What a section uses that the section before has brought is kept beside the chip.
        let touched = naive_touched(&setups[..1], &beams);
        let mut kept = HashMap::new();
        for (&[frame, section, j, k], minis) in touched.iter().filter(|(key, _)| key[1] > 0) {
            let before = touched.get(&[frame, section - 1, j, k]);
            let both = minis.iter().filter(|mini| before.is_some_and(|before| before.contains(mini)));
            *kept.entry(section).or_insert(0) += 8 * both.count() as u64;
        }
        prop_assert_eq!(edge_words(&setups[0].geometry, &Schedule::new(&machine, &setups[0].geometry)), kept.into_values().max().unwrap_or(0));
        machine.rays.section = None;
        let stays = naive_stays(&setups[..1], &naive_beams(&machine, &setups[..1]));
        let mut reads: HashMap<[usize; 3], usize> = HashMap::new();
        stays.iter().flat_map(|stay| &stay.minis).for_each(|&mini| *reads.entry(mini).or_default() += 1);
        let dims = setups[0].geometry.dims();
        prop_assert_eq!(reads.len(), dims.map(|n| n.div_ceil(2)).iter().product::<usize>());
        prop_assert!(reads.values().all(|&times| times <= 2));
        // At most one row of each two depths goes over the wrap.
        let pairs = setups[0].geometry.size[2] / 2 + 1;
        let twice: HashSet<Vec<[usize; 3]>> = stays.iter().filter(|stay| reads[&stay.minis[0]] == 2).map(|stay| stay.minis.clone()).collect();
        let padded = machine.rays.slots == RaySlots::Padded;
        let again = if padded { 0 } else { stays.len() };
        prop_assert!((minis(&stays)..=minis(&stays) + again).contains(&minis(&in_sections)));
        prop_assert!(twice.len() <= if padded { 0 } else { pairs }, "{} of {}", twice.len(), pairs);
    }
}

/// Four SDRAMs of 125 MHz with bursts of 8, of which 16 are asked for ahead, behind a pipeline of the same clock.
fn four_sdrams() -> MachineSpec {
    let cfb = Cfb {
        memory: MemoryType::Sdram,
        memory_clock_hz: Some(125e6),
        layout: Layout::MiniBlocks,
        burst_words: Some(8),
        look_ahead: Some(16),
        look_ahead_unit: LookAheadUnit::Bursts,
        ..Cfb::default()
    };
    MachineSpec { lanes: 4, clock_hz: 125e6, cfb, ..MachineSpec::default() }
}

/// The 26 directions to the neighbours of a cube, each a little turned.
fn directions() -> impl Iterator<Item = [f64; 3]> {
    let turned = |i: usize| [0.07, -0.11, 0.05].map(|turn| if i == 0 { 0.0 } else { turn });
    let all = (0..27).filter(|i| *i != 13).map(|i| [i % 3, i / 3 % 3, i / 9].map(|n| n as f64 - 1.0));
    all.flat_map(move |d| [0, 1].map(|i| [0, 1, 2].map(|axis| d[axis] + turned(i)[axis])))
}

/// The ticks of a frame are those of its bursts, of which a module has the same number as any other; a refresh loses tRP + tRFC + tRCD = 15 of
/// 976 ticks; a burst in another row of the bank of the burst before loses what closing and opening takes longer than a burst, 8 + 3 + 3 − 8.
#[test]
fn a_frame_from_every_direction_takes_its_bursts_its_refreshes_and_the_rows_that_meet_in_a_bank() {
    let machine = four_sdrams();
    let n = 64;
    let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let skew = Skew { coefficients: [1; 3], lanes: 4 };
    let placement = Placement { skew, layout: Layout::MiniBlocks, dims: [n; 3] };
    for direction in directions() {
        let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
        let setup = frame_setup(&scene, &machine, &volume, true).unwrap().setup;
        let setup = Arc::new(setup);
        let setups = vec![Arc::clone(&setup), Arc::clone(&setup), setup];
        let stays = naive_stays(&setups[..2], &naive_beams(&machine, &setups[..2]));
        let (mut bursts, mut met, mut last) = (0, 0, None);
        for (i, mini) in stays.iter().flat_map(|stay| stay.minis.iter().map(move |mini| (stay.frame, mini))) {
            let voxel = mini.map(|i| 2 * i);
            if placement.module(voxel) != 0 {
                continue;
            }
            let sum = |of: &dyn Fn(usize) -> usize| (0..3).map(of).sum::<usize>();
            let bank = sum(&|axis| placement.block(axis, voxel[axis])) % 4;
            let row = sum(&|axis| placement.bank_term(axis, voxel[axis], 4)) / 512;
            if i == 1 {
                bursts += 1;
                met += u64::from(last.is_some_and(|(before, open)| before == bank && open != row));
            }
            last = Some((bank, row));
        }
        let seen = run(&machine, &setups);
        let frame = (seen.sent[3 * n * n - 1] - seen.sent[2 * n * n - 1]) as f64;
        let expected = (8 * bursts + 6 * met) as f64 * 976.0 / (976.0 - 15.0);
        assert!((frame / expected - 1.0).abs() < 0.002, "{direction:?}: {frame}, expected {expected}");
        // 1.02 ticks a word, the rows that are read twice, and the banks.
        let words = (n * n * n) as f64 / 4.0;
        let twice = 8.0 * bursts as f64 / words;
        assert!(frame / words < 1.02 * (twice + 6.0 * met as f64 / words), "{direction:?}: {}", frame / words);
    }
}

/// With room for what the frame needs, and modules that read at the rate of its need, no beam waits but the first; with half the room above
/// the least some do.
#[test]
fn the_steady_capacity_is_what_a_reader_of_one_rate_needs_and_no_more() {
    let n = 64;
    let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    for direction in [[0.3, 0.1, 1.0], [1.0, 0.9, 0.95], [-1.0, 0.9, -0.8], [0.2, 0.5, 1.0]] {
        let mut machine = four_sdrams();
        machine.cfb = Cfb { layout: Layout::MiniBlocks, look_ahead: Some(64), ..Cfb::default() };
        let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
        let setup = frame_setup(&scene, &machine, &volume, true).unwrap().setup;
        let need = ReorderNeed::new(&machine, &setup.geometry);
        machine.cfb.memory_clock_hz = Some((125e6 * (1.0002 * need.words as f64 / (n * n * n) as f64)).ceil());
        let setup = Arc::new(setup);
        let setups = vec![Arc::clone(&setup), Arc::clone(&setup), setup];
        let frame = |words: u64| {
            let mut machine = machine.clone();
            machine.cfb.reorder_words = Some(words);
            let seen = run(&machine, &setups);
            seen.sent[3 * n * n - 1] - seen.sent[2 * n * n - 1]
        };
        let least = (n * n * n / 4) as u64;
        assert_eq!(frame(need.steady), least, "{direction:?}");
        assert!(frame((need.least + need.steady) / 2) > least, "{direction:?}");
    }
}
