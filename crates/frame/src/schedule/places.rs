//! The beams and the rays of a frame in their order.

use super::{Schedule, Sections};
use serde::{Deserialize, Serialize};

/// The place of a beam in the schedule of its frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct BeamPlace {
    /// Section of ray slots, from 0.
    pub section: u32,
    /// Plane of ray slots, from 0.
    pub plane: u32,
    /// Depth k.
    pub depth: u32,
}

/// The place of a ray in the schedule of its frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct RayPlace {
    /// Section of ray slots, from 0.
    pub section: u32,
    /// Plane of ray slots, from 0.
    pub plane: u32,
    /// Ray slot of the plane, from 0.
    pub slot: u32,
}

impl Schedule {
    /// The beams of the frame in the order in which they are read, written and turned.
    pub fn beams(&self) -> impl Iterator<Item = BeamPlace> + use<> {
        let [planes, depths] = [self.shape.planes, self.shape.depths].map(|count| count as u32);
        (0..self.sections.count() as u32).flat_map(move |section| {
            (0..planes).flat_map(move |plane| (0..depths).map(move |depth| BeamPlace { section, plane, depth }))
        })
    }

    /// The rays of the frame in the order in which the buffers read them.
    pub fn rays(&self) -> impl Iterator<Item = RayPlace> + use<> {
        rays_of(self.sections, self.shape.planes)
    }

    /// The rays in the order in which TRILIN finishes them, each with the next of its plane, with the sections in which it does.
    pub fn finished_rays(&self) -> impl Iterator<Item = RayPlace> + use<> {
        rays_of(self.finished(), self.shape.planes)
    }

    /// The sections in which TRILIN finishes rays: a slot when the next one has come.
    pub fn finished(&self) -> Sections {
        self.sections.behind(1)
    }

    /// Goes on to the next of [`Schedule::beams`]. Whether the frame is over; the place is then that of its first beam.
    #[inline]
    pub fn next_beam(&self, place: &mut BeamPlace) -> bool {
        place.depth += 1;
        if (place.depth as usize) < self.shape.depths {
            return false;
        }
        (place.depth, place.plane) = (0, place.plane + 1);
        if (place.plane as usize) < self.shape.planes {
            return false;
        }
        (place.plane, place.section) = (0, place.section + 1);
        if (place.section as usize) < self.sections.count() {
            return false;
        }
        place.section = 0;
        true
    }

    /// Goes on to the next of [`Schedule::rays`]. Whether the frame is over; the place is then that of its first ray.
    #[inline]
    pub fn next_ray(&self, place: &mut RayPlace) -> bool {
        place.slot += 1;
        if (place.slot as usize) < self.sections.end(place.section as usize) {
            return false;
        }
        place.plane += 1;
        if (place.plane as usize) < self.shape.planes {
            place.slot = self.sections.slots(place.section as usize).start as u32;
            return false;
        }
        // The slot is the first of the next section.
        (place.plane, place.section) = (0, place.section + 1);
        if (place.section as usize) < self.sections.count() {
            return false;
        }
        *place = RayPlace::default();
        true
    }
}

/// Section by section the slots of every plane.
fn rays_of(sections: Sections, planes: usize) -> impl Iterator<Item = RayPlace> {
    (0..sections.count()).flat_map(move |section| {
        (0..planes).flat_map(move |plane| {
            let place = move |slot| RayPlace { section: section as u32, plane: plane as u32, slot: slot as u32 };
            sections.slots(section).map(place)
        })
    })
}
