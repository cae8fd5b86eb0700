//! Rows of mini-blocks along the beams of a frame: which beams use one, and so how many words the reorder buffer holds.
//!
//! The beam of plane i at depth k is row v of the voxels of plane w = k, and lies in the row (⌊y/2⌋, ⌊z/2⌋) of mini-blocks, y and z its voxels'
//! coordinates along the axes of v and w. Another row of voxels at the same depth, and both at the depth beside it, lie there too. From
//! plane to plane the row of voxels at a depth moves by one, so that a row of mini-blocks is used in two or three planes that follow each
//! other; where planes wrap round, some are used in the first planes and again in the last. A row stays in the buffer as long as the same
//! plane or the next one uses it again.
//!
//! Where ray slots are taken in sections, a section brings what its slots use of such a row at both depths, and what the section before has
//! not brought: mini-blocks across the edge of a section are read once, and kept beside the chip for the next one.

use crate::golden::Placement;
use crate::scan::{CfbSpec, Piece};
use cube3_frame::{BeamPlace, Geometry, Schedule};
use cube3_machine::{LookAheadUnit, MachineSpec, MemoryModel, RaySlots};
use std::ops::Range;

/// The mini-block, along the axis behind v (1) or w (2), of a row or depth.
fn mini(geometry: &Geometry, axis: usize, coordinate: usize) -> usize {
    let Geometry { axes, size, .. } = geometry;
    let voxel = if axes.reversed[axis] { size[axis] - 1 - coordinate } else { coordinate };
    voxel / Placement::MINI
}

/// Mini-blocks of a row.
pub(super) fn row_minis(geometry: &Geometry) -> usize {
    geometry.size[0].div_ceil(Placement::MINI)
}

/// Which mini-block along its axis is number `number` of a row, in the order of u.
pub(super) fn along(geometry: &Geometry, number: usize) -> usize {
    if geometry.axes.reversed[0] { row_minis(geometry) - 1 - number } else { number }
}

/// The number within its row, in the order of u, of the mini-block that voxel u is in.
pub(super) fn number(geometry: &Geometry, u: usize) -> usize {
    along(geometry, mini(geometry, 0, u))
}

/// Words of so many mini-blocks.
pub(super) fn words_of(minis: usize) -> u64 {
    (minis * Placement::MINI_WORDS) as u64
}

/// A beam of a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct At<'a> {
    pub geometry: &'a Geometry,
    pub schedule: &'a Schedule,
    pub place: BeamPlace,
}

impl At<'_> {
    /// The rows of mini-blocks that the beam uses, in the order in which it does: none where it is outside of the volume, two where
    /// slots need their own cells and these lie in both.
    pub fn used(&self) -> [Option<usize>; 2] {
        let At { geometry, schedule, place } = *self;
        let Some(piece) = Piece::at(place, geometry, schedule) else {
            return [None; 2];
        };
        let near = of_voxels(geometry, piece.row as usize);
        let below =
            if geometry.doubled() { geometry.row_below(place.plane as usize, place.depth as usize) } else { None };
        [Some(near), below.map(|v| of_voxels(geometry, v)).filter(|&below| below != near)]
    }

    fn uses(&self, plane: u32, depth: u32, j: usize) -> bool {
        At { place: BeamPlace { plane, depth, ..self.place }, ..*self }.used().contains(&Some(j))
    }

    /// Whether the beam, which uses row `j`, is the first to do so since the row was last in the buffer.
    pub fn is_first(&self, j: usize) -> bool {
        let At { geometry, place: BeamPlace { plane, depth, .. }, .. } = *self;
        let partner = partner(geometry, depth);
        let before = partner.is_some_and(|partner| partner < depth && self.uses(plane, partner, j));
        let beside = plane.checked_sub(1).is_some_and(|above| {
            self.uses(above, depth, j) || partner.is_some_and(|partner| self.uses(above, partner, j))
        });
        !before && !beside
    }

    /// Whether it is the last one before the row leaves the buffer.
    pub fn is_last(&self, j: usize) -> bool {
        let At { geometry, schedule, place: BeamPlace { plane, depth, .. } } = *self;
        let partner = partner(geometry, depth);
        let behind = partner.is_some_and(|partner| partner > depth && self.uses(plane, partner, j));
        let below = plane + 1;
        let beside = !schedule.is_last_plane(plane)
            && (self.uses(below, depth, j) || partner.is_some_and(|partner| self.uses(below, partner, j)));
        !behind && !beside
    }

    /// The mini-blocks, by their numbers, that the section brings of a row at this depth and the one beside it: two ranges where they go on from
    /// the row's last to its first.
    pub fn brought(&self) -> [Range<usize>; 2] {
        let (all, section) = (row_minis(self.geometry), self.place.section);
        if self.schedule.sections().is_whole() {
            return [0..all, 0..0];
        }
        let Some(mut brought) = self.touched(section) else {
            return [0..0, 0..0];
        };
        if let Some(before) = section.checked_sub(1).and_then(|before| self.touched(before)) {
            brought.end = brought.end.min(before.start + all);
            brought.start = brought.end.min(brought.start.max(before.end));
        }
        let (start, count) = (brought.start % all, brought.len().min(all));
        [start..all.min(start + count), 0..(start + count).saturating_sub(all)]
    }

    /// How many mini-blocks the section uses that the section before has brought.
    fn kept(&self) -> usize {
        let brought: usize = self.brought().iter().map(Range::len).sum();
        self.touched(self.place.section).map_or(0, |minis| minis.len().min(row_minis(self.geometry)) - brought)
    }

    /// The mini-blocks that the slots of a section use at this depth and the one beside it, counted on where they go on from the row's last to its
    /// first.
    fn touched(&self, section: u32) -> Option<Range<usize>> {
        let At { geometry, schedule, place: BeamPlace { depth, .. } } = *self;
        let (n, all) = (geometry.size[0], row_minis(geometry));
        let depths = [Some(depth), partner(geometry, depth)].into_iter().flatten();
        let nearest = depths.clone().min().unwrap_or(depth);
        let rounds = geometry.u.columns[nearest as usize] as usize / n * n;
        let slots = schedule.sections().slots(section as usize);
        let spans = depths.filter_map(|depth| {
            let columns = match geometry.slots {
                RaySlots::Wrapped => {
                    let column = geometry.u.columns[depth as usize] as usize - rounds;
                    slots.start + column..slots.end + column
                }
                RaySlots::Padded => geometry.columns(slots.clone(), depth as usize)[0].clone(),
            };
            let mini = |u: usize| number(geometry, u % n) + u / n * all;
            (!columns.is_empty()).then(|| mini(columns.start)..mini(columns.end - 1) + 1)
        });
        spans.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end))
    }
}

/// Words of mini-blocks that lie across the edges of sections and are kept beside the chip from one section to the next; the most at a time.
pub fn edge_words(geometry: &Geometry, schedule: &Schedule) -> u64 {
    let rows = geometry.size[1].div_ceil(Placement::MINI);
    let at = |section: u32| {
        let kept =
            (0..geometry.size[2] as u32).filter(|&depth| partner(geometry, depth).is_none_or(|beside| beside > depth));
        kept.map(|depth| At { geometry, schedule, place: BeamPlace { section, plane: 0, depth } }.kept()).sum()
    };
    words_of((1..schedule.sections().count() as u32).map(at).max().unwrap_or(0) * rows)
}

/// The mini-blocks along w that a depth is in.
pub(super) fn pair(geometry: &Geometry, depth: u32) -> usize {
    mini(geometry, 2, depth as usize)
}

/// The depth that is in the same mini-blocks.
fn partner(geometry: &Geometry, depth: u32) -> Option<u32> {
    let beside = [depth.checked_sub(1), Some(depth + 1).filter(|&depth| (depth as usize) < geometry.size[2])];
    beside.into_iter().flatten().find(|&beside| pair(geometry, beside) == pair(geometry, depth))
}

/// The mini-blocks along v that a row of voxels is in.
pub(super) fn of_voxels(geometry: &Geometry, v: usize) -> usize {
    mini(geometry, 1, v)
}

/// What a frame needs of the reorder buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReorderNeed {
    /// Words of the rows that some beam finds in the buffer together: with fewer it would wait for ever.
    pub least: u64,
    /// Words that let the modules read at one rate throughout the frame, as late as each beam allows; and the words that they are asked for
    /// ahead, and two rows more.
    pub steady: u64,
    /// Rows of mini-blocks that are read, some twice; in sections parts of rows.
    pub rows: u64,
    /// Words that are read.
    pub words: u64,
}

impl ReorderNeed {
    /// The need of a frame on a machine.
    ///
    /// With N(t) words asked for first by the beams up to beam t, R(t) words left behind by those before it, and the beam from cycle s(t) to
    /// e(t) of T: reading N(T) words at one rate, word N(t) has to be there at s(t), so the reading begins at the least of s(t) − T·N(t)/N(T)
    /// at the latest, and at e(t) the buffer holds what has been read until then less R(t).
    pub fn new(machine: &MachineSpec, geometry: &Geometry) -> ReorderNeed {
        let schedule = Schedule::new(machine, geometry);
        let spec = CfbSpec::new(machine, geometry, schedule);
        let (mut cycle, mut rows, mut asked, mut left, mut least, mut widest) = (0, 0, 0_u64, 0_u64, 0, 0);
        let (mut starts, mut ends) = (Vec::new(), Vec::new());
        for place in schedule.beams() {
            let at = At { geometry, schedule: &schedule, place };
            let brought = at.brought().map(|minis| words_of(minis.len()));
            let (words, parts) = (brought.iter().sum(), brought.iter().filter(|&&words| words > 0).count() as u64);
            let (before, mut leave) = (asked, 0);
            for j in at.used().into_iter().flatten() {
                if at.is_first(j) {
                    asked += words;
                    rows += parts;
                    widest = brought.into_iter().fold(widest, u64::max);
                }
                leave += if at.is_last(j) { words } else { 0 };
            }
            least = least.max(asked - left);
            if asked > before {
                starts.push([cycle, asked]);
            }
            cycle += spec.piece_cycles(Piece::at(place, geometry, &schedule).as_ref());
            if leave > 0 {
                ends.push([cycle, left]);
                left += leave;
            }
        }
        // In words · cycles.
        let ahead = |[at, words]: [u64; 2]| i128::from(asked) * i128::from(at) - i128::from(cycle) * i128::from(words);
        let begin = starts.into_iter().map(ahead).min().unwrap_or(0);
        let most = ends.into_iter().map(ahead).max().unwrap_or(0);
        let held = ((most - begin) as u64).div_ceil(cycle.max(1)).max(least);
        let held = if widest > 0 { held.next_multiple_of(widest) } else { held };
        let model = MemoryModel::of_machine(&machine.cfb);
        let burst = model.burst.min(Placement::MINI_WORDS);
        let bursts = match machine.cfb.look_ahead_unit {
            LookAheadUnit::Words => model.look_ahead.div_ceil(burst),
            LookAheadUnit::Bursts => model.look_ahead,
        };
        let outstanding = bursts * burst * machine.lanes;
        ReorderNeed { least, steady: held + 2 * widest + outstanding as u64, rows, words: asked }
    }
}
