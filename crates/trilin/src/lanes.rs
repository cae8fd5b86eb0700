//! The same lerps for whole rows and whole rays.
//!
//! A *row* is all rays of a plane at one depth: the weights are one number, and neighbours along u are
//! neighbours in memory. A *ray* is all depths of one ray: the weights differ, and neighbours along w are
//! neighbours in memory. Both give the golden bits.

use crate::SampleBlock;
use cube3_word::{BLOCK_LANES, LaneBlock, LerpLanes, Words, vectorised};

/// The interpolator's lanes for a machine's words.
#[derive(Clone, Copy, Debug)]
pub struct TrilinLanes {
    lerp: LerpLanes,
    lift: u32,
}

impl TrilinLanes {
    /// Lanes for `words`.
    pub fn new(words: &Words) -> TrilinLanes {
        let lerp = LerpLanes::new(words.sample_bits(), words.weight_bits, words.rounding);
        TrilinLanes { lerp, lift: words.sample_fraction_bits }
    }

    /// A row of voxels in the sample format.
    pub fn lift(&self, voxels: &[u16], out: &mut [i32]) {
        let (voxels, lift) = (&voxels[..out.len()], self.lift);
        vectorised(
            #[inline(always)]
            || {
                for i in 0..out.len() {
                    out[i] = i32::from(voxels[i]) << lift;
                }
            },
        );
    }

    /// One edge of the cells of a row: voxels of the front and the back plane, lerped by the offset. `back` is not read at
    /// offset 0.
    pub fn row_along_w(&self, front: &[u16], back: &[u16], offset: u32, out: &mut [i32]) {
        if offset == 0 {
            return self.lift(front, out);
        }
        let (n, lift, lerp) = (out.len(), self.lift, self.lerp);
        let (front, back) = (&front[..n], &back[..n]);
        vectorised(
            #[inline(always)]
            || {
                for i in 0..n {
                    let near = i32::from(front[i]) << lift;
                    let far = i32::from(back[i]) << lift;
                    out[i] = lerp.one(near, far, offset);
                }
            },
        );
    }

    /// The same for voxels gathered by the columns of the front and of the back plane; columns beyond the rows give the voxel at
    /// their end.
    pub fn gathered_along_w(&self, front: &[u16], back: &[u16], columns: [&[i32]; 2], offset: u32, out: &mut [i32]) {
        let (lift, lerp) = (self.lift, self.lerp);
        let last = front.len() as i32 - 1;
        let voxel = |row: &[u16], column: i32| i32::from(row[column.clamp(0, last) as usize]) << lift;
        if offset == 0 {
            for (out, &column) in out.iter_mut().zip(columns[0]) {
                *out = voxel(front, column);
            }
            return;
        }
        for (i, out) in out.iter_mut().enumerate() {
            *out = lerp.one(voxel(front, columns[0][i]), voxel(back, columns[1][i]), offset);
        }
    }

    /// A row lerped with another by one weight; the ends copy.
    pub fn row(&self, near: &[i32], far: &[i32], weight: u32, out: &mut [i32]) {
        let lerp = self.lerp;
        vectorised(
            #[inline(always)]
            || lerp.uniform(near, far, weight, out),
        );
    }

    /// A row lerped with another by the weights of its samples.
    pub fn row_by_weights(&self, near: &[i32], far: &[i32], weights: &[u32], out: &mut [i32]) {
        let lerp = self.lerp;
        vectorised(
            #[inline(always)]
            || lerp.varying(near, far, weights, out),
        );
    }

    /// A whole ray of voxels in the sample format, by depth. `voxels` has whole blocks, and as many words as `out` at least.
    pub fn lift_ray(&self, voxels: &[u16], out: &mut [i32]) {
        let lift = self.lift;
        for (voxels, out) in voxels.as_chunks::<BLOCK_LANES>().0.iter().zip(out.as_chunks_mut::<BLOCK_LANES>().0) {
            vectorised(
                #[inline(always)]
                || {
                    for i in 0..BLOCK_LANES {
                        out[i] = i32::from(voxels[i]) << lift;
                    }
                },
            );
        }
    }

    /// The edges of the cells along a whole ray: `out[k] = lerp(ray[k], ray[k + 1], offset)`. `out` has whole blocks, and the ray a
    /// word more at least.
    pub fn edges(&self, ray: &[i32], offset: u32, out: &mut [i32]) {
        let (lerp, weights) = (self.lerp, [offset; BLOCK_LANES]);
        for (place, out) in out.as_chunks_mut::<BLOCK_LANES>().0.iter_mut().enumerate() {
            let from = place * BLOCK_LANES;
            if let (Some(near), Some(far)) = (ray[from..].first_chunk(), ray[from + 1..].first_chunk()) {
                vectorised(
                    #[inline(always)]
                    || lerp.block(near, far, &weights, out),
                );
            }
        }
    }

    /// [`TrilinLanes::edges`] of voxels as they come: `out` has whole blocks, and the ray a word more at least.
    pub fn edges_of_voxels(&self, ray: &[u16], offset: u32, out: &mut [i32]) {
        let (lerp, lift, weights) = (self.lerp, self.lift, [offset; BLOCK_LANES]);
        for (place, out) in out.as_chunks_mut::<BLOCK_LANES>().0.iter_mut().enumerate() {
            let from = place * BLOCK_LANES;
            if let (Some(near), Some(far)) = (ray[from..].first_chunk(), ray[from + 1..].first_chunk()) {
                vectorised(
                    #[inline(always)]
                    || {
                        let lifted = |voxels: &LaneBlock<u16>| {
                            let mut lifted = [0; BLOCK_LANES];
                            for i in 0..BLOCK_LANES {
                                lifted[i] = i32::from(voxels[i]) << lift;
                            }
                            lifted
                        };
                        lerp.block(&lifted(near), &lifted(far), &weights, out);
                    },
                );
            }
        }
    }

    /// A ray lerped with another by the weights of its samples. All have whole blocks.
    pub fn lerps(&self, near: &[i32], far: &[i32], weights: &[u32], out: &mut [i32]) {
        let lerp = self.lerp;
        let inputs = near.as_chunks().0.iter().zip(far.as_chunks().0).zip(weights.as_chunks().0);
        for (((near, far), weights), out) in inputs.zip(out.as_chunks_mut().0) {
            vectorised(
                #[inline(always)]
                || lerp.block(near, far, weights, out),
            );
        }
    }

    /// [`TrilinLanes::lerps`], with 0 where no sample is present. The rays have as many whole blocks as there are in `out`.
    pub fn samples(&self, near: &[i32], far: &[i32], weights: &[u32], out: &mut [SampleBlock]) {
        let lerp = self.lerp;
        let inputs = near.as_chunks().0.iter().zip(far.as_chunks().0).zip(weights.as_chunks().0);
        for (((near, far), weights), out) in inputs.zip(out) {
            vectorised(
                #[inline(always)]
                || present(lerp, near, far, weights, out),
            );
        }
    }

    /// The samples between the lerp along u of the current plane, which `side` has, and that of the plane below, of the ray on the left and the
    /// one on the right, which it gets instead. `weights` are those along u and along v; all have whole blocks.
    pub fn samples_below(
        &self,
        [left, right]: [&[i32]; 2],
        side: &mut [i32],
        weights: [&[u32]; 2],
        out: &mut [SampleBlock],
    ) {
        let lerp = self.lerp;
        for (place, out) in out.iter_mut().enumerate() {
            let from = place * BLOCK_LANES;
            let (Some(left), Some(right), Some(along_u), Some(along_v), Some(side)) = (
                left[from..].first_chunk(),
                right[from..].first_chunk(),
                weights[0][from..].first_chunk(),
                weights[1][from..].first_chunk(),
                side[from..].first_chunk_mut(),
            ) else {
                return;
            };
            vectorised(
                #[inline(always)]
                || {
                    let current = *side;
                    lerp.block(left, right, along_u, side);
                    present(lerp, &current, side, along_v, out);
                },
            );
        }
    }
}

/// A lerp where a sample is present, and 0 elsewhere.
#[inline(always)]
fn present(
    lerp: LerpLanes,
    near: &LaneBlock<i32>,
    far: &LaneBlock<i32>,
    weights: &LaneBlock<u32>,
    out: &mut SampleBlock,
) {
    let mut all = [0; BLOCK_LANES];
    lerp.block(near, far, weights, &mut all);
    let SampleBlock { samples, present } = out;
    for i in 0..BLOCK_LANES {
        samples[i] = if *present & (1 << i) == 0 { 0 } else { all[i] };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::golden::{Weights, cell, lift};
    use cube3_cases::cases;
    use cube3_word::Rounding;
    use proptest::prelude::*;

    fn words(voxel_bits: u32, fraction: u32, weight_bits: u32, truncate: bool) -> Words {
        let rounding = if truncate { Rounding::Truncate } else { Rounding::Nearest };
        Words { voxel_bits, sample_fraction_bits: fraction, weight_bits, rounding, ..Words::default() }
    }

    #[test]
    fn exhaustively_for_two_bit_voxels_and_weights() {
        let words = words(2, 1, 1, false);
        let lanes = TrilinLanes::new(&words);
        for bits in 0_u32..1 << 16 {
            let corner = |i: u32| (bits >> (2 * i) & 3) as u16;
            let corners = [0, 1].map(|w| [0, 1].map(|v| [0, 1].map(|u| corner(4 * w + 2 * v + u))));
            for weights in 0..27 {
                let weights = Weights { w: weights % 3, u: weights / 3 % 3, v: weights / 9 };
                let mut along_w = [[0; 2]; 2];
                for v in 0..2 {
                    lanes.row_along_w(&corners[0][v], &corners[1][v], weights.w, &mut along_w[v]);
                }
                let mut along_u = [[0; 1]; 2];
                for v in 0..2 {
                    lanes.row(&along_w[v][..1], &along_w[v][1..], weights.u, &mut along_u[v]);
                }
                let mut sample = [0];
                lanes.row(&along_u[0], &along_u[1], weights.v, &mut sample);
                let lifted = corners.map(|plane| plane.map(|row| row.map(|voxel| lift(voxel, &words))));
                assert_eq!(sample[0], cell(lifted, weights, &words));
            }
        }
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn rows_and_rays_equal_golden(
            voxel_bits in 1_u32..=16, fraction in 0_u32..=8, weight_bits in 0_u32..=12, truncate: bool,
            depth in 2_usize..40,
            seed in proptest::collection::vec(any::<u16>(), 4 * 40), weight_seed in proptest::collection::vec(0.0..=1.0_f64, 80),
        ) {
            let words = words(voxel_bits, fraction, weight_bits, truncate);
            let lanes = TrilinLanes::new(&words);
            let mask = ((1_u32 << voxel_bits) - 1) as u16;
            let one = f64::from(1_u32 << weight_bits);
            let weight = |i: usize| (weight_seed[i] * one).round() as u32;
            let room = depth.div_ceil(BLOCK_LANES) * BLOCK_LANES;
            let ray = |r: usize| {
                let mut voxels: Vec<u16> = seed[r * depth..(r + 1) * depth].iter().map(|&voxel| voxel & mask).collect();
                voxels.resize(room + BLOCK_LANES, 0);
                let mut ray = vec![0; room + BLOCK_LANES];
                lanes.lift_ray(&voxels, &mut ray);
                (voxels, ray)
            };
            let [(v0, r0), (v1, r1), (v2, r2), (v3, r3)] = [ray(0), ray(1), ray(2), ray(3)];
            let (voxels, rays) = ([[v0, v1], [v2, v3]], [[r0, r1], [r2, r3]]);
            let offset = weight(0);
            let row = |first: usize| (0..room).map(|k| if k < depth - 1 { weight(first + k) } else { 0 }).collect();
            let (weights_u, weights_v): (Vec<u32>, Vec<u32>) = (row(1), row(depth));
            let mut edges = vec![vec![vec![0; room]; 2]; 2];
            for v in 0..2 {
                for u in 0..2 {
                    lanes.edges(&rays[v][u], offset, &mut edges[v][u]);
                    let mut same = vec![0; room];
                    lanes.edges_of_voxels(&voxels[v][u], offset, &mut same);
                    prop_assert_eq!(&same, &edges[v][u]);
                }
            }
            let mut sides = vec![vec![0; room]; 2];
            for v in 0..2 {
                lanes.lerps(&edges[v][0], &edges[v][1], &weights_u, &mut sides[v]);
            }
            let mut samples = vec![0; room];
            lanes.lerps(&sides[0], &sides[1], &weights_v, &mut samples);
            let mut by_weights = vec![0; room];
            lanes.row_by_weights(&sides[0], &sides[1], &weights_v, &mut by_weights);
            prop_assert_eq!(&by_weights, &samples);
            let block = |present| SampleBlock { present, ..SampleBlock::default() };
            let mut masked: Vec<SampleBlock> = seed[..room / BLOCK_LANES].iter().map(|&bits| block(bits)).collect();
            lanes.samples(&sides[0], &sides[1], &weights_v, &mut masked);
            let (mut below, mut same) = (sides[0].clone(), masked.clone());
            let edges = [edges[1][0].as_slice(), &edges[1][1]];
            lanes.samples_below(edges, &mut below, [&weights_u, &weights_v], &mut same);
            prop_assert_eq!(&below, &sides[1]);
            prop_assert_eq!(&same, &masked);
            for k in 0..room {
                let there = seed[k / BLOCK_LANES] >> (k % BLOCK_LANES) & 1 != 0;
                prop_assert_eq!(masked[k / BLOCK_LANES].samples[k % BLOCK_LANES], if there { samples[k] } else { 0 });
            }
            for k in 0..depth - 1 {
                let corners = [0, 1].map(|w| [0, 1].map(|v| [0, 1].map(|u: usize| rays[v][u][k + w])));
                let weights = Weights { w: offset, u: weights_u[k], v: weights_v[k] };
                prop_assert_eq!(samples[k], cell(corners, weights, &words));
            }
        }
    }

    #[test]
    fn gathered_edges_are_lerps_of_the_voxels_at_their_columns() {
        let words = Words { sample_fraction_bits: 3, ..Words::default() };
        let lanes = TrilinLanes::new(&words);
        let (front, back) = ([100, 2000, 30_000, 400], [5, 60_000, 70, 800]);
        // Columns beyond the row give the voxel at its end.
        let columns: [[i32; 6]; 2] = [[0, 1, 2, 3, -2, 9], [1, 1, 3, 2, 0, 3]];
        for offset in [0, 1, 77, 255] {
            let mut out = [0; 6];
            lanes.gathered_along_w(&front, &back, [&columns[0], &columns[1]], offset, &mut out);
            for i in 0..6 {
                let voxel = |row: &[u16; 4], column: i32| lift(row[column.clamp(0, 3) as usize], &words);
                let [near, far] = [voxel(&front, columns[0][i]), voxel(&back, columns[1][i])];
                assert_eq!(out[i], cube3_word::lerp(near, far, offset, words.weight_bits, words.rounding));
            }
        }
    }
}
