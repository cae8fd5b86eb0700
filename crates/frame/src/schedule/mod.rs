//! The schedule of a frame: what comes behind what, how many there are, and what each waits for. Memory, buffers, units, the host's port and
//! *function* all follow it.
//!
//! ```text
//!   beams:  for each section, for each plane of ray slots, for each depth
//!   rays:   for each section, for each plane of ray slots, for each slot of the section
//!   shaded: the same, behind the neighbours; where slots are shared the first come last
//! ```

mod bands;
mod places;
mod sections;
mod shading;
#[cfg(test)]
mod tests;
mod widths;

pub use bands::Bands;
pub use places::{BeamPlace, RayPlace};
pub use sections::Sections;
pub use shading::ShadingOrder;

use crate::Geometry;
use cube3_machine::MachineSpec;

/// What a frame has of everything, and on how many lanes a machine takes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameShape {
    /// Ray slots of a plane.
    pub slots: usize,
    /// Planes of ray slots.
    pub planes: usize,
    /// Beams of a plane, and words of a ray: n_w.
    pub depths: usize,
    /// Voxels of a row: n_u.
    pub columns: usize,
    /// Whether slots are shared along u and along v, so that the last one's neighbour is the first.
    pub closes: [bool; 2],
    /// Whether slots have cells of their own: two rows are then read for a beam, and each gives two words to a slot.
    pub doubled: bool,
    /// Lanes of the machine.
    pub lanes: usize,
    /// Slots of a section; all of them where it is not given.
    pub section: Option<usize>,
}

/// The schedule of a frame on a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    shape: FrameShape,
    sections: Sections,
    row_cycles: u64,
    aligned_cycles: u64,
    ray_cycles: u64,
}

impl Schedule {
    /// The schedule of a machine for a frame.
    pub fn new(machine: &MachineSpec, geometry: &Geometry) -> Schedule {
        Schedule::of(geometry, machine.lanes, machine.rays.section)
    }

    /// The schedule of a frame on so many lanes, in sections of so many slots. In perspective planes are always taken whole.
    pub fn of(geometry: &Geometry, lanes: usize, section: Option<usize>) -> Schedule {
        let [slots, planes] = geometry.slot_counts();
        Schedule::of_shape(FrameShape {
            slots,
            planes,
            depths: geometry.size[2],
            columns: geometry.size[0],
            closes: geometry.closes(),
            doubled: geometry.doubled(),
            lanes,
            section: section.filter(|_| geometry.perspective.is_none()),
        })
    }

    /// The schedule of any frame of a shape.
    pub fn of_shape(shape: FrameShape) -> Schedule {
        let FrameShape { slots, depths, columns, doubled, lanes, section, .. } = shape;
        let aligned = if doubled { slots } else { columns };
        Schedule {
            shape,
            sections: Sections::new(slots, section),
            row_cycles: Schedule::cycles(columns, lanes),
            aligned_cycles: Schedule::cycles(aligned, lanes),
            ray_cycles: Schedule::cycles(depths, lanes),
        }
    }

    /// Cycles in which `lanes` lanes take so many words, and chunks of them: ⌈words / lanes⌉.
    #[inline]
    pub fn cycles(words: usize, lanes: usize) -> u64 {
        words.div_ceil(lanes) as u64
    }

    /// What the frame has of everything.
    #[inline]
    pub fn shape(&self) -> &FrameShape {
        &self.shape
    }

    /// The sections in which the slots of a plane are taken.
    #[inline]
    pub fn sections(&self) -> &Sections {
        &self.sections
    }

    /// Ray slots of the frame.
    #[inline]
    pub fn ray_slots(&self) -> u64 {
        self.shape.slots as u64 * self.shape.planes as u64
    }

    /// Planes of the frame, those of each section.
    pub fn planes_of_frame(&self) -> u64 {
        self.plane_number(self.sections.count() as u32, 0)
    }

    /// Planes of the frame before a plane of a section.
    #[inline]
    pub fn plane_number(&self, section: u32, plane: u32) -> u64 {
        u64::from(section) * self.shape.planes as u64 + u64::from(plane)
    }

    /// Planes of the frame that are there when the rays of a plane of a section can be read: that and those before it, and the one below where
    /// there is one.
    #[inline]
    pub fn planes_read(&self, section: u32, plane: u32) -> u64 {
        self.plane_number(section, (plane + 2).min(self.shape.planes as u32))
    }

    /// Whether a depth is the last one: with its beam a plane is whole.
    #[inline]
    pub fn is_last_depth(&self, depth: u32) -> bool {
        depth as usize + 1 == self.shape.depths
    }

    /// Whether a plane is the last one.
    #[inline]
    pub fn is_last_plane(&self, plane: u32) -> bool {
        plane as usize + 1 == self.shape.planes
    }

    /// Whether a slot is the last one of a plane.
    #[inline]
    pub fn is_last_slot(&self, slot: u32) -> bool {
        slot as usize + 1 == self.shape.slots
    }

    /// The plane below a plane: below the last the first where they are shared, and else none.
    #[inline]
    pub fn below(&self, plane: u32) -> Option<u32> {
        if !self.is_last_plane(plane) { Some(plane + 1) } else { self.shape.closes[1].then_some(0) }
    }

    /// Rows of voxels that are read for a beam.
    pub fn rows_of_beam(&self) -> u64 {
        if self.shape.doubled { 2 } else { 1 }
    }

    /// Words of a slot at a depth: one, or the four of a cell of its own.
    pub fn words_of_slot(&self) -> usize {
        if self.shape.doubled { 4 } else { 1 }
    }

    /// Words side by side that a beam gives to the buffers: n_u; where slots have cells of their own a word for each slot,
    /// [`Schedule::words_of_slot`] times.
    pub fn aligned_words(&self) -> usize {
        if self.shape.doubled { self.shape.slots } else { self.shape.columns }
    }

    /// Cycles in which the lanes take a row of voxels: ⌈n_u / lanes⌉.
    #[inline]
    pub fn row_cycles(&self) -> u64 {
        self.row_cycles
    }

    /// Cycles in which they take the words of [`Schedule::aligned_words`].
    #[inline]
    pub fn aligned_cycles(&self) -> u64 {
        self.aligned_cycles
    }

    /// Cycles in which they take so many voxels of a row.
    #[inline]
    pub fn piece_cycles(&self, voxels: u32) -> u64 {
        Schedule::cycles(voxels as usize, self.shape.lanes)
    }

    /// Words of a ray that is filled up to whole chunks of lanes.
    #[inline]
    pub fn ray_words(&self) -> usize {
        self.ray_cycles as usize * self.shape.lanes
    }

    /// Cycles in which they take a ray: ⌈n_w / lanes⌉.
    #[inline]
    pub fn ray_cycles(&self) -> u64 {
        self.ray_cycles
    }
}
