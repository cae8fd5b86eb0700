//! The overlap buffers of a machine that takes the ray slots of a plane in sections, in closed form.
//!
//! Across the edge of a section TRILIN needs the last ray before it, and a gradient the last two rays of samples, of every plane. Where slots
//! are shared along u, the last section needs the first ray of each plane, and the first two of samples, too.

use cube3_frame::{FrameSetup, Schedule};
use cube3_machine::MachineSpec;

/// What a frame needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overlap {
    /// Words kept for TRILIN, and for the ABC units: a word for each depth of a ray.
    pub rays: u64,
    /// Words of samples.
    pub samples: u64,
    /// Words for TRILIN that are written and read in a frame.
    pub rays_moved: u64,
    /// The same of samples.
    pub samples_moved: u64,
}

impl Overlap {
    /// The overlap buffers for a frame; nothing where planes are taken whole.
    pub fn new(machine: &MachineSpec, setup: &FrameSetup) -> Overlap {
        let schedule = Schedule::new(machine, &setup.geometry);
        if schedule.sections().is_whole() {
            return Overlap::default();
        }
        let shape = schedule.shape();
        let [planes, depths] = [shape.planes, shape.depths].map(|count| count as u64);
        let [first, again] = shape.closes.map(u64::from);
        let edges = schedule.sections().count() - 1;
        // The first plane, which is the one below the last where planes are shared, is read a second time, from a copy of the ray.
        let rays = depths * ((1 + first) * planes + again);
        let rays_moved = depths * ((edges as u64 + first) * (2 * planes + again));
        if setup.gradient.is_none() {
            return Overlap { rays, rays_moved, ..Overlap::default() };
        }
        let order = setup.shading_order(&schedule);
        let written: usize = (0..edges).map(|section| order.kept(section).len()).sum();
        let read: usize = (0..=edges).map(|section| order.needed_before(section)[0].len()).sum();
        let firsts = order.needed_before(edges)[1].len();
        Overlap {
            rays,
            rays_moved,
            samples: schedule.overlap_samples(),
            samples_moved: depths * planes * (written + read + 2 * firsts) as u64,
        }
    }
}
