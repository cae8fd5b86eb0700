//! Which samples of a parallel frame lie in the volume, for whole rays at once.

use crate::{DiscreteRay, Geometry};
use cube3_machine::RaySlots;
use cube3_word::{BLOCK_LANES, LaneBlock, block, vectorised};
use std::ops::Range;

/// For each depth the rays that have a sample in the volume, along u and along v: [`Geometry::has_sample`] of a parallel frame as two
/// comparisons an axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SampleBounds {
    /// For u and v: the first ray at depth k − 1, and one past the last; nothing before the first depth and behind the last, in whole blocks
    /// and one more.
    first: [Vec<i32>; 2],
    end: [Vec<i32>; 2],
}

impl SampleBounds {
    /// The bounds of a geometry; none in perspective.
    pub fn new(geometry: &Geometry) -> Option<SampleBounds> {
        if geometry.perspective.is_some() {
            return None;
        }
        let depths = geometry.size[2];
        let (mut first, mut end) = ([vec![0], vec![0]], [vec![0], vec![0]]);
        for (axis, template) in [&geometry.u, &geometry.v].into_iter().enumerate() {
            for k in 0..depths {
                let far = if geometry.offset == 0 { k } else { k + 1 };
                let reach = i32::from(template.weights[k] != 0);
                let there = far < depths;
                first[axis].push(if there { -(template.columns[k] as i32) } else { 0 });
                let last = geometry.size[axis] as i32 - reach - template.columns[far] as i32;
                end[axis].push(if there { last } else { 0 });
            }
            let room = depths.div_ceil(BLOCK_LANES) * BLOCK_LANES + BLOCK_LANES;
            first[axis].resize(room, 0);
            end[axis].resize(room, 0);
        }
        Some(SampleBounds { first, end })
    }
}

/// Places of [`SampleBounds::bits`]: by −1, 0 and 1 rays, for each of −1, 0 and 1 slices.
pub const BESIDE: usize = 9;

impl SampleBounds {
    /// Of the rays of a slot along an axis, one for each depth, those that are some rays and slices away and have a sample in the volume along
    /// this axis: for each [`BLOCK_LANES`] depths, and for each place `3 (slices + 1) + by + 1`, a bit for each depth, the first the lowest.
    pub fn bits(&self, axis: usize, rays: &[i32], out: &mut [[u16; BESIDE]]) {
        let (first, end) = (&self.first[axis], &self.end[axis]);
        for (word, out) in out.iter_mut().enumerate() {
            let from = word * BLOCK_LANES;
            vectorised(
                #[inline(always)]
                || {
                    let rays = block(rays, from);
                    let bounds =
                        |bounds: &[i32]| [block(bounds, from), block(bounds, from + 1), block(bounds, from + 2)];
                    inside(&rays, &bounds(first), &bounds(end), out);
                },
            );
        }
    }
}

/// The bits of a block for the rays by −1, 0 and 1, from the bounds of each of −1, 0 and 1 slices.
#[inline(always)]
fn inside(rays: &LaneBlock<i32>, first: &[LaneBlock<i32>; 3], end: &[LaneBlock<i32>; 3], out: &mut [u16; BESIDE]) {
    let mut bits = [[0; BLOCK_LANES]; BESIDE];
    for i in 0..BLOCK_LANES {
        for (place, bits) in bits.iter_mut().enumerate() {
            let (by, slices) = (place as i32 % 3 - 1, place / 3);
            let there = (rays[i] + by >= first[slices][i]) & (rays[i] + by < end[slices][i]);
            bits[i] = if there { 1_u32 << i } else { 0 };
        }
    }
    for (out, bits) in out.iter_mut().zip(&bits) {
        *out = bits.iter().fold(0, |word, bit| word | bit) as u16;
    }
}

impl Geometry {
    /// The rays of a slot of a parallel frame along an axis, 0 for u and 1 for v, by depth: [`Geometry::ray_in_slot`].
    pub fn rays_along(&self, axis: usize, slot: usize, rays: &mut Vec<i32>) {
        rays.clear();
        let (template, n, depths) = (if axis == 0 { &self.u } else { &self.v }, self.size[axis], self.size[2]);
        if self.slots == RaySlots::Padded {
            let shear = if axis == 0 { self.shear_u() } else { self.shear_v() };
            rays.resize(depths, slot as i32 - shear as i32);
            return;
        }
        // The next ray begins where the column has gone once more around.
        let (mut ray, mut turn, side) = (slot as i32, (n - slot) as u32, n as u32);
        rays.extend(template.columns[..depths].iter().map(|&column| {
            while column >= turn {
                turn += side;
                ray -= side as i32;
            }
            ray
        }));
    }
}

/// The rays of every slot of a frame, each with the depths at which the slot has it: [`Geometry::ray_in_slot`] in stretches.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RayStretches {
    u: Stretches,
    v: Stretches,
}

/// The rays of every slot along an axis.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Stretches {
    /// Rays, each with one past its last depth, those of a slot behind one another.
    rays: Vec<(i64, usize)>,
    /// Where those of each slot begin, and one past the last.
    starts: Vec<usize>,
}

impl Stretches {
    fn new(geometry: &Geometry, axis: usize) -> Stretches {
        let (template, side, depths) = ([&geometry.u, &geometry.v][axis], geometry.size[axis], geometry.size[2]);
        let slots = geometry.slot_counts()[axis];
        let (mut rays, mut starts) = (Vec::with_capacity(2 * slots), Vec::with_capacity(slots + 1));
        for slot in 0..slots {
            starts.push(rays.len());
            if geometry.perspective.is_some() || geometry.slots == RaySlots::Padded {
                let DiscreteRay { u, v } = geometry.ray_in_slot(slot, slot, 0);
                rays.push(([u, v][axis], depths));
                continue;
            }
            // The next ray begins where the column has gone once more around.
            let columns = &template.columns[..depths];
            let (mut ray, mut turn, mut end) = (slot as i64, side - slot, 0);
            while end < depths {
                while columns[end] as usize >= turn {
                    turn += side;
                    ray -= side as i64;
                }
                end = columns.partition_point(|&column| (column as usize) < turn);
                rays.push((ray, end));
            }
        }
        starts.push(rays.len());
        Stretches { rays, starts }
    }

    #[inline]
    fn of(&self, slot: usize) -> &[(i64, usize)] {
        &self.rays[self.starts[slot]..self.starts[slot + 1]]
    }
}

impl RayStretches {
    /// The stretches of a geometry.
    pub fn new(geometry: &Geometry) -> RayStretches {
        RayStretches { u: Stretches::new(geometry, 0), v: Stretches::new(geometry, 1) }
    }

    /// The rays of a slot in order of depth, each with its depths.
    #[inline]
    pub fn of(&self, plane: usize, slot: usize) -> impl Iterator<Item = (DiscreteRay, Range<usize>)> {
        let (mut u, mut v) = (self.u.of(slot), self.v.of(plane));
        let mut depth = 0;
        std::iter::from_fn(move || {
            let ([(ray_u, end_u), behind_u @ ..], [(ray_v, end_v), behind_v @ ..]) = (u, v) else {
                return None;
            };
            let end = *end_u.min(end_v);
            if *end_u == end {
                u = behind_u;
            }
            if *end_v == end {
                v = behind_v;
            }
            let depths = depth..end;
            depth = end;
            Some((DiscreteRay { u: *ray_u, v: *ray_v }, depths))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axes, largest_offset, slope_register};
    use cube3_cases::cases;
    use cube3_machine::TemplateRule;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn whole_rays_are_inside_where_each_sample_is(
            size in [1_usize..7, 1_usize..7, 1_usize..40], du in 0.0..=1.0_f64, dv in 0.0..=1.0_f64, part in 0_u32..3,
            plane_floor: bool, padded: bool, by in [-1_i64..2, -1_i64..2, -1_i64..2],
        ) {
            let rule = if plane_floor { TemplateRule::PlaneFloor } else { TemplateRule::SampleFloor };
            let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
            let slopes = [du, dv].map(slope_register);
            let offset = largest_offset(rule, slopes, 8) * part / 2;
            let axes = Axes { axis: [0, 1, 2], reversed: [false; 3] };
            let geometry = Geometry::new(size, axes, slopes, offset, 8, rule, slots);
            let bounds = SampleBounds::new(&geometry).unwrap();
            let stretches = RayStretches::new(&geometry);
            let [slots, planes] = geometry.slot_counts();
            for (plane, slot) in (0..planes).flat_map(|plane| (0..slots).map(move |slot| (plane, slot))) {
                let (mut us, mut vs) = (Vec::new(), Vec::new());
                geometry.rays_along(0, slot, &mut us);
                geometry.rays_along(1, plane, &mut vs);
                let words = size[2].div_ceil(BLOCK_LANES);
                let [mut in_u, mut in_v] = [(); 2].map(|()| vec![[0; BESIDE]; words]);
                bounds.bits(0, &us, &mut in_u);
                bounds.bits(1, &vs, &mut in_v);
                let inside = |bits: &[[u16; BESIDE]], axis: usize, k: usize| {
                    let place = (3 * (by[2] + 1) + by[axis] + 1) as usize;
                    bits[k / BLOCK_LANES][place] >> (k % BLOCK_LANES) & 1 != 0
                };
                let rays: Vec<_> = stretches.of(plane, slot).collect();
                let all: Vec<DiscreteRay> = rays.iter().flat_map(|(ray, depths)| depths.clone().map(|_| *ray)).collect();
                let expected: Vec<DiscreteRay> = (0..size[2]).map(|k| geometry.ray_in_slot(plane, slot, k)).collect();
                prop_assert_eq!(all, expected);
                prop_assert!(rays.iter().zip(&rays[1..]).all(|((ray, depths), (next, behind))| ray != next && depths.end == behind.start));
                for k in 0..size[2] {
                    let ray = geometry.ray_in_slot(plane, slot, k);
                    prop_assert_eq!([i64::from(us[k]), i64::from(vs[k])], [ray.u, ray.v]);
                    let beside = DiscreteRay { u: ray.u + by[0], v: ray.v + by[1] };
                    let expected = geometry.has_sample(beside, k as i64 + by[2]);
                    prop_assert_eq!(inside(&in_u, 0, k) && inside(&in_v, 1, k), expected);
                }
            }
        }
    }
}
