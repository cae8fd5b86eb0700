//! The geometry of a frame: discrete rays, ray slots, and which samples lie in the volume.

use crate::bits::PLACE_BITS;
use crate::perspective::PerspectivePass;
use crate::{Axes, Linear, SLOPE_FRACTION_BITS, Template};
use cube3_machine::{RaySlots, TemplateRule};
use cube3_word::Probe;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The geometry registers of a frame, in canonical coordinates.
///
/// In a parallel frame sample k of ray (u, v) is at `(u + (k+o)·du, v + (k+o)·dv, k+o)`. Rays are numbered as their
/// base-plane pixel: u from `−X(n_w−1)` to `n_u − 1`. In perspective each ray has registers of its own, its number is the place
/// at which it crosses the grid plane, and it has one slot for all depths; slopes and templates are then empty.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Geometry {
    /// n_u, n_v, n_w.
    pub size: [usize; 3],
    /// The voxel axes behind u, v, w.
    pub axes: Axes,
    /// du and dv of a parallel frame, fractions of [`SLOPE_FRACTION_BITS`].
    pub slopes: [u32; 2],
    /// The sample offset o, a fraction of `weight_bits`, below 1.
    pub offset: u32,
    /// Fraction bits of the offset and the weights.
    pub weight_bits: u32,
    /// The rule of the templates.
    pub rule: TemplateRule,
    /// How rays share slots.
    pub slots: RaySlots,
    /// Columns and weights along u of a parallel frame.
    pub u: Template,
    /// Rows and weights along v of a parallel frame.
    pub v: Template,
    /// The rays of a perspective pass.
    pub perspective: Option<PerspectivePass>,
}

/// A discrete ray, by its base-plane pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DiscreteRay {
    /// Column of the pixel, in a parallel frame −X(n_w−1) to n_u − 1.
    pub u: i64,
    /// Row of the pixel, in a parallel frame −Y(n_w−1) to n_v − 1.
    pub v: i64,
}

impl Geometry {
    /// A parallel frame: makes the templates. `slopes` and `offset` are register values, the offset legal for the rule.
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
        Geometry { size, axes, slopes, offset, weight_bits, rule, slots, u, v, perspective: None }
    }

    /// Voxels along x, y, z.
    pub fn dims(&self) -> [usize; 3] {
        let mut dims = [0; 3];
        for i in 0..3 {
            dims[self.axes.axis[i]] = self.size[i];
        }
        dims
    }

    /// du and dv of a parallel frame as reals, exactly what the registers hold.
    pub fn real_slopes(&self) -> [f64; 2] {
        self.slopes.map(|slope| f64::from(slope) / f64::from(1_u32 << SLOPE_FRACTION_BITS))
    }

    /// The offset o as a real, exactly what the register holds.
    pub fn real_offset(&self) -> f64 {
        f64::from(self.offset) / f64::from(1_u32 << self.weight_bits)
    }

    /// Whether each sample is its nearest voxel, in frames of label volumes: voxels are then boxes, and the volume reaches half a voxel beyond
    /// the outermost centres.
    #[inline]
    pub fn nearest(&self) -> bool {
        self.rule == TemplateRule::Nearest
    }

    /// Planes, a step apart, from the volume's front face to its back one: n_w, and one more where voxels are boxes.
    pub fn bounding_planes(&self) -> usize {
        self.size[2] + usize::from(self.nearest())
    }

    /// The position of sample `k` of a ray of the frame, in canonical voxels.
    pub fn sample_position(&self, ray: DiscreteRay, k: usize) -> [f64; 3] {
        let depth = k as f64 + self.real_offset();
        if let Some(pass) = &self.perspective {
            let [row, column] = self.slot_of(ray);
            let shape = self.fan_shape();
            return [pass.u.real_place(column, k, &shape), pass.v.real_place(row, k, &shape), depth];
        }
        let [du, dv] = self.real_slopes();
        [ray.u as f64 + depth * du, ray.v as f64 + depth * dv, depth]
    }

    /// Where linear functions take their argument: ray and depth themselves in a parallel frame, where they are linear in
    /// the sample's position; in perspective that position, fractions of [`PLACE_BITS`].
    #[inline]
    pub fn place(&self, [u, v, k]: [i64; 3]) -> [i64; 3] {
        let Some(pass) = &self.perspective else {
            return [u, v, k];
        };
        let shape = self.fan_shape();
        let depth = (k << PLACE_BITS) + (i64::from(self.offset) << (PLACE_BITS - self.weight_bits));
        let k = k as usize;
        let [column, row] = [(u - pass.u.first) as usize, (v - pass.v.first) as usize];
        [pass.u.place(column, k, &shape, PLACE_BITS), pass.v.place(row, k, &shape, PLACE_BITS), depth]
    }

    /// The value of a linear function at sample `k` of ray (u, v): [`Linear::at`], in perspective of the sample's place.
    #[inline]
    pub fn evaluate(&self, function: &Linear, at: [i64; 3]) -> i64 {
        self.evaluate_wires(function, at, &mut ())
    }

    /// [`Geometry::evaluate`], and what its wires carry in a parallel frame.
    #[inline]
    pub fn evaluate_wires(&self, function: &Linear, at: [i64; 3], probe: &mut impl Probe) -> i64 {
        match &self.perspective {
            None => function.at_wires(at[0], at[1], at[2], probe),
            Some(_) => function.at_place(self.place(at)),
        }
    }

    /// X(n_w − 1): how far the discrete rays of a parallel frame move along u. Rays start at minus this.
    #[inline]
    pub fn shear_u(&self) -> usize {
        self.u.columns.get(self.size[2] - 1).map_or(0, |&x| x as usize)
    }

    /// Y(n_w − 1): how far the discrete rays of a parallel frame move along v.
    #[inline]
    pub fn shear_v(&self) -> usize {
        self.v.columns.get(self.size[2] - 1).map_or(0, |&y| y as usize)
    }

    /// The ray of the base plane's first pixel: its numbers along u and v.
    #[inline]
    pub fn first_ray(&self) -> DiscreteRay {
        match &self.perspective {
            None => DiscreteRay { u: -(self.shear_u() as i64), v: -(self.shear_v() as i64) },
            Some(pass) => DiscreteRay { u: pass.u.first, v: pass.v.first },
        }
    }

    /// Width and height of the base plane in pixels: every ray that meets a voxel.
    pub fn base_plane_size(&self) -> [usize; 2] {
        match &self.perspective {
            None => [self.size[0] + self.shear_u(), self.size[1] + self.shear_v()],
            Some(pass) => [pass.u.count(), pass.v.count()],
        }
    }

    /// The pixel of the base plane, column and row from 0, that belongs to a ray.
    #[inline]
    pub fn pixel(&self, ray: DiscreteRay) -> [usize; 2] {
        let first = self.first_ray();
        [(ray.u - first.u) as usize, (ray.v - first.v) as usize]
    }

    /// Ray slots in a plane, and planes in a frame.
    #[inline]
    pub fn slot_counts(&self) -> [usize; 2] {
        match self.slots {
            RaySlots::Wrapped => [self.size[0], self.size[1]],
            RaySlots::Padded => self.base_plane_size(),
        }
    }

    /// Whether slots are shared along u and along v, so that the last slot's neighbour is the first.
    #[inline]
    pub fn closes(&self) -> [bool; 2] {
        let wrapped = self.slots == RaySlots::Wrapped;
        [wrapped && self.shear_u() > 0, wrapped && self.shear_v() > 0]
    }

    /// The ray whose voxel is in slot `j` (of plane `i`) at depth `k`.
    #[inline]
    pub fn ray_in_slot(&self, i: usize, j: usize, k: usize) -> DiscreteRay {
        if let Some(pass) = &self.perspective {
            return DiscreteRay { u: pass.u.first + j as i64, v: pass.v.first + i as i64 };
        }
        DiscreteRay {
            u: self.ray_in(j, self.size[0], self.u.columns[k], self.shear_u()),
            v: self.ray_in(i, self.size[1], self.v.columns[k], self.shear_v()),
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
        let x = match &self.perspective {
            None => u + i64::from(self.u.columns[k]),
            Some(pass) => i64::from(pass.u.near(pass.u.index(u)?, k)),
        };
        (0..self.size[0] as i64).contains(&x).then_some(x as usize)
    }

    /// The voxel of plane `v` (one axis) at depth `k`: its row, where it is in the volume.
    pub fn row_at(&self, v: i64, k: usize) -> Option<usize> {
        let y = match &self.perspective {
            None => v + i64::from(self.v.columns[k]),
            Some(pass) => i64::from(pass.v.near(pass.v.index(v)?, k)),
        };
        (0..self.size[1] as i64).contains(&y).then_some(y as usize)
    }

    /// Whether a ray of the frame runs against u and against v: only in perspective.
    pub fn mirrored(&self, ray: DiscreteRay) -> [bool; 2] {
        let Some(pass) = &self.perspective else {
            return [false; 2];
        };
        let [row, column] = self.slot_of(ray);
        [pass.u.slopes[column] < 0, pass.v.slopes[row] < 0]
    }

    /// Whether slots need cells of their own, as rays may share columns: an eye that is near.
    #[inline]
    pub fn doubled(&self) -> bool {
        self.perspective.as_ref().is_some_and(|pass| pass.doubled)
    }

    /// The row below the cells of plane `i` of slots at depth `k` of a perspective frame, where it is in the volume.
    #[inline]
    pub fn row_below(&self, i: usize, k: usize) -> Option<usize> {
        let row = self.perspective.as_ref()?.v.right(i, k);
        usize::try_from(row).ok().filter(|&row| row < self.size[1])
    }

    /// A corner of the cell of sample `k` of a ray, `[w, v, u]` each 0 or 1 for the near and the far side: its canonical voxel,
    /// where it is in the volume.
    pub fn corner(&self, ray: DiscreteRay, k: usize, [w, v, u]: [usize; 3]) -> Option<[usize; 3]> {
        let depth = Some(k + w).filter(|&depth| depth < self.size[2])?;
        let Some(pass) = &self.perspective else {
            return Some([self.column_at(ray.u + u as i64, depth)?, self.row_at(ray.v + v as i64, depth)?, depth]);
        };
        let side = |fan: &crate::Fan, ray, far, n: usize| {
            let i = fan.index(ray)?;
            let at = if far == 1 { fan.right(i, depth) } else { fan.near(i, depth) };
            usize::try_from(at).ok().filter(|&at| at < n)
        };
        Some([side(&pass.u, ray.u, u, self.size[0])?, side(&pass.v, ray.v, v, self.size[1])?, depth])
    }

    /// Weights along u and v of sample `k` of a ray of the frame.
    pub fn weights(&self, ray: DiscreteRay, k: usize) -> [u32; 2] {
        match &self.perspective {
            None => [self.u.weights[k], self.v.weights[k]],
            Some(pass) => {
                let [row, column] = self.slot_of(ray);
                [pass.u.weight(column, k), pass.v.weight(row, k)]
            }
        }
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
        if let Some(pass) = &self.perspective {
            let rows = pass.v.valid(k);
            if !pass.v.index(v).is_some_and(|row| rows.contains(&row)) {
                return 0..0;
            }
            let columns = pass.u.valid(k);
            return pass.u.first + columns.start as i64..pass.u.first + columns.end as i64;
        }
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
        let first = self.first_ray().v;
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
    use cube3_cases::cases;
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
        #![proptest_config(cases(256))]

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
