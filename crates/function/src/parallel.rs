//! A band of planes of a parallel frame: whole rows through the units' lanes.
//!
//! Planes of samples follow each other as in the machine: the lerps along u of plane v + 1 serve plane v now and plane v + 1 next; three
//! planes of samples serve the gradient. Rows lie along u in voxel columns x = u + X(k), so that the row of the next depth is a shift.

use crate::canonical_volume::CanonicalVolume;
use crate::plane::Plane;
use cube3_abc::ends::PlaneEnds;
use cube3_abc::lanes::{AbcLanes, ShadedRow};
use cube3_cone::lanes::{Accumulator, ConeLanes};
use cube3_frame::{Bands, FrameSetup, HalfSpace, Overflows};
use cube3_trilin::lanes::TrilinLanes;
use cube3_word::vectorised;
use std::ops::Range;
use std::slice::ChunksMut;

/// Places before column 0 of a row of samples: neighbour −1 of a row that is one column behind.
const MARGIN: usize = 2;

/// The units' lanes and the planes between them, for one band.
pub(crate) struct Worker<'a, T> {
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
    pub fn new(
        setup: &'a FrameSetup,
        bands: &'a Bands,
        volume: &'a CanonicalVolume<'a>,
        abc: AbcLanes,
    ) -> Worker<'a, T> {
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
    pub fn band(&mut self, rows: Range<i64>, pixels: ChunksMut<'_, [u32; 4]>) -> Overflows {
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
    }
}
