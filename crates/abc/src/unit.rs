//! The ABC units on their channels: rays of samples in, rays of coloured samples out, a plane and a ray later.
//!
//! ```text
//!   [samples] ──► ring of planes (and the first two) ──► 3 × 3 rays ──► gradient, table, light ──► [shaded]
//! ```
//! A ray is shaded when its neighbours in the planes above and below have come, in near frames several planes away. Where slots are shared, the last
//! plane's neighbour is the first, so the first is shaded last; rays of a plane likewise. Without a gradient,
//! rays pass straight through.
//!
//! Where the slots of a plane are taken in sections, planes of the ring are those of one section. The last two rays of a section, which the
//! next one needs beside its own, go to an overlap buffer with two for every plane; so do the first two of the plane where slots are shared.

use crate::ends::{End, ray_ends};
use crate::golden::Shaded;
use crate::lanes::{AbcLanes, Around, HERE, Neighbour, Neighbours, ShadedBlock, ShadedRow, reads};
use cube3_channel::{Account, Activity, Archive, ArchiveError, Archived, Channel, Payload, PortState, Wait};
use cube3_frame::{BESIDE, DiscreteRay, FrameSetup, Geometry, RayStretches, SampleBounds, Sections};
use cube3_machine::{GradientMethod, MachineSpec};
use cube3_trilin::{RaySamples, SampleRay};
use cube3_word::{BLOCK, Block};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A slot of coloured samples.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ShadedRay<D> {
    /// Frame, from 0.
    pub frame: u32,
    /// Plane of ray slots.
    pub plane: u32,
    /// Ray slot.
    pub slot: u32,
    /// The samples.
    pub data: D,
}

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
        ShadedSamples(samples.chunks(BLOCK).map(block).collect())
    }

    /// The sample at a depth.
    #[inline]
    pub fn at(&self, depth: usize) -> Shaded {
        self.0[depth / BLOCK].at(depth % BLOCK)
    }
}

/// The ABC units' arithmetic, or nothing where only time counts.
pub trait Shade: Archived {
    /// What rays of samples carry.
    type Input: Default;
    /// What rays of coloured samples carry.
    type Output: Payload;

    /// An empty ray with memory for the coloured samples of one.
    fn blank(&self) -> Self::Output;

    /// Takes the next ray of a plane.
    fn take(&mut self, setup: &FrameSetup, ray: &mut SampleRay<Self::Input>);

    /// Shades a slot whose neighbours have all been taken.
    fn give(&mut self, setup: &FrameSetup, plane: usize, slot: usize, output: &mut Self::Output);
}

/// ABC units for timing alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoShading;

impl Shade for NoShading {
    type Input = ();
    type Output = ();

    fn blank(&self) {}

    #[inline(always)]
    fn take(&mut self, _: &FrameSetup, _: &mut SampleRay<()>) {}

    #[inline(always)]
    fn give(&mut self, _: &FrameSetup, _: usize, _: usize, _: &mut ()) {}
}

impl Archived for NoShading {
    fn archive(&mut self, _: &mut Archive<'_>) -> Result<(), ArchiveError> {
        Ok(())
    }
}

/// Samples of a plane, a row for each slot: in order of depth, with a word before the first and words up to a whole block and more behind the
/// last, which are 0 and lie in no volume.
type Plane = Vec<i32>;

/// The ABC units with their sample planes.
#[derive(Clone, Debug)]
pub struct Shader {
    arithmetic: AbcLanes,
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

/// Rays of a plane that a section needs of those before it.
const BORDER: usize = 2;

/// The overlap buffers: rows of every plane that other sections need.
#[derive(Clone, Debug)]
struct Overlap {
    /// Sections of the rays that come.
    sections: Sections,
    /// Planes of the frame.
    planes: usize,
    /// Whether rays wait for their neighbours.
    buffered: bool,
    /// Whether the last slot's neighbour is the first.
    closes: bool,
    /// Of each plane the rows of the last slots so far: slot j is in row j mod 2.
    borders: Vec<Plane>,
    /// Of each plane the rows of slots 0 and 1, where slots are shared.
    firsts: Vec<Plane>,
}

impl Overlap {
    /// A plane of the section that a slot comes with, counted over all sections.
    fn plane_of_ray(&self, plane: usize, slot: usize) -> usize {
        self.sections.section(slot) * self.planes + plane
    }

    /// A plane of the section in which a slot has all of its neighbours.
    fn plane_of_shaded(&self, plane: usize, slot: usize, slots: usize) -> usize {
        let last = match (self.buffered, self.closes) {
            (false, _) => slot,
            (true, true) if slot == 0 => slots - 1,
            (true, _) => (slot + 1).min(slots - 1),
        };
        self.plane_of_ray(plane, last)
    }

    /// The rows that the ring gets with the first ray of a section's plane: each slot with where its row is.
    fn rows_before<'a>(&'a self, plane: usize, slot: usize, row: usize) -> impl Iterator<Item = (usize, &'a [i32])> {
        let section = self.sections.section(slot);
        let starts = self.sections.slots(section).start == slot;
        let borders = if starts { slot.saturating_sub(BORDER)..slot } else { 0..0 };
        let last = starts && self.closes && section + 1 == self.sections.count();
        let firsts = if last { 0..BORDER.min(borders.start) } else { 0..0 };
        let kept = move |planes: &'a [Plane], slot: usize| (slot, &planes[plane][slot % BORDER * row..][..row]);
        let borders = borders.map(move |slot| kept(&self.borders, slot));
        borders.chain(firsts.map(move |slot| kept(&self.firsts, slot)))
    }

    /// Keeps the row of a slot for other sections.
    fn keep(&mut self, plane: usize, slot: usize, row: &[i32]) {
        let place = slot % BORDER * row.len()..(slot % BORDER + 1) * row.len();
        let section = self.sections.section(slot);
        if section + 1 < self.sections.count() && slot + BORDER >= self.sections.slots(section).end {
            self.borders[plane][place.clone()].copy_from_slice(row);
        }
        if self.closes && slot < BORDER {
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
    fn new(setup: &FrameSetup) -> Option<Parallel> {
        let geometry = &setup.geometry;
        let bounds = SampleBounds::new(geometry)?;
        let words = geometry.size[2].div_ceil(BLOCK);
        let [slots, _] = geometry.slot_counts();
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
fn select(samples: [&Block<i32>; 4], bits: [u16; 4], border: i32) -> [Block<i32>; 4] {
    // Loaded before they are chosen from: a word that is loaded under a condition costs a branch.
    let samples = [*samples[0], *samples[1], *samples[2], *samples[3]];
    let mut out = [[0; BLOCK]; 4];
    for i in 0..BLOCK {
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
    /// Units for a frame on a machine of `planes` sample planes. With `skip`, transparent stretches are not shaded, which changes no bit.
    pub fn new(setup: &FrameSetup, planes: usize, skip: bool) -> Shader {
        let ring = setup.ring(planes);
        let [slots, frame_planes] = setup.geometry.slot_counts();
        let depths = setup.geometry.size[2].div_ceil(BLOCK) * BLOCK;
        let row = depths + BLOCK;
        let empty: Plane = vec![0; slots * row];
        let kept = if setup.geometry.closes()[1] { frame_planes.min(2) } else { 0 };
        let parallel = Parallel::new(setup);
        let rows = if parallel.is_none() { 27 } else { 0 };
        Shader {
            arithmetic: AbcLanes::new(setup, skip),
            row,
            planes: vec![empty; kept + ring],
            kept,
            overlap: None,
            overflows: 0,
            parallel,
            perspective: Any { around: vec![vec![0; setup.geometry.size[2]]; rows], row: ShadedRow::default() },
            stretches: setup.ends.as_ref().map(|_| RayStretches::new(&setup.geometry)),
            ends: Vec::new(),
        }
    }

    /// The same for a frame that is taken in sections. A plane of the ring has a row for every slot, though the machine's has rows for those
    /// of one section.
    #[must_use]
    pub fn in_sections(mut self, setup: &FrameSetup, sections: Sections) -> Shader {
        let geometry = &setup.geometry;
        let [_, planes] = geometry.slot_counts();
        let closes = geometry.closes()[0];
        let rows = |planes| vec![vec![0; BORDER * self.row]; planes];
        self.overlap = (!sections.is_whole()).then(|| Overlap {
            sections: sections.behind(1),
            planes,
            buffered: setup.gradient.is_some(),
            closes,
            borders: rows(planes),
            firsts: rows(if closes { planes } else { 0 }),
        });
        self
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

/// How many lanes away the samples are that a gradient method reads where neighbours are `rays` rays away: a ray along u and a step along w are a
/// lane each. `against` is whether the ray runs against u, so that it is shaded in the mirror.
pub fn reach(method: GradientMethod, rays: usize, against: bool) -> usize {
    let steps = [-1_i64, 0, 1];
    let all = steps.into_iter().flat_map(|u| steps.into_iter().flat_map(move |v| steps.map(|w| [u, v, w])));
    let along = if against { -(rays as i64) } else { rays as i64 };
    all.filter(|by| reads(method, *by)).map(|by| (by[0] * along + by[2]).unsigned_abs() as usize).max().unwrap_or(0)
}

/// The farthest of them for any ray of a frame; 0 where it needs no gradient.
pub fn frame_reach(setup: &FrameSetup) -> usize {
    let Some(registers) = &setup.gradient else {
        return 0;
    };
    let slopes = setup.geometry.perspective.as_ref().map_or(&[0][..], |pass| &pass.u.slopes);
    let runs = [false, true].into_iter().filter(|&against| slopes.iter().any(|&slope| (slope < 0) == against));
    runs.map(|against| reach(registers.method, setup.most_reach(), against)).max().unwrap_or(0)
}

impl Shade for Shader {
    type Input = RaySamples;
    type Output = ShadedSamples;

    fn blank(&self) -> ShadedSamples {
        ShadedSamples(vec![ShadedBlock::default(); self.row / BLOCK - 1])
    }

    fn take(&mut self, _: &FrameSetup, ray: &mut SampleRay<RaySamples>) {
        let (plane, slot) = (ray.plane as usize, ray.slot as usize);
        let row = slot * self.row..(slot + 1) * self.row;
        let counted = self.overlap.as_ref().map_or(plane, |overlap| overlap.plane_of_ray(plane, slot));
        let held = in_ring(counted, self.kept, self.planes.len());
        let place = &mut self.planes[held][row.clone()];
        for (from, block) in ray.data.0.iter().enumerate() {
            if let Some(place) = place[from * BLOCK + 1..].first_chunk_mut() {
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
        if output.0.len() != self.row / BLOCK - 1 {
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
            arithmetic, planes: buffers, row, kept, overlap, overflows, parallel: Some(parallel), ends, ..
        } = self
        else {
            return;
        };
        let geometry = &setup.geometry;
        let depths = geometry.size[2];
        parallel.aim(geometry, plane, slot);
        let border = setup.gradient.map_or(0, |registers| registers.border);
        let [slots, planes] = geometry.slot_counts();
        let counted = overlap.as_ref().map_or(plane, |overlap| overlap.plane_of_shaded(plane, slot, slots));
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
            let from = word * BLOCK;
            let count = BLOCK.min(depths - from);
            let samples = |w: usize, v: usize, u: usize| -> &Block<i32> {
                planes[v][starts[u] + from + w..].first_chunk().unwrap_or(&[0; BLOCK])
            };
            let bits = |w: usize, v: usize, u: usize| along_u[3 * w + u] & along_v[3 * w + v];
            let at =
                |lane: usize| [i64::from(rays_u[from + lane]), i64::from(rays_v[from + lane]), (from + lane) as i64];
            for End { lane, class } in ends.iter().filter(|end| end.lane / BLOCK == word) {
                arithmetic.end(lane - from, *class);
            }
            let saturated = arithmetic.shade_block(
                #[inline(always)]
                |out: &mut ShadedBlock| {
                    let here = u32::from(bits(1, 1, 1));
                    for i in 0..BLOCK {
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
            output.0[k / BLOCK].put(k % BLOCK, &shaded);
        }
    }
}

/// Data sheet of the ABC units for one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AbcSpec {
    /// Cycles of a ray: ⌈n_w / lanes⌉.
    pub ray_cycles: u64,
    /// Ray slots of a plane.
    pub slots: u64,
    /// Planes of the frame.
    pub planes: u64,
    /// Whether the last slot's neighbour is the first, along u and along v.
    pub closes: [bool; 2],
    /// Whether rays wait for their neighbours at all.
    pub buffered: bool,
    /// How many rays and planes away neighbours are.
    pub reach: u64,
    /// Planes of samples in the ring: above, current, below, and those that come in.
    pub ring: u64,
    /// Sections of the rays that come: TRILIN gives a ray when the next has come.
    pub sections: Sections,
}

impl AbcSpec {
    /// The data sheet for a machine and the registers of a frame.
    pub fn new(machine: &MachineSpec, setup: &FrameSetup) -> AbcSpec {
        let [slots, planes] = setup.geometry.slot_counts();
        AbcSpec {
            ray_cycles: setup.geometry.size[2].div_ceil(machine.lanes) as u64,
            slots: slots as u64,
            planes: planes as u64,
            closes: setup.geometry.closes(),
            buffered: setup.gradient.is_some(),
            reach: setup.most_reach() as u64,
            ring: setup.ring(machine.abc.planes) as u64,
            sections: Sections::of(machine, &setup.geometry).behind(1),
        }
    }

    /// The slots that come with a section.
    fn taken(&self, section: usize) -> Range<u64> {
        let Range { start, end } = self.sections.slots(section);
        start as u64..end as u64
    }

    /// The slots that are shaded in a section, counted in the order in which they are: those whose neighbours have all come.
    fn given(&self, section: usize) -> Range<u64> {
        let behind = if self.buffered { self.reach as usize + usize::from(self.closes[0]) } else { 0 };
        let Range { start, end } = self.sections.behind(behind).slots(section);
        start as u64..end as u64
    }

    /// The slots of a frame, plane and ray, in the order in which they are shaded. Where the last is followed by the first, the first
    /// comes last.
    pub fn order(&self) -> impl Iterator<Item = [u64; 2]> + use<> {
        let spec = *self;
        let planes = move |section| (0..spec.planes).map(move |plane| (plane, spec.given(section)));
        let counted = (0..spec.sections.count()).flat_map(planes);
        counted.flat_map(move |(plane, slots)| slots.map(move |slot| spec.turned([plane, slot])))
    }

    /// The same for the plane and slot that would be next if the first came first.
    #[inline]
    fn turned(&self, [plane, slot]: [u64; 2]) -> [u64; 2] {
        let turn = |i: u64, n: u64, closes: bool| {
            if !(closes && self.buffered) {
                i
            } else if i + 1 == n {
                0
            } else {
                i + 1
            }
        };
        [turn(plane, self.planes, self.closes[1]), turn(slot, self.slots, self.closes[0])]
    }

    /// The oldest plane of the ring that the slots of a plane, counted in the order in which they are shaded, and later ones need: the one
    /// above it. Where the first plane comes last, that is the last.
    #[inline]
    fn oldest(&self, plane: u64) -> u64 {
        let [current, _] = self.turned([plane, 0]);
        if !self.buffered {
            current
        } else if self.closes[1] && plane + 1 >= self.planes {
            self.planes - 1
        } else {
            current.saturating_sub(self.reach)
        }
    }

    /// How many rays must have come before a slot can be shaded.
    #[inline]
    pub fn needed(&self, plane: u64, slot: u64) -> u64 {
        let last = self.last([plane, slot]);
        let of_section = self.taken(self.sections.section(last[1] as usize));
        of_section.start * self.planes + in_section(&of_section, last) + 1
    }

    /// The last plane and ray that a slot needs.
    #[inline]
    fn last(&self, [plane, slot]: [u64; 2]) -> [u64; 2] {
        if !self.buffered {
            return [plane, slot];
        }
        let last = |i: u64, n: u64, closes: bool| if closes && i == 0 { n - 1 } else { (i + self.reach).min(n - 1) };
        [last(plane, self.planes, self.closes[1]), last(slot, self.slots, self.closes[0])]
    }
}

/// Rays of a section, which has these slots, before the one of a plane and slot.
#[inline]
fn in_section(slots: &Range<u64>, [plane, slot]: [u64; 2]) -> u64 {
    plane * (slots.end - slots.start) + slot - slots.start
}

/// The ABC unit.
#[derive(Clone, Debug)]
pub struct AbcUnit<A> {
    frames: Vec<(AbcSpec, A)>,
    passes: Vec<Pass>,
    state: State,
    /// Planes of the pass that is taken for which the ring has a buffer, as `state` says.
    room: u64,
    account: Account,
}

/// A section of a frame with rays in it.
#[derive(Clone, Debug)]
struct Pass {
    frame: u32,
    /// Slots that come, and that are shaded in the order in which they are.
    taken: Range<u64>,
    given: Range<u64>,
    /// Rays and planes of the passes before.
    rays: u64,
    planes: u64,
}

/// Where the two ports are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    /// Rays taken, over all frames, and the pass of the next.
    taken: u64,
    taking: u32,
    /// Pass that is being given.
    giving: u32,
    /// Plane and slot of the next given of that pass, counted in the order in which they are.
    next: [u64; 2],
    take_spent: u64,
    give_spent: u64,
}

impl<A> AbcUnit<A> {
    /// Finds for which planes of the pass that is being taken the ring has a buffer: the plane above the one being shaded is still needed. The
    /// buffers of first planes serve two passes, the one being shaded and the next.
    fn look(&mut self) {
        let State { taking, giving, next, .. } = self.state;
        self.room = match (self.passes.get(giving as usize), self.passes.get(taking as usize)) {
            (None, _) => u64::MAX,
            (_, None) => 0,
            _ if taking > giving + 1 => 0,
            (Some(giving), Some(taking)) => {
                let spec = &self.frames[giving.frame as usize].0;
                let behind = giving.planes + spec.oldest(next[0]) + spec.ring;
                let room = behind.saturating_sub(taking.planes);
                // The next frame's ring may be the smaller one: its neighbours may be nearer.
                let other = taking.frame != giving.frame;
                if other { room.min(self.frames[taking.frame as usize].0.ring) } else { room }
            }
        };
    }
}

impl<A: Shade> AbcUnit<A> {
    /// The unit's name.
    pub const NAME: &'static str = "abc";

    /// Units at the start of the first frame: a data sheet and the arithmetic for each.
    pub fn new(parts: impl IntoIterator<Item = (AbcSpec, A)>) -> AbcUnit<A> {
        let frames: Vec<(AbcSpec, A)> = parts.into_iter().collect();
        let (mut passes, mut rays, mut planes) = (Vec::new(), 0, 0);
        for (frame, (spec, _)) in (0..).zip(&frames) {
            for section in 0..spec.sections.count() {
                let taken = spec.taken(section);
                let width = taken.end - taken.start;
                if width > 0 {
                    passes.push(Pass { frame, taken, given: spec.given(section), rays, planes });
                    rays += width * spec.planes;
                    planes += spec.planes;
                }
            }
        }
        let mut unit = AbcUnit { frames, passes, state: State::default(), room: 0, account: Account::default() };
        unit.aim();
        unit
    }

    /// Goes on to the next pass in which slots are shaded: narrow sections at a frame's start have none yet.
    fn aim(&mut self) {
        while let Some(pass) = self.passes.get(self.state.giving as usize) {
            self.state.next = [0, pass.given.start];
            if !pass.given.is_empty() {
                break;
            }
            self.state.giving += 1;
        }
        self.look();
    }

    /// One cycle: a ray is taken and a ray is given, at most. `frames` are the registers of all frames.
    #[inline]
    pub fn tick(
        &mut self,
        frames: &[FrameSetup],
        samples: &mut Channel<SampleRay<A::Input>>,
        shaded: &mut Channel<ShadedRay<A::Output>>,
    ) -> Activity {
        let taken = self.take(frames, samples);
        let given = self.give(frames, shaded);
        let activity = match (taken, given) {
            (Activity::Busy, _) | (_, Activity::Busy) => Activity::Busy,
            (Activity::Blocked, _) | (_, Activity::Blocked) => Activity::Blocked,
            (Activity::Starved, given) => given,
            (taken, _) => taken,
        };
        self.account.record(activity)
    }

    #[inline]
    fn take(&mut self, frames: &[FrameSetup], samples: &mut Channel<SampleRay<A::Input>>) -> Activity {
        let Some(ray) = samples.front() else {
            return samples.lack();
        };
        if u64::from(ray.plane) >= self.room {
            return Activity::Blocked;
        }
        let frame = ray.frame as usize;
        let (spec, arithmetic) = &mut self.frames[frame];
        if self.state.take_spent + 1 < spec.ray_cycles {
            self.state.take_spent += 1;
            return Activity::Busy;
        }
        if let Some(ray) = samples.pop_slot() {
            arithmetic.take(&frames[frame], ray);
        }
        self.state.take_spent = 0;
        self.state.taken += 1;
        let behind = self.passes.get(self.state.taking as usize + 1);
        if behind.is_some_and(|behind| behind.rays == self.state.taken) {
            self.state.taking += 1;
            self.look();
        }
        Activity::Busy
    }

    #[inline]
    fn give(&mut self, frames: &[FrameSetup], shaded: &mut Channel<ShadedRay<A::Output>>) -> Activity {
        let Some(pass) = self.passes.get(self.state.giving as usize) else {
            return Activity::Starved;
        };
        let (spec, arithmetic) = &mut self.frames[pass.frame as usize];
        let [plane, slot] = spec.turned(self.state.next);
        if self.state.taken <= pass.rays + in_section(&pass.taken, spec.last([plane, slot])) {
            return Activity::Starved;
        }
        if self.state.give_spent + 1 < spec.ray_cycles {
            self.state.give_spent += 1;
            return Activity::Busy;
        }
        let Some(output) = shaded.push_slot() else {
            return shaded.refusal();
        };
        output.frame = pass.frame;
        output.plane = plane as u32;
        output.slot = slot as u32;
        let setup = &frames[pass.frame as usize];
        arithmetic.give(setup, plane as usize, slot as usize, &mut output.data);
        self.state.give_spent = 0;
        let [plane, slot] = &mut self.state.next;
        *slot += 1;
        if *slot == pass.given.end {
            (*plane, *slot) = (*plane + 1, pass.given.start);
            if *plane == spec.planes {
                self.state.giving += 1;
                self.aim();
            } else {
                self.look();
            }
        }
        Activity::Busy
    }

    /// Whether every ray of every frame has been given.
    pub fn done(&self) -> bool {
        self.state.giving as usize == self.passes.len()
    }

    /// What stops the unit inside, when nothing moves.
    pub fn inner_wait(&self, samples: &Channel<SampleRay<A::Input>>) -> Option<Wait> {
        let ray = samples.front()?;
        if u64::from(ray.plane) < self.room {
            return None;
        }
        let pass = self.passes.get(self.state.giving as usize)?;
        let spec = self.frames[pass.frame as usize].0;
        let last = spec.last(spec.turned(self.state.next));
        // Where the next ray to be given still lacks a neighbour, the unit waits for itself: the ring is too small.
        let lacks = self.state.taken <= pass.rays + in_section(&pass.taken, last);
        Some(Wait {
            unit: Self::NAME,
            port: "sample planes".into(),
            state: PortState::Full,
            occupancy: spec.ring as usize,
            capacity: spec.ring as usize,
            upon: if lacks { Self::NAME } else { "cone" },
        })
    }

    /// The arithmetic of each frame, to ask what it counted.
    pub fn arithmetic(&self) -> impl Iterator<Item = &A> {
        self.frames.iter().map(|(_, arithmetic)| arithmetic)
    }

    /// What the unit did with its cycles.
    pub fn account(&self) -> &Account {
        &self.account
    }
}

impl Archived for Shader {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let Shader {
            arithmetic: _,
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

impl<A: Archived> Archived for AbcUnit<A> {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let AbcUnit { frames, passes: _, state, room: _, account } = self;
        archive.item(state)?;
        archive.item(account)?;
        frames.iter_mut().try_for_each(|(_, arithmetic)| arithmetic.archive(archive))?;
        self.look();
        Ok(())
    }
}
