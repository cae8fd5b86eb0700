//! The order in which rays are shaded, which wait for the rays beside them.

use super::{Schedule, Sections};
use std::ops::Range;

/// The rays of a frame as the ABC units have them: in which order they come and are shaded, and what each waits for.
///
/// Planes and slots are shaded in the order in which they come, but where the last is followed by the first the first comes last. Slots are
/// *counted* in the order in which they are shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShadingOrder {
    schedule: Schedule,
    /// Whether rays wait for their neighbours at all.
    buffered: bool,
    /// How many rays and planes away neighbours are.
    reach: u64,
    /// Sections of the rays that come, and of those that are shaded, as counted.
    taken: Sections,
    given: Sections,
}

impl Schedule {
    /// How rays are shaded whose neighbours are `reach` rays and planes away, 1 and more; where rays are not `buffered` none is waited for.
    pub fn shading_order(&self, reach: usize, buffered: bool) -> ShadingOrder {
        let taken = self.finished();
        let behind = reach + usize::from(self.shape.closes[0]);
        let given = if buffered { taken.behind(behind) } else { taken };
        ShadingOrder { schedule: *self, buffered, reach: reach as u64, taken, given }
    }
}

impl ShadingOrder {
    /// Rays of a plane that a section needs of those before it, and of the plane's first where slots are shared: in frames that are taken in
    /// sections neighbours are the next rays.
    pub const BORDER: usize = 2;

    /// The schedule that it is a part of.
    #[inline]
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// Planes of the frame.
    #[inline]
    pub fn planes(&self) -> u64 {
        self.schedule.shape.planes as u64
    }

    /// Ray slots of a plane.
    #[inline]
    fn slots(&self) -> u64 {
        self.schedule.shape.slots as u64
    }

    /// The sections of the rays that come.
    #[inline]
    pub fn sections(&self) -> &Sections {
        &self.taken
    }

    /// The slots that come with a section.
    pub fn taken(&self, section: usize) -> Range<u64> {
        wide(self.taken.slots(section))
    }

    /// The slots, as counted, that are shaded in a section: those whose neighbours have all come.
    pub fn given(&self, section: usize) -> Range<u64> {
        wide(self.given.slots(section))
    }

    /// The slots of the frame, plane and ray, in the order in which they are shaded.
    pub fn shaded(&self) -> impl Iterator<Item = [u64; 2]> + use<> {
        let all = *self;
        let planes = move |section| (0..all.planes()).map(move |plane| (plane, all.given(section)));
        let counted = (0..all.given.count()).flat_map(planes);
        counted.flat_map(move |(plane, slots)| slots.map(move |slot| all.turned([plane, slot])))
    }

    /// The plane and slot of a counted plane and slot.
    #[inline]
    pub fn turned(&self, [plane, slot]: [u64; 2]) -> [u64; 2] {
        let turn = |i: u64, n: u64, closes: bool| {
            if !(closes && self.buffered) {
                i
            } else if i + 1 == n {
                0
            } else {
                i + 1
            }
        };
        let [along_u, along_v] = self.schedule.shape.closes;
        [turn(plane, self.planes(), along_v), turn(slot, self.slots(), along_u)]
    }

    /// The oldest plane that the slots of a counted plane and later ones need: the one above it. Where the first plane comes last, that is the
    /// last.
    #[inline]
    pub fn oldest(&self, plane: u64) -> u64 {
        let [current, _] = self.turned([plane, 0]);
        if !self.buffered {
            current
        } else if self.schedule.shape.closes[1] && plane + 1 >= self.planes() {
            self.planes() - 1
        } else {
            current.saturating_sub(self.reach)
        }
    }

    /// The last plane and ray that a slot needs.
    #[inline]
    pub fn last(&self, [plane, slot]: [u64; 2]) -> [u64; 2] {
        if !self.buffered {
            return [plane, slot];
        }
        let last = |i: u64, n: u64, closes: bool| if closes && i == 0 { n - 1 } else { (i + self.reach).min(n - 1) };
        let [along_u, along_v] = self.schedule.shape.closes;
        [last(plane, self.planes(), along_v), last(slot, self.slots(), along_u)]
    }

    /// How many rays must have come before a slot can be shaded.
    pub fn needed(&self, plane: u64, slot: u64) -> u64 {
        let last = self.last([plane, slot]);
        let of_section = self.taken(self.taken.section(last[1] as usize));
        of_section.start * self.planes() + self.rays_before(&of_section, last) + 1
    }

    /// Rays of a section that come before the one of a plane and slot; `slots` are those that come with the section.
    #[inline]
    pub fn rays_before(&self, slots: &Range<u64>, [plane, slot]: [u64; 2]) -> u64 {
        plane * (slots.end - slots.start) + slot - slots.start
    }

    /// Planes of the frame, those of each section, before a plane of the section that a slot comes with.
    #[inline]
    pub fn plane_of_ray(&self, plane: usize, slot: usize) -> usize {
        self.taken.section(slot) * self.schedule.shape.planes + plane
    }

    /// The same of the section that the last of a slot's neighbours comes with.
    #[inline]
    pub fn plane_of_shaded(&self, plane: usize, slot: usize) -> usize {
        let [_, last] = self.last([plane as u64, slot as u64]);
        self.plane_of_ray(plane, last as usize)
    }

    /// Slots of a section that later ones need: the last of those that come with it. None of the last section.
    pub fn kept(&self, section: usize) -> Range<usize> {
        let Range { start, end } = self.taken.slots(section);
        let last = section + 1 >= self.taken.count();
        if last { end..end } else { end.saturating_sub(ShadingOrder::BORDER).max(start)..end }
    }

    /// Slots of the sections before that a section needs: the last of them, and for the last section the first of the plane where slots are
    /// shared.
    pub fn needed_before(&self, section: usize) -> [Range<usize>; 2] {
        let Range { start, end } = self.taken.slots(section);
        let border = if start < end { start.saturating_sub(ShadingOrder::BORDER)..start } else { start..start };
        let firsts = self.schedule.shape.closes[0] && section + 1 == self.taken.count();
        let firsts = 0..if firsts { ShadingOrder::BORDER.min(border.start) } else { 0 };
        [border, firsts]
    }
}

fn wide(slots: Range<usize>) -> Range<u64> {
    slots.start as u64..slots.end as u64
}
