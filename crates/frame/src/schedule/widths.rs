//! How wide planes on the chip are, and what the buffers hold that keep rays for their neighbours.

use super::{Schedule, ShadingOrder};

impl Schedule {
    /// Ray slots that a plane of voxels has room for on the chip: those of the widest section.
    pub fn voxel_slots(&self) -> u64 {
        self.sections().widest() as u64
    }

    /// Ray slots that TRILIN finishes of a plane in one section at most.
    pub fn sample_slots(&self) -> u64 {
        self.finished().widest() as u64
    }

    /// Ray slots that a plane of samples has room for on the chip: those of a section, and what comes from the overlap buffers.
    pub fn neighbour_slots(&self) -> u64 {
        let order = self.shading_order(1, true);
        let room = |section: usize| {
            let [border, firsts] = order.needed_before(section);
            order.sections().slots(section).len() + border.len() + firsts.len()
        };
        (0..order.sections().count()).map(room).max().unwrap_or(0) as u64
    }

    /// How many times the buffers of first planes are there: twice where sections follow each other, or frames that overlap.
    pub fn first_copies(&self, overlap: bool) -> u64 {
        if overlap || !self.sections().is_whole() { 2 } else { 1 }
    }

    /// Words of a ring of planes of voxels.
    pub fn voxel_planes(&self, ring: usize) -> u64 {
        (self.words_of_slot() * ring * self.shape().depths) as u64 * self.voxel_slots()
    }

    /// Words of a ring of planes of samples.
    pub fn sample_planes(&self, ring: usize) -> u64 {
        (ring * self.shape().depths) as u64 * self.neighbour_slots()
    }

    /// Words of the buffers that keep the first plane of voxels for the last, where slots are shared along v.
    pub fn first_voxels(&self, overlap: bool) -> u64 {
        self.first_copies(overlap) * self.voxel_planes(1)
    }

    /// The same of the first two planes of samples.
    pub fn first_samples(&self, overlap: bool) -> u64 {
        self.first_copies(overlap) * self.sample_planes(2)
    }

    /// Words of the overlap buffers of samples beside the chip: of each plane the last rays of a section, and the first of the plane where
    /// slots are shared. None where planes are taken whole.
    pub fn overlap_samples(&self) -> u64 {
        if self.sections().is_whole() {
            return 0;
        }
        let order = self.shading_order(1, true);
        let [_, firsts] = order.needed_before(order.sections().count() - 1);
        (self.shape().depths * self.shape().planes * (ShadingOrder::BORDER + firsts.len())) as u64
    }
}

impl ShadingOrder {
    /// Rays that come before the first is shaded.
    pub fn first_wait(&self) -> u64 {
        let [plane, slot] = self.turned([0, 0]);
        self.needed(plane, slot)
    }
}
