//! Rays through the interpolators: every sample of a frame has the golden bits, whatever is kept and however slots are shared,
//! and the lerps are the multipliers that the level of reuse promises.

use cube3_cases::cases;
use cube3_channel::Channel;
use cube3_dsb::{RayPair, RayVoxels};
use cube3_frame::{DiscreteRay, FrameSetup, Geometry, Schedule};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::{MachineSpec, RaySlots, Rays, Reuse, TemplateRule, Trilin};
use cube3_scene::{Scene, View};
use cube3_trilin::golden::{Weights, cell, lift};
use cube3_trilin::{Interpolator, RaySamples, SampleRay, TrilinUnit};
use cube3_word::{Rounding, Words};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

fn machine(words: Words, padded: bool, plane_floor: bool, offset: f64, lanes: usize) -> MachineSpec {
    let rays = Rays {
        slots: if padded { RaySlots::Padded } else { RaySlots::Wrapped },
        template: if plane_floor { TemplateRule::PlaneFloor } else { TemplateRule::SampleFloor },
        offset,
        ..Rays::default()
    };
    let machine = MachineSpec { words, rays, lanes, ..MachineSpec::default() };
    machine.check("machine").unwrap();
    machine
}

fn setup(machine: &MachineSpec, dims: [usize; 3], direction: [f64; 3], reuse: Reuse) -> FrameSetup {
    let machine = MachineSpec { trilin: Trilin { reuse }, ..machine.clone() };
    let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
    let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
    frame_setup(&scene, &machine, &volume, true).unwrap().setup
}

/// The voxel of a ray at a depth, 0 outside of the volume.
fn voxel_of(geometry: &Geometry, ray: DiscreteRay, k: usize, voxel: &impl Fn([usize; 3]) -> u16) -> u16 {
    if k >= geometry.size[2] {
        return 0;
    }
    match (geometry.column_at(ray.u, k), geometry.row_at(ray.v, k)) {
        (Some(x), Some(y)) => voxel([x, y, k]),
        _ => 0,
    }
}

/// A slot of a plane in order of depth, as the skewed buffers give it; a plane beyond the last is the first where slots
/// are shared, and nothing where they are not.
fn ray(setup: &FrameSetup, lanes: usize, plane: usize, slot: usize, voxel: &impl Fn([usize; 3]) -> u16) -> Vec<u16> {
    let geometry = &setup.geometry;
    let [_, planes] = geometry.slot_counts();
    let mut words = vec![0; geometry.size[2].div_ceil(lanes) * lanes];
    let plane = if plane == planes && geometry.closes()[1] { 0 } else { plane };
    if plane < planes {
        for (k, word) in words.iter_mut().enumerate().take(geometry.size[2]) {
            let owner = geometry.ray_in_slot(plane, slot, k);
            *word = voxel_of(geometry, owner, k, voxel);
        }
    }
    words
}

/// What the definition says of a slot.
fn expected(setup: &FrameSetup, plane: usize, slot: usize, voxel: &impl Fn([usize; 3]) -> u16) -> Vec<Option<i32>> {
    let geometry = &setup.geometry;
    let mut samples = vec![None; geometry.size[2]];
    for (k, sample) in samples.iter_mut().enumerate() {
        let owner = geometry.ray_in_slot(plane, slot, k);
        if geometry.has_sample(owner, k as i64) {
            let corners = [0, 1].map(|w: usize| {
                [0, 1].map(|v| {
                    [0, 1].map(|u| {
                        let corner = DiscreteRay { u: owner.u + u, v: owner.v + v };
                        lift(voxel_of(geometry, corner, k + w, voxel), &setup.words)
                    })
                })
            });
            let weights = Weights { w: geometry.offset, u: geometry.u.weights[k], v: geometry.v.weights[k] };
            *sample = Some(cell(corners, weights, &setup.words));
        }
    }
    samples
}

/// A frame through the unit; `each` sees every ray of samples. Returns the lerps of whole rays.
fn run(
    setup: &FrameSetup,
    lanes: usize,
    voxel: &impl Fn([usize; 3]) -> u16,
    mut each: impl FnMut(&SampleRay<RaySamples>),
) -> u64 {
    let machine = MachineSpec { lanes, ..MachineSpec::default() };
    let schedule = Schedule::new(&machine, &setup.geometry);
    let mut unit = TrilinUnit::new([(schedule, Interpolator::new(setup, schedule))]);
    let mut rays = Channel::<RayPair<RayVoxels>>::new("rays", 2, 1).unwrap();
    let mut samples = Channel::<SampleRay<RaySamples>>::new("samples", 2, 1).unwrap();
    let [slots, planes] = setup.geometry.slot_counts();
    let (mut offered, mut given, mut cycle) = (0, 0, 0);
    while given < slots * planes {
        if offered < slots * planes
            && let Some(pair) = rays.push_slot()
        {
            let (plane, slot) = (offered / slots, offered % slots);
            (pair.plane, pair.slot) = (plane as u32, slot as u32);
            pair.data.current = ray(setup, lanes, plane, slot, voxel);
            pair.data.below = ray(setup, lanes, plane + 1, slot, voxel);
            offered += 1;
        }
        unit.tick(std::slice::from_ref(setup), &mut rays, &mut samples);
        if let Some(ray) = samples.pop_slot() {
            assert_eq!((ray.plane as usize, ray.slot as usize), (given / slots, given % slots));
            each(ray);
            given += 1;
        }
        rays.commit();
        samples.commit();
        cycle += 1;
        assert!(cycle < 100_000, "stuck");
    }
    assert!(unit.done());
    unit.arithmetic().map(Interpolator::ray_lerps).sum()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(1500) })]

    #[test]
    fn every_sample_has_the_golden_bits_whatever_is_kept(
        dims in prop::array::uniform3(1_usize..8), long in 1_usize..40, longest in 0_usize..6,
        slopes in prop::array::uniform2(prop_oneof![Just(0.0), Just(1.0), 0.0..1.0_f64]),
        axis in 0_usize..3, signs: [bool; 3],
        bits in (1_u32..=16, 0_u32..=8, 0_u32..=12), truncate: bool, padded: bool, plane_floor: bool,
        offset in prop_oneof![Just(0.0), Just(0.5), 0.0..1.0_f64], lanes in prop_oneof![1_usize..12, 12_usize..40], seed: u64,
    ) {
        // In half of the cases one side of more than a block.
        let dims = [0, 1, 2].map(|i| if i == longest { long } else { dims[i] });
        let rounding = if truncate { Rounding::Truncate } else { Rounding::Nearest };
        let (voxel_bits, sample_fraction_bits, weight_bits) = bits;
        let words = Words {
            voxel_bits, sample_fraction_bits, weight_bits, rounding, gradient_bits: 2, table_bits: 1, ..Words::default()
        };
        let machine = machine(words, padded, plane_floor, offset, lanes);
        let mut direction = [0.0; 3];
        direction[axis] = 1.0;
        direction[(axis + 1) % 3] = slopes[0];
        direction[(axis + 2) % 3] = slopes[1];
        let direction = [0, 1, 2].map(|i| if signs[i] { -direction[i] } else { direction[i] });
        for reuse in Reuse::ALL {
            let setup = setup(&machine, dims, direction, reuse);
            let [columns, rows, planes] = setup.geometry.size;
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let voxels: Vec<u16> =
                (0..columns * rows * planes).map(|_| (random.next_u32() >> (32 - voxel_bits)) as u16).collect();
            let voxel = |[x, y, k]: [usize; 3]| voxels[x + columns * (y + rows * k)];
            let lerps = run(&setup, lanes, &voxel, |ray| {
                let expected = expected(&setup, ray.plane as usize, ray.slot as usize, &voxel);
                assert_eq!(ray.data, RaySamples::new(&expected), "{reuse:?}, plane {}, slot {}", ray.plane, ray.slot);
            });
            prop_assert_eq!(lerps, lerps_of_a_frame(reuse, setup.geometry.slot_counts()));
        }
    }
}

/// Lerps of whole rays in a frame: the multipliers of the level for each ray slot, and the first plane's, which has none above
/// it whose results are kept: where planes are kept, its own lerp along u and what that needs along w, two rays or, where
/// rays are kept too, one.
fn lerps_of_a_frame(reuse: Reuse, [slots, planes]: [usize; 2]) -> u64 {
    let start = match reuse {
        Reuse::None | Reuse::Ray => 0,
        Reuse::Plane => 3,
        Reuse::Both => 2,
    };
    (slots * planes) as u64 * u64::from(reuse.lerps()) + slots as u64 * start
}

/// With slopes and offset in sixteenths, weights are exact in 8 bits; with 8 fraction bits in the sample, so is every lerp of
/// a field with whole steps.
#[test]
fn affine_volumes_come_out_to_the_bit() {
    let words = Words { weight_bits: 8, sample_fraction_bits: 8, ..Words::default() };
    let mut samples = 0;
    for (du, dv) in [(0, 0), (3, 0), (7, 2), (12, 12), (16, 5), (16, 16)] {
        for (plane_floor, offset) in [(false, 0.0), (false, 0.25), (true, 0.5), (true, 0.9375)] {
            for padded in [false, true] {
                let machine = machine(words, padded, plane_floor, offset, 5);
                let direction = [f64::from(du) / 16.0, f64::from(dv) / 16.0, 1.0];
                let setup = setup(&machine, [9, 8, 10], direction, Reuse::Both);
                let geometry = &setup.geometry;
                let field = |p: [f64; 3]| 3000.0 + 37.0 * p[0] - 111.0 * p[1] + 5.0 * p[2];
                let voxel = |p: [usize; 3]| field(p.map(|i| i as f64)) as u16;
                run(&setup, 5, &voxel, |ray| {
                    for k in 0..geometry.size[2] {
                        if let Some(sample) = ray.data.at(k) {
                            let owner = geometry.ray_in_slot(ray.plane as usize, ray.slot as usize, k);
                            let exact = field(geometry.sample_position(owner, k));
                            assert_eq!(f64::from(sample) / 256.0, exact, "{owner:?}, {k}");
                            samples += 1;
                        }
                    }
                });
            }
        }
    }
    assert!(samples > 10_000, "{samples}");
}

#[test]
fn all_levels_of_reuse_cost_what_they_say() {
    let levels = Reuse::ALL.map(|reuse| lerps_of_a_frame(reuse, [128, 128]) as f64 / (128.0 * 128.0));
    assert_eq!(levels, [7.0, 5.0, 4.0 + 3.0 / 128.0, 3.0 + 2.0 / 128.0]);
}
