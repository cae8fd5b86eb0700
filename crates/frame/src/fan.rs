//! Fans: the discrete rays of a perspective view along one axis, in exact integers.
//!
//! Where a [`Template`](crate::Template) is one ray for all, a fan has a ray of its own for each column of the base plane:
//! the n² entries of the paper, section 2. A ray is two registers, its place at the first plane and its slope; columns and
//! weights follow from them without a rounding but the last one of each weight.

use crate::SLOPE_FRACTION_BITS;
use cube3_machine::TemplateRule;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The rays of one axis of a perspective pass.
///
/// The sample of ray i at depth k lies between its column L and its right column R, each the lerp by the offset of two
/// planes: `w = (p − lerp(L(k), L(k+1), o)) / (lerp(R(k), R(k+1), o) − lerp(L(k), L(k+1), o))`. R is the column of the next ray,
/// or the next column where the two rays share one. By the rule of the nearest voxel L is the sample's own, and w is 0.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fan {
    /// Number of the first ray: the whole number at which it crosses the grid plane.
    pub first: i64,
    /// Position of each ray at [`FanShape::first_depth`], fractions of [`SLOPE_FRACTION_BITS`].
    pub starts: Vec<i64>,
    /// Steps from plane to plane, fractions of [`SLOPE_FRACTION_BITS`].
    pub slopes: Vec<i64>,
    /// L of each ray, the rays of a depth together.
    pub(crate) near: Vec<i32>,
    /// R of each ray, likewise.
    pub(crate) right: Vec<i32>,
    /// Weights, fractions of the machine's weight bits, likewise.
    pub(crate) weights: Vec<u32>,
    /// The rays, by their index, that have samples at a depth; one entry for each depth.
    pub(crate) valid: Vec<[usize; 2]>,
}

/// What the two fans of a pass share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FanShape {
    /// The first plane behind the eye.
    pub first_depth: usize,
    /// Planes of the volume.
    pub depths: usize,
    /// The offset o, a fraction of `weight_bits`.
    pub offset: u32,
    /// Fraction bits of offset and weights.
    pub weight_bits: u32,
    /// The rule of the columns.
    pub rule: TemplateRule,
}

/// Registers of a fan's rays before columns are made from them: place and slope, and whether the last one has a
/// neighbour that was left out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FanRays {
    /// Number of the first ray.
    pub first: i64,
    /// Positions at the first depth; one ray more than the fan will have.
    pub starts: Vec<i64>,
    /// Slopes, likewise.
    pub slopes: Vec<i64>,
    /// Whether rays end because they are too steep, not because they miss the volume.
    pub cut: bool,
}

impl Fan {
    /// The fan of `rays` in a volume of `columns` voxels along its axis; `None` where no ray meets a voxel.
    pub(crate) fn new(rays: FanRays, shape: &FanShape, columns: usize) -> Option<Fan> {
        let inside = |i: usize| {
            (shape.first_depth..shape.depths)
                .any(|k| (0..columns as i32).contains(&shape.column(rays.starts[i], rays.slopes[i], k)))
        };
        let all = rays.starts.len() - 1;
        let from = (0..all).find(|&i| inside(i))?;
        let last = (from..all).rev().find(|&i| inside(i))?;
        let count = last + 1 - from;
        let mut fan =
            Fan::of(rays.first + from as i64, &rays.starts[from..=last + 1], &rays.slopes[from..=last + 1], shape);
        // The ray that ends a fan which was cut has no neighbour on its right.
        let whole = if rays.cut && last + 1 == all { count - 1 } else { count };
        for k in shape.first_depth..shape.depths {
            fan.valid[k] = fan.valid_at(k, shape, columns as i32, whole);
        }
        Some(fan)
    }

    /// The fan of rays by their places and slopes, without what is valid of it. The last of them has no entries: it is the next of the one
    /// before it.
    pub(crate) fn of(first: i64, starts: &[i64], slopes: &[i64], shape: &FanShape) -> Fan {
        let count = starts.len() - 1;
        let size = count * shape.depths;
        let mut fan = Fan {
            first,
            starts: starts[..count].to_vec(),
            slopes: slopes[..count].to_vec(),
            near: vec![-1; size],
            right: vec![-1; size],
            weights: vec![0; size],
            valid: vec![[0, 0]; shape.depths],
        };
        let column = |i: usize, k: usize| shape.column(starts[i], slopes[i], k);
        let right = |i: usize, k: usize| column(i + 1, k).max(column(i, k) + 1);
        for k in shape.first_depth..shape.depths {
            for i in 0..count {
                let (near, next) = (column(i, k), right(i, k));
                let left_edge = shape.between(near, column(i, k + 1));
                let right_edge = shape.between(next, right(i, k + 1));
                let place = k * count + i;
                fan.near[place] = near;
                fan.right[place] = next;
                fan.weights[place] = shape.weight(shape.position(starts[i], slopes[i], k), left_edge, right_edge);
            }
        }
        fan
    }

    /// The rays with a sample at a depth: every voxel that it gives a weight to is in the volume.
    pub(crate) fn valid_at(&self, k: usize, shape: &FanShape, columns: i32, whole: usize) -> [usize; 2] {
        let far = if shape.offset == 0 { k } else { k + 1 };
        if far >= shape.depths {
            return [0, 0];
        }
        let within = |x: i32| (0..columns).contains(&x);
        let has = |&i: &usize| {
            let needs_right = self.weight(i, k) != 0;
            within(self.near(i, k))
                && within(self.near(i, far))
                && (!needs_right || (within(self.right(i, k)) && within(self.right(i, far))))
        };
        let first = (0..whole).find(has).unwrap_or(0);
        let end = (first..whole).find(|i| !has(i)).unwrap_or(whole);
        [first, end]
    }

    /// How many rays.
    pub fn count(&self) -> usize {
        self.starts.len()
    }

    /// The index of a ray.
    pub fn index(&self, ray: i64) -> Option<usize> {
        usize::try_from(ray - self.first).ok().filter(|&i| i < self.count())
    }

    /// L of a ray by its index; −1 in front of the eye.
    #[inline]
    pub fn near(&self, i: usize, k: usize) -> i32 {
        self.near[k * self.count() + i]
    }

    /// R of a ray by its index.
    #[inline]
    pub fn right(&self, i: usize, k: usize) -> i32 {
        self.right[k * self.count() + i]
    }

    /// Weight of a ray's sample by its index.
    #[inline]
    pub fn weight(&self, i: usize, k: usize) -> u32 {
        self.weights[k * self.count() + i]
    }

    /// L of all rays at a depth.
    pub fn near_row(&self, k: usize) -> &[i32] {
        &self.near[k * self.count()..(k + 1) * self.count()]
    }

    /// R of all rays at a depth.
    pub fn right_row(&self, k: usize) -> &[i32] {
        &self.right[k * self.count()..(k + 1) * self.count()]
    }

    /// Weights of all rays at a depth.
    pub fn weight_row(&self, k: usize) -> &[u32] {
        &self.weights[k * self.count()..(k + 1) * self.count()]
    }

    /// The rays, by index, that have samples at a depth, as far as this axis decides.
    pub fn valid(&self, k: usize) -> Range<usize> {
        let [from, to] = self.valid[k];
        from..to
    }

    /// Index of the first ray whose slope is not negative.
    pub fn turn(&self) -> usize {
        self.slopes.partition_point(|&slope| slope < 0)
    }

    /// The position of a ray's sample in voxels, a fraction of `bits` (at most the slope's) rounded down.
    #[inline]
    pub fn place(&self, i: usize, k: usize, shape: &FanShape, bits: u32) -> i64 {
        shape.position(self.starts[i], self.slopes[i], k) >> (SLOPE_FRACTION_BITS + shape.weight_bits - bits)
    }

    /// The position of a ray's sample in voxels.
    pub fn real_place(&self, i: usize, k: usize, shape: &FanShape) -> f64 {
        let one = 2_f64.powi((SLOPE_FRACTION_BITS + shape.weight_bits) as i32);
        shape.position(self.starts[i], self.slopes[i], k) as f64 / one
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        /// Columns by the three rules, from places in exact fractions: the floor at the sample, the floor at the plane, the nearest there.
        #[test]
        fn a_column_is_the_floor_or_the_nearest(
            start in -(40_i64 << 30)..40 << 30, slope in -(2_i64 << 30)..=2 << 30, first_depth in 0_usize..4, behind in 0_usize..40,
            weight_bits in 0_u32..=12, offset in 0.0..1.0_f64,
        ) {
            let offset = (offset * f64::from(1_u32 << weight_bits)) as u32;
            let k = first_depth + behind;
            let one = 1_i128 << SLOPE_FRACTION_BITS;
            let at_plane = i128::from(start) + behind as i128 * i128::from(slope);
            let [weights, o] = [1_i128 << weight_bits, i128::from(offset)];
            for (rule, expected) in [
                (TemplateRule::SampleFloor, (at_plane * weights + o * i128::from(slope)).div_euclid(one * weights)),
                (TemplateRule::PlaneFloor, at_plane.div_euclid(one)),
                (TemplateRule::Nearest, (2 * at_plane + one).div_euclid(2 * one)),
            ] {
                let shape = FanShape { first_depth, depths: k + 1, offset, weight_bits, rule };
                prop_assert_eq!(i128::from(shape.column(start, slope, k)), expected, "{:?}", rule);
            }
        }
    }
}
