//! Which samples of a parallel frame lie in the volume, for whole rays at once.

use crate::{Geometry, RaySlots, Template};
use cube3_word::BLOCK;

/// For each depth the rays that have a sample in the volume, along u and along v: [`Geometry::has_sample`] of a parallel frame as two
/// comparisons an axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SampleBounds {
    /// For u and v: the first ray at depth k − 1, and one past the last; nothing before the first depth and behind the last.
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
            first[axis].push(0);
            end[axis].push(0);
        }
        Some(SampleBounds { first, end })
    }
}

/// Places of [`SampleBounds::bits`]: by −1, 0 and 1 rays, for each of −1, 0 and 1 slices.
pub const BESIDE: usize = 9;

impl SampleBounds {
    /// Of the rays of a slot along an axis, one for each depth, those that are some rays and slices away and have a sample in the volume along
    /// this axis: a bit for each depth in words of [`BLOCK`] bits, the first depth the lowest; words `p · ⌈depths / BLOCK⌉` on are those of place `p = 3 (slices + 1) + by + 1`.
    pub fn bits(&self, axis: usize, rays: &[i32], out: &mut [u16]) {
        let words = rays.len().div_ceil(BLOCK);
        for (place, out) in out.chunks_mut(words).enumerate().take(BESIDE) {
            let (by, slices) = (place as i32 % 3 - 1, place as i32 / 3 - 1);
            for (first, (rays, out)) in rays.chunks(BLOCK).zip(out).enumerate() {
                let start = first * BLOCK + (1 + slices) as usize;
                let (first, end) = (&self.first[axis][start..][..rays.len()], &self.end[axis][start..][..rays.len()]);
                *out = (0..rays.len())
                    .map(|i| u16::from((rays[i] + by >= first[i]) & (rays[i] + by < end[i])) << i)
                    .fold(0, |word, bit| word | bit);
            }
        }
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

impl Geometry {
    /// One past the last depth at which a slot has the ray that it has at depth `k`.
    pub fn ray_end(&self, plane: usize, slot: usize, k: usize) -> usize {
        let depths = self.size[2];
        if self.perspective.is_some() || self.slots == RaySlots::Padded {
            return depths;
        }
        let end = |template: &Template, slot: usize, n: usize| {
            let column = template.columns[k] as usize;
            let mut turn = n - slot;
            while column >= turn {
                turn += n;
            }
            template.first_depth(turn as i64)
        };
        depths.min(end(&self.u, slot, self.size[0])).min(end(&self.v, plane, self.size[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axes, DiscreteRay, TemplateRule, largest_offset, slope_register};
    use proptest::prelude::*;

    proptest! {
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
            let [slots, planes] = geometry.slot_counts();
            for (plane, slot) in (0..planes).flat_map(|plane| (0..slots).map(move |slot| (plane, slot))) {
                let (mut us, mut vs) = (Vec::new(), Vec::new());
                geometry.rays_along(0, slot, &mut us);
                geometry.rays_along(1, plane, &mut vs);
                let words = size[2].div_ceil(BLOCK);
                let [mut in_u, mut in_v] = [(); 2].map(|()| vec![0; BESIDE * words]);
                bounds.bits(0, &us, &mut in_u);
                bounds.bits(1, &vs, &mut in_v);
                let inside = |bits: &[u16], axis: usize, k: usize| {
                    let place = (3 * (by[2] + 1) + by[axis] + 1) as usize;
                    bits[place * words + k / BLOCK] >> (k % BLOCK) & 1 != 0
                };
                for k in 0..size[2] {
                    let ray = geometry.ray_in_slot(plane, slot, k);
                    let same = (k..size[2]).take_while(|&k| geometry.ray_in_slot(plane, slot, k) == ray).count();
                    prop_assert_eq!(geometry.ray_end(plane, slot, k), k + same);
                    prop_assert_eq!([i64::from(us[k]), i64::from(vs[k])], [ray.u, ray.v]);
                    let beside = DiscreteRay { u: ray.u + by[0], v: ray.v + by[1] };
                    let expected = geometry.has_sample(beside, k as i64 + by[2]);
                    prop_assert_eq!(inside(&in_u, 0, k) && inside(&in_v, 1, k), expected);
                }
            }
        }
    }
}
