//! Sections of ray slots: the picture is the same to the bit, a frame takes the cycles of its closed form, and planes on the chip are as
//! wide as a section.

use cube3::limits::frame_interval;
use cube3_cases::cases;
use cube3_frame::{FrameSetup, Schedule};
use cube3_function::{CanonicalVolume, render};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::{Abc, MachineSpec, RaySlots, Rays, Reuse, Trilin};
use cube3_pipeline::{Machine, RunCounters};
use cube3_resources::Overlap;
use cube3_resources::resources;
use cube3_scene::{Mode, Scene, View};
use cube3_tests::{SmallVolume, machines, scenes, volumes};
use proptest::prelude::*;
use std::collections::BTreeSet;

fn with_sections(machine: &MachineSpec, section: Option<usize>) -> MachineSpec {
    MachineSpec { rays: Rays { section, ..machine.rays }, ..machine.clone() }
}

fn case() -> impl Strategy<Value = (MachineSpec, Scene, SmallVolume)> {
    (machines(), scenes()).prop_flat_map(|(machine, scene)| {
        let bits = machine.words.voxel_bits;
        (Just(machine), Just(scene), volumes(9, bits))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(500) })]

    #[test]
    fn sections_change_no_bit((machine, scene, volume) in case(), section in 1_usize..20) {
        let setup = frame_setup(&scene, &machine, &volume.info(), true).unwrap().setup;
        let run = |section| {
            let machine = with_sections(&machine, section);
            let mut run = Machine::cycle(&machine, vec![setup.clone(); 2], volume.dims, &volume.words).unwrap();
            run.run(&|_, _| {}).unwrap();
            let (counters, overflows) = (run.counters(), run.overflows());
            (counters, overflows, run.into_base_planes())
        };
        let (counters, overflows, bases) = run(Some(section));
        let (whole, overflows_whole, bases_whole) = run(None);
        prop_assert_eq!(&bases, &bases_whole);
        prop_assert_eq!(overflows, overflows_whole);
        let turned = CanonicalVolume::new(&setup.geometry.axes, volume.dims, &volume.words);
        prop_assert_eq!(&render(&setup, &turned, true, &|_, _| {}).base, &bases[1]);
        // Every voxel goes over the bus once, and every ray and pixel through the pipeline.
        prop_assert_eq!(counters.bus.words, whole.bus.words);
        prop_assert_eq!((counters.ray_slots, counters.host), (whole.ray_slots, whole.host));
        let mut timing = Machine::timing(&with_sections(&machine, Some(section)), vec![setup; 2]).unwrap();
        timing.run(&|_, _| {}).unwrap();
        prop_assert_eq!(timing.counters(), counters);
    }

    /// What the closed forms count, ray by ray: those that a section's rays need of others, and the room for them.
    #[test]
    fn overlap_buffers_hold_what_sections_need_of_others(
        dims in [2_usize..14, 1_usize..6, 1_usize..6], slopes in [0.0..=1.0_f64, 0.0..=1.0_f64], padded: bool, section in 3_usize..20, lit: bool,
    ) {
        let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
        let machine = MachineSpec { rays: Rays { slots, section: Some(section), ..Rays::default() }, ..MachineSpec::default() };
        let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
        let view = View::from_direction([slopes[0], slopes[1], 1.0], None);
        let mode = if lit { Mode::Composite } else { Mode::Maximum };
        let setup = frame_setup(&Scene { view, mode, ..Scene::default() }, &machine, &volume, true).unwrap().setup;
        prop_assert_eq!(setup.gradient.is_some(), lit);
        let schedule = Schedule::new(&machine, &setup.geometry);
        let sections = *schedule.sections();
        let [slots, planes] = setup.geometry.slot_counts();
        let ([closes, shared], depths) = (setup.geometry.closes(), setup.geometry.size[2] as u64);
        let (several, last) = (sections.count() > 1, slots - 1);
        let besides = |j: usize, closes: bool| -> Vec<usize> {
            let right = if j < last { Some(j + 1) } else { closes.then_some(0) };
            right.into_iter().collect()
        };
        // Rays of voxels: slot j is finished by the next; one column a plane, the first plane's once more where planes are shared.
        let given = schedule.finished();
        let (mut needed_of_others, mut widest) = (0, 0);
        for section in 0..sections.count() {
            let needed = given.slots(section).flat_map(|j| [vec![j], besides(j, closes)].concat());
            let needed: BTreeSet<usize> = needed.filter(|j| !sections.slots(section).contains(j)).collect();
            needed_of_others += needed.len() as u64;
            widest = widest.max(sections.slots(section).len());
        }
        let rays = u64::from(several) * depths * ((1 + u64::from(closes)) * planes as u64 + u64::from(shared));
        let overlap = Overlap::new(&machine, &setup);
        prop_assert_eq!(overlap.rays, rays);
        // Each is written and read once, that of the first plane read again.
        let of_column = 2 * planes as u64 + u64::from(shared);
        prop_assert_eq!(overlap.rays_moved, depths * needed_of_others * of_column);
        prop_assert_eq!(schedule.voxel_slots(), widest as u64);
        prop_assert_eq!(schedule.sample_slots(), (0..given.count()).map(|s| given.slots(s).len()).max().unwrap() as u64);
        if !lit {
            prop_assert_eq!((overlap.samples, overlap.samples_moved), (0, 0));
            return Ok(());
        }
        // Rays of samples: slot j needs those beside it; what is shaded with a section is what its rays complete.
        let order: Vec<[u64; 2]> = setup.shading_order(&schedule).shaded().filter(|[plane, _]| *plane == 0).collect();
        let section_of = |j: usize| {
            let left = if j > 0 { j - 1 } else if closes { last } else { j };
            [vec![j, left], besides(j, closes)].concat().into_iter().map(|j| given.section(j)).max().unwrap()
        };
        prop_assert!(order.iter().map(|[_, slot]| section_of(*slot as usize)).is_sorted());
        let (mut loaded, mut room, mut firsts) = (0, 0, 0);
        for section in 0..given.count() {
            let shaded = (0..slots).filter(|&j| section_of(j) == section);
            let needed = shaded.flat_map(|j| {
                let left = if j > 0 { Some(j - 1) } else { closes.then_some(last) };
                [vec![j], left.into_iter().collect(), besides(j, closes)].concat()
            });
            let outside: BTreeSet<usize> = needed.filter(|j| !given.slots(section).contains(j)).collect();
            loaded += outside.len();
            let start = given.slots(section).start;
            firsts += outside.iter().filter(|&&j| j + 2 < start).count();
            room = room.max(given.slots(section).len() + outside.len());
        }
        prop_assert_eq!(schedule.neighbour_slots(), room as u64);
        // Sections of three slots and more keep two rays each for the next one; each is written once and read once.
        prop_assert_eq!(overlap.samples_moved, depths * planes as u64 * 2 * loaded as u64);
        prop_assert_eq!(overlap.samples, u64::from(several) * depths * planes as u64 * (2 + firsts as u64));
    }
}

fn cube(machine: &MachineSpec, n: usize, slopes: [f64; 2], mode: Mode) -> FrameSetup {
    let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let view = View::from_direction([slopes[0], slopes[1], 1.0], None);
    frame_setup(&Scene { view, mode, ..Scene::default() }, machine, &volume, true).unwrap().setup
}

/// A frame of n² rays takes more cycles than whole planes do for the rays that the first section cannot finish and the last one does: one of
/// each plane in TRILIN, one more in the ABC units where they wait for neighbours, and one more where slots are shared along u. Without a
/// gradient that is all; with one the ring of sample planes and the channels take up a part of it.
#[test]
fn a_frame_takes_its_rays_and_those_that_are_left_to_the_last_section() {
    for (n, lanes, section) in [(32, 4, 8), (32, 4, 16), (32, 8, 8), (24, 4, 12), (24, 2, 6)] {
        let machine = |planes| MachineSpec {
            lanes,
            rays: Rays { section: Some(section), ..Rays::default() },
            abc: Abc { planes, ..Abc::default() },
            ..MachineSpec::default()
        };
        let (square, beam) = ((n * n) as u64, (n / lanes) as u64);
        for slopes in [[0.0, 0.0], [0.0, 0.5], [0.5, 0.0], [0.6, 0.4]] {
            let interval =
                |machine: &MachineSpec, mode| frame_interval(machine, &[cube(machine, n, slopes, mode)]).unwrap();
            let whole = with_sections(&machine(4), None);
            assert_eq!(interval(&whole, Mode::Composite), beam * square);
            let label = format!("n = {n}, {lanes} lanes, {section}, {slopes:?}");
            assert_eq!(interval(&machine(4), Mode::Maximum), beam * (square + n as u64), "{label}");
            let setup = cube(&whole, n, slopes, Mode::Composite);
            let late = (2 + u64::from(setup.geometry.closes()[0])) * n as u64;
            for planes in [4, 5, 8] {
                let cycles = interval(&machine(planes), Mode::Composite);
                let most = beam * (square + late);
                // Each plane of the ring beyond three takes up its rays; the units and channels some more.
                let taken = (planes as u64 - 3) * section as u64 + 12;
                let least = beam * (square + late.saturating_sub(taken).max(n as u64));
                assert!((least..=most).contains(&cycles), "{label}, {planes} planes: {cycles}, {least} to {most}");
            }
        }
    }
}

fn timing(machine: &MachineSpec, setup: &FrameSetup) -> RunCounters {
    let mut run = Machine::timing(machine, vec![setup.clone()]).unwrap();
    run.run(&|_, _| {}).unwrap();
    run.counters()
}

/// A piece of S voxels takes ⌈S / lanes⌉ cycles, wherever it starts in its row.
#[test]
fn pieces_take_the_cycles_of_their_lanes() {
    for (n, lanes, section) in [(24, 4, 8), (24, 4, 9), (24, 4, 5), (24, 4, 1), (24, 6, 7), (24, 24, 8)] {
        let machine =
            MachineSpec { lanes, rays: Rays { section: Some(section), ..Rays::default() }, ..MachineSpec::default() };
        for slopes in [[0.0, 0.0], [0.7, 0.3]] {
            let counters = timing(&machine, &cube(&machine, n, slopes, Mode::Composite));
            let widths = (0..n).step_by(section).map(|first| section.min(n - first));
            let pieces = widths.clone().count() as u64;
            let cycles: u64 = widths.map(|width| width.div_ceil(lanes) as u64).sum();
            let beams = (n * n) as u64;
            assert_eq!(counters.beams, beams * pieces, "{n}, {lanes}, {section}, {slopes:?}");
            for (name, account) in counters.units.iter().take(3) {
                assert_eq!(account.busy, beams * cycles, "{name}: {n}, {lanes}, {section}, {slopes:?}");
            }
            assert_eq!(counters.bus.words, (n * n * n) as u64);
        }
    }
}

/// Padded slots beside the volume have no voxels: a piece without any takes a cycle, as a padded row without any does.
#[test]
fn padded_pieces_beside_the_volume_take_a_cycle() {
    let (n, lanes, section) = (24, 4, 8);
    let rays = Rays { slots: RaySlots::Padded, section: Some(section), ..Rays::default() };
    let machine = MachineSpec { lanes, rays, ..MachineSpec::default() };
    let setup = cube(&machine, n, [1.0, 0.0], Mode::Composite);
    let counters = timing(&machine, &setup);
    let [slots, planes] = setup.geometry.slot_counts();
    assert!(slots > n + section && planes == n);
    let (mut busy, mut beams) = (0, 0);
    for first in (0..slots).step_by(section) {
        for depth in 0..n {
            let slots = first..slots.min(first + section);
            let rays = slots.map(|j| setup.geometry.ray_in_slot(0, j, depth).u);
            let voxels = rays.filter(|&u| setup.geometry.column_at(u, depth).is_some()).count();
            beams += u64::from(voxels > 0);
            busy += voxels.div_ceil(lanes).max(1) as u64;
        }
    }
    assert_eq!((counters.beams, counters.units[0].1.busy), (beams * n as u64, busy * n as u64));
}

#[test]
fn planes_on_the_chip_are_as_wide_as_a_section() {
    let bits = |section, reuse, slopes| {
        let rays = Rays { section, ..Rays::default() };
        let machine = MachineSpec { lanes: 8, rays, trilin: Trilin { reuse }, ..MachineSpec::default() };
        let frames = [cube(&machine, 32, slopes, Mode::Composite)];
        let report = resources(&machine, [32; 3], &frames, &timing(&machine, &frames[0]), 1);
        let moved = report.interfaces.iter().find(|interface| interface.name == "overlap buffers").is_some();
        let names =
            ["skewed buffers", "lerps kept", "sample planes", "overlap buffers of rays", "overlap buffers of samples"];
        let of = |name| report.memory.iter().find(|memory| memory.what == name).map_or(0, |memory| memory.bits);
        (names.map(of), moved)
    };
    let tilted = [0.5, 0.25];
    // Three planes and two first ones; two rays, a first pair and a plane of lerps; four planes and two times two first ones.
    assert_eq!(bits(None, Reuse::Both, tilted), ([5 * 1024 * 16, (4 * 32 + 1024) * 16, 8 * 1024 * 16, 0, 0], false));
    // TRILIN's last section finishes a ray more; the ABC units' planes have it, the two rays before, and the first two.
    let kept = [(2 * 32 + 1) * 32 * 16, 4 * 32 * 32 * 16];
    let planes = [5 * 8 * 32 * 16, (4 * 32 + 9 * 32) * 16, 8 * 13 * 32 * 16];
    assert_eq!(bits(Some(8), Reuse::Both, tilted), ([planes[0], planes[1], planes[2], kept[0], kept[1]], true));
    // Along an axis no slots are shared: no first planes, no first rays.
    let straight = [3 * 8 * 32 * 16, (2 * 32 + 9 * 32) * 16, 4 * 11 * 32 * 16, 32 * 32 * 16, 2 * 32 * 32 * 16];
    assert_eq!(bits(Some(8), Reuse::Both, [0.0; 2]), (straight, true));
    assert_eq!(bits(Some(32), Reuse::Both, tilted), bits(None, Reuse::Both, tilted));
}
