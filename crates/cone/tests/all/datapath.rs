//! Rays through the cone itself: each pixel of a frame is the golden reduction of its ray, however slots are shared.

use cube3_abc::golden::Shaded;
use cube3_abc::{ShadedRay, ShadedSamples};
use cube3_cases::cases;
use cube3_channel::Channel;
use cube3_cone::golden::{Node, leaf, pixel, reduce};
use cube3_cone::{ConeSpec, ConeUnit, PixelGroup, Pixels, Reducer};
use cube3_frame::{DiscreteRay, FrameSetup, Schedule};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::{Cone, ConeKind, MachineSpec, RaySlots, Rays, TemplateRule};
use cube3_scene::{Mode, Scene, View};
use cube3_word::{Rounding, Words, unit_full};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use std::collections::BTreeMap;

/// A sample of a place, from a seed: absent, transparent, full or anything.
fn sample(seed: u64, setup: &FrameSetup, ray: DiscreteRay, k: usize) -> Shaded {
    if !setup.geometry.has_sample(ray, k as i64) {
        return Shaded::default();
    }
    let place = (ray.u as u64) << 40 ^ (ray.v as u64 & 0xffff) << 20 ^ k as u64;
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(place);
    let random = generator.next_u64();
    let words = &setup.words;
    let opacity = match random >> 61 {
        0 => return Shaded { sample: 3, ..Shaded::default() },
        1 => 0,
        2 => unit_full(words.opacity_bits),
        _ => (random >> 40) as u32 & unit_full(words.opacity_bits),
    };
    let colour = |i: u32| (random >> (8 * i)) as u32 & unit_full(words.colour_bits);
    let colour = if opacity == 0 { [0; 3] } else { [colour(0), colour(1), colour(2)] };
    Shaded { present: true, sample: (random >> 33) as i32 & 7, opacity, colour }
}

/// The pixels of all rays that come through a frame, and saturated words.
fn expected(seed: u64, setup: &FrameSetup) -> (BTreeMap<DiscreteRay, [u32; 4]>, u64) {
    let geometry = &setup.geometry;
    let [width, height] = geometry.base_plane_size();
    let mut overflows = 0;
    let mut pixels = BTreeMap::new();
    for row in 0..height {
        for column in 0..width {
            let ray =
                DiscreteRay { u: column as i64 - geometry.shear_u() as i64, v: row as i64 - geometry.shear_v() as i64 };
            let leaves: Vec<Node> =
                (0..geometry.size[2]).map(|k| leaf(&sample(seed, setup, ray, k), &setup.cone, &setup.words)).collect();
            let counted = pixel(reduce(&leaves, &setup.cone, &setup.words), &setup.cone, &setup.words);
            overflows += u64::from(counted.overflows);
            pixels.insert(ray, counted.value);
        }
    }
    (pixels, overflows)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(800) })]

    #[test]
    fn every_pixel_has_the_golden_bits(
        dims in prop::array::uniform3(1_usize..9), long in 1_usize..45, axis in 0_usize..6, direction in prop::array::uniform3(prop_oneof![Just(1.0), Just(0.0), -1.0..1.0_f64]),
        padded: bool, plane_floor: bool, lanes in prop_oneof![1_usize..14, 14_usize..40], seed: u64, mode in 0_usize..6, kind in 0_usize..4,
        bits in (1_u32..=16, 1_u32..=16, 1_u32..=32), truncate: bool,
    ) {
        prop_assume!(direction.iter().any(|x| x.abs() > 0.01));
        // In half of the cases rays, or beams, of more than a block.
        let dims = [0, 1, 2].map(|i| if i == axis { long } else { dims[i] });
        let (colour_bits, opacity_bits, accumulator_bits) = bits;
        let rounding = if truncate { Rounding::Truncate } else { Rounding::Nearest };
        let words = Words { colour_bits, opacity_bits, accumulator_bits, rounding, table_bits: 1, ..Words::default() };
        let rays = Rays {
            slots: if padded { RaySlots::Padded } else { RaySlots::Wrapped },
            template: if plane_floor { TemplateRule::PlaneFloor } else { TemplateRule::SampleFloor },
            offset: 0.5, ..Rays::default() };
        let cone = Cone { kind: ConeKind::ALL[kind] };
        let machine = MachineSpec { words, rays, lanes, cone, ..MachineSpec::default() };
        let view = View::from_direction(direction, None);
        let scene = Scene { view, mode: Mode::ALL[mode], ..Scene::default() };
        let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
        let setup = frame_setup(&scene, &machine, &volume, true).unwrap().setup;
        let geometry = &setup.geometry;
        let depths = geometry.size[2];
        let (pixels, overflows) = expected(seed, &setup);

        let mut unit = ConeUnit::new(vec![ConeSpec::new(&machine, &Schedule::new(&machine, &setup.geometry))], Reducer::default());
        let mut shaded = Channel::<ShadedRay<ShadedSamples>>::new("shaded", 2, 1).unwrap();
        let mut out = Channel::<PixelGroup<Pixels>>::new("pixels", 2, 1).unwrap();
        let [slots, planes] = geometry.slot_counts();
        let (mut offered, mut taken) = (0, 0);
        let mut seen = BTreeMap::new();
        while taken < slots * planes {
            if offered < slots * planes && let Some(ray) = shaded.push_slot() {
                let (plane, slot) = (offered / slots, offered % slots);
                (ray.plane, ray.slot) = (plane as u32, slot as u32);
                let at = |k| sample(seed, &setup, geometry.ray_in_slot(plane, slot, k), k);
                let samples: Vec<Shaded> = (0..depths).map(at).collect();
                ray.data = ShadedSamples::new(&samples);
                offered += 1;
            }
            unit.tick(std::slice::from_ref(&setup), &mut shaded, &mut out);
            if let Some(group) = out.pop_slot() {
                let (plane, slot) = (taken / slots, taken % slots);
                prop_assert_eq!((group.plane as usize, group.slot as usize), (plane, slot));
                // Every ray of the slot once, in order of depth: three at most in a cube, where both axes are shared.
                let mut rays: Vec<DiscreteRay> = (0..depths).map(|k| geometry.ray_in_slot(plane, slot, k)).collect();
                rays.dedup();
                prop_assert_eq!(group.data.0.iter().map(|pixel| pixel.ray).collect::<Vec<_>>(), rays);
                let seams = geometry.shear_u().div_ceil(geometry.size[0]) + geometry.shear_v().div_ceil(geometry.size[1]);
                let most = if padded { 1 } else { 1 + seams };
                prop_assert!(group.data.0.len() <= most);
                for pixel in &group.data.0 {
                    prop_assert!(seen.insert(pixel.ray, pixel.rgba).is_none(), "{:?} twice", pixel.ray);
                }
                taken += 1;
            }
            shaded.commit();
            out.commit();
        }
        // A ray through no slot has no sample: its pixel is clear.
        for (ray, rgba) in &pixels {
            prop_assert_eq!(seen.get(ray).unwrap_or(&[0; 4]), rgba, "{:?}", ray);
        }
        prop_assert_eq!(unit.arithmetic().overflows(), overflows);
    }
}
