//! The same picture without the clock: whole rows through the units' lanes, planes on all cores.
//!
//! A band of planes v is one piece of work. Within it, planes of samples follow each other as in the machine: the
//! lerps along u of plane v + 1 serve plane v now and plane v + 1 next; three planes of samples serve the
//! gradient. Rows lie along u in voxel columns x = u + X(k), so that the row of the next depth is a shift.

use crate::function_perspective::PassWorker;
use crate::machine::Overflows;
use cube3_abc::ends::PlaneEnds;
use cube3_abc::lanes::{AbcLanes, ShadedRow};
use cube3_cone::lanes::{Accumulator, ConeLanes};
use cube3_frame::{Axes, Bands, BasePlane, FrameSetup, HalfSpace, Schedule};
use cube3_trilin::lanes::TrilinLanes;
use cube3_word::vectorised;
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;
use std::slice::ChunksMut;
use std::sync::atomic::{AtomicU64, Ordering};

/// A volume of voxel words in canonical order: u fastest, then v, then w.
pub struct CanonicalVolume<'a> {
    size: [usize; 3],
    voxels: Cow<'a, [u16]>,
}

/// Side of the blocks in which a volume is turned, in voxels: a block's lines fit the first cache.
const BLOCK: usize = 32;

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
        turned.par_chunks_mut(plane * BLOCK).enumerate().for_each(|(block, planes)| {
            let start = first + (block * BLOCK) as i64 * step[2];
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
    for a0 in (0..count).step_by(BLOCK) {
        let width = BLOCK.min(count - a0);
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

/// What a function run gives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FunctionRun {
    /// The base plane.
    pub base: BasePlane,
    /// Words that were saturated.
    pub overflows: Overflows,
}

/// Renders the base plane on all cores of the current rayon pool. With `skip`, transparent stretches are not shaded,
/// which changes no bit. `progress(done, all)` is called with the planes that are done.
pub fn render(
    setup: &FrameSetup,
    volume: &CanonicalVolume<'_>,
    skip: bool,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> FunctionRun {
    if setup.words.accumulator_bits <= 16 {
        render_in::<u32>(setup, volume, skip, progress)
    } else {
        render_in::<u64>(setup, volume, skip, progress)
    }
}

fn render_in<T: Accumulator>(
    setup: &FrameSetup,
    volume: &CanonicalVolume<'_>,
    skip: bool,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> FunctionRun {
    let geometry = &setup.geometry;
    let mut base = BasePlane::empty(geometry, setup.words.accumulator_bits);
    let width = base.width;
    let schedule = Schedule::of(geometry, setup.cone.leaves, None);
    let bands = schedule.bands(geometry, 4 * rayon::current_num_threads());
    let done = AtomicU64::new(0);
    // One set of tables for all bands.
    let abc = AbcLanes::new(setup, skip);
    let overflows = base
        .pixels
        .par_chunks_mut(width * bands.height())
        .enumerate()
        .map(|(number, pixels)| {
            let (rows, pixels) = (bands.band(number), pixels.chunks_mut(width));
            let count = pixels.len() as u64;
            let overflows = match &geometry.perspective {
                None => Worker::<T>::new(setup, &bands, volume, abc.clone()).band(rows, pixels),
                Some(pass) => PassWorker::<T>::new(setup, pass, &bands, volume, abc.clone()).band(rows, pixels),
            };
            let done = done.fetch_add(count, Ordering::Relaxed) + count;
            progress(done, bands.rows() as u64);
            overflows
        })
        .reduce(Overflows::default, Overflows::plus);
    FunctionRun { base, overflows }
}

/// Places before column 0 of a row of samples: neighbour −1 of a row that is one column behind.
const MARGIN: usize = 2;

/// Rows of one plane, one for each depth.
pub(crate) struct Plane {
    stride: usize,
    words: Vec<i32>,
}

impl Plane {
    pub fn new(stride: usize, depths: usize) -> Plane {
        Plane { stride, words: vec![0; stride * depths] }
    }

    pub fn row(&self, k: usize) -> &[i32] {
        &self.words[k * self.stride..(k + 1) * self.stride]
    }

    pub fn row_mut(&mut self, k: usize) -> &mut [i32] {
        &mut self.words[k * self.stride..(k + 1) * self.stride]
    }
}

/// The units' lanes and the planes between them, for one band.
struct Worker<'a, T> {
    setup: &'a FrameSetup,
    bands: &'a Bands,
    volume: &'a CanonicalVolume<'a>,
    trilin: TrilinLanes,
    abc: AbcLanes,
    cone: ConeLanes<T>,
    /// Lerps along u of planes v and v + 1, by parity.
    sides: [Plane; 2],
    /// Samples of planes v − 1, v, v + 1, by remainder of 3, the border around them.
    samples: [Plane; 3],
    edges: Vec<i32>,
    beyond: Vec<i32>,
    /// Ends of the rays of the plane in hand.
    ends: PlaneEnds,
    shaded: ShadedRow,
}

impl<'a, T: Accumulator> Worker<'a, T> {
    fn new(setup: &'a FrameSetup, bands: &'a Bands, volume: &'a CanonicalVolume<'a>, abc: AbcLanes) -> Worker<'a, T> {
        let [n, _, depths] = setup.geometry.size;
        let border = setup.gradient.map_or(0, |registers| registers.border);
        let plane = || Plane::new(n + 2 * MARGIN, depths);
        Worker {
            setup,
            bands,
            volume,
            trilin: TrilinLanes::new(&setup.words),
            abc,
            cone: ConeLanes::new(setup.cone, setup.words),
            sides: [plane(), plane()],
            samples: [plane(), plane(), plane()],
            edges: vec![0; n],
            beyond: vec![border; n + 2 * MARGIN],
            ends: PlaneEnds::default(),
            shaded: ShadedRow::default(),
        }
    }

    /// Renders planes `rows` into their rows of pixels.
    fn band(&mut self, rows: Range<i64>, pixels: ChunksMut<'_, [u32; 4]>) -> Overflows {
        let reach = i64::from(self.setup.gradient.is_some());
        let mut overflows = Overflows::default();
        self.sides(rows.start - reach);
        for v in rows.start - reach..rows.start + reach {
            self.sides(v + 1);
            self.samples(v);
        }
        for (v, row) in rows.zip(pixels) {
            self.sides(v + reach + 1);
            self.samples(v + reach);
            overflows.shading += self.shade(v);
            let shear = self.setup.geometry.shear_u() as i64;
            overflows.pixel += self.cone.finish(|u, rgba| row[(u + shear) as usize] = rgba);
        }
        overflows
    }

    /// The lerps along w and u of plane `v`, where its rows are in the volume.
    fn sides(&mut self, v: i64) {
        let geometry = &self.setup.geometry;
        let offset = geometry.offset;
        let plane = &mut self.sides[v.rem_euclid(2) as usize];
        for k in self.bands.sampled() {
            let far = if offset == 0 { k } else { k + 1 };
            let (Some(front), Some(back)) = (geometry.row_at(v, k), geometry.row_at(v, far)) else {
                continue;
            };
            let step = (geometry.u.columns[far] - geometry.u.columns[k]) as usize;
            let edges = &mut self.edges[..geometry.size[0] - step];
            self.trilin.row_along_w(self.volume.row(front, k), &self.volume.row(back, far)[step..], offset, edges);
            let weight = geometry.u.weights[k];
            let reach = usize::from(weight != 0).min(edges.len());
            let sides = &mut plane.row_mut(k)[..edges.len() - reach];
            self.trilin.row(edges, &edges[reach..], weight, sides);
        }
    }

    /// The samples of plane `v`, the border around them.
    fn samples(&mut self, v: i64) {
        let geometry = &self.setup.geometry;
        let border = self.beyond[0];
        let [even, odd] = &self.sides;
        let (near, far) = if v.rem_euclid(2) == 0 { (even, odd) } else { (odd, even) };
        let plane = &mut self.samples[v.rem_euclid(3) as usize];
        for k in self.bands.depths() {
            let valid = geometry.valid_columns(v, k);
            let count = (valid.end - valid.start) as usize;
            let row = plane.row_mut(k);
            row[..MARGIN].fill(border);
            row[MARGIN + count..].fill(border);
            self.trilin.row(near.row(k), far.row(k), geometry.v.weights[k], &mut row[MARGIN..MARGIN + count]);
        }
    }

    /// Shades plane `v` and sends its rows into the cone, in order of depth. Returns the words that were saturated.
    fn shade(&mut self, v: i64) -> u64 {
        let setup = self.setup;
        let geometry = &setup.geometry;
        let (depths, sampled) = (self.bands.depths(), self.bands.sampled_in(geometry, v));
        let has_gradient = setup.gradient.is_some();
        let mut overflows = 0;
        let first = geometry.first_ray().u;
        self.ends.aim(v, first..geometry.size[0] as i64, setup);
        self.cone.pass(sampled.start);
        for k in sampled.clone() {
            let valid = geometry.valid_columns(v, k);
            let (from, to) = inside(&setup.clips, v, k, valid.start, valid.end);
            if from >= to {
                self.cone.pass(1);
                continue;
            }
            let n = (to - from) as usize;
            let (samples, beyond) = (&self.samples, self.beyond.as_slice());
            // Rows of the neighbourhood, from the neighbour on the left of the first lane to that on the right of the last.
            let row = |w: usize, dv: usize| -> &[i32] {
                let Some(depth) = (k + w).checked_sub(1).filter(|depth| depths.contains(depth)) else {
                    return &beyond[..n + 2];
                };
                if !has_gradient && (w, dv) != (1, 1) {
                    return &beyond[..n + 2];
                }
                let plane = &samples[(v + dv as i64 - 1).rem_euclid(3) as usize];
                let column = from + i64::from(geometry.u.columns[depth]);
                &plane.row(depth)[(column - 1 + MARGIN as i64) as usize..][..n + 2]
            };
            let rows: [[&[i32]; 3]; 3] = [0, 1, 2].map(|w| [0, 1, 2].map(|dv| row(w, dv)));
            self.shaded.present.clear();
            self.shaded.present.resize(n, 1);
            self.shaded.ends.clear();
            self.shaded.ends.extend(self.ends.row(k, from));
            let neighbour = |w: usize, dv: usize, u: usize| &rows[w][dv][u..u + n];
            self.abc.shade(n, neighbour, |lane| [from + lane as i64, v, k as i64], geometry, &mut self.shaded);
            let (cone, shaded) = (&mut self.cone, &self.shaded);
            vectorised(
                #[inline(always)]
                || cone.push(Some((from, shaded, |lane: usize| rows[1][1][lane + 1]))),
            );
            overflows += self.shaded.overflows;
        }
        self.cone.pass(depths.end - sampled.end);
        overflows
    }
}

/// The rays from `from` to `to` whose sample at plane `v` and depth `k` is inside of every clip.
fn inside(clips: &[HalfSpace], v: i64, k: usize, from: i64, to: i64) -> (i64, i64) {
    let [from, to] = clips.iter().fold([from, to], |rays, clip| clip.interval(v, k as i64, rays));
    (from, to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use cube3_frame::Linear;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn the_interval_of_a_clip_is_where_it_is_not_negative(
            planes in proptest::collection::vec((-9_i64..10, -9_i64..10, -9_i64..10, -90_i64..90), 0..4), v in -5_i64..5, k in 0_usize..5,
        ) {
            let clips: Vec<HalfSpace> = planes
                .iter()
                .map(|&(u, v, k, constant)| HalfSpace { distance: Linear { u, v, k, constant } })
                .collect();
            let (from, to) = inside(&clips, v, k, -20, 20);
            for u in -20..20 {
                let kept = clips.iter().all(|clip| clip.distance.at(u, v, k as i64) >= 0);
                prop_assert_eq!(kept, (from..to).contains(&u));
            }
        }

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
