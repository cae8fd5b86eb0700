//! One pass of a perspective view: the rays of an eye whose major axis is one signed voxel axis.

use crate::fan::Fan;
use crate::{Axes, SLOPE_FRACTION_BITS};
use cube3_machine::TemplateRule;
use serde::{Deserialize, Serialize};

/// Grid steps by which rays go beyond those that pictures show, so that the warp finds all neighbours at the edge; the gradients of those
/// find theirs as many rays farther as they reach.
pub(crate) const MARGIN: f64 = 1.0;

/// Part of F by which the rays that pictures show go beyond a slope of 1 in near frames, so that the warp can pass from one base plane to the
/// next over some width.
pub(crate) const OVERLAP: f64 = 0.125;

/// The fans of a pass, and where its eye is.
///
/// The eye is at (e_u, e_v, e_w) in canonical voxels. Rays cross the *grid plane*, which is `F` behind the eye, at whole numbers
/// (g, h), and are `m(k) = (k − e_w) / F` apart at depth k. `F` is the eye's distance to the base plane w = 0, or half of the
/// volume's depth where the eye is nearer: then rays are less than a voxel apart in front, and never more than 3 behind.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PerspectivePass {
    /// Rays along u.
    pub u: Fan,
    /// Rays along v.
    pub v: Fan,
    /// The first plane behind the eye; in front of it are no samples.
    pub first_depth: usize,
    /// w of the grid plane, a fraction of [`SLOPE_FRACTION_BITS`]: 0 where it is the base plane.
    pub grid_plane: i64,
    /// m at plane `first_depth`, and its step from plane to plane, fractions of [`SLOPE_FRACTION_BITS`].
    pub spacing: [i64; 2],
    /// Whether rays may share columns, so that a slot needs its own cell: beams of rows Y and Y + 1 are fetched for every plane, and
    /// each is gathered twice.
    pub doubled: bool,
    /// Most rays from a sample to the neighbours along u and v that its gradient reads.
    pub most_reach: u32,
    /// Rays beyond a slope of 1 that pictures show where two near frames join; none in others.
    pub overlap: u32,
}

impl PerspectivePass {
    /// The distance m between rays at a plane, which may be before the first or behind the last, plus an offset
    /// (a fraction of `weight_bits`).
    pub fn spacing_at(&self, k: i64, offset: u32, weight_bits: u32) -> f64 {
        let one = f64::from(1_u32 << SLOPE_FRACTION_BITS);
        let part = f64::from(offset) / f64::from(1_u32 << weight_bits);
        let depth = (k - self.first_depth as i64) as f64 + part;
        (self.spacing[0] as f64 + depth * self.spacing[1] as f64) / one
    }

    /// The slope of the last ray beyond 1 that pictures show, where it is 1 and more: the other side of a joint begins at one over it.
    pub fn farthest_slope(&self) -> f64 {
        1.0 + f64::from(self.overlap) * self.spacing[1] as f64 / f64::from(1_u32 << SLOPE_FRACTION_BITS)
    }

    /// From a sample to the neighbours along u and v that its gradient reads, in voxels: what is [`PerspectivePass::reach_at`] rays.
    pub fn neighbour_spacing(&self, k: i64, offset: u32, weight_bits: u32) -> f64 {
        self.spacing_at(k, offset, weight_bits) * f64::from(self.reach_at(k, offset, weight_bits))
    }

    /// How many rays at a plane, plus an offset, are about a voxel.
    pub fn reach_at(&self, k: i64, offset: u32, weight_bits: u32) -> u32 {
        reach(self.spacing_at(k, offset, weight_bits), self.most_reach)
    }
}

/// What a pass is made from.
#[derive(Clone, Copy, Debug)]
pub struct PassShape {
    /// n_u, n_v, n_w.
    pub size: [usize; 3],
    /// The voxel axes behind u, v, w.
    pub axes: Axes,
    /// The eye in canonical voxels.
    pub eye: [f64; 3],
    /// The offset wanted, a fraction of `weight_bits`; lowered to what the rule allows for the steepest ray.
    pub offset: u32,
    /// Fraction bits of the offset and the weights.
    pub weight_bits: u32,
    /// The rule of the columns.
    pub rule: TemplateRule,
    /// Least distance of the grid plane from the eye, in depths n_w.
    pub grid: f64,
    /// Most rays to a gradient's neighbours along u and v: see [`PerspectivePass::reach_at`].
    pub reach: u32,
    /// Whether another near frame may join this one, if it is near: rays then go on beyond a slope of 1.
    pub joins: bool,
}

impl PassShape {
    /// Whether the eye is so near that rays in front are less than a voxel apart.
    pub fn is_near(&self) -> bool {
        -self.eye[2] < self.grid * self.size[2] as f64
    }
}

/// How many rays that are `spacing` apart are about a voxel, one and `most` at most.
pub(crate) fn reach(spacing: f64, most: u32) -> u32 {
    if spacing > 0.0 { (1.0 / spacing).round().clamp(1.0, f64::from(most)) as u32 } else { most }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{DiscreteRay, Geometry};
    use cube3_cases::cases;
    use proptest::prelude::*;

    fn eyes() -> impl Strategy<Value = [f64; 3]> {
        let near = || -20.0..30.0_f64;
        let voxel = || (0_u8..9).prop_map(f64::from);
        prop_oneof![
            3 => [near(), near(), near()],
            1 => [voxel(), voxel(), voxel()],
            1 => [near(), near(), -1e3..0.0_f64],
            1 => [-1e12..1e12_f64, -1e12..1e12_f64, -1e12..0.0_f64],
        ]
    }

    pub(crate) fn any_pass() -> impl Strategy<Value = Geometry> {
        let size = [1_usize..9, 1_usize..9, 1_usize..9];
        let grid = prop_oneof![Just(0.5), 0.1..4.0_f64];
        (size, eyes(), 0.0..1.0_f64, 0_u32..=12, any::<bool>(), grid, 1_u32..9, any::<bool>()).prop_filter_map(
            "an eye from which no ray meets the volume",
            |(size, eye, offset, weight_bits, plane, grid, reach, joins)| {
                Geometry::perspective(&PassShape {
                    size,
                    axes: Axes { axis: [0, 1, 2], reversed: [false; 3] },
                    eye,
                    offset: ((offset * f64::from(1_u32 << weight_bits)) as u32).min((1 << weight_bits) - 1),
                    weight_bits,
                    rule: if plane { TemplateRule::PlaneFloor } else { TemplateRule::SampleFloor },
                    grid,
                    reach,
                    joins,
                })
            },
        )
    }

    proptest! {
        #![proptest_config(cases(1500))]

        /// The sheared cell contains its sample, and the weight is its place in it: so an affine field comes out exact, to the
        /// rounding of the weight.
        #[test]
        fn cells_contain_their_samples_at_the_weight(geometry in any_pass()) {
            let pass = geometry.perspective.as_ref().unwrap();
            let (shape, one) = (geometry.fan_shape(), f64::from(1_u32 << geometry.weight_bits));
            let offset = geometry.real_offset();
            for fan in [&pass.u, &pass.v] {
                for k in pass.first_depth..geometry.size[2] - 1 {
                    for i in 0..fan.count() {
                        let between = |near: i32, far: i32| f64::from(near) + f64::from(far - near) * offset;
                        let left = between(fan.near(i, k), fan.near(i, k + 1));
                        let right = between(fan.right(i, k), fan.right(i, k + 1));
                        let place = fan.real_place(i, k, &shape);
                        prop_assert!(left <= place && place <= right, "{left} {place} {right}");
                        let weight = f64::from(fan.weight(i, k)) / one;
                        prop_assert!((0.0..=1.0).contains(&weight));
                        prop_assert!((left + (right - left) * weight - place).abs() <= (right - left) * 0.5 / one + 1e-9);
                    }
                }
            }
        }

        #[test]
        fn rays_stay_in_order_and_without_own_cells_the_right_column_is_the_next_rays(geometry in any_pass()) {
            let pass = geometry.perspective.as_ref().unwrap();
            for fan in [&pass.u, &pass.v] {
                for k in pass.first_depth..geometry.size[2] {
                    for i in 0..fan.count() {
                        prop_assert!(fan.right(i, k) > fan.near(i, k));
                        if i + 1 < fan.count() {
                            prop_assert!(fan.near(i + 1, k) >= fan.near(i, k));
                            prop_assert!(pass.doubled || fan.right(i, k) == fan.near(i + 1, k));
                            let apart = pass.spacing_at(k as i64, 0, 8).ceil().max(1.0) as i32 + 1;
                            prop_assert!(fan.right(i, k) <= fan.near(i, k) + apart);
                        }
                    }
                }
            }
        }

        #[test]
        fn a_sample_has_every_voxel_that_it_gives_a_weight_to(geometry in any_pass()) {
            let first = geometry.first_ray();
            let [width, height] = geometry.base_plane_size();
            let mut count = 0;
            for i in 0..height as i64 {
                for j in 0..width as i64 {
                    let ray = DiscreteRay { u: first.u + j, v: first.v + i };
                    for k in 0..geometry.size[2] {
                        if !geometry.has_sample(ray, k as i64) {
                            continue;
                        }
                        count += 1;
                        let weights = geometry.weights(ray, k);
                        for corner in 0..8 {
                            let [w, v, u] = [corner >> 2, corner >> 1 & 1, corner & 1];
                            let weighted = (w == 0 || geometry.offset != 0)
                                && (v == 0 || weights[1] != 0)
                                && (u == 0 || weights[0] != 0);
                            prop_assert!(!weighted || geometry.corner(ray, k, [w, v, u]).is_some());
                        }
                        let place = geometry.sample_position(ray, k);
                        for (at, side) in place.into_iter().zip(geometry.size) {
                            prop_assert!((0.0..=side as f64).contains(&at));
                        }
                    }
                }
            }
            prop_assert_eq!(geometry.sample_count(), count);
        }
    }

    /// An eye of any kind has the samples that its rays have within the volume: none is lost at a border but for the last ray.
    #[test]
    fn a_central_eye_has_a_sample_for_each_ray_between_the_faces() {
        let eye = [15.5, 15.5, -64.0];
        let axes = Axes { axis: [0, 1, 2], reversed: [false; 3] };
        let shape = PassShape {
            size: [32; 3],
            axes,
            eye,
            offset: 0,
            weight_bits: 8,
            rule: TemplateRule::SampleFloor,
            grid: 0.5,
            reach: 1,
            joins: false,
        };
        let geometry = Geometry::perspective(&shape).unwrap();
        for k in 0..32 {
            let spacing = 1.0 + k as f64 / 64.0;
            let expected = (0..32).filter(|g| (15.5 + (f64::from(*g) - 15.5) * spacing - 15.5).abs() <= 15.5).count();
            let valid = geometry.perspective.as_ref().unwrap().u.valid(k);
            assert!(valid.len() >= expected - 1 && valid.len() <= expected + 1, "{k}: {} of {expected}", valid.len());
        }
    }
}
