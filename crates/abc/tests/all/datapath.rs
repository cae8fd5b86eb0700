//! Rays through the unit itself, with its ring of planes: every sample has the golden bits, however slots are shared.

use crate::registers::{Dice, hosted_frame};
use cube3_abc::golden::{Neighbourhood, Shaded, shade};
use cube3_abc::{AbcSpec, AbcUnit, ShadedRay, ShadedSamples, Shader};
use cube3_cases::cases;
use cube3_channel::Channel;
use cube3_frame::{DiscreteRay, FrameSetup, Geometry, Schedule};
use cube3_machine::MachineSpec;
use cube3_trilin::{RaySamples, SampleRay};
use cube3_word::unit_full;
use proptest::prelude::*;

/// A sample word for each place, from a seed; large flat regions with noise on some of them.
fn sample(seed: u64, ray: DiscreteRay, k: i64, bits: u32) -> i32 {
    let place = (ray.u as u64) << 40 ^ (ray.v as u64 & 0xffff) << 20 ^ k as u64;
    let mut dice = Dice::at(seed, place);
    dice.word(0, unit_full(bits)) as i32
}

/// The samples around one, beyond the volume the border, straight from the geometry.
fn neighbourhood(seed: u64, setup: &FrameSetup, ray: DiscreteRay, k: i64) -> Neighbourhood {
    let border = setup.gradient.map_or(0, |registers| registers.border);
    [-1, 0, 1].map(|c| {
        [-1, 0, 1].map(|b| {
            [-1, 0, 1].map(|a| {
                let beside = DiscreteRay { u: ray.u + a, v: ray.v + b };
                if setup.geometry.has_sample(beside, k + c) {
                    sample(seed, beside, k + c, setup.words.sample_bits())
                } else {
                    border
                }
            })
        })
    })
}

/// A slot as the interpolators send it.
fn fill(seed: u64, setup: &FrameSetup, plane: usize, slot: usize, data: &mut RaySamples) {
    let depths = setup.geometry.size[2];
    let at = |k: usize| {
        let ray = setup.geometry.ray_in_slot(plane, slot, k);
        let there = setup.geometry.has_sample(ray, k as i64);
        there.then(|| sample(seed, ray, k as i64, setup.words.sample_bits()))
    };
    *data = RaySamples::new(&(0..depths).map(at).collect::<Vec<_>>());
}

fn assert_slot(seed: u64, setup: &FrameSetup, ray: &ShadedRay<ShadedSamples>) -> u64 {
    let geometry: &Geometry = &setup.geometry;
    let (plane, slot) = (ray.plane as usize, ray.slot as usize);
    let mut expected = vec![Shaded::default(); geometry.size[2]];
    let mut overflows = 0;
    for (k, expected) in expected.iter_mut().enumerate() {
        let owner = geometry.ray_in_slot(plane, slot, k);
        if geometry.has_sample(owner, k as i64) {
            let around = neighbourhood(seed, setup, owner, k as i64);
            let counted = shade(&around, [owner.u, owner.v, k as i64], setup);
            overflows += u64::from(counted.overflows);
            if counted.value.present {
                *expected = counted.value;
            }
        }
    }
    assert_eq!(ray.data, ShadedSamples::new(&expected), "plane {plane}, slot {slot}, {:?}", geometry.size);
    overflows
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(1500) })]

    #[test]
    fn a_frame_through_the_unit_has_the_golden_bits(seed: u64, lanes in 1_usize..12, skip: bool, slow in 1_u64..4) {
        let mut dice = Dice::new(seed);
        let mut setup = hosted_frame(&mut dice);
        if let Some(registers) = &mut setup.gradient {
            registers.border = dice.word(0, unit_full(setup.words.sample_bits())) as i32;
        }
        let machine = MachineSpec { lanes, ..MachineSpec::default() };
        let schedule = Schedule::new(&machine, &setup.geometry);
        let spec = AbcSpec::new(&machine, &setup, &schedule);
        let mut unit = AbcUnit::new([(spec, Shader::new(&setup, &schedule, machine.abc.planes, skip))]);
        let mut samples = Channel::<SampleRay<RaySamples>>::new("samples", 2, 1).unwrap();
        let mut shaded = Channel::<ShadedRay<ShadedSamples>>::new("shaded", 2, 1).unwrap();
        let (slots, total) = (schedule.shape().slots as u64, schedule.ray_slots());
        let (mut offered, mut given, mut overflows, mut cycle) = (0, 0, 0, 0_u64);
        while given < total {
            if offered < total && let Some(ray) = samples.push_slot() {
                let (plane, slot) = ((offered / slots) as usize, (offered % slots) as usize);
                (ray.plane, ray.slot) = (plane as u32, slot as u32);
                fill(seed, &setup, plane, slot, &mut ray.data);
                offered += 1;
            }
            unit.tick(std::slice::from_ref(&setup), &mut samples, &mut shaded);
            if cycle.is_multiple_of(slow) && let Some(ray) = shaded.pop_slot() {
                overflows += assert_slot(seed, &setup, ray);
                given += 1;
            }
            samples.commit();
            shaded.commit();
            cycle += 1;
            prop_assert!(cycle < 100_000, "stuck");
        }
        prop_assert!(unit.done());
        prop_assert_eq!(unit.arithmetic().map(Shader::overflows).sum::<u64>(), overflows);
    }
}
