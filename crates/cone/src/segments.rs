//! How many pixels a ray slot gives, from the geometry alone.

use cube3_frame::{Geometry, RayPlace, RayStretches, Schedule};

/// Pixels of each slot of a frame: one for each ray that it has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PixelCounts {
    rays: RayStretches,
    schedule: Schedule,
}

impl PixelCounts {
    /// The counts of a frame, which has this schedule.
    pub fn new(geometry: &Geometry, schedule: Schedule) -> PixelCounts {
        PixelCounts { rays: RayStretches::new(geometry), schedule }
    }

    /// Pixels of a slot of a plane.
    #[inline]
    pub fn of(&self, plane: usize, slot: usize) -> u64 {
        self.rays.of(plane, slot).count() as u64
    }

    /// Pixels of the frame.
    pub fn total(&self) -> u64 {
        self.schedule.rays().map(|RayPlace { plane, slot, .. }| self.of(plane as usize, slot as usize)).sum()
    }
}
