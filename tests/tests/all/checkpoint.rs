//! A run that is saved and resumed ends as one that was not interrupted, and nothing else is taken for a saved run.

use cube3_cases::cases;
use cube3_frame::FrameSetup;
use cube3_host::frame_setup;
use cube3_machine::{Frames, MachineSpec};
use cube3_pipeline::Fidelity;
use cube3_pipeline::Machine;
use cube3_pipeline::checkpoint::{CheckpointError, RunIdentity, restore, save};
use cube3_scene::Scene;
use cube3_tests::{SmallVolume, machines, scenes, volumes};
use proptest::prelude::*;
use proptest::sample::Index;
use sha2::{Digest, Sha256};

/// A machine, the frames it renders, and the words of its volume.
#[derive(Clone, Debug)]
struct Case {
    machine: MachineSpec,
    setups: Vec<FrameSetup>,
    volume: SmallVolume,
}

fn saved_runs() -> impl Strategy<Value = Case> {
    (machines(), proptest::collection::vec(scenes(), 1..3), volumes(6, 8), any::<bool>()).prop_map(
        |(machine, scenes, mut volume, overlap)| {
            let machine = MachineSpec { frames: Frames { overlap }, ..machine };
            volume.words.iter_mut().for_each(|word| *word >>= 8 - machine.words.voxel_bits.min(8));
            let setup = |scene: &Scene| frame_setup(scene, &machine, &volume.info(), true).unwrap().setup;
            let setups = scenes.iter().map(setup).collect();
            Case { machine, setups, volume }
        },
    )
}

impl Case {
    fn cycle(&self) -> Machine<cube3_pipeline::Cycle> {
        Machine::cycle(&self.machine, self.setups.clone(), self.volume.dims, &self.volume.words).unwrap()
    }

    fn timing(&self) -> Machine<cube3_pipeline::Timing> {
        Machine::timing(&self.machine, self.setups.clone()).unwrap()
    }

    fn identity(&self, fidelity: &str) -> RunIdentity {
        RunIdentity::new(fidelity, &self.machine, &self.setups, self.volume.dims, &self.volume.words)
    }
}

fn finish<F: Fidelity>(mut machine: Machine<F>) -> Machine<F> {
    machine.run(&|_, _| {}).unwrap();
    machine
}

/// Runs a new machine to each of some cycles, saves it, and goes on with another; the last one, not finished yet.
fn interrupted<F: Fidelity>(build: impl Fn() -> Machine<F>, identity: &RunIdentity, stops: &[u64]) -> Machine<F> {
    let mut machine = build();
    for &stop in stops {
        assert!(!machine.run_until(stop, &|_, _| {}).unwrap());
        let bytes = save(&mut machine, identity).unwrap();
        machine = build();
        restore(&bytes, &mut machine, identity).unwrap();
        assert_eq!(machine.now(), stop);
        assert_eq!(save(&mut machine, identity).unwrap(), bytes, "nothing is lost on the way");
    }
    machine
}

fn stops(cycles: u64, fractions: &[f64]) -> Vec<u64> {
    let mut stops: Vec<u64> = fractions.iter().map(|fraction| (fraction * cycles as f64) as u64).collect();
    stops.sort_unstable();
    stops
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn a_resumed_run_has_the_bits_and_counters_of_one_that_went_through(
        case in saved_runs(), fractions in proptest::collection::vec(0.0..1.0_f64, 1..4),
    ) {
        let through = finish(case.cycle());
        let stops = stops(through.counters().cycles, &fractions);
        let resumed = finish(interrupted(|| case.cycle(), &case.identity("cycle"), &stops));
        prop_assert_eq!(resumed.counters(), through.counters());
        prop_assert_eq!(resumed.overflows(), through.overflows());
        let timing = finish(interrupted(|| case.timing(), &case.identity("timing"), &stops));
        prop_assert_eq!(timing.counters(), through.counters());
        prop_assert_eq!(resumed.into_base_planes(), through.into_base_planes());
    }

    #[test]
    fn another_run_is_refused(case in saved_runs(), other in saved_runs(), fraction in 0.0..1.0_f64, word: Index) {
        let mut machine = case.timing();
        machine.run_until((200.0 * fraction) as u64, &|_, _| {}).unwrap();
        let identity = case.identity("timing");
        let bytes = save(&mut machine, &identity).unwrap();
        let differs = |other: &Case, fidelity: &str| match restore(&bytes, &mut other.timing(), &other.identity(fidelity)) {
            Err(CheckpointError::Other { what }) => what,
            result => panic!("{result:?}"),
        };
        prop_assert_eq!(differs(&case, "cycle"), "fidelity");
        let mut changed = case.clone();
        changed.machine.clock_hz *= 2.0;
        prop_assert_eq!(differs(&changed, "timing"), "machine");
        let mut changed = case.clone();
        *word.get_mut(&mut changed.volume.words) ^= 1;
        prop_assert_eq!(differs(&changed, "timing"), "volume");
        if other.setups != case.setups {
            let changed = Case { setups: other.setups, ..case };
            prop_assert_eq!(differs(&changed, "timing"), "scene or plan");
        }
    }

    #[test]
    fn damage_is_found(case in saved_runs(), fraction in 0.0..1.0_f64, place: Index, flip in 1_u8..=255, cut: Index, noise: Vec<u8>) {
        let mut machine = case.cycle();
        machine.run_until((200.0 * fraction) as u64, &|_, _| {}).unwrap();
        let identity = case.identity("cycle");
        let bytes = save(&mut machine, &identity).unwrap();
        let read = |bytes: &[u8]| restore(bytes, &mut case.cycle(), &identity);
        prop_assert!(read(&bytes).is_ok());
        prop_assert!(read(&bytes[..cut.index(bytes.len())]).is_err());
        prop_assert!(read(&[bytes.as_slice(), &[0]].concat()).is_err());
        prop_assert!(read(&noise).is_err());
        let mut damaged = bytes.clone();
        *place.get_mut(&mut damaged) ^= flip;
        prop_assert!(read(&damaged).is_err());
        // A state that was changed and signed again is taken or refused, and takes no memory that its bytes do not.
        let body = bytes.len() - 32;
        let start = 400.min(body - 1);
        damaged.clone_from(&bytes);
        damaged[start + place.index(body - start)] ^= flip;
        let digest = Sha256::digest(&damaged[..body]);
        damaged[body..].copy_from_slice(&digest);
        let _ = read(&damaged);
    }
}
