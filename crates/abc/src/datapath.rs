//! What the ABC units' tokens carry, and how the lanes work on them: planes of samples in, coloured samples out.

use crate::ends::{End, ray_ends};
use crate::golden::Shaded;
use crate::lanes::{AbcLanes, Around, HERE, Neighbour, Neighbours, ShadedBlock, ShadedRow, reads};
use crate::unit::Shade;
use cube3_channel::{Archive, ArchiveError, Archived};
use cube3_frame::{
    BESIDE, DiscreteRay, FrameSetup, FrameShape, Geometry, RayStretches, SampleBounds, Schedule, ShadingOrder,
};
use cube3_trilin::{RaySamples, SampleRay};
use cube3_word::{BLOCK_LANES, LaneBlock};
use serde::{Deserialize, Serialize};

/// Coloured samples of a ray slot in order of depth, block by block. The sample at depth k is in lane `(slot + k) mod lanes`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShadedSamples(pub Vec<ShadedBlock>);

impl ShadedSamples {
    /// The samples of a ray.
    pub fn new(samples: &[Shaded]) -> ShadedSamples {
        let block = |samples: &[Shaded]| {
            let mut block = ShadedBlock::default();
            samples.iter().enumerate().for_each(|(lane, sample)| block.put(lane, sample));
            block
        };
        ShadedSamples(samples.chunks(BLOCK_LANES).map(block).collect())
    }

    /// The sample at a depth.
    #[inline]
    pub fn at(&self, depth: usize) -> Shaded {
        self.0[depth / BLOCK_LANES].at(depth % BLOCK_LANES)
    }
}

/// Samples of a plane, a row for each slot: in order of depth, with a word before the first and words up to a whole block and more behind the
/// last, which are 0 and lie in no volume.
type Plane = Vec<i32>;

/// The ABC units with their sample planes.
#[derive(Clone, Debug)]
pub struct Shader {
    arithmetic: AbcLanes,
    schedule: Schedule,
    /// Words of a slot's row in a plane: a block more than the samples have.
    row: usize,
    /// The first planes, where they are needed again, and the ring behind them.
    planes: Vec<Plane>,
    /// How many the first are.
    kept: usize,
    /// What each plane has for other sections than the one in hand, where there are several.
    overlap: Option<Overlap>,
    overflows: u64,
    /// Of a parallel frame; perspective asks for each sample.
    parallel: Option<Parallel>,
    perspective: Any,
    /// The rays of every slot, where their ends have parts of a step.
    stretches: Option<RayStretches>,
    /// The ends of the rays of the slot in hand, by depth.
    ends: Vec<End>,
}

/// Rows of a plane that are kept from one section to the next.
const BORDER: usize = ShadingOrder::BORDER;

/// The overlap buffers: rows of every plane that other sections need.
#[derive(Clone, Debug)]
struct Overlap {
    order: ShadingOrder,
    /// Of each plane the rows of the last slots so far: slot j is in row j mod 2.
    borders: Vec<Plane>,
    /// Of each plane the rows of slots 0 and 1, where slots are shared.
    firsts: Vec<Plane>,
}

impl Overlap {
    /// The rows that the ring gets with the first ray of a section's plane: each slot with where its row is.
    fn rows_before<'a>(&'a self, plane: usize, slot: usize, row: usize) -> impl Iterator<Item = (usize, &'a [i32])> {
        let section = self.order.sections().section(slot);
        let starts = self.order.sections().slots(section).start == slot;
        let [borders, firsts] = if starts { self.order.needed_before(section) } else { [0..0, 0..0] };
        let kept = move |planes: &'a [Plane], slot: usize| (slot, &planes[plane][slot % BORDER * row..][..row]);
        let borders = borders.map(move |slot| kept(&self.borders, slot));
        borders.chain(firsts.map(move |slot| kept(&self.firsts, slot)))
    }

    /// Keeps the row of a slot for other sections.
    fn keep(&mut self, plane: usize, slot: usize, row: &[i32]) {
        let place = slot % BORDER * row.len()..(slot % BORDER + 1) * row.len();
        if self.order.kept(self.order.sections().section(slot)).contains(&slot) {
            self.borders[plane][place.clone()].copy_from_slice(row);
        }
        if !self.firsts.is_empty() && slot < BORDER {
            self.firsts[plane][place].copy_from_slice(row);
        }
    }
}

/// What whole rays of a parallel frame are gathered with.
#[derive(Clone, Debug)]
struct Parallel {
    bounds: SampleBounds,
    /// Which samples lie in the volume along u, for every slot: see [`SampleBounds::bits`].
    along_u: Vec<[u16; BESIDE]>,
    /// The same along v for the plane in hand.
    along_v: Vec<[u16; BESIDE]>,
    plane: Option<usize>,
    /// Whether something depends on where a ray is.
    placed: bool,
    /// The rays of the slot and of the plane in hand, by depth.
    rays: [Vec<i32>; 2],
    /// Where the plane above the one in hand is kept, that one, and the one below, and which one that is, counted over all sections.
    planes: [usize; 3],
    around: Option<usize>,
}

impl Parallel {
    fn new(setup: &FrameSetup, slots: usize) -> Option<Parallel> {
        let geometry = &setup.geometry;
        let bounds = SampleBounds::new(geometry)?;
        let words = geometry.size[2].div_ceil(BLOCK_LANES);
        let mut along_u = vec![[0; BESIDE]; slots * words];
        let mut rays = Vec::new();
        for (slot, along_u) in along_u.chunks_mut(words).enumerate() {
            geometry.rays_along(0, slot, &mut rays);
            bounds.bits(0, &rays, along_u);
        }
        Some(Parallel {
            bounds,
            along_u,
            along_v: vec![[0; BESIDE]; words],
            plane: None,
            placed: !setup.clips.is_empty() || setup.depth_cue.is_some(),
            rays: [rays, Vec::new()],
            planes: [0; 3],
            around: None,
        })
    }

    /// Makes ready for a slot.
    fn aim(&mut self, geometry: &Geometry, plane: usize, slot: usize) {
        let [along_u, along_v] = &mut self.rays;
        if self.plane != Some(plane) {
            geometry.rays_along(1, plane, along_v);
            self.bounds.bits(1, along_v, &mut self.along_v);
            self.plane = Some(plane);
        }
        if self.placed {
            geometry.rays_along(0, slot, along_u);
        }
    }
}

/// What a ray of any frame is gathered with.
#[derive(Clone, Debug, Default)]
struct Any {
    /// Neighbourhood of the ray in hand: `[w][v][u]`, each by depth.
    around: Vec<Vec<i32>>,
    row: ShadedRow,
}

/// Samples of neighbour rays whose bits are set, and the border elsewhere.
#[inline(always)]
fn select(samples: [&LaneBlock<i32>; 4], bits: [u16; 4], border: i32) -> [LaneBlock<i32>; 4] {
    // Loaded before they are chosen from: a word that is loaded under a condition costs a branch.
    let samples = [*samples[0], *samples[1], *samples[2], *samples[3]];
    let mut out = [[0; BLOCK_LANES]; 4];
    for i in 0..BLOCK_LANES {
        for j in 0..4 {
            out[j][i] = if u32::from(bits[j]) >> i & 1 == 0 { border } else { samples[j][i] };
        }
    }
    out
}

/// Where a plane is kept to be read, of `planes` buffers of which the first `kept` are those of the first planes; `counted` is the plane
/// counted over all sections.
#[inline]
fn place(plane: usize, counted: usize, kept: usize, planes: usize) -> usize {
    if plane < kept { plane } else { in_ring(counted, kept, planes) }
}

/// Where a plane, counted over all sections, is in the ring behind those.
#[inline]
fn in_ring(counted: usize, kept: usize, planes: usize) -> usize {
    kept + counted % (planes - kept)
}

impl Shader {
    /// Units for a frame, which has this schedule on a machine of `planes` sample planes. A plane of the ring has a row for every slot, though
    /// the machine's has rows for those of one section. With `skip`, transparent stretches are not shaded, which changes no bit.
    pub fn new(setup: &FrameSetup, schedule: &Schedule, planes: usize, skip: bool) -> Shader {
        let ring = setup.ring(planes);
        let FrameShape { slots, planes: frame_planes, closes, .. } = *schedule.shape();
        let depths = setup.geometry.size[2].div_ceil(BLOCK_LANES) * BLOCK_LANES;
        let row = depths + BLOCK_LANES;
        let empty: Plane = vec![0; slots * row];
        let kept = if closes[1] { frame_planes.min(2) } else { 0 };
        let rows_kept = |planes| vec![vec![0; BORDER * row]; planes];
        let overlap = (!schedule.sections().is_whole()).then(|| Overlap {
            order: setup.shading_order(schedule),
            borders: rows_kept(frame_planes),
            firsts: rows_kept(if closes[0] { frame_planes } else { 0 }),
        });
        let parallel = Parallel::new(setup, slots);
        let rows = if parallel.is_none() { 27 } else { 0 };
        Shader {
            arithmetic: AbcLanes::new(setup, skip),
            schedule: *schedule,
            row,
            planes: vec![empty; kept + ring],
            kept,
            overlap,
            overflows: 0,
            parallel,
            perspective: Any { around: vec![vec![0; setup.geometry.size[2]]; rows], row: ShadedRow::default() },
            stretches: setup.ends.as_ref().map(|_| RayStretches::new(&setup.geometry)),
            ends: Vec::new(),
        }
    }

    /// Words saturated so far.
    pub fn overflows(&self) -> u64 {
        self.overflows
    }

    /// The row of a slot of a frame that is taken whole: a word, and then the samples in order of depth.
    #[inline]
    fn samples(&self, plane: usize, slot: usize) -> &[i32] {
        &self.planes[place(plane, plane, self.kept, self.planes.len())][slot * self.row..][..self.row]
    }

    /// Fills one of the 27 neighbour rays: the samples at displacement (u, v, w), u and v in units of the depth's reach, or the border.
    fn neighbour(&mut self, setup: &FrameSetup, rays: &[DiscreteRay], by: [i64; 3], border: i32) {
        let geometry = &setup.geometry;
        let place = ((by[2] + 1) * 9 + (by[1] + 1) * 3 + by[0] + 1) as usize;
        let mut row = std::mem::take(&mut self.perspective.around[place]);
        row.clear();
        for (k, ray) in rays.iter().enumerate() {
            let apart = setup.reach(k);
            let ray = DiscreteRay { u: ray.u + by[0] * apart, v: ray.v + by[1] * apart };
            let depth = k as i64 + by[2];
            row.push(if geometry.has_sample(ray, depth) {
                let [plane, slot] = geometry.slot_of(ray);
                self.samples(plane, slot)[depth as usize + 1]
            } else {
                border
            });
        }
        self.perspective.around[place] = row;
    }
}

impl Shade for Shader {
    type Input = RaySamples;
    type Output = ShadedSamples;

    fn blank(&self) -> ShadedSamples {
        ShadedSamples(vec![ShadedBlock::default(); self.row / BLOCK_LANES - 1])
    }

    fn take(&mut self, _: &FrameSetup, ray: &mut SampleRay<RaySamples>) {
        let (plane, slot) = (ray.plane as usize, ray.slot as usize);
        let row = slot * self.row..(slot + 1) * self.row;
        let counted = self.overlap.as_ref().map_or(plane, |overlap| overlap.order.plane_of_ray(plane, slot));
        let held = in_ring(counted, self.kept, self.planes.len());
        let place = &mut self.planes[held][row.clone()];
        for (from, block) in ray.data.0.iter().enumerate() {
            if let Some(place) = place[from * BLOCK_LANES + 1..].first_chunk_mut() {
                *place = block.samples;
            }
        }
        if plane < self.kept {
            let (first, ring) = self.planes.split_at_mut(self.kept);
            first[plane][row.clone()].copy_from_slice(&ring[held - self.kept][row.clone()]);
        }
        if let Some(overlap) = &mut self.overlap {
            let kept = (plane < self.kept).then_some(plane);
            for (slot, samples) in overlap.rows_before(plane, slot, self.row) {
                for place in kept.into_iter().chain([held]) {
                    self.planes[place][slot * self.row..][..self.row].copy_from_slice(samples);
                }
            }
            overlap.keep(plane, slot, &self.planes[held][row]);
        }
    }

    fn give(&mut self, setup: &FrameSetup, plane: usize, slot: usize, output: &mut ShadedSamples) {
        if output.0.len() != self.row / BLOCK_LANES - 1 {
            *output = self.blank();
        }
        if let Some(stretches) = &self.stretches {
            let rays = stretches.of(plane, slot);
            self.ends.clear();
            self.ends.extend(rays.flat_map(|(ray, depths)| ray_ends(ray, depths, setup)));
        }
        if self.parallel.is_some() {
            self.shade_parallel(setup, plane, slot, output);
        } else {
            self.shade_any(setup, plane, slot, output);
        }
    }
}

impl Shader {
    /// A slot of a parallel frame, whose neighbours are those of the same slots and planes at every depth.
    fn shade_parallel(&mut self, setup: &FrameSetup, plane: usize, slot: usize, output: &mut ShadedSamples) {
        let Shader {
            arithmetic,
            schedule,
            planes: buffers,
            row,
            kept,
            overlap,
            overflows,
            parallel: Some(parallel),
            ends,
            ..
        } = self
        else {
            return;
        };
        let geometry = &setup.geometry;
        let depths = geometry.size[2];
        parallel.aim(geometry, plane, slot);
        let border = setup.gradient.map_or(0, |registers| registers.border);
        let FrameShape { slots, planes, .. } = *schedule.shape();
        let counted = overlap.as_ref().map_or(plane, |overlap| overlap.order.plane_of_shaded(plane, slot));
        if parallel.around != Some(counted) {
            // Beyond the last plane comes the first where they are shared, and else nothing that is in the volume.
            let above = plane.checked_sub(1).unwrap_or(planes - 1);
            let below = if plane + 1 < planes { plane + 1 } else { 0 };
            let of_section = counted - plane;
            parallel.planes = [above, plane, below].map(|plane| place(plane, of_section + plane, *kept, buffers.len()));
            parallel.around = Some(counted);
        }
        // Likewise slots.
        let left = slot.checked_sub(1).unwrap_or(slots - 1);
        let right = if slot + 1 < slots { slot + 1 } else { 0 };
        let [above, here, below] = parallel.planes;
        let planes = [&buffers[above], &buffers[here], &buffers[below]];
        let starts = [left * *row, slot * *row, right * *row];
        let Parallel { along_u, along_v, rays: [rays_u, rays_v], .. } = parallel;
        let along_u = &along_u[slot * along_v.len()..];
        for (word, ((out, along_u), along_v)) in output.0.iter_mut().zip(along_u).zip(along_v).enumerate() {
            let from = word * BLOCK_LANES;
            let count = BLOCK_LANES.min(depths - from);
            let samples = |w: usize, v: usize, u: usize| -> &LaneBlock<i32> {
                planes[v][starts[u] + from + w..].first_chunk().unwrap_or(&[0; BLOCK_LANES])
            };
            let bits = |w: usize, v: usize, u: usize| along_u[3 * w + u] & along_v[3 * w + v];
            let at =
                |lane: usize| [i64::from(rays_u[from + lane]), i64::from(rays_v[from + lane]), (from + lane) as i64];
            for End { lane, class } in ends.iter().filter(|end| end.lane / BLOCK_LANES == word) {
                arithmetic.end(lane - from, *class);
            }
            let saturated = arithmetic.shade_block(
                #[inline(always)]
                |out: &mut ShadedBlock| {
                    let here = u32::from(bits(1, 1, 1));
                    for i in 0..BLOCK_LANES {
                        out.present[i] = here >> i & 1;
                    }
                    for clip in &setup.clips {
                        for (lane, present) in out.present[..count].iter_mut().enumerate() {
                            *present &= u32::from(geometry.evaluate(&clip.distance, at(lane)) >= 0);
                        }
                    }
                    out.samples = *samples(1, 1, 1);
                },
                #[inline(always)]
                |reads: &[Neighbours], around: &mut Around| {
                    for group in reads {
                        let samples = |i: usize| {
                            let Neighbour { w, v, u, .. } = group[i];
                            samples(w, v, u)
                        };
                        let bits = |i: usize| {
                            let Neighbour { w, v, u, .. } = group[i];
                            bits(w, v, u)
                        };
                        let samples = [samples(0), samples(1), samples(2), samples(3)];
                        let gathered = select(samples, [bits(0), bits(1), bits(2), bits(3)], border);
                        for (Neighbour { place, .. }, block) in group.iter().zip(&gathered) {
                            around[*place] = *block;
                        }
                    }
                },
                count,
                at,
                geometry,
                out,
            );
            *overflows += u64::from(saturated.unwrap_or(0));
        }
    }

    /// A slot of any frame, sample by sample.
    fn shade_any(&mut self, setup: &FrameSetup, plane: usize, slot: usize, output: &mut ShadedSamples) {
        let geometry = &setup.geometry;
        let depths = geometry.size[2];
        let rays: Vec<DiscreteRay> = (0..depths).map(|k| geometry.ray_in_slot(plane, slot, k)).collect();
        let border = setup.gradient.map_or(0, |registers| registers.border);
        self.neighbour(setup, &rays, [0; 3], border);
        if let Some(registers) = &setup.gradient {
            let mirrored = rays.first().map_or([false; 2], |ray| geometry.mirrored(*ray));
            for place in 0..27 {
                let by = [place % 3 - 1, place / 3 % 3 - 1, place / 9 - 1];
                let turned = [0, 1].map(|axis| if mirrored[axis] { -by[axis] } else { by[axis] });
                if by != [0; 3] && reads(registers.method, [turned[0], turned[1], by[2]]) {
                    self.neighbour(setup, &rays, by, border);
                }
            }
        }
        let Any { around, row } = &mut self.perspective;
        row.present.clear();
        row.present.extend(rays.iter().enumerate().map(|(k, ray)| {
            let inside =
                |clip: &cube3_frame::HalfSpace| geometry.evaluate(&clip.distance, [ray.u, ray.v, k as i64]) >= 0;
            u8::from(geometry.has_sample(*ray, k as i64) && setup.clips.iter().all(inside))
        }));
        if let Some(ray) = rays.first() {
            self.arithmetic.aim(ray.v, ray.u..ray.u + 1);
        }
        row.ends.clone_from(&self.ends);
        let neighbour = |w: usize, v: usize, u: usize| around[w * 9 + v * 3 + u].as_slice();
        let at = |k: usize| [rays[k].u, rays[k].v, k as i64];
        self.arithmetic.shade(depths, neighbour, at, geometry, row);
        self.overflows += row.overflows;
        for (k, &sample) in around[HERE].iter().enumerate() {
            let present = row.present[k] != 0;
            let shaded = Shaded {
                present,
                sample: if present { sample } else { 0 },
                opacity: row.opacity[k],
                colour: [row.colour[0][k], row.colour[1][k], row.colour[2][k]],
            };
            output.0[k / BLOCK_LANES].put(k % BLOCK_LANES, &shaded);
        }
    }
}

impl Archived for Shader {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let Shader {
            arithmetic: _,
            schedule: _,
            row: _,
            planes,
            kept: _,
            overlap,
            overflows,
            parallel: _,
            perspective: _,
            stretches: _,
            ends: _,
        } = self;
        planes.iter_mut().try_for_each(|plane| archive.list(plane))?;
        if let Some(Overlap { borders, firsts, .. }) = overlap {
            borders.iter_mut().chain(firsts).try_for_each(|rows| archive.list(rows))?;
        }
        archive.item(overflows)
    }
}
