//! A volume as a frame reads it.

use cube3_frame::Axes;
use rayon::prelude::*;
use std::borrow::Cow;

/// A volume of voxel words in canonical order: u fastest, then v, then w.
pub struct CanonicalVolume<'a> {
    size: [usize; 3],
    voxels: Cow<'a, [u16]>,
}

/// Side of the blocks in which a volume is turned, in voxels: a block's lines fit the first cache.
const TURNED_SIDE: usize = 32;

impl<'a> CanonicalVolume<'a> {
    /// Turns a volume (x fastest) so that rows lie along u. A volume that lies so already is not copied.
    pub fn new(axes: &Axes, dims: [usize; 3], voxels: &'a [u16]) -> CanonicalVolume<'a> {
        let size = axes.permute(dims);
        if axes.axis == [0, 1, 2] && axes.reversed == [false; 3] {
            return CanonicalVolume { size, voxels: Cow::Borrowed(voxels) };
        }
        let strides = [1, dims[0] as i64, (dims[0] * dims[1]) as i64];
        let step = [0, 1, 2].map(|i| if axes.reversed[i] { -strides[axes.axis[i]] } else { strides[axes.axis[i]] });
        let [x, y, z] = axes.voxel(size, [0, 0, 0]);
        let first = (x + dims[0] * (y + dims[1] * z)) as i64;
        let plane = size[0] * size[1];
        let mut turned = vec![0; voxels.len()];
        turned.par_chunks_mut(plane * TURNED_SIDE).enumerate().for_each(|(block, planes)| {
            let start = first + (block * TURNED_SIDE) as i64 * step[2];
            if axes.axis[0] == 0 {
                rows(voxels, start, step, size, planes);
            } else {
                blocks(voxels, start, step, size, planes);
            }
        });
        CanonicalVolume { size, voxels: Cow::Owned(turned) }
    }

    pub(crate) fn row(&self, v: usize, w: usize) -> &[u16] {
        let start = (w * self.size[1] + v) * self.size[0];
        &self.voxels[start..start + self.size[0]]
    }
}

/// Turns planes whose rows lie along x in the source too, forwards or backwards.
fn rows(voxels: &[u16], start: i64, step: [i64; 3], size: [usize; 3], planes: &mut [u16]) {
    let n = size[0];
    for (i, row) in planes.chunks_mut(n).enumerate() {
        let first = start + (i / size[1]) as i64 * step[2] + (i % size[1]) as i64 * step[1];
        if step[0] == 1 {
            row.copy_from_slice(&voxels[first as usize..first as usize + n]);
        } else {
            let source = &voxels[first as usize + 1 - n..=first as usize];
            for (voxel, from) in row.iter_mut().zip(source.iter().rev()) {
                *voxel = *from;
            }
        }
    }
}

/// Turns planes whose rows lie across x: x runs along v or along w, and blocks of it are read and written together.
fn blocks(voxels: &[u16], start: i64, step: [i64; 3], size: [usize; 3], planes: &mut [u16]) {
    let plane = size[0] * size[1];
    let depths = planes.len() / plane;
    // The axis along which the source is contiguous, how many voxels, and the stride of the result along it.
    let (along, count, stride) = if step[1].abs() == 1 { (1, size[1], size[0]) } else { (2, depths, plane) };
    let (other, others, other_stride) = if along == 1 { (2, depths, plane) } else { (1, size[1], size[0]) };
    for a0 in (0..count).step_by(TURNED_SIDE) {
        let width = TURNED_SIDE.min(count - a0);
        for o in 0..others {
            for u in 0..size[0] {
                let from = start + u as i64 * step[0] + o as i64 * step[other] + a0 as i64 * step[along];
                let place = u + o * other_stride + a0 * stride;
                if step[along] == 1 {
                    let source = &voxels[from as usize..from as usize + width];
                    for (i, voxel) in source.iter().enumerate() {
                        planes[place + i * stride] = *voxel;
                    }
                } else {
                    let source = &voxels[from as usize + 1 - width..=from as usize];
                    for (i, voxel) in source.iter().rev().enumerate() {
                        planes[place + i * stride] = *voxel;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn a_turned_volume_has_each_voxel_in_its_place(
            dims in [1_usize..70, 1_usize..6, 1_usize..40], order in Just([0_usize, 1, 2]).prop_shuffle(), reversed: [bool; 3],
        ) {
            let voxels: Vec<u16> = (0..dims.iter().product::<usize>()).map(|i| i as u16).collect();
            let axes = Axes { axis: order, reversed };
            let volume = CanonicalVolume::new(&axes, dims, &voxels);
            let size = axes.permute(dims);
            for w in 0..size[2] {
                for v in 0..size[1] {
                    for u in 0..size[0] {
                        let [x, y, z] = axes.voxel(size, [u, v, w]);
                        prop_assert_eq!(volume.row(v, w)[u], voxels[x + dims[0] * (y + dims[1] * z)]);
                    }
                }
            }
        }
    }
}
