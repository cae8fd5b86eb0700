//! Which samples are the ends of rays, and the opacity tables that they take: what lanes are patched with where ends have parts of a
//! step. Nothing else of a row depends on it.

use crate::golden::{class_of, in_place};
use cube3_frame::{DiscreteRay, FrameSetup};
use std::ops::Range;

/// A sample that is the first or the last of its ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct End {
    /// The lane that it is in.
    pub lane: usize,
    /// Its opacity table: see [`crate::golden::opacity_class`].
    pub class: u32,
}

/// The ends of a ray whose samples are at some of `depths`, by depth: two, one that is both, or none.
pub fn ray_ends(ray: DiscreteRay, depths: Range<usize>, setup: &FrameSetup) -> impl Iterator<Item = End> {
    let inside = |k: &usize| in_place(ray, *k as i64, setup);
    let end = |k: usize, ends: [bool; 2]| End { lane: k, class: class_of(ends, [ray.u, ray.v, k as i64], setup) };
    let ends = match depths.clone().find(inside).zip(depths.rev().find(inside)) {
        None => [None, None],
        Some((first, last)) if first == last => [Some(end(first, [true; 2])), None],
        Some((first, last)) => [Some(end(first, [true, false])), Some(end(last, [false, true]))],
    };
    ends.into_iter().flatten()
}

/// The ends of all rays of a plane, by depth.
#[derive(Clone, Debug, Default)]
pub struct PlaneEnds {
    /// Rays u and the classes that their samples at a depth have, in the order of the rays.
    depths: Vec<Vec<(i64, u32)>>,
}

impl PlaneEnds {
    /// Finds the ends of rays `us` of plane `v`; none where samples stand for whole steps.
    pub fn aim(&mut self, v: i64, us: Range<i64>, setup: &FrameSetup) {
        if setup.ends.is_none() {
            return;
        }
        let depths = setup.geometry.size[2];
        self.depths.resize(depths, Vec::new());
        self.depths.iter_mut().for_each(Vec::clear);
        for u in us {
            for End { lane: k, class } in ray_ends(DiscreteRay { u, v }, 0..depths, setup) {
                self.depths[k].push((u, class));
            }
        }
    }

    /// The ends at depth `k`, in a row of lanes that begins with ray `from` and has all of them.
    pub fn row(&self, k: usize, from: i64) -> impl Iterator<Item = End> {
        let ends = self.depths.get(k).map_or(&[][..], Vec::as_slice);
        ends.iter().map(move |&(u, class)| End { lane: (u - from) as usize, class })
    }
}
