//! The order in which beams are fetched, what each brings, and how long it takes.

use crate::golden::{Skew, Steps, row};
use cube3_frame::{BeamPlace, Geometry, Schedule};
use cube3_machine::{Layout, MachineSpec};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Data sheet of the frame buffer for one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CfbSpec {
    /// The order of the beams, and what they have.
    pub schedule: Schedule,
    /// Cycles of a beam without conflicts: ⌈n_u / lanes⌉ for each row.
    pub beam_cycles: u64,
    /// Further cycles of a beam, in which modules serve voxels that share one; none with mini-blocks, whose reorder buffer gives any `lanes`
    /// voxels in a cycle.
    pub conflict_cycles: u64,
    /// Neighbouring voxels of a beam that a cycle gives: they are in different modules, or come from a reorder buffer.
    together: usize,
    reorders: bool,
}

/// What a beam brings of the row that a plane of ray slots has at a depth: the voxels of a section's slots, which may go on from the
/// row's last voxel to its first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Row v of the volume.
    pub row: u32,
    /// Voxels u.
    pub columns: [Range<usize>; 2],
}

/// A beam that is fetched, or a piece of one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fetching {
    /// Row v of the volume, where there is something to fetch.
    pub row: Option<u32>,
    pub voxels: u32,
    pub cycles: u64,
    /// Of these the cycles without conflicts.
    pub work: u64,
}

impl Piece {
    /// What the beam of a place brings, if it has any voxels.
    #[inline(always)]
    pub(crate) fn at(place: BeamPlace, geometry: &Geometry, schedule: &Schedule) -> Option<Piece> {
        let row = row(geometry, place.plane, place.depth)?;
        if schedule.sections().is_whole() {
            return Some(Piece { row, columns: [0..geometry.size[0], 0..0] });
        }
        Piece::of_section(row, place, geometry, schedule)
    }

    /// What a section has of a row.
    #[inline(never)]
    fn of_section(row: u32, place: BeamPlace, geometry: &Geometry, schedule: &Schedule) -> Option<Piece> {
        let slots = schedule.sections().slots(place.section as usize);
        let columns = geometry.columns(slots, place.depth as usize);
        (!columns[0].is_empty()).then_some(Piece { row, columns })
    }

    /// How many voxels it has.
    #[inline(always)]
    fn voxels(&self) -> u32 {
        let [first, second] = &self.columns;
        (first.len() + second.len()) as u32
    }
}

impl CfbSpec {
    /// The data sheet for a machine and a frame, which has this schedule there.
    pub fn new(machine: &MachineSpec, geometry: &Geometry, schedule: Schedule) -> CfbSpec {
        let skew = Skew { coefficients: machine.cfb.skew, lanes: machine.lanes };
        let beam_cycles = schedule.row_cycles();
        let all = match machine.cfb.layout {
            Layout::Rows | Layout::Blocks => skew.beam_cycles(geometry.axes.axis[0], geometry.size[0]) as u64,
            Layout::MiniBlocks => beam_cycles,
        };
        let rows = schedule.rows_of_beam();
        CfbSpec {
            schedule,
            beam_cycles: rows * beam_cycles,
            conflict_cycles: rows * (all - beam_cycles),
            together: match machine.cfb.layout {
                Layout::Rows | Layout::Blocks => skew.together(geometry.axes.axis[0]),
                Layout::MiniBlocks => machine.lanes,
            },
            reorders: machine.cfb.layout == Layout::MiniBlocks,
        }
    }

    /// Cycles of a whole beam, or of a padded plane's depth outside of the volume, that waits for nothing.
    #[inline]
    pub fn cycles(&self, row: Option<u32>) -> u64 {
        if row.is_some() { self.beam_cycles + self.conflict_cycles } else { 1 }
    }

    /// The same of a piece of a beam.
    #[inline]
    pub fn piece_cycles(&self, piece: Option<&Piece>) -> u64 {
        match piece {
            Some(Piece { columns, .. }) if !self.schedule.sections().is_whole() => self.steps(columns).count() as u64,
            _ => self.cycles(piece.map(|piece| piece.row)),
        }
    }

    /// What the scan fetches.
    #[inline(always)]
    pub(crate) fn fetching(&self, geometry: &Geometry, scan: &Scan) -> Fetching {
        if !self.schedule.sections().is_whole() {
            return self.fetching_piece(geometry, scan);
        }
        let row = row(geometry, scan.place.plane, scan.place.depth);
        let voxels = if row.is_some() { geometry.size[0] as u32 } else { 0 };
        Fetching { row, voxels, cycles: self.cycles(row), work: self.beam_cycles }
    }

    #[inline(never)]
    fn fetching_piece(&self, geometry: &Geometry, scan: &Scan) -> Fetching {
        let piece = Piece::at(scan.place, geometry, &self.schedule);
        let voxels = piece.as_ref().map_or(0, Piece::voxels);
        Fetching {
            row: piece.as_ref().map(|piece| piece.row),
            voxels,
            cycles: self.piece_cycles(piece.as_ref()),
            work: if piece.is_some() { self.schedule.piece_cycles(voxels) } else { self.beam_cycles },
        }
    }

    /// The voxels of a step of a piece.
    #[inline]
    pub(crate) fn voxels_of_step(&self, piece: &Piece, step: usize) -> [Range<usize>; 2] {
        if self.schedule.sections().is_whole() {
            let first = step * self.together;
            return [first..piece.columns[0].end.min(first + self.together), 0..0];
        }
        self.steps(&piece.columns).voxels(step)
    }

    /// The steps in which the voxels of a piece are read.
    fn steps(&self, columns: &[Range<usize>; 2]) -> Steps {
        if self.reorders {
            Steps::from_buffer(self.schedule.shape().lanes, columns)
        } else {
            Steps::new(self.together, columns)
        }
    }
}

/// A place in the scan of the frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Scan {
    pub frame: u32,
    pub place: BeamPlace,
    /// Cycles of the beam that are over.
    pub spent: u64,
}

impl Scan {
    /// Whether no voxel of the next frame has been read.
    pub fn between_frames(&self) -> bool {
        self.place == BeamPlace::default() && self.spent == 0
    }

    /// Goes on to the next beam.
    #[inline]
    pub fn advance(&mut self, schedule: &Schedule) {
        self.spent = 0;
        self.frame += u32::from(schedule.next_beam(&mut self.place));
    }
}

/// The beams of a frame that have voxels, in the order in which they are fetched, each with what is fetched.
pub fn scan(geometry: &Geometry, schedule: &Schedule) -> impl Iterator<Item = (BeamPlace, Piece)> {
    schedule.beams().filter_map(move |place| Some((place, Piece::at(place, geometry, schedule)?)))
}
