//! The geometry of a parallel frame: discrete rays, ray slots, and which samples lie in the volume.

use crate::{Axes, SLOPE_FRACTION_BITS, Template, TemplateRule};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// How rays of a tilted view share the machine's ray slots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RaySlots {
    /// Rays u and u − n, which together have n voxels, share one slot; planes v and v − n likewise.
    #[default]
    Wrapped,
    /// Each ray and each plane has its own slot: up to four times as many.
    Padded,
}

/// The geometry registers of a parallel frame, in canonical coordinates.
///
/// Sample k of ray (u, v) is at `(u + (k+o)·du, v + (k+o)·dv, k+o)`. Rays are numbered as their base-plane pixel:
/// u from `−X(n_w−1)` to `n_u − 1`.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Geometry {
    /// n_u, n_v, n_w.
    pub size: [usize; 3],
    /// The voxel axes behind u, v, w.
    pub axes: Axes,
    /// du and dv, fractions of [`SLOPE_FRACTION_BITS`].
    pub slopes: [u32; 2],
    /// The sample offset o, a fraction of `weight_bits`, below 1.
    pub offset: u32,
    /// Fraction bits of the offset and the weights.
    pub weight_bits: u32,
    /// The rule of the templates.
    pub rule: TemplateRule,
    /// How rays share slots.
    pub slots: RaySlots,
    /// Columns and weights along u.
    pub u: Template,
    /// Rows and weights along v.
    pub v: Template,
}

/// A discrete ray, by its base-plane pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct DiscreteRay {
    /// Column of the pixel, −X(n_w−1) to n_u − 1.
    pub u: i64,
    /// Row of the pixel, −Y(n_w−1) to n_v − 1.
    pub v: i64,
}

impl Geometry {
    /// Makes the templates. `slopes` and `offset` are register values, the offset legal for the rule.
    pub fn new(
        size: [usize; 3],
        axes: Axes,
        slopes: [u32; 2],
        offset: u32,
        weight_bits: u32,
        rule: TemplateRule,
        slots: RaySlots,
    ) -> Geometry {
        let template = |slope| Template::new(rule, slope, offset, weight_bits, size[2]);
        let (u, v) = (template(slopes[0]), template(slopes[1]));
        Geometry { size, axes, slopes, offset, weight_bits, rule, slots, u, v }
    }

    /// Voxels along x, y, z.
    pub fn dims(&self) -> [usize; 3] {
        let mut dims = [0; 3];
        for i in 0..3 {
            dims[self.axes.axis[i]] = self.size[i];
        }
        dims
    }

    /// du and dv as reals, exactly what the registers hold.
    pub fn real_slopes(&self) -> [f64; 2] {
        self.slopes.map(|slope| f64::from(slope) / f64::from(1_u32 << SLOPE_FRACTION_BITS))
    }

    /// The offset o as a real, exactly what the register holds.
    pub fn real_offset(&self) -> f64 {
        f64::from(self.offset) / f64::from(1_u32 << self.weight_bits)
    }

    /// The position of sample `k` of a ray, in canonical voxels.
    pub fn sample_position(&self, ray: DiscreteRay, k: usize) -> [f64; 3] {
        let [du, dv] = self.real_slopes();
        let depth = k as f64 + self.real_offset();
        [ray.u as f64 + depth * du, ray.v as f64 + depth * dv, depth]
    }

    /// X(n_w − 1): how far the discrete rays move along u. Rays start at minus this.
    pub fn shear_u(&self) -> usize {
        self.u.columns[self.size[2] - 1] as usize
    }

    /// Y(n_w − 1): how far the discrete rays move along v.
    pub fn shear_v(&self) -> usize {
        self.v.columns[self.size[2] - 1] as usize
    }

    /// Width and height of the base plane in pixels: every ray that meets a voxel.
    pub fn base_plane_size(&self) -> [usize; 2] {
        [self.size[0] + self.shear_u(), self.size[1] + self.shear_v()]
    }

    /// The pixel of the base plane, column and row from 0, that belongs to a ray.
    pub fn pixel(&self, ray: DiscreteRay) -> [usize; 2] {
        [(ray.u + self.shear_u() as i64) as usize, (ray.v + self.shear_v() as i64) as usize]
    }

    /// Ray slots in a plane, and planes in a frame.
    pub fn slot_counts(&self) -> [usize; 2] {
        match self.slots {
            RaySlots::Wrapped => [self.size[0], self.size[1]],
            RaySlots::Padded => self.base_plane_size(),
        }
    }

    /// Whether slots are shared along u and along v, so that the last slot's neighbour is the first.
    pub fn closes(&self) -> [bool; 2] {
        let wrapped = self.slots == RaySlots::Wrapped;
        [wrapped && self.shear_u() > 0, wrapped && self.shear_v() > 0]
    }

    /// The ray whose voxel is in slot `j` (of plane `i`) at depth `k`.
    pub fn ray_in_slot(&self, i: usize, j: usize, k: usize) -> DiscreteRay {
        DiscreteRay {
            u: self.ray_in(j, self.size[0], self.u.columns[k], self.shear_u()),
            v: self.ray_in(i, self.size[1], self.v.columns[k], self.shear_v()),
        }
    }

    fn ray_in(&self, slot: usize, n: usize, column: u32, shear: usize) -> i64 {
        match self.slots {
            RaySlots::Wrapped => slot as i64 - ((slot + column as usize) / n * n) as i64,
            RaySlots::Padded => slot as i64 - shear as i64,
        }
    }

    /// The slot (plane, slot) of a ray.
    pub fn slot_of(&self, ray: DiscreteRay) -> [usize; 2] {
        match self.slots {
            RaySlots::Wrapped => {
                [ray.v.rem_euclid(self.size[1] as i64) as usize, ray.u.rem_euclid(self.size[0] as i64) as usize]
            }
            RaySlots::Padded => {
                let [column, row] = self.pixel(ray);
                [row, column]
            }
        }
    }

    /// The voxel of ray `u` (one axis) at depth `k`: its column, where it is in the volume.
    pub fn column_at(&self, u: i64, k: usize) -> Option<usize> {
        let x = u + i64::from(self.u.columns[k]);
        (0..self.size[0] as i64).contains(&x).then_some(x as usize)
    }

    /// The voxel of plane `v` (one axis) at depth `k`: its row, where it is in the volume.
    pub fn row_at(&self, v: i64, k: usize) -> Option<usize> {
        let y = v + i64::from(self.v.columns[k]);
        (0..self.size[1] as i64).contains(&y).then_some(y as usize)
    }

    /// Whether sample `k` of a ray lies in the volume: every voxel that it gives a weight to is there.
    ///
    /// A lerp needs its near operand always and its far one unless the weight is 0. `k` may be any depth.
    pub fn has_sample(&self, ray: DiscreteRay, k: i64) -> bool {
        if k < 0 || k >= self.size[2] as i64 {
            return false;
        }
        let valid = self.valid_columns(ray.v, k as usize);
        valid.contains(&ray.u)
    }

    /// The rays u of plane `v` that have a sample at depth `k`, a range that may be empty.
    pub fn valid_columns(&self, v: i64, k: usize) -> Range<i64> {
        let far = if self.offset == 0 { k } else { k + 1 };
        if far >= self.size[2] {
            return 0..0;
        }
        let reach_v = i64::from(self.v.weights[k] != 0);
        let near_row = v + i64::from(self.v.columns[k]);
        let far_row = v + i64::from(self.v.columns[far]);
        if near_row < 0 || far_row + reach_v >= self.size[1] as i64 {
            return 0..0;
        }
        let reach_u = i64::from(self.u.weights[k] != 0);
        let first = -i64::from(self.u.columns[k]);
        let end = self.size[0] as i64 - reach_u - i64::from(self.u.columns[far]);
        first..end.max(first)
    }

    /// All samples of the frame.
    pub fn sample_count(&self) -> u64 {
        let [_, rows] = self.base_plane_size();
        let first = -(self.shear_v() as i64);
        (first..first + rows as i64)
            .flat_map(|v| (0..self.size[2]).map(move |k| (v, k)))
            .map(|(v, k)| {
                let valid = self.valid_columns(v, k);
                (valid.end - valid.start) as u64
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{largest_offset, slope_register};
    use proptest::prelude::*;

    pub(crate) fn geometry(size: [usize; 3], slopes: [f64; 2], rule: TemplateRule, slots: RaySlots) -> Geometry {
        let registers = slopes.map(slope_register);
        let offset = largest_offset(rule, registers, 8).min(128);
        let axes = Axes { axis: [0, 1, 2], reversed: [false; 3] };
        Geometry::new(size, axes, registers, offset, 8, rule, slots)
    }

    fn any_geometry() -> impl Strategy<Value = Geometry> {
        (1_usize..9, 1_usize..9, 1_usize..9, 0.0..=1.0_f64, 0.0..=1.0_f64, any::<bool>(), any::<bool>()).prop_map(
            |(nu, nv, nw, du, dv, plane, padded)| {
                let rule = if plane { TemplateRule::PlaneFloor } else { TemplateRule::SampleFloor };
                let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
                geometry([nu, nv, nw], [du, dv], rule, slots)
            },
        )
    }

    proptest! {
        #[test]
        fn slots_and_rays_agree(geometry in any_geometry()) {
            let [slots, planes] = geometry.slot_counts();
            let mut voxels = 0;
            for k in 0..geometry.size[2] {
                for i in 0..planes {
                    for j in 0..slots {
                        let ray = geometry.ray_in_slot(i, j, k);
                        let inside = geometry.column_at(ray.u, k).is_some() && geometry.row_at(ray.v, k).is_some();
                        if inside {
                            prop_assert_eq!(geometry.slot_of(ray), [i, j]);
                            voxels += 1;
                        }
                        prop_assert!(inside || geometry.slots == RaySlots::Padded);
                    }
                }
            }
            prop_assert_eq!(voxels, geometry.size.iter().product::<usize>());
        }

        #[test]
        fn a_sample_is_valid_where_every_weighted_voxel_is_in_the_volume(geometry in any_geometry()) {
            let [width, height] = geometry.base_plane_size();
            let mut count = 0;
            for row in 0..height {
                for column in 0..width {
                    let ray = DiscreteRay {
                        u: column as i64 - geometry.shear_u() as i64,
                        v: row as i64 - geometry.shear_v() as i64,
                    };
                    for k in 0..geometry.size[2] {
                        let mut all = true;
                        for (dk, weighted_k) in [(0, true), (1, geometry.offset != 0)] {
                            for (di, weighted_i) in [(0, true), (1, geometry.v.weights[k] != 0)] {
                                for (dj, weighted_j) in [(0, true), (1, geometry.u.weights[k] != 0)] {
                                    let there = k + dk < geometry.size[2]
                                        && geometry.column_at(ray.u + dj, k + dk).is_some()
                                        && geometry.row_at(ray.v + di, k + dk).is_some();
                                    all &= there || !(weighted_k && weighted_i && weighted_j);
                                }
                            }
                        }
                        prop_assert_eq!(geometry.has_sample(ray, k as i64), all);
                        count += u64::from(all);
                    }
                }
            }
            prop_assert_eq!(geometry.sample_count(), count);
        }

        #[test]
        fn a_frame_that_shares_slots_has_one_for_each_beam_of_the_base(
            n in 1_usize..40, du in 0.0..=1.0_f64, dv in 0.0..=1.0_f64,
        ) {
            let wrapped = geometry([n; 3], [du, dv], TemplateRule::SampleFloor, RaySlots::Wrapped);
            prop_assert_eq!(wrapped.slot_counts(), [n, n]);
            let padded = geometry([n; 3], [du, dv], TemplateRule::SampleFloor, RaySlots::Padded);
            let last = (n - 1) as f64 + padded.real_offset();
            let [exact_u, exact_v] = padded.real_slopes().map(|slope| (last * slope).floor() as usize);
            prop_assert_eq!(padded.slot_counts(), [n + exact_u, n + exact_v]);
        }
    }
}
