//! What a frame saw of volumes that came in while it was read.
//!
//! Volume 0 is in the frame buffer at the start; volume j comes in behind volume j − 1. A beam that has seen W words written
//! read voxel i (x fastest) of volume ⌈(W − i)/voxels⌉. A frame that reads voxels of more than one volume is *torn*.

use cube3_cfb::{Piece, scan};
use cube3_frame::{BeamPlace, Geometry, Schedule};
use std::collections::BTreeMap;

/// A frame with what each of its beams, in the order of fetches, has seen written.
#[derive(Clone, Copy, Debug)]
pub struct Sight<'a> {
    geometry: &'a Geometry,
    schedule: Schedule,
    dims: [usize; 3],
    seen: &'a [u64],
}

/// How the volumes of a frame are mixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mixture {
    /// The oldest volume that a voxel was read of.
    pub oldest: u64,
    /// The newest.
    pub newest: u64,
    /// Voxels read: all of the volume.
    pub voxels: u64,
    /// Voxels of volumes newer than the oldest.
    pub newer: u64,
    /// Beams with voxels of two volumes.
    pub mixed_beams: u64,
    /// The first plane of rays, in the order in which they are read, by whose end voxels of two volumes had been read.
    pub first_torn_plane: Option<u32>,
}

impl Mixture {
    /// A frame of one volume.
    pub fn whole(volume: u64) -> Mixture {
        Mixture { oldest: volume, newest: volume, voxels: 0, newer: 0, mixed_beams: 0, first_torn_plane: None }
    }

    /// Two frames of one picture together.
    pub fn and(self, other: Mixture) -> Mixture {
        let (oldest, newest) = (self.oldest.min(other.oldest), self.newest.max(other.newest));
        let newer = |part: Mixture| if part.oldest == oldest { part.newer } else { part.voxels };
        Mixture {
            oldest,
            newest,
            voxels: self.voxels + other.voxels,
            newer: newer(self) + newer(other),
            mixed_beams: self.mixed_beams + other.mixed_beams,
            first_torn_plane: self.first_torn_plane.or(other.first_torn_plane),
        }
    }

    /// Whether the frame shows more than one volume.
    pub fn is_torn(&self) -> bool {
        self.oldest != self.newest
    }
}

/// Neighbouring voxels of a beam in the order of the volume.
struct Row {
    /// The beam, in the order of fetches: where there are sections it may have two rows.
    beam: usize,
    plane: u32,
    /// Place of its first voxel.
    first: usize,
    /// From voxel to voxel.
    stride: usize,
    count: usize,
    /// Voxels before this place are of volume `before + 1`, the others of volume `before`.
    edge: usize,
    before: u64,
}

impl Row {
    /// Voxels of volume `before + 1`, which come first.
    fn newer(&self) -> usize {
        self.edge.saturating_sub(self.first).div_ceil(self.stride).min(self.count)
    }
}

impl<'a> Sight<'a> {
    /// The next frame, which has this schedule, of a volume of `dims` voxels along x, y, z: its beams are taken from the front of `seen`, which is
    /// for the beams of all frames in the order of fetches.
    pub fn next<'s: 'a>(
        geometry: &'a Geometry,
        schedule: Schedule,
        dims: [usize; 3],
        seen: &mut &'s [u64],
    ) -> Sight<'a> {
        let all: &'s [u64] = seen;
        let (own, rest) = all.split_at(scan(geometry, &schedule).count().min(all.len()));
        *seen = rest;
        Sight { geometry, schedule, dims, seen: own }
    }

    fn rows(&self) -> impl Iterator<Item = Row> + '_ {
        let Geometry { axes, size, .. } = self.geometry;
        let [nx, ny, _] = self.dims;
        let voxels: usize = self.dims.iter().product();
        let place = move |u: usize, v: usize, w: usize| {
            let [x, y, z] = axes.voxel(*size, [u, v, w]);
            x + nx * (y + ny * z)
        };
        let beams = scan(self.geometry, &self.schedule).zip(self.seen).enumerate();
        beams.flat_map(move |(beam, ((BeamPlace { plane, depth, .. }, Piece { row, columns }), &seen))| {
            columns.into_iter().filter(|columns| !columns.is_empty()).map(move |columns| {
                let (start, count) = (columns.start, columns.len());
                let [a, b] = [start, start + count - 1].map(|u| place(u, row as usize, depth as usize));
                Row {
                    beam,
                    plane,
                    first: a.min(b),
                    stride: a.abs_diff(b).checked_div(count - 1).unwrap_or(1),
                    count,
                    edge: (seen % voxels as u64) as usize,
                    before: seen / voxels as u64,
                }
            })
        })
    }

    /// How the volumes are mixed.
    pub fn mixture(&self) -> Mixture {
        let mut voxels: BTreeMap<u64, u64> = BTreeMap::new();
        let (mut mixed_beams, mut first_torn_plane) = (0, None);
        // Voxels of the beam in hand, and those of them that are newer.
        let (mut beam, mut of_beam) = (usize::MAX, [0; 2]);
        for row in self.rows() {
            let newer = row.newer();
            if row.beam != beam {
                (beam, of_beam) = (row.beam, [0; 2]);
            }
            let mixed = |[count, newer]: [usize; 2]| newer > 0 && newer < count;
            let was_mixed = mixed(of_beam);
            of_beam = [of_beam[0] + row.count, of_beam[1] + newer];
            mixed_beams += u64::from(mixed(of_beam) && !was_mixed);
            for (volume, count) in [(row.before, row.count - newer), (row.before + 1, newer)] {
                if count > 0 {
                    *voxels.entry(volume).or_default() += count as u64;
                }
            }
            if voxels.len() > 1 && first_torn_plane.is_none() {
                first_torn_plane = Some(row.plane);
            }
        }
        let all: u64 = voxels.values().sum();
        let (oldest, of_oldest) = voxels.first_key_value().map_or((0, 0), |(volume, count)| (*volume, *count));
        let newest = voxels.last_key_value().map_or(0, |(volume, _)| *volume);
        Mixture { oldest, newest, voxels: all, newer: all - of_oldest, mixed_beams, first_torn_plane }
    }

    /// The volume as the frame saw it, x fastest: each voxel from the volume that it was read of. `volumes` are the words
    /// of the volumes from the oldest to the newest.
    pub fn assemble(&self, oldest: u64, volumes: &[&[u16]]) -> Vec<u16> {
        let mut words = volumes[0].to_vec();
        for row in self.rows() {
            let newer = row.newer();
            for (volume, voxels) in [(row.before, newer..row.count), (row.before + 1, 0..newer)] {
                if volume == oldest {
                    continue;
                }
                for i in voxels {
                    let place = row.first + i * row.stride;
                    words[place] = volumes[(volume - oldest) as usize][place];
                }
            }
        }
        words
    }
}
