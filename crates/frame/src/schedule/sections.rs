//! Sections: ranges of the ray slots of a plane that the machine takes one behind another.

use crate::Geometry;
use cube3_machine::RaySlots;
use std::ops::Range;

/// The sections of a frame: the slots of a plane in pieces of one width, the last as wide as is left.
///
/// A unit that gives a slot only when later ones have come gives the last of them with the next section: its sections end so many slots
/// earlier, but for the last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sections {
    slots: usize,
    width: usize,
    behind: usize,
    last: usize,
}

impl Sections {
    /// Sections of `width` of so many slots; one of all slots where none is given.
    pub(super) fn new(slots: usize, width: Option<usize>) -> Sections {
        let width = width.unwrap_or(slots).clamp(1, slots.max(1));
        Sections { slots, width, behind: 0, last: slots.div_ceil(width).saturating_sub(1) }
    }

    /// The sections of a unit that gives a slot when so many more behind it have come.
    #[must_use]
    pub(super) fn behind(self, slots: usize) -> Sections {
        Sections { behind: self.behind + slots, ..self }
    }

    /// How many there are.
    #[inline]
    pub fn count(&self) -> usize {
        if self.slots == 0 { 0 } else { self.last + 1 }
    }

    /// Whether a plane is taken as a whole.
    #[inline]
    pub fn is_whole(&self) -> bool {
        self.last == 0
    }

    /// The slots of a section; none of a first one that is narrower than what its unit waits for.
    #[inline]
    pub fn slots(&self, section: usize) -> Range<usize> {
        let start = (section * self.width).saturating_sub(self.behind);
        if section > self.last { self.slots..self.slots } else { start..self.end(section) }
    }

    /// The slot behind the last of a section.
    #[inline]
    pub fn end(&self, section: usize) -> usize {
        if section >= self.last { self.slots } else { ((section + 1) * self.width).saturating_sub(self.behind) }
    }

    /// Whether a slot is the first of a section behind another.
    #[inline]
    pub fn continues(&self, slot: usize) -> bool {
        slot > 0 && self.slots(self.section(slot)).start == slot
    }

    /// Whether a slot is the last of a section before another.
    #[inline]
    pub fn breaks_off(&self, slot: usize) -> bool {
        let section = self.section(slot);
        section < self.last && self.end(section) == slot + 1
    }

    /// The widest one in slots.
    pub fn widest(&self) -> usize {
        (0..self.count()).map(|section| self.slots(section).len()).max().unwrap_or(0)
    }

    /// The section of a slot.
    #[inline]
    pub fn section(&self, slot: usize) -> usize {
        ((slot + self.behind) / self.width).min(self.last)
    }
}

impl Geometry {
    /// The voxels along u that these slots of a parallel frame have at a depth, in the order of the slots: two ranges where they go on from the
    /// last voxel to the first, else the second is empty. Padded slots beside the volume have none.
    #[inline]
    pub fn columns(&self, slots: Range<usize>, depth: usize) -> [Range<usize>; 2] {
        let (n, column) = (self.size[0], self.u.columns[depth] as usize);
        match self.slots {
            RaySlots::Wrapped => {
                let (start, count) = ((slots.start + column) % n, slots.len());
                [start..n.min(start + count), 0..(start + count).saturating_sub(n)]
            }
            RaySlots::Padded => {
                let voxel = |slot: usize| (slot + column).saturating_sub(self.shear_u()).min(n);
                [voxel(slots.start)..voxel(slots.end), 0..0]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axes, largest_offset, slope_register};
    use cube3_cases::cases;
    use cube3_machine::TemplateRule;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn the_columns_of_slots_are_those_of_their_rays(
            size in [1_usize..12, 1_usize..5, 1_usize..12], du in 0.0..=1.0_f64, padded: bool, width in 1_usize..14,
        ) {
            let rule = TemplateRule::SampleFloor;
            let slopes = [du, 0.0].map(slope_register);
            let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
            let axes = Axes { axis: [0, 1, 2], reversed: [false; 3] };
            let geometry = Geometry::new(size, axes, slopes, largest_offset(rule, slopes, 8).min(128), 8, rule, slots);
            let [count, _] = geometry.slot_counts();
            let sections = Sections::new(count, Some(width));
            let all: Vec<usize> = (0..sections.count()).flat_map(|s| sections.slots(s)).collect();
            prop_assert_eq!(all, (0..count).collect::<Vec<_>>());
            prop_assert!((0..sections.count()).all(|s| (1..=width).contains(&sections.slots(s).len())));
            prop_assert_eq!(Sections::new(count, None).slots(0), 0..count);
            for depth in 0..size[2] {
                for s in 0..sections.count() {
                    let slots = sections.slots(s);
                    let rays = slots.clone().map(|j| geometry.ray_in_slot(0, j, depth).u);
                    let expected: Vec<usize> = rays.filter_map(|u| geometry.column_at(u, depth)).collect();
                    let columns: Vec<usize> = geometry.columns(slots, depth).into_iter().flatten().collect();
                    prop_assert_eq!(columns, expected);
                }
            }
        }

        /// A unit gives slot j when slot j + `behind` has come, or the last one.
        #[test]
        fn sections_behind_give_what_has_come(slots in 1_usize..30, width in 1_usize..34, behind in 0_usize..5) {
            let taken = Sections::new(slots, Some(width));
            let given = taken.behind(behind);
            prop_assert_eq!(given.count(), slots.div_ceil(width));
            prop_assert_eq!(given.is_whole(), width >= slots);
            for j in 0..slots {
                let section = given.section(j);
                prop_assert_eq!(section, taken.section((j + behind).min(slots - 1)));
                prop_assert!(given.slots(section).contains(&j));
            }
            let all: Vec<usize> = (0..given.count()).flat_map(|s| given.slots(s)).collect();
            prop_assert_eq!(all, (0..slots).collect::<Vec<_>>());
        }
    }
}
