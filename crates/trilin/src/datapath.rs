//! What TRILIN's tokens carry, and how the lanes work on them: pairs of discrete rays in, rays of samples out.

use crate::lanes::TrilinLanes;
use crate::ray_samples::{RaySamples, SampleBlock};
use crate::unit::Interpolate;
use cube3_channel::{Archive, ArchiveError, Archived};
use cube3_dsb::{RayPair, RayVoxels};
use cube3_frame::{BESIDE, FrameSetup, FrameShape, Geometry, PerspectivePass, SampleBounds, Schedule};
use cube3_machine::Reuse;
use cube3_word::BLOCK_LANES;
use serde::{Deserialize, Serialize};

/// A discrete ray slot of one plane as an interpolator holds it, in order of depth. Rows are filled up with zeros to whole blocks,
/// and one more behind the voxels.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Held {
    /// Lifted voxels; where slots have their own cells, of two rays one after the other.
    voxels: Vec<i32>,
    /// Voxels lerped along w, where they are kept.
    edges: Vec<i32>,
}

impl Held {
    fn new(rays: usize, row: usize) -> Held {
        Held { voxels: vec![0; rays * (row + BLOCK_LANES)], edges: vec![0; row] }
    }

    fn copy(&mut self, other: &Held) {
        self.voxels.copy_from_slice(&other.voxels);
        self.edges.copy_from_slice(&other.edges);
    }

    fn clear(&mut self) {
        self.voxels.fill(0);
        self.edges.fill(0);
    }
}

fn copy_pair(to: &mut [Held; 2], from: &[Held; 2]) {
    to.iter_mut().zip(from).for_each(|(to, from)| to.copy(from));
}

/// The interpolators with their registers.
#[derive(Clone, Debug)]
pub struct Interpolator {
    schedule: Schedule,
    arithmetic: TrilinLanes,
    reuse: Reuse,
    /// Words of a row: the depths, filled up to whole blocks.
    row: usize,
    /// The first pair of the plane, the pair before, and the newest: current plane and the one below.
    first: [Held; 2],
    before: [Held; 2],
    newest: [Held; 2],
    /// What each plane has for other sections than the one in hand, where there are several.
    overlap: Option<Overlap>,
    /// Lerps along u of the plane below, for each slot: those of the current plane next time.
    sides: Vec<Vec<i32>>,
    lerps: u64,
    /// Weights along u and v by depth; in perspective those of the ray in hand.
    weights: [Vec<u32>; 2],
    /// Of a parallel frame, which samples lie in the volume: along u for every slot, and along v for the plane in hand.
    bounds: Option<Bounds>,
    /// Rows in hand, for their memory.
    rows: Rows,
}

/// The overlap buffers: of every plane the pairs of rays that other sections need. The hardware keeps of each plane one ray.
#[derive(Clone, Debug)]
struct Overlap {
    /// The last of the section before.
    borders: Vec<[Held; 2]>,
    /// The first of the plane; none where slots are not shared.
    firsts: Vec<[Held; 2]>,
}

/// Which samples of a parallel frame lie in the volume: a bit for each depth.
#[derive(Clone, Debug)]
struct Bounds {
    bounds: SampleBounds,
    along_u: Vec<u16>,
    along_v: Vec<u16>,
    /// The plane that the latter is for.
    plane: Option<usize>,
    rays: Vec<i32>,
    /// Places beside the rays too, of which the middle one counts.
    beside: Vec<[u16; BESIDE]>,
}

impl Bounds {
    fn new(geometry: &Geometry, slots: usize) -> Option<Bounds> {
        let bounds = SampleBounds::new(geometry)?;
        let words = geometry.size[2].div_ceil(BLOCK_LANES);
        let mut new = Bounds {
            bounds,
            along_u: vec![0; slots * words],
            along_v: vec![0; words],
            plane: None,
            rays: Vec::new(),
            beside: vec![[0; BESIDE]; words],
        };
        for slot in 0..slots {
            new.aim(geometry, 0, slot);
            copy_middle(&new.beside, &mut new.along_u[slot * words..]);
        }
        Some(new)
    }

    fn aim(&mut self, geometry: &Geometry, axis: usize, slot: usize) {
        geometry.rays_along(axis, slot, &mut self.rays);
        self.bounds.bits(axis, &self.rays, &mut self.beside);
    }

    /// Makes ready for a plane.
    fn aim_plane(&mut self, geometry: &Geometry, plane: usize) {
        if self.plane != Some(plane) {
            self.aim(geometry, 1, plane);
            copy_middle(&self.beside, &mut self.along_v);
            self.plane = Some(plane);
        }
    }
}

/// The bits of the rays themselves.
fn copy_middle(beside: &[[u16; BESIDE]], out: &mut [u16]) {
    out.iter_mut().zip(beside).for_each(|(out, beside)| *out = beside[BESIDE / 2]);
}

/// Rows of a slot, filled up to whole blocks.
#[derive(Clone, Debug, Default)]
struct Rows {
    /// Voxels in order of depth, one block more.
    words: Vec<u16>,
    edges: [Vec<i32>; 2],
    /// Lerps along u of the current plane and of the one below.
    lerped: [Vec<i32>; 2],
}

impl Interpolator {
    /// Interpolators for a frame, which has this schedule.
    pub fn new(setup: &FrameSetup, schedule: Schedule) -> Interpolator {
        let geometry = &setup.geometry;
        let keeps_planes = matches!(setup.reuse, Reuse::Plane | Reuse::Both);
        let FrameShape { slots, planes, closes: [closes, _], .. } = *schedule.shape();
        let row = geometry.size[2].div_ceil(BLOCK_LANES) * BLOCK_LANES;
        let rays = if geometry.doubled() { 2 } else { 1 };
        let held = || [Held::new(rays, row), Held::new(rays, row)];
        let empty = || vec![0; row];
        let each = |planes| vec![[Held::new(1, row), Held::new(1, row)]; planes];
        let overlap = (!schedule.sections().is_whole())
            .then(|| Overlap { borders: each(planes), firsts: each(if closes { planes } else { 0 }) });
        let mut weights = [vec![0; row], vec![0; row]];
        if geometry.perspective.is_none() {
            for (row, template) in weights.iter_mut().zip([&geometry.u, &geometry.v]) {
                let depths = row.len().min(template.weights.len());
                row[..depths].copy_from_slice(&template.weights[..depths]);
            }
        }
        Interpolator {
            schedule,
            arithmetic: TrilinLanes::new(&setup.words),
            reuse: setup.reuse,
            row,
            first: held(),
            before: held(),
            newest: held(),
            overlap,
            sides: vec![empty(); if keeps_planes { slots } else { 0 }],
            lerps: 0,
            weights,
            bounds: Bounds::new(geometry, slots),
            rows: Rows { words: vec![0; row + BLOCK_LANES], edges: [empty(), empty()], lerped: [empty(), empty()] },
        }
    }

    /// Lerps of whole rays done so far.
    pub fn ray_lerps(&self) -> u64 {
        self.lerps
    }

    fn keeps_rays(&self) -> bool {
        matches!(self.reuse, Reuse::Ray | Reuse::Both)
    }

    /// The edges of one plane (0 current, 1 below) of the ray before and the newest are made where they are not kept.
    fn edges(&mut self, offset: u32, plane: usize) {
        if !self.keeps_rays() {
            for (held, edges) in [&self.before, &self.newest].into_iter().zip(&mut self.rows.edges) {
                self.arithmetic.edges(&held[plane].voxels, offset, edges);
            }
            self.lerps += 2;
        }
        self.lerps += 1;
    }

    /// Their lerp along u of the current plane.
    fn side(&mut self, offset: u32) {
        self.edges(offset, 0);
        let Interpolator { arithmetic, before, newest, weights, rows: Rows { edges, lerped, .. }, .. } = self;
        let [left, right] = edges_of_plane(self.reuse, [before, newest], edges, 0);
        arithmetic.lerps(left, right, &weights[0], &mut lerped[0]);
    }

    /// The lerp along u of one plane in the cell that the ray before has for itself: its voxels are those of both columns.
    fn cell_side(&mut self, offset: u32, plane: usize) {
        let Interpolator { arithmetic, before, weights, rows, .. } = self;
        let Rows { edges, lerped, .. } = rows;
        for (edges, voxels) in edges.iter_mut().zip(before[plane].voxels.chunks(self.row + BLOCK_LANES)) {
            arithmetic.edges(voxels, offset, edges);
        }
        arithmetic.lerps(&edges[0], &edges[1], &weights[0], &mut lerped[plane]);
        self.lerps += 3;
    }

    /// Takes the weights of a slot of a perspective frame.
    fn aim(&mut self, pass: &PerspectivePass, plane: usize, slot: usize, depths: usize) {
        for (weights, (fan, i)) in self.weights.iter_mut().zip([(&pass.u, slot), (&pass.v, plane)]) {
            weights[..depths].iter_mut().enumerate().for_each(|(k, weight)| *weight = fan.weight(i, k));
        }
    }
}

impl Interpolate for Interpolator {
    type Input = RayVoxels;
    type Output = RaySamples;

    fn blank(&self) -> RaySamples {
        RaySamples(vec![SampleBlock::default(); self.row / BLOCK_LANES])
    }

    fn take(&mut self, setup: &FrameSetup, pair: &mut RayPair<RayVoxels>) {
        let depths = setup.geometry.size[2];
        let doubled = setup.geometry.doubled();
        std::mem::swap(&mut self.before, &mut self.newest);
        let (plane, slot) = (pair.plane as usize, pair.slot as usize);
        if let Some(overlap) = &self.overlap
            && self.schedule.sections().continues(slot)
        {
            copy_pair(&mut self.before, &overlap.borders[plane]);
        }
        let keeps_rays = self.keeps_rays();
        let words_of_ray = self.schedule.ray_words();
        // Where lerps of planes are kept, those of the current one have been made already; a cell of its own shares none.
        let current_needed = self.sides.is_empty() || pair.plane == 0 || doubled;
        for (i, ray) in [&pair.data.current, &pair.data.below].into_iter().enumerate() {
            if i == 0 && !current_needed {
                continue;
            }
            let (held, words) = (&mut self.newest[i], &mut self.rows.words);
            if keeps_rays && !doubled {
                words[..depths].copy_from_slice(&ray[..depths]);
                self.arithmetic.edges_of_voxels(words, setup.geometry.offset, &mut held.edges);
                self.lerps += 1;
                continue;
            }
            let rays = ray.chunks(words_of_ray);
            for (ray, voxels) in rays.zip(held.voxels.chunks_mut(self.row + BLOCK_LANES)) {
                words[..depths].copy_from_slice(&ray[..depths]);
                self.arithmetic.lift_ray(words, voxels);
            }
        }
        if slot == 0 {
            copy_pair(&mut self.first, &self.newest);
        }
        if let Some(overlap) = &mut self.overlap {
            if self.schedule.sections().breaks_off(slot) {
                copy_pair(&mut overlap.borders[plane], &self.newest);
            }
            if slot == 0
                && let Some(first) = overlap.firsts.get_mut(plane)
            {
                copy_pair(first, &self.newest);
            }
        }
    }

    fn give(&mut self, setup: &FrameSetup, plane: usize, slot: usize, output: &mut RaySamples) {
        let geometry = &setup.geometry;
        if self.schedule.is_last_slot(slot as u32) {
            // The newest pair is the last of the plane: it becomes the one before.
            std::mem::swap(&mut self.before, &mut self.newest);
            if self.schedule.shape().closes[0] {
                let kept = self.overlap.as_ref().and_then(|overlap| overlap.firsts.get(plane));
                copy_pair(&mut self.newest, kept.unwrap_or(&self.first));
            } else {
                self.newest.iter_mut().for_each(Held::clear);
            }
        }
        let keeps_planes = !self.sides.is_empty();
        if let Some(pass) = &geometry.perspective {
            self.aim(pass, plane, slot, geometry.size[2]);
        }
        if output.0.len() != self.row / BLOCK_LANES {
            *output = self.blank();
        }
        Self::inside(&mut self.bounds, geometry, plane, slot, &mut output.0);
        self.lerps += 1;
        if geometry.doubled() {
            self.cell_side(geometry.offset, 0);
            self.cell_side(geometry.offset, 1);
            let [current, below] = &self.rows.lerped;
            self.arithmetic.samples(current, below, &self.weights[1], &mut output.0);
        } else {
            if !keeps_planes || plane == 0 {
                self.side(geometry.offset);
                if keeps_planes {
                    std::mem::swap(&mut self.sides[slot], &mut self.rows.lerped[0]);
                }
            }
            self.edges(geometry.offset, 1);
            let Interpolator { arithmetic, before, newest, weights, rows, sides, .. } = self;
            let Rows { edges, lerped, .. } = rows;
            let edges = edges_of_plane(self.reuse, [before, newest], edges, 1);
            let side = if keeps_planes { &mut sides[slot] } else { &mut lerped[0] };
            arithmetic.samples_below(edges, side, [&weights[0], &weights[1]], &mut output.0);
        }
    }
}

/// The edges of a plane of the ray before and the newest: kept, or made again.
fn edges_of_plane<'a>(reuse: Reuse, held: [&'a [Held; 2]; 2], made: &'a [Vec<i32>; 2], plane: usize) -> [&'a [i32]; 2] {
    match reuse {
        Reuse::Ray | Reuse::Both => [&held[0][plane].edges, &held[1][plane].edges],
        Reuse::None | Reuse::Plane => [&made[0], &made[1]],
    }
}

impl Interpolator {
    /// Which samples of a slot lie in the volume.
    fn inside(bounds: &mut Option<Bounds>, geometry: &Geometry, plane: usize, slot: usize, out: &mut [SampleBlock]) {
        if let Some(bounds) = bounds {
            bounds.aim_plane(geometry, plane);
            let along_u = &bounds.along_u[slot * out.len()..];
            for ((out, along_u), along_v) in out.iter_mut().zip(along_u).zip(&bounds.along_v) {
                out.present = along_u & along_v;
            }
        } else {
            out.iter_mut().for_each(|out| out.present = 0);
            for k in 0..geometry.size[2] {
                let there = geometry.has_sample(geometry.ray_in_slot(plane, slot, k), k as i64);
                out[k / BLOCK_LANES].present |= u16::from(there) << (k % BLOCK_LANES);
            }
        }
    }
}

impl Archived for Interpolator {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let Interpolator {
            schedule: _,
            arithmetic: _,
            reuse: _,
            row: _,
            first,
            before,
            newest,
            overlap,
            sides,
            lerps,
            weights: _,
            bounds: _,
            rows: _,
        } = self;
        archive.item(first)?;
        archive.item(before)?;
        archive.item(newest)?;
        if let Some(Overlap { borders, firsts }) = overlap {
            archive.list(borders)?;
            archive.list(firsts)?;
        }
        archive.list(sides)?;
        archive.item(lerps)
    }
}
