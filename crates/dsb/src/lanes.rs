//! A whole beam on the bus, and a whole ray out of a plane.

use crate::golden::{beam_lane, slot};
use cube3_cfb::golden::output_lane;
use cube3_channel::{Archive, ArchiveError, Archived};
use cube3_frame::{BeamPlace, FrameShape, Geometry, Schedule};
use cube3_word::turn;
use std::ops::Range;

/// Turns beams from the frame buffer's lane order into the skewed buffers'.
#[derive(Clone, Copy, Debug)]
pub struct Rotator {
    /// Lanes of the machine.
    pub lanes: usize,
}

impl Rotator {
    /// Aligns a beam of row `v` at a depth. Slots without a voxel are 0.
    pub fn align(&self, geometry: &Geometry, v: usize, depth: usize, beam: &[u16], aligned: &mut Vec<u16>) {
        self.align_columns(geometry, v, depth, &[0..geometry.size[0], 0..0], beam, aligned);
    }

    /// The same for some voxels of the beam; slots of others are 0 or aligned as well.
    pub fn align_columns(
        &self,
        geometry: &Geometry,
        v: usize,
        depth: usize,
        columns: &[Range<usize>; 2],
        beam: &[u16],
        aligned: &mut Vec<u16>,
    ) {
        let [slots, _] = geometry.slot_counts();
        let n = self.lanes;
        if slots == n && geometry.size[0] == n {
            // A beam that fills the lanes is turned as a whole: see `rotation`.
            let mut by = geometry.u.columns[depth] as usize + v;
            while by >= n {
                by -= n;
            }
            aligned.resize(n, 0);
            turn(beam, if by == 0 { 0 } else { n - by }, aligned);
            return;
        }
        aligned.clear();
        aligned.resize(slots.div_ceil(self.lanes) * self.lanes, 0);
        for x in columns.iter().cloned().flatten() {
            let from = x / self.lanes * self.lanes + output_lane(self.lanes, [x, v, depth]);
            aligned[beam_lane(self.lanes, slot(geometry, x, depth), depth)] = beam[from];
        }
    }
}

impl Rotator {
    /// De-fans the beam of a perspective plane at a depth: each slot takes the voxel of its column. Where slots need their own cells,
    /// the beam has two rows, and four beams come out: columns L and R of the row, and of the row below. Slots without a voxel
    /// are 0.
    pub fn gather(&self, geometry: &Geometry, plane: usize, depth: usize, beam: &[u16], aligned: &mut Vec<u16>) {
        aligned.clear();
        let Some(pass) = &geometry.perspective else {
            return;
        };
        let width = geometry.size[0].div_ceil(self.lanes) * self.lanes;
        let slots = pass.u.count().div_ceil(self.lanes) * self.lanes;
        let rows = [geometry.row_at(pass.v.first + plane as i64, depth), geometry.row_below(plane, depth)];
        for (row, beam) in rows.into_iter().zip(beam.chunks(width)) {
            let columns = [pass.u.near_row(depth), pass.u.right_row(depth)];
            for columns in &columns[..if pass.doubled { 2 } else { 1 }] {
                let start = aligned.len();
                aligned.resize(start + slots, 0);
                let Some(row) = row else {
                    continue;
                };
                for (j, &x) in columns.iter().enumerate().filter(|(_, x)| (0..geometry.size[0] as i32).contains(x)) {
                    let x = x as usize;
                    let from = x / self.lanes * self.lanes + output_lane(self.lanes, [x, row, depth]);
                    aligned[start + beam_lane(self.lanes, j, depth)] = beam[from];
                }
            }
        }
    }
}

/// The skewed buffers' planes of voxels: a ring, and one more that keeps the first plane. Where slots need their own cells, a
/// plane holds four voxels for each slot and depth.
///
/// The words of a ray are kept side by side, in order of depth: a beam is spread, and a ray, which is read twice, is one piece. The word at
/// depth k is in lane `(j + k) mod lanes`, see [`ray_lane`](crate::golden::ray_lane).
#[derive(Clone, Debug)]
pub struct PlaneStore {
    /// The order of the beams: the ring holds planes of sections, one behind another.
    schedule: Schedule,
    ring: Vec<Vec<u16>>,
    first: Vec<u16>,
    /// A beam of zeros.
    zeros: Vec<u16>,
}

impl PlaneStore {
    /// `planes` buffers for a frame, and one for the first plane where the last needs it again. A buffer has a place for every slot, though
    /// the machine's has places for those of one section.
    pub fn new(schedule: Schedule, planes: usize) -> PlaneStore {
        let FrameShape { slots, lanes, closes: [_, closes], .. } = *schedule.shape();
        let words = slots * schedule.ray_words() * schedule.words_of_slot();
        let first = if closes { vec![0; words] } else { Vec::new() };
        let zeros = vec![0; schedule.words_of_slot() * slots.div_ceil(lanes) * lanes];
        PlaneStore { schedule, ring: vec![vec![0; words]; planes], first, zeros }
    }

    /// A plane of a section, counted over all of them.
    pub(crate) fn plane(&self, section: u32, plane: u32) -> usize {
        self.schedule.plane_number(section, plane) as usize
    }

    /// Writes what a section's slots have of an aligned beam; none writes zeros.
    pub fn write(&mut self, BeamPlace { section, plane, depth }: BeamPlace, beam: Option<&[u16]>) {
        let place = self.plane(section, plane) % self.ring.len();
        let beam = beam.unwrap_or(&self.zeros);
        let PlaneStore { schedule, ring, first, .. } = self;
        let (FrameShape { slots, lanes, .. }, copies) = (*schedule.shape(), schedule.words_of_slot());
        let depths = schedule.ray_words();
        let (sections, depth) = (schedule.sections(), depth as usize);
        let kept = (plane == 0 && !first.is_empty()).then_some(first);
        for plane in std::iter::once(&mut ring[place]).chain(kept) {
            if sections.is_whole() {
                put([lanes, slots, depths, copies], depth, beam, plane);
            } else {
                for j in sections.slots(section as usize) {
                    plane[j * depths + depth] = beam[beam_lane(lanes, j, depth)];
                }
            }
        }
    }

    /// Reads ray slot `j` of a plane, counted over all sections, in order of depth, filled up with zeros to whole chunks of lanes; `kept`
    /// reads the plane that was kept from the section's start.
    pub fn read(&self, plane: usize, kept: bool, j: usize, ray: &mut Vec<u16>) {
        ray.clear();
        self.read_copy(plane, kept, j, 0, ray);
    }

    /// Whether a slot has its own cell.
    pub(crate) fn has_cells(&self) -> bool {
        self.schedule.shape().doubled
    }

    /// Appends copy `copy` of ray slot `j`; see [`Rotator::gather`] for their order.
    pub(crate) fn read_copy(&self, plane: usize, kept: bool, j: usize, copy: usize, ray: &mut Vec<u16>) {
        let buffer = if kept { &self.first } else { &self.ring[plane % self.ring.len()] };
        let depths = self.schedule.ray_words();
        ray.extend_from_slice(&buffer[(copy * self.schedule.shape().slots + j) * depths..][..depths]);
    }
}

/// Writes the beams of a depth, those of all copies behind one another as the rays are.
fn put([lanes, slots, depths, copies]: [usize; 4], depth: usize, mut beams: &[u16], rays: &mut [u16]) {
    let start = if depth < lanes { depth } else { depth % lanes };
    for copy in 0..copies {
        let (mut first, all) = (copy * slots, (copy + 1) * slots);
        while first < all {
            let end = all.min(first + lanes);
            // Each ray has its word a lane behind that of the one before; the one behind the last lane is in the first.
            let turn = end.min(first + lanes - start);
            let (beam, behind) = beams.split_at(lanes);
            spread(&beam[start..], depth, depths, &mut rays[first * depths..turn * depths]);
            spread(&beam[..start], depth, depths, &mut rays[turn * depths..end * depths]);
            (first, beams) = (end, behind);
        }
    }
}

/// Writes a word at a depth of each ray.
#[inline]
fn spread(words: &[u16], depth: usize, depths: usize, rays: &mut [u16]) {
    let mut at = depth;
    for word in words {
        let Some(place) = rays.get_mut(at) else {
            return;
        };
        *place = *word;
        at += depths;
    }
}

impl Archived for PlaneStore {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let PlaneStore { schedule: _, ring, first, zeros: _ } = self;
        ring.iter_mut().try_for_each(|plane| archive.list(plane))?;
        archive.list(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::golden::{module, ray_lane, rotation};
    use cube3_cases::cases;
    use cube3_frame::{Axes, Geometry, largest_offset, slope_register};
    use cube3_machine::{RaySlots, TemplateRule};
    use proptest::prelude::*;

    fn geometry(size: [usize; 3], slopes: [f64; 2], padded: bool, reversed: [bool; 3]) -> Geometry {
        let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
        let rule = TemplateRule::SampleFloor;
        let slopes = slopes.map(slope_register);
        let offset = largest_offset(rule, slopes, 8).min(128);
        Geometry::new(size, Axes { axis: [0, 1, 2], reversed }, slopes, offset, 8, rule, slots)
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn a_word_is_in_its_module_in_a_beam_and_in_a_ray(lanes in 1_usize..40, slot in 0_usize..100, depth in 0_usize..100) {
            let module = module(lanes, slot, depth);
            prop_assert_eq!(beam_lane(lanes, slot, depth), slot / lanes * lanes + module);
            prop_assert_eq!(ray_lane(lanes, slot, depth), depth / lanes * lanes + module);
        }

        #[test]
        fn beams_are_written_and_rays_read_without_conflict(lanes in 1_usize..20, fixed in 0_usize..100, chunk in 0_usize..4) {
            let start = chunk * lanes;
            let mut written: Vec<usize> = (start..start + lanes).map(|j| module(lanes, j, fixed)).collect();
            let mut read: Vec<usize> = (start..start + lanes).map(|k| module(lanes, fixed, k)).collect();
            written.sort_unstable();
            read.sort_unstable();
            let all: Vec<usize> = (0..lanes).collect();
            prop_assert_eq!(&written, &all);
            prop_assert_eq!(&read, &all);
        }

        #[test]
        fn a_full_beam_is_turned_by_the_rotation_which_changes_by_two_at_most(
            n in 1_usize..12, du in 0.0..=1.0_f64, dv in 0.0..=1.0_f64, plane in 0_usize..12, reversed: [bool; 3],
        ) {
            let geometry = geometry([n; 3], [du, dv], false, reversed);
            let plane = plane % n;
            let rotator = Rotator { lanes: n };
            let mut aligned = Vec::new();
            for k in 0..n {
                let row = (plane + geometry.v.columns[k] as usize) % n;
                let beam: Vec<u16> = (0..n as u16).collect();
                rotator.align(&geometry, row, k, &beam, &mut aligned);
                let turned = rotation(&geometry, plane, k);
                for lane in 0..n {
                    prop_assert_eq!(aligned[(lane + turned) % n], beam[lane]);
                }
                if k > 0 {
                    let change = (rotation(&geometry, plane, k - 1) + n - turned) % n;
                    prop_assert!(change <= 2 || n <= 2);
                }
            }
        }

        #[test]
        fn each_ray_slot_comes_out_with_the_voxels_of_its_rays(
            size in [1_usize..8, 1_usize..8, 1_usize..8], du in 0.0..=1.0_f64, dv in 0.0..=1.0_f64, padded: bool, lanes in 1_usize..10, reversed: [bool; 3],
        ) {
            let geometry = geometry(size, [du, dv], padded, reversed);
            let [slots, planes] = geometry.slot_counts();
            let rotator = Rotator { lanes };
            let word = |x: usize, y: usize, k: usize| (1 + x + 10 * y + 100 * k) as u16;
            let mut store = PlaneStore::new(Schedule::of(&geometry, lanes, None), 2);
            let (mut beam, mut aligned, mut ray) = (Vec::new(), Vec::new(), Vec::new());
            for i in 0..planes {
                for k in 0..size[2] {
                    let v = geometry.ray_in_slot(i, 0, k).v;
                    let row = geometry.row_at(v, k);
                    if let Some(y) = row {
                        beam.clear();
                        beam.resize(size[0].div_ceil(lanes) * lanes, 0);
                        for x in 0..size[0] {
                            beam[x / lanes * lanes + output_lane(lanes, [x, y, k])] = word(x, y, k);
                        }
                        rotator.align(&geometry, y, k, &beam, &mut aligned);
                    }
                    let place = BeamPlace { section: 0, plane: i as u32, depth: k as u32 };
                    store.write(place, row.map(|_| aligned.as_slice()));
                }
                for j in 0..slots {
                    store.read(i, false, j, &mut ray);
                    for (k, read) in ray.iter().enumerate().take(size[2]) {
                        let owner = geometry.ray_in_slot(i, j, k);
                        let expected = match (geometry.column_at(owner.u, k), geometry.row_at(owner.v, k)) {
                            (Some(x), Some(y)) => word(x, y, k),
                            _ => 0,
                        };
                        prop_assert_eq!(*read, expected);
                    }
                }
            }
        }
    }
}
