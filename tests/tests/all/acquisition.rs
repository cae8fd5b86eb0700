//! Volumes that come in while frames are read: what each frame saw is known to the voxel, rates have closed forms, and stolen
//! cycles are all that stealing costs.

use cube3_cases::cases;
use cube3_cfb::{AcquisitionPort, Piece, PortSpec};
use cube3_channel::Reason;
use cube3_frame::{BeamPlace, FrameSetup, Schedule};
use cube3_function::{CanonicalVolume, render};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::{Acquisition, AcquisitionMode, Frames, MachineSpec, RaySlots, Rays};
use cube3_pipeline::Machine;
use cube3_pipeline::acquisition::{Mixture, Sight};
use cube3_scene::{Scene, View};
use cube3_tests::{machines, scenes, volumes};
use proptest::prelude::*;

const MODES: [AcquisitionMode; 3] =
    [AcquisitionMode::DualPort, AcquisitionMode::CycleStealing, AcquisitionMode::DoubleBuffer];

fn modes() -> impl Strategy<Value = AcquisitionMode> {
    proptest::sample::select(MODES.to_vec())
}

fn port(machine: &Machine<impl cube3_pipeline::Fidelity>) -> &AcquisitionPort {
    machine.port().unwrap()
}

fn sights<'a>(
    machine: &MachineSpec,
    setups: &'a [FrameSetup],
    dims: [usize; 3],
    mut seen: &'a [u64],
) -> Vec<Sight<'a>> {
    let schedule = |geometry| Schedule::new(machine, geometry);
    setups.iter().map(|setup| Sight::next(&setup.geometry, schedule(&setup.geometry), dims, &mut seen)).collect()
}

/// Volumes of one grid whose words differ from each other's.
fn series(words: &[u16], bits: u32, count: u16) -> Vec<Vec<u16>> {
    let mask = ((1_u32 << bits) - 1) as u16;
    (0..count)
        .map(|j| words.iter().map(|word| word.wrapping_mul(2 * j + 1).wrapping_add(77 * j) & mask).collect())
        .collect()
}

/// A machine that never stalls, and a frame on it.
fn smooth(n: usize, slopes: [f64; 2], acquisition: Acquisition, overlap: bool) -> (MachineSpec, FrameSetup) {
    let machine = MachineSpec { lanes: n, acquisition, frames: Frames { overlap }, ..MachineSpec::default() };
    let scene = Scene { view: View::from_direction([slopes[0], slopes[1], 1.0], None), ..Scene::default() };
    let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let setup = frame_setup(&scene, &machine, &volume, true).unwrap().setup;
    (machine, setup)
}

proptest! {
    #![proptest_config(cases(400))]

    /// The oracle: a frame buffer that is really written while the machine reads it, against pictures of the volumes as they
    /// are put together from what each beam has seen.
    #[test]
    fn the_volume_as_the_machine_saw_it_is_assembled_to_the_bit(
        machine in machines(), views in proptest::collection::vec(scenes(), 1..4), volume in volumes(6, 16), mode in modes(),
        words_per_cycle in prop_oneof![0.05..1.0_f64, 1.0..20.0_f64], overlap: bool,
    ) {
        let acquisition = Acquisition { mode, words_per_cycle };
        let machine = MachineSpec { acquisition, frames: Frames { overlap }, ..machine };
        let setups: Vec<FrameSetup> =
            views.iter().map(|scene| frame_setup(scene, &machine, &volume.info(), true).unwrap().setup).collect();
        let spec = PortSpec::new(&machine, volume.dims, None);

        let mut timing = Machine::timing(&machine, setups.clone()).unwrap();
        timing.acquire(spec);
        timing.run(&|_, _| {}).unwrap();
        let started = port(&timing).written() / spec.voxels + 2;
        let series = series(&volume.words, machine.words.voxel_bits, started.min(400) as u16);
        prop_assume!(started <= 400);

        let mut cycle = Machine::cycle(&machine, setups.clone(), volume.dims, &series[0]).unwrap();
        cycle.acquire_volumes(spec, series[1..].to_vec());
        cycle.run(&|_, _| {}).unwrap();
        prop_assert_eq!(cycle.counters(), timing.counters());
        prop_assert_eq!(port(&cycle), port(&timing));

        let sights = sights(&machine, &setups, volume.dims, port(&timing).seen());
        let bases = cycle.into_base_planes();
        let mut newest = 0;
        for ((setup, sight), base) in setups.iter().zip(sights).zip(bases) {
            let mixture = sight.mixture();
            prop_assert_eq!(mixture.voxels, spec.voxels, "a frame reads every voxel once");
            prop_assert!(mixture.oldest + 1 >= newest && mixture.newer < mixture.voxels);
            prop_assert_eq!(mixture.first_torn_plane.is_some(), mixture.is_torn());
            prop_assert!(mixture.mixed_beams == 0 || mixture.is_torn());
            if mode == AcquisitionMode::DoubleBuffer {
                prop_assert!(!mixture.is_torn());
            }
            newest = mixture.newest;
            let shown: Vec<&[u16]> =
                (mixture.oldest..=mixture.newest).map(|j| series[j as usize].as_slice()).collect();
            let words = sight.assemble(mixture.oldest, &shown);
            let turned = CanonicalVolume::new(&setup.geometry.axes, volume.dims, &words);
            prop_assert_eq!(render(setup, &turned, true, &|_, _| {}).base, base);
        }
    }

    /// Two frames of one picture, beam by beam and voxel by voxel: voxel i of a beam that has seen W words is of volume ⌈(W − i)/voxels⌉.
    #[test]
    fn frames_of_one_picture_are_mixed_as_all_of_their_voxels_are(
        dims in [1_usize..6, 1_usize..6, 1_usize..6], slopes in [[0.0..=1.0_f64, 0.0..=1.0_f64], [0.0..=1.0_f64, 0.0..=1.0_f64]],
        steps in proptest::collection::vec(0_u64..9, 1000), start in [0_u64..400, 0_u64..400], still: bool, section in proptest::option::of(1_usize..7),
    ) {
        let machine = MachineSpec { rays: Rays { section, ..Rays::default() }, ..MachineSpec::default() };
        let info = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
        let setups: Vec<FrameSetup> = slopes.iter().map(|&[du, dv]| {
            let scene = Scene { view: View::from_direction([du, dv, 1.0], None), ..Scene::default() };
            frame_setup(&scene, &machine, &info, true).unwrap().setup
        }).collect();
        let voxels: usize = dims.iter().product();
        let (mut parts, mut counts, mut mixed_beams) = (Vec::new(), std::collections::BTreeMap::new(), 0);
        for (setup, start) in setups.iter().zip(start) {
            let geometry = &setup.geometry;
            let schedule = Schedule::new(&machine, geometry);
            let beams: Vec<(BeamPlace, Piece)> = cube3_cfb::scan(geometry, &schedule).collect();
            let mut seen = Vec::new();
            for &step in steps.iter().take(beams.len()) {
                seen.push(seen.last().map_or(start, |last| last + if still { 0 } else { step }));
            }
            for ((BeamPlace { depth, .. }, Piece { row, columns }), &seen) in beams.iter().zip(&seen) {
                let volumes: Vec<u64> = columns.iter().cloned().flatten().map(|u| {
                    let [x, y, z] = geometry.axes.voxel(geometry.size, [u, *row as usize, *depth as usize]);
                    (seen + (voxels - 1) as u64 - (x + dims[0] * (y + dims[1] * z)) as u64) / voxels as u64
                }).collect();
                mixed_beams += u64::from(volumes.iter().any(|volume| *volume != volumes[0]));
                volumes.into_iter().for_each(|volume| *counts.entry(volume).or_insert(0_u64) += 1);
            }
            parts.push(Sight::next(geometry, schedule, dims, &mut seen.as_slice()).mixture());
        }
        let picture = parts[0].and(parts[1]);
        let (oldest, of_oldest) = counts.first_key_value().unwrap();
        prop_assert_eq!((picture.oldest, picture.newest), (*oldest, *counts.last_key_value().unwrap().0));
        prop_assert_eq!(picture.voxels, counts.values().sum::<u64>());
        prop_assert_eq!((picture.newer, picture.mixed_beams), (picture.voxels - of_oldest, mixed_beams));
        prop_assert_eq!(picture.is_torn(), counts.len() > 1);
        if parts[0].is_torn() {
            prop_assert_eq!(picture.first_torn_plane, parts[0].first_torn_plane);
        }
    }

    #[test]
    fn words_come_in_at_their_rate_to_a_word(
        n in 4_usize..20, slopes in [0.0..=1.0_f64, 0.0..=1.0_f64], part in 0.01..1.5_f64, double: bool, overlap: bool,
    ) {
        let mode = if double { AcquisitionMode::DoubleBuffer } else { AcquisitionMode::DualPort };
        let acquisition = Acquisition { mode, words_per_cycle: part * n as f64 };
        let (machine, setup) = smooth(n, slopes, acquisition, overlap);
        let alone = { let mut run = Machine::timing(&machine, vec![setup.clone(); 3]).unwrap(); run.run(&|_, _| {}).unwrap(); run.counters() };
        let mut run = Machine::timing(&machine, vec![setup; 3]).unwrap();
        let spec = PortSpec::new(&machine, [n; 3], None);
        run.acquire(spec);
        run.run(&|_, _| {}).unwrap();
        prop_assert_eq!(run.counters(), alone, "reads do not notice");
        prop_assert_eq!(spec.words_per_cycle(), (part * n as f64).min(n as f64).mul_add((1_u64 << 40) as f64, 0.0).round() / (1_u64 << 40) as f64);
        let written = port(&run).written() as f64;
        let expected = spec.words_per_cycle() * run.counters().cycles as f64;
        if double {
            // Held back where a volume is complete and the frame is not.
            prop_assert!(written <= expected);
        } else {
            prop_assert!((expected - written).abs() < 1.0, "{} for {}", written, expected);
        }
    }

    #[test]
    fn a_stolen_cycle_costs_a_cycle_and_no_more(
        n in 4_usize..20, slopes in [0.0..=1.0_f64, 0.0..=1.0_f64], part in 0.01..1.5_f64, overlap: bool, frames in 1_usize..4,
    ) {
        let acquisition = Acquisition { mode: AcquisitionMode::CycleStealing, words_per_cycle: part * n as f64 };
        let (machine, setup) = smooth(n, slopes, acquisition, overlap);
        let mut alone = Machine::timing(&machine, vec![setup.clone(); frames]).unwrap();
        alone.run(&|_, _| {}).unwrap();
        let mut run = Machine::timing(&machine, vec![setup; frames]).unwrap();
        let spec = PortSpec::new(&machine, [n; 3], None);
        run.acquire(spec);
        run.run(&|_, _| {}).unwrap();
        let (counters, stolen) = (run.counters(), port(&run).stolen());
        prop_assert_eq!(counters.cycles, alone.counters().cycles + stolen);
        prop_assert_eq!(counters.units[0].1.waiting[Reason::Port as usize], stolen);
        prop_assert_eq!(counters.units[0].1.busy, alone.counters().units[0].1.busy);
        // A group is a whole row here, so every write is of n words, and one of each stolen cycle.
        let written = port(&run).written();
        prop_assert_eq!(written % n as u64, 0);
        prop_assert!(written >= stolen * n as u64);
        if part >= 1.0 {
            // A group is always due: writes and reads take turns.
            prop_assert_eq!(stolen, counters.units[0].1.busy);
        }
        if part < 0.5 {
            // Less than every second cycle: no write waits, and what has come in is in the modules but for a group.
            let arrived = spec.words_per_cycle() * counters.cycles as f64;
            prop_assert!(arrived - (written as f64) < n as f64 + 1.0, "{} of {}", written, arrived);
        }
    }

    #[test]
    fn double_buffering_shows_the_newest_whole_volume_and_never_tears(
        n in 4_usize..16, slopes in [0.0..=1.0_f64, 0.0..=1.0_f64], part in 0.05..1.5_f64, overlap: bool,
    ) {
        let acquisition = Acquisition { mode: AcquisitionMode::DoubleBuffer, words_per_cycle: part * n as f64 };
        let (machine, setup) = smooth(n, slopes, acquisition, overlap);
        let setups = vec![setup; 6];
        let mut run = Machine::timing(&machine, setups.clone()).unwrap();
        run.acquire(PortSpec::new(&machine, [n; 3], None));
        run.run(&|_, _| {}).unwrap();
        let seen = port(&run).seen();
        let mixtures = sights(&machine, &setups, [n; 3], seen).iter().map(Sight::mixture).collect::<Vec<_>>();
        prop_assert!(!mixtures.iter().any(Mixture::is_torn));
        let shown: Vec<u64> = mixtures.iter().map(|mixture| mixture.oldest).collect();
        prop_assert_eq!(shown[0], 0);
        prop_assert!(shown.is_sorted());
        if overlap {
            // The next frame is at the modules in the cycle behind the last beam: time for one change of roles.
            prop_assert!(shown.windows(2).all(|pair| pair[1] <= pair[0] + 1), "{:?}", shown);
        }
        if part >= 1.0 {
            prop_assert!((0..).zip(&shown).all(|(frame, &volume)| volume >= frame), "a port as fast as the reads keeps pace: {:?}", shown);
        }
    }
}

/// Two neighbours along x share a module of mini-blocks, which takes one in a cycle and the other in the next: a group is still `lanes` words.
/// In a stolen cycle the modules' time stands still, and the pipeline waits for them at the end of the cycle before.
#[test]
fn modules_of_mini_blocks_lose_the_stolen_cycles_and_no_more() {
    for (n, part) in [(16, 0.3), (16, 1.0), (24, 0.05)] {
        let mut machine = cube3_inputs::machine("em-cube").unwrap();
        let words_per_cycle = 4.0 * part;
        machine.acquisition = Acquisition { mode: AcquisitionMode::CycleStealing, words_per_cycle };
        let scene = Scene { view: View::from_direction([0.4, 0.3, 1.0], None), ..Scene::default() };
        let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
        let setup = frame_setup(&scene, &machine, &volume, true).unwrap().setup;
        let mut alone = Machine::timing(&machine, vec![setup.clone(); 2]).unwrap();
        alone.run(&|_, _| {}).unwrap();
        let mut run = Machine::timing(&machine, vec![setup; 2]).unwrap();
        let spec = PortSpec::new(&machine, [n; 3], None);
        assert!(spec.group == 4 && (spec.words_per_cycle() - words_per_cycle).abs() < 1e-9);
        run.acquire(spec);
        run.run(&|_, _| {}).unwrap();
        let stolen = port(&run).stolen();
        assert!(stolen > 0);
        assert_eq!(run.counters().cycles, alone.counters().cycles + stolen);
        assert_eq!(run.counters().units[0].1.busy, alone.counters().units[0].1.busy);
        assert_eq!(
            (run.counters().memory, run.counters().reorder),
            (alone.counters().memory, alone.counters().reorder)
        );
        assert!(port(&run).written() >= 4 * stolen);
    }
}

#[test]
fn a_port_as_fast_as_the_modules_writes_a_volume_in_the_cycles_of_its_words() {
    for (skew, lanes, group) in [([1, 1, 1], 8, 8), ([2, 1, 1], 8, 4), ([0, 1, 1], 8, 1), ([1, 1, 1], 5, 5)] {
        let mut machine = MachineSpec { lanes, ..MachineSpec::default() };
        machine.cfb.skew = skew;
        let spec = PortSpec::new(&machine, [8; 3], None);
        assert_eq!((spec.group, spec.words_per_cycle()), (group, group as f64), "{skew:?}");
    }
}

#[test]
fn a_source_that_stops_leaves_its_last_volume() {
    let acquisition = Acquisition { mode: AcquisitionMode::DualPort, words_per_cycle: 8.0 };
    let (machine, setup) = smooth(8, [0.3, 0.2], acquisition, true);
    let mut run = Machine::timing(&machine, vec![setup.clone(); 5]).unwrap();
    run.acquire(PortSpec::new(&machine, [8; 3], Some(2)));
    run.run(&|_, _| {}).unwrap();
    assert_eq!(port(&run).written(), 2 * 512);
    let setups = vec![setup; 5];
    let last = sights(&machine, &setups, [8; 3], port(&run).seen())[4].mixture();
    assert_eq!((last.oldest, last.newest, last.newer), (2, 2, 0));
}

/// Rays along +z read plane by plane of y, all z of each: the write in order of z crosses that.
#[test]
fn tearing_has_its_closed_form_when_a_volume_is_written_within_a_frame() {
    let n = 8_u64;
    let acquisition = Acquisition { mode: AcquisitionMode::DualPort, words_per_cycle: n as f64 };
    for slots in [RaySlots::Wrapped, RaySlots::Padded] {
        let (mut machine, _) = smooth(n as usize, [0.0, 0.0], acquisition, true);
        machine.rays = Rays { slots, ..Rays::default() };
        let scene = Scene { view: View::from_direction([0.0, 0.0, 1.0], None), ..Scene::default() };
        let info = VolumeInfo { dims: [n as usize; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
        let setup = frame_setup(&scene, &machine, &info, true).unwrap().setup;
        let mut run = Machine::timing(&machine, vec![setup.clone()]).unwrap();
        run.acquire(PortSpec::new(&machine, [n as usize; 3], None));
        run.run(&|_, _| {}).unwrap();
        // Ties go to y for u: a beam lies along y or x; row r of the volume is written in cycle r, beam b is read in cycle b.
        let (axes, size) = (setup.geometry.axes, setup.geometry.size);
        let mut newer = 0;
        let mut beam = 0;
        for v in 0..n as usize {
            for w in 0..n as usize {
                for u in 0..n as usize {
                    let [_, y, z] = axes.voxel(size, [u, v, w]);
                    newer += u64::from((y + n as usize * z) as u64 <= beam);
                }
                beam += 1;
            }
        }
        let mixture = Sight::next(
            &setup.geometry,
            Schedule::new(&machine, &setup.geometry),
            [n as usize; 3],
            &mut port(&run).seen(),
        )
        .mixture();
        assert_eq!((mixture.newer, mixture.oldest, mixture.newest), (newer, 0, 1), "{slots:?}");
        assert_eq!(mixture.first_torn_plane, Some(0));
    }
}
