//! The overlap buffers of a machine that takes the ray slots of a plane in sections, and the widths of its planes on the chip, in closed form.
//!
//! Across the edge of a section TRILIN needs the last ray before it, and a gradient the last two rays of samples, of every plane. Where slots
//! are shared along u, the last section needs the first ray of each plane, and the first two of samples, too.

use cube3_abc::AbcSpec;
use cube3_frame::{FrameSetup, Sections};
use cube3_machine::MachineSpec;

/// Rays of samples that a section needs of those before it, and of the plane's first.
const BORDER: usize = 2;

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
        let sections = Sections::of(machine, &setup.geometry);
        if sections.is_whole() {
            return Overlap::default();
        }
        let geometry = &setup.geometry;
        let [_, planes] = geometry.slot_counts().map(|count| count as u64);
        let [first, again] = geometry.closes().map(u64::from);
        let depths = geometry.size[2] as u64;
        let edges = sections.count() as u64 - 1;
        // The first plane, which is the one below the last where planes are shared, is read a second time, from a copy of the ray.
        let rays = depths * ((1 + first) * planes + again);
        let rays_moved = depths * ((edges + first) * (2 * planes + again));
        if setup.gradient.is_none() {
            return Overlap { rays, rays_moved, ..Overlap::default() };
        }
        let given = AbcSpec::new(machine, setup).sections;
        let narrow = |slots: usize| slots.min(BORDER) as u64;
        let written: u64 = (0..given.count() - 1).map(|section| narrow(given.slots(section).len())).sum();
        let with_rays = (0..given.count()).map(|section| given.slots(section)).filter(|slots| !slots.is_empty());
        let read: u64 = with_rays.map(|slots| narrow(slots.start)).sum();
        let firsts = first * first_rays(given.slots(given.count() - 1).start);
        Overlap {
            rays,
            rays_moved,
            samples: depths * planes * (BORDER as u64 + firsts),
            samples_moved: depths * planes * (written + read + 2 * firsts),
        }
    }
}

/// Of the first rays of a plane those that are kept for its last section, which begins with this slot, beside the ones before it.
fn first_rays(start: usize) -> u64 {
    start.saturating_sub(BORDER).min(BORDER) as u64
}

/// Ray slots that a plane of voxels has room for on the chip.
pub fn voxel_slots(machine: &MachineSpec, setup: &FrameSetup) -> u64 {
    widest(Sections::of(machine, &setup.geometry), |_, slots| slots as u64)
}

/// Ray slots that TRILIN finishes of a plane in one section at most.
pub fn sample_slots(machine: &MachineSpec, setup: &FrameSetup) -> u64 {
    widest(Sections::of(machine, &setup.geometry).behind(1), |_, slots| slots as u64)
}

/// Ray slots that a plane of samples has room for on the chip: those of a section, and what comes from the overlap buffers.
pub fn neighbour_slots(machine: &MachineSpec, setup: &FrameSetup) -> u64 {
    let sections = Sections::of(machine, &setup.geometry).behind(1);
    let closes = setup.geometry.closes()[0];
    widest(sections, |section, slots| {
        let start = sections.slots(section).start;
        let last = closes && section + 1 == sections.count();
        (slots + start.min(BORDER)) as u64 + if last { first_rays(start) } else { 0 }
    })
}

fn widest(sections: Sections, width: impl Fn(usize, usize) -> u64) -> u64 {
    (0..sections.count()).map(|section| width(section, sections.slots(section).len())).max().unwrap_or(0)
}
