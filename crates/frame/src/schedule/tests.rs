//! The steps, counts and waits of the schedule are those of its definition, and that is said here a second time: by nested ranges, by walks
//! and by the samples of a frame.

use super::*;
use crate::perspective::tests::any_pass;
use crate::{Axes, largest_offset, slope_register};
use cube3_cases::cases;
use cube3_machine::{RaySlots, TemplateRule};
use proptest::prelude::*;
use std::collections::BTreeSet;

fn any_shape() -> impl Strategy<Value = FrameShape> {
    let counts = [1_usize..9, 1..7, 1..7, 1..9, 1..10];
    (counts, proptest::option::of(1_usize..11), any::<[bool; 2]>(), any::<bool>()).prop_map(
        |([slots, planes, depths, columns, lanes], section, closes, doubled)| FrameShape {
            slots,
            planes,
            depths,
            columns,
            closes,
            doubled,
            lanes,
            section,
        },
    )
}

fn any_geometry() -> impl Strategy<Value = Geometry> {
    ([1_usize..9, 1..9, 1..9], [0.0..=1.0_f64, 0.0..=1.0], any::<[bool; 3]>()).prop_map(
        |(size, slopes, [plane, padded, on_planes])| {
            let rule = if plane { TemplateRule::PlaneFloor } else { TemplateRule::SampleFloor };
            let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
            let slopes = slopes.map(slope_register);
            let offset = if on_planes { 0 } else { largest_offset(rule, slopes, 8).min(128) };
            let axes = Axes { axis: [0, 1, 2], reversed: [false; 3] };
            Geometry::new(size, axes, slopes, offset, 8, rule, slots)
        },
    )
}

/// The slots of each section, cut off one after another.
fn slots_of_sections(shape: &FrameShape) -> Vec<Vec<usize>> {
    let all: Vec<usize> = (0..shape.slots).collect();
    all.chunks(shape.section.unwrap_or(shape.slots)).map(<[usize]>::to_vec).collect()
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn beams_are_those_of_sections_planes_and_depths_and_a_step_leads_from_each_to_the_next(shape in any_shape()) {
        let schedule = Schedule::of_shape(shape);
        let mut beams = Vec::new();
        for section in 0..slots_of_sections(&shape).len() as u32 {
            for plane in 0..shape.planes as u32 {
                beams.extend((0..shape.depths as u32).map(|depth| BeamPlace { section, plane, depth }));
            }
        }
        prop_assert_eq!(&schedule.beams().collect::<Vec<_>>(), &beams);
        prop_assert_eq!(schedule.planes_of_frame() * shape.depths as u64, beams.len() as u64);
        prop_assert!(beams.is_sorted());
        let mut place = BeamPlace::default();
        for (number, beam) in beams.iter().enumerate() {
            prop_assert_eq!(place, *beam);
            let plane = schedule.plane_number(place.section, place.plane);
            prop_assert_eq!(plane, (number / shape.depths) as u64);
            prop_assert_eq!(schedule.next_beam(&mut place), number + 1 == beams.len());
        }
        prop_assert_eq!(place, BeamPlace::default());
        prop_assert_eq!(schedule.planes_of_frame(), (beams.len() / shape.depths) as u64);
    }

    #[test]
    fn rays_are_those_of_sections_planes_and_slots_and_a_step_leads_from_each_to_the_next(shape in any_shape()) {
        let schedule = Schedule::of_shape(shape);
        let mut rays = Vec::new();
        for (section, slots) in (0..).zip(slots_of_sections(&shape)) {
            for plane in 0..shape.planes as u32 {
                rays.extend(slots.iter().map(|&slot| RayPlace { section, plane, slot: slot as u32 }));
            }
        }
        prop_assert_eq!(&schedule.rays().collect::<Vec<_>>(), &rays);
        prop_assert_eq!(schedule.ray_slots(), rays.len() as u64);
        let mut place = RayPlace::default();
        for (number, ray) in rays.iter().enumerate() {
            prop_assert_eq!(place, *ray);
            prop_assert_eq!(schedule.next_ray(&mut place), number + 1 == rays.len());
        }
        prop_assert_eq!(place, RayPlace::default());
    }

    /// TRILIN finishes a ray with the next of its plane, and the last of a plane with itself.
    #[test]
    fn a_ray_is_finished_in_the_section_of_the_next(shape in any_shape()) {
        let schedule = Schedule::of_shape(shape);
        let finished: Vec<RayPlace> = schedule.finished_rays().collect();
        let section_of = |slot: u32| schedule.rays().find(|ray| ray.slot == slot).map(|ray| ray.section);
        let last = shape.slots as u32 - 1;
        prop_assert!(finished.iter().all(|ray| Some(ray.section) == section_of((ray.slot + 1).min(last))));
        prop_assert!(finished.is_sorted());
        let places: BTreeSet<[u32; 2]> = finished.iter().map(|ray| [ray.plane, ray.slot]).collect();
        prop_assert_eq!([finished.len(), places.len()], [shape.slots * shape.planes; 2]);
    }

    /// A ray is read with the plane below its own: of its section all of that plane's beams are there, and of those before.
    #[test]
    fn a_ray_is_read_when_its_plane_and_the_one_below_are_there(shape in any_shape()) {
        let schedule = Schedule::of_shape(shape);
        for RayPlace { section, plane, .. } in schedule.rays() {
            let below = (plane + 1 < shape.planes as u32).then_some(plane + 1);
            let needed = [plane, below.unwrap_or(plane)];
            let last = schedule.beams().filter(|beam| beam.section == section && needed.contains(&beam.plane)).max();
            let beams = schedule.beams().filter(|beam| Some(*beam) <= last).count();
            prop_assert_eq!(schedule.planes_read(section, plane) * shape.depths as u64, beams as u64);
            prop_assert_eq!(schedule.is_last_plane(plane), below.is_none());
            prop_assert_eq!(schedule.below(plane), below.or(shape.closes[1].then_some(0)));
        }
    }

    #[test]
    fn a_frame_has_what_its_geometry_says(geometry in any_geometry(), lanes in 1_usize..10, section in 1_usize..11) {
        let schedule = Schedule::of(&geometry, lanes, Some(section));
        let [slots, planes] = geometry.slot_counts();
        let voxels: usize = geometry.size.iter().product();
        let places = schedule.rays().flat_map(|ray| (0..geometry.size[2]).map(move |k| (ray, k)));
        let in_volume = places.filter(|&(RayPlace { plane, slot, .. }, k)| {
            let ray = geometry.ray_in_slot(plane as usize, slot as usize, k);
            geometry.column_at(ray.u, k).is_some() && geometry.row_at(ray.v, k).is_some()
        });
        prop_assert_eq!(in_volume.count(), voxels);
        prop_assert_eq!(schedule.sections().count(), slots.div_ceil(section));
        prop_assert_eq!(schedule.planes_of_frame(), (slots.div_ceil(section) * planes) as u64);
        // Lanes take as many words a cycle as they are.
        let taken = |words: usize| (0..words).step_by(lanes).count() as u64;
        prop_assert_eq!(schedule.row_cycles(), taken(geometry.size[0]));
        prop_assert_eq!(schedule.aligned_cycles(), taken(geometry.size[0]));
        prop_assert_eq!(schedule.ray_cycles(), taken(geometry.size[2]));
        prop_assert_eq!(schedule.piece_cycles(section as u32), taken(section));
        prop_assert_eq!((schedule.rows_of_beam(), schedule.words_of_slot()), (1, 1));
    }

    #[test]
    fn a_frame_in_perspective_is_taken_whole(geometry in any_pass(), section in 1_usize..11) {
        let schedule = Schedule::of(&geometry, 1, Some(section));
        prop_assert!(schedule.sections().is_whole());
        prop_assert_eq!(schedule.sections().slots(0), 0..geometry.slot_counts()[0]);
        prop_assert_eq!(schedule.shape().doubled, geometry.doubled());
    }

    #[test]
    fn slots_with_cells_of_their_own_have_four_words_of_two_rows(shape in any_shape()) {
        let schedule = Schedule::of_shape(FrameShape { doubled: true, ..shape });
        prop_assert_eq!((schedule.rows_of_beam(), schedule.words_of_slot()), (2, 4));
        prop_assert_eq!(schedule.aligned_words(), shape.slots);
        prop_assert_eq!(schedule.aligned_cycles(), (0..shape.slots).step_by(shape.lanes).count() as u64);
    }

    /// Bands have each row once, and the samples of a row are at the depths that they say.
    #[test]
    fn bands_have_every_row_and_its_samples(geometry in prop_oneof![any_geometry(), any_pass()], pieces in 1_usize..40) {
        let bands = Schedule::of(&geometry, 1, None).bands(&geometry, pieces);
        let [_, rows] = geometry.base_plane_size();
        let first = geometry.first_ray().v;
        let all: Vec<i64> = (0..rows.div_ceil(bands.height())).flat_map(|number| bands.band(number)).collect();
        prop_assert_eq!(all, (first..first + rows as i64).collect::<Vec<_>>());
        prop_assert_eq!(bands.rows(), rows);
        prop_assert_eq!(bands.depths(), 0..geometry.size[2]);
        for v in first - 2..first + rows as i64 + 2 {
            let with_samples: Vec<usize> = bands.depths().filter(|&k| !geometry.valid_columns(v, k).is_empty()).collect();
            let sampled = bands.sampled_in(&geometry, v);
            prop_assert!(with_samples.iter().all(|k| sampled.contains(k) && bands.sampled().contains(k)));
            let ends = [sampled.clone().next(), sampled.last()];
            prop_assert_eq!([with_samples.first(), with_samples.last()].map(Option::<&usize>::copied), ends);
        }
    }
}

/// The order in which rays are shaded, of frames of every small shape, taken whole and in sections.
fn all_orders() -> impl Iterator<Item = (FrameShape, usize, bool, ShadingOrder)> {
    let closes = [[false, false], [false, true], [true, false], [true, true]];
    let sizes = (1..=6).flat_map(|slots| (1..=6).map(move |planes| (slots, planes)));
    let shapes = sizes.flat_map(move |size| closes.map(|closes| (size, closes)));
    shapes.flat_map(|((slots, planes), closes)| {
        let kinds = [false, true].into_iter().flat_map(move |buffered| (1..=slots).map(move |width| (buffered, width)));
        kinds.flat_map(move |(buffered, width)| {
            let shape = FrameShape {
                slots,
                planes,
                depths: 1,
                columns: 1,
                closes,
                doubled: false,
                lanes: 1,
                section: Some(width),
            };
            // Farther neighbours than the next are those of frames that share no slots.
            let most = if closes == [false; 2] { 3 } else { 1 };
            (1..=most)
                .map(move |reach| (shape, reach, buffered, Schedule::of_shape(shape).shading_order(reach, buffered)))
        })
    })
}

/// Slots that are read for slot or plane `i` of `n`: those `reach` away and nearer.
fn beside(i: usize, n: usize, closes: bool, reach: usize) -> Vec<usize> {
    if closes {
        return vec![(i + n - 1) % n, i, (i + 1) % n];
    }
    (i.saturating_sub(reach)..=(i + reach).min(n - 1)).collect()
}

#[test]
fn every_slot_is_shaded_once() {
    for (shape, _, _, order) in all_orders() {
        let slots: Vec<[u64; 2]> = order.shaded().collect();
        let places: BTreeSet<[u64; 2]> = slots.iter().copied().collect();
        let all = (0..shape.planes).flat_map(|plane| (0..shape.slots).map(move |slot| [plane as u64, slot as u64]));
        assert_eq!(places, all.collect(), "{shape:?}");
        assert_eq!(slots.len(), places.len(), "{shape:?}");
    }
}

#[test]
fn a_slot_needs_its_neighbours_and_nothing_that_comes_after_them() {
    for (shape, reach, buffered, order) in all_orders() {
        let came: Vec<RayPlace> = Schedule::of_shape(shape).finished_rays().collect();
        let number =
            |at: [usize; 2]| came.iter().position(|ray| [ray.plane, ray.slot].map(|i| i as usize) == at).unwrap();
        for [plane, slot] in order.shaded() {
            let [i, j] = [plane as usize, slot as usize];
            let (planes, slots) = if buffered {
                (beside(i, shape.planes, shape.closes[1], reach), beside(j, shape.slots, shape.closes[0], reach))
            } else {
                (vec![i], vec![j])
            };
            let last = planes.into_iter().flat_map(|i| slots.iter().map(move |&j| number([i, j]))).max().unwrap();
            let label = format!("{shape:?}, reach {reach}, plane {plane}, slot {slot}");
            assert_eq!(order.needed(plane, slot), last as u64 + 1, "{label}");
            let plane_of = |ray: RayPlace| ray.section as usize * shape.planes + i;
            assert_eq!(order.plane_of_shaded(i, j), plane_of(came[last]), "{label}");
            assert_eq!(order.plane_of_ray(i, j), plane_of(came[number([i, j])]), "{label}");
        }
    }
}

/// Of what is left to shade some slot reads the oldest plane, and none an older one. The first two planes are kept beside the ring where
/// planes are shared.
#[test]
fn the_oldest_plane_is_the_one_above_what_is_left_to_shade() {
    for (shape, reach, buffered, order) in all_orders() {
        let last_first = usize::from(buffered && shape.closes[1]);
        let counted: Vec<usize> = (last_first..shape.planes).chain(0..last_first).collect();
        for plane in 0..shape.planes {
            let oldest = |&left: &usize| match (buffered, left) {
                (false, _) => left,
                (true, 0) if shape.closes[1] => shape.planes - 1,
                (true, _) => left.saturating_sub(reach),
            };
            let oldest = counted[plane..].iter().map(oldest).min().unwrap();
            assert_eq!(order.oldest(plane as u64), oldest as u64, "{shape:?}, {reach}, {buffered}, {plane}");
        }
    }
}

/// What a section needs of the slots before it is what the rays that are shaded with it read, and what is kept is enough for it.
#[test]
fn a_section_needs_of_others_what_its_rays_read() {
    for (shape, _, _, order) in all_orders().filter(|(_, reach, buffered, _)| *buffered && *reach == 1) {
        let section_of = |j: usize| {
            let last = |j: &usize| order.sections().section(*j);
            beside(j, shape.slots, shape.closes[0], 1).iter().map(last).max().unwrap()
        };
        for section in 0..order.sections().count() {
            let slots = order.sections().slots(section);
            let shaded = (0..shape.slots).filter(|&j| section_of(j) == section);
            let read = shaded.flat_map(|j| beside(j, shape.slots, shape.closes[0], 1));
            let read: BTreeSet<usize> = read.filter(|j| !slots.contains(j)).collect();
            let needed: BTreeSet<usize> = order.needed_before(section).into_iter().flatten().collect();
            assert!(read.is_subset(&needed), "{shape:?}, section {section}: {read:?}, {needed:?}");
            assert!(shape.section.unwrap() < 3 || read == needed, "{shape:?}, section {section}: {read:?}, {needed:?}");
            let [border, firsts] = order.needed_before(section);
            let kept: BTreeSet<usize> = (0..section).flat_map(|before| order.kept(before)).collect();
            assert!(border.clone().all(|j| kept.contains(&j)), "{shape:?}, section {section}");
            assert!(firsts.end <= ShadingOrder::BORDER.min(border.start));
        }
    }
}
