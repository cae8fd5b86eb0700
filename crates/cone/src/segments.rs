//! How many pixels a ray slot gives, from the geometry alone.

use cube3_frame::{Geometry, RayStretches};

/// Pixels of each slot of a frame: one for each ray that it has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PixelCounts {
    rays: RayStretches,
    /// Slots of a plane, and planes.
    slots: [usize; 2],
}

impl PixelCounts {
    /// The counts of a geometry.
    pub fn new(geometry: &Geometry) -> PixelCounts {
        PixelCounts { rays: RayStretches::new(geometry), slots: geometry.slot_counts() }
    }

    /// Pixels of a slot of a plane.
    #[inline]
    pub fn of(&self, plane: usize, slot: usize) -> u64 {
        self.rays.of(plane, slot).count() as u64
    }

    /// Pixels of the frame.
    pub fn total(&self) -> u64 {
        let [slots, planes] = self.slots;
        (0..planes).flat_map(|plane| (0..slots).map(move |slot| self.of(plane, slot))).sum()
    }
}
