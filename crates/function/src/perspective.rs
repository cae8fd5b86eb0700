//! The same for a perspective pass: rows hold the rays of a plane by slot, gathered from the volume by the fan.
//!
//! The lerps along u of plane v + 1 serve plane v now and plane v + 1 next, unless slots have cells of their own; planes
//! of samples as far above and below as neighbours are serve the gradient.

use crate::canonical_volume::CanonicalVolume;
use crate::plane::Plane;
use cube3_abc::ends::PlaneEnds;
use cube3_abc::lanes::{AbcLanes, ShadedRow};
use cube3_cone::lanes::{Accumulator, ConeLanes};
use cube3_frame::{Bands, FrameSetup, Overflows, PerspectivePass};
use cube3_trilin::lanes::TrilinLanes;
use cube3_word::vectorised;
use std::ops::Range;
use std::slice::ChunksMut;

/// The units' lanes and the planes between them, for one band of a pass.
pub(crate) struct PassWorker<'a, T> {
    setup: &'a FrameSetup,
    pass: &'a PerspectivePass,
    bands: &'a Bands,
    volume: &'a CanonicalVolume<'a>,
    trilin: TrilinLanes,
    abc: AbcLanes,
    cone: ConeLanes<T>,
    /// Lerps along u: of planes v and v + 1, by parity; where slots have their own cells, above and below the one plane.
    sides: [Plane; 2],
    /// Places before slot 0 of a row of samples, and planes above and below that are read: as far as neighbours are.
    reach: usize,
    /// Samples of planes v − reach to v + reach, by remainder of their number, the border around them.
    samples: Vec<Plane>,
    /// Lerps along w in columns L and R.
    edges: [Vec<i32>; 2],
    beyond: Vec<i32>,
    /// Ends of the rays of the plane in hand.
    ends: PlaneEnds,
    shaded: ShadedRow,
}

impl<'a, T: Accumulator> PassWorker<'a, T> {
    pub fn new(
        setup: &'a FrameSetup,
        pass: &'a PerspectivePass,
        bands: &'a Bands,
        volume: &'a CanonicalVolume<'a>,
        abc: AbcLanes,
    ) -> PassWorker<'a, T> {
        let (slots, depths) = (pass.u.count(), setup.geometry.size[2]);
        let border = setup.gradient.map_or(0, |registers| registers.border);
        let plane = |stride| Plane::new(stride, depths);
        let reach = setup.most_reach();
        let row = slots + 2 * reach;
        PassWorker {
            setup,
            pass,
            bands,
            volume,
            trilin: TrilinLanes::new(&setup.words),
            abc,
            cone: ConeLanes::new(setup.cone, setup.words),
            sides: [plane(slots), plane(slots)],
            reach,
            samples: (0..=2 * reach).map(|_| plane(row)).collect(),
            edges: [vec![0; slots + 1], vec![0; slots + 1]],
            beyond: vec![border; row],
            ends: PlaneEnds::default(),
            shaded: ShadedRow::default(),
        }
    }

    /// Renders planes `rows` into their rows of pixels.
    pub fn band(&mut self, rows: Range<i64>, pixels: ChunksMut<'_, [u32; 4]>) -> Overflows {
        let reach = if self.setup.gradient.is_some() { self.reach as i64 } else { 0 };
        let mut overflows = Overflows::default();
        if !self.pass.doubled {
            self.plane_sides(rows.start - reach);
        }
        for v in rows.start - reach..rows.start + reach {
            self.samples(v);
        }
        for (v, row) in rows.zip(pixels) {
            self.samples(v + reach);
            overflows.shading += self.shade(v);
            let start = self.pass.u.first;
            overflows.pixel += self.cone.finish(|u, rgba| row[(u - start) as usize] = rgba);
        }
        overflows
    }

    /// The lerps along w and u in the rows of plane `v` itself.
    fn plane_sides(&mut self, v: i64) {
        let Some(j) = self.pass.v.index(v) else {
            return;
        };
        for k in self.bands.sampled() {
            self.sides(v.rem_euclid(2) as usize, k, |pass, k| pass.v.near(j, k));
        }
    }

    /// The lerps along w and u at a depth, in the rows that `row_at` gives for the two planes of it, where they are in the volume.
    fn sides(&mut self, into: usize, k: usize, row_at: impl Fn(&PerspectivePass, usize) -> i32) {
        let geometry = &self.setup.geometry;
        let far = if geometry.offset == 0 { k } else { k + 1 };
        let row = |k: usize| usize::try_from(row_at(self.pass, k)).ok().filter(|&row| row < geometry.size[1]);
        let (Some(front), Some(back)) = (row(k), row(far)) else {
            return;
        };
        let (front, back) = (self.volume.row(front, k), self.volume.row(back, far));
        let fan = &self.pass.u;
        let valid = fan.valid(k);
        let n = valid.len();
        let gather = |columns: [&[i32]; 2], rays: Range<usize>, out: &mut [i32]| {
            let columns = columns.map(|row| &row[rays.clone()]);
            self.trilin.gathered_along_w(front, back, columns, geometry.offset, &mut out[..rays.len()]);
        };
        let [left, right] = &mut self.edges;
        let near = [fan.near_row(k), fan.near_row(far)];
        let right = if self.pass.doubled {
            gather(near, valid.clone(), left);
            gather([fan.right_row(k), fan.right_row(far)], valid.clone(), right);
            &right[..n]
        } else {
            // The right column is that of the next ray; the last of all has a weight of 0 for want of it.
            gather(near, valid.start..(valid.end + usize::from(n > 0)).min(fan.count()), left);
            &left[1..n + 1]
        };
        let sides = &mut self.sides[into].row_mut(k)[valid.clone()];
        self.trilin.row_by_weights(&left[..n], right, &fan.weight_row(k)[valid], sides);
    }

    /// The samples of plane `v`, the border around them.
    fn samples(&mut self, v: i64) {
        let geometry = &self.setup.geometry;
        let border = self.beyond[0];
        if self.pass.doubled {
            if let Some(j) = self.pass.v.index(v) {
                for k in self.bands.sampled() {
                    self.sides(0, k, |pass, k| pass.v.near(j, k));
                    self.sides(1, k, |pass, k| pass.v.right(j, k));
                }
            }
        } else {
            self.plane_sides(v + 1);
        }
        let [even, odd] = &self.sides;
        let (near, far) = if self.pass.doubled || v.rem_euclid(2) == 0 { (even, odd) } else { (odd, even) };
        let planes = self.samples.len() as i64;
        let margin = self.reach;
        let plane = &mut self.samples[v.rem_euclid(planes) as usize];
        for k in self.bands.depths() {
            let row = plane.row_mut(k);
            let rays = geometry.valid_columns(v, k);
            if rays.is_empty() {
                row.fill(border);
                continue;
            }
            let [from, to] = [rays.start, rays.end].map(|u| (u - self.pass.u.first) as usize);
            row[..margin + from].fill(border);
            row[margin + to..].fill(border);
            let weight = self.pass.v.index(v).map_or(0, |j| self.pass.v.weight(j, k));
            let out = &mut row[margin + from..margin + to];
            self.trilin.row(&near.row(k)[from..to], &far.row(k)[from..to], weight, out);
        }
    }

    /// Shades plane `v` and sends its rows into the cone, in order of depth. Returns the words that were saturated.
    fn shade(&mut self, v: i64) -> u64 {
        let setup = self.setup;
        let geometry = &setup.geometry;
        let (depths, sampled) = (self.bands.depths(), self.bands.sampled_in(geometry, v));
        let first = self.pass.u.first;
        let has_gradient = setup.gradient.is_some();
        let mut overflows = 0;
        let rays = first..first + self.pass.u.count() as i64;
        self.abc.aim(v, rays.clone());
        self.ends.aim(v, rays, setup);
        self.cone.pass(sampled.start);
        for k in sampled.clone() {
            let (from, to) = self.inside(v, k);
            if from >= to {
                self.cone.pass(1);
                continue;
            }
            let n = (to - from) as usize;
            let (samples, beyond, reach) = (&self.samples, self.beyond.as_slice(), self.reach);
            let (apart, planes) = (setup.reach(k), samples.len() as i64);
            let wide = n + 2 * apart as usize;
            // Rows of the neighbourhood, from the neighbour on the left of the first lane to that on the right of the last.
            let row = |w: usize, dv: usize| -> &[i32] {
                let Some(depth) = (k + w).checked_sub(1).filter(|depth| depths.contains(depth)) else {
                    return &beyond[..wide];
                };
                if !has_gradient && (w, dv) != (1, 1) {
                    return &beyond[..wide];
                }
                let plane = &samples[(v + (dv as i64 - 1) * apart).rem_euclid(planes) as usize];
                &plane.row(depth)[(from - first + reach as i64 - apart) as usize..][..wide]
            };
            let rows: [[&[i32]; 3]; 3] = [0, 1, 2].map(|w| [0, 1, 2].map(|dv| row(w, dv)));
            self.shaded.present.clear();
            self.shaded.present.resize(n, 1);
            self.shaded.ends.clear();
            self.shaded.ends.extend(self.ends.row(k, from));
            let neighbour = |w: usize, dv: usize, u: usize| &rows[w][dv][u * apart as usize..][..n];
            self.abc.shade(n, neighbour, |lane| [from + lane as i64, v, k as i64], geometry, &mut self.shaded);
            let (cone, shaded) = (&mut self.cone, &self.shaded);
            vectorised(
                #[inline(always)]
                || cone.push(Some((from, shaded, |lane: usize| rows[1][1][lane + apart as usize]))),
            );
            overflows += self.shaded.overflows;
        }
        self.cone.pass(depths.end - sampled.end);
        overflows
    }

    /// The rays of plane `v` that have a sample at depth `k` inside of every clip. A clip's distance never turns along u.
    fn inside(&self, v: i64, k: usize) -> (i64, i64) {
        let geometry = &self.setup.geometry;
        let valid = geometry.valid_columns(v, k);
        let (mut from, mut to) = (valid.start, valid.end);
        for clip in &self.setup.clips {
            let outside = |u: i64| geometry.evaluate(&clip.distance, [u, v, k as i64]) < 0;
            while from < to && outside(from) {
                from += 1;
            }
            while from < to && outside(to - 1) {
                to -= 1;
            }
        }
        (from, to)
    }
}
