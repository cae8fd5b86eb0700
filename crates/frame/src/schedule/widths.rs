//! How wide planes on the chip are, and what they hold.

use super::{Neighbours, Schedule, Sections};

impl Schedule {
    /// Ray slots that a plane of voxels has room for on the chip: those of the widest section.
    pub fn voxel_slots(&self) -> u64 {
        widest(self.sections(), |_, slots| slots)
    }

    /// Ray slots that TRILIN finishes of a plane in one section at most.
    pub fn sample_slots(&self) -> u64 {
        widest(&self.finished(), |_, slots| slots)
    }

    /// Ray slots that a plane of samples has room for on the chip: those of a section, and what comes from the overlap buffers.
    pub fn neighbour_slots(&self) -> u64 {
        let neighbours = self.neighbours(1, true);
        widest(neighbours.sections(), |section, slots| {
            let before: usize = neighbours.needed_before(section).iter().map(|slots| slots.len()).sum();
            slots + before
        })
    }

    /// How many times the buffers of first planes are there: twice where sections follow each other, or frames that overlap.
    pub fn first_copies(&self, overlap: bool) -> u64 {
        if overlap || !self.sections().is_whole() { 2 } else { 1 }
    }

    /// Words of the buffers that keep the first plane of voxels for the last.
    pub fn first_voxels(&self, overlap: bool) -> u64 {
        self.first_copies(overlap) * self.voxel_slots() * self.shape().depths as u64
    }

    /// The same of the first two planes of samples.
    pub fn first_samples(&self, overlap: bool) -> u64 {
        self.first_copies(overlap) * 2 * self.neighbour_slots() * self.shape().depths as u64
    }

    /// Words of the overlap buffers of samples beside the chip: of each plane the last rays of a section, and the first of the plane where
    /// slots are shared. None where planes are taken whole.
    pub fn overlap_samples(&self) -> u64 {
        if self.sections().is_whole() {
            return 0;
        }
        let neighbours = self.neighbours(1, true);
        let [_, firsts] = neighbours.needed_before(neighbours.sections().count() - 1);
        (self.shape().depths * self.shape().planes * (Neighbours::BORDER + firsts.len())) as u64
    }

    /// Words of the planes of samples that a gradient reads: a ring of so many, and the first two where the last is followed by the first.
    pub fn samples_kept(&self, ring: usize, overlap: bool) -> u64 {
        let firsts = if self.shape().closes[1] { self.first_samples(overlap) } else { 0 };
        ring as u64 * self.neighbour_slots() * self.shape().depths as u64 + firsts
    }
}

impl Neighbours {
    /// Rays that come before the first is shaded.
    pub fn first_wait(&self) -> u64 {
        let [plane, slot] = self.turned([0, 0]);
        self.needed(plane, slot)
    }
}

fn widest(sections: &Sections, width: impl Fn(usize, usize) -> usize) -> u64 {
    (0..sections.count()).map(|section| width(section, sections.slots(section).len())).max().unwrap_or(0) as u64
}
