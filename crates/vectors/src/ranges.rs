//! Proofs of range: what each wire can carry at most, as the sheet derives it, against what a search finds.
//!
//! Where inputs are few, every line is tried. Else a boundary search: random lines, and from the best line for each end of each
//! wire a climb, field by field to the ends of its range, until no field helps. All of the arithmetic is monotone in each field or
//! in its distance from another, so extremes lie at ends.

use crate::expression::ExpressionError;
use crate::{LineField, Lines, Set, Unit, UnitFormat, WireRecorder, bits_of};

/// Most lines of an exhaustive search.
pub const MOST_LINES: u128 = 1 << 21;

/// A wire's range.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WireRange {
    /// Part and name.
    pub path: String,
    /// As derived in the sheet.
    pub derived: [i128; 2],
    /// Bits that hold the derived range.
    pub bits: u32,
    /// Lowest and highest value that the search found; none where the wire was never seen.
    pub found: Option<[i128; 2]>,
    /// Whether the sheet says that both ends are reached.
    pub tight: bool,
}

impl WireRange {
    /// Whether the search found nothing outside of the derived range.
    pub fn holds(&self) -> bool {
        self.found.is_none_or(|[low, high]| self.derived[0] <= low && high <= self.derived[1])
    }

    /// Whether the search reached both ends.
    pub fn reached(&self) -> bool {
        self.found == Some(self.derived)
    }
}

/// The ranges of a unit's wires in a format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ranges {
    /// The wires.
    pub wires: Vec<WireRange>,
    /// Whether every legal line was tried.
    pub exhaustive: bool,
    /// Lines that were evaluated.
    pub lines: u64,
}

/// The value of a wire, and the line that gave it.
type Extreme = (i128, Vec<i128>);

struct Search<'a> {
    unit: &'a dyn Unit,
    format: &'a UnitFormat,
    set: &'a Set,
    recorder: WireRecorder,
    /// For each wire and end.
    best: Vec<[Option<Extreme>; 2]>,
    lines: u64,
}

impl Search<'_> {
    /// Evaluates a line; whether it moved an end of `wire`, or of any where that is none.
    fn try_line(&mut self, line: &[i128], wire: Option<usize>) -> bool {
        self.recorder.clear();
        self.unit.evaluate(self.format, &self.set.tables, line, &mut self.recorder);
        self.lines += 1;
        let mut moved = false;
        for seen in self.recorder.seen() {
            let Some(index) = self.set.sheet.wire(seen.part, seen.name) else { continue };
            for end in 0..2 {
                let better = match &self.best[index][end] {
                    None => true,
                    Some((value, _)) => {
                        if end == 0 {
                            seen.value < *value
                        } else {
                            seen.value > *value
                        }
                    }
                };
                if better {
                    self.best[index][end] = Some((seen.value, line.to_vec()));
                    moved |= wire.is_none_or(|wire| wire == index);
                }
            }
        }
        moved
    }

    fn climb(&mut self, fields: &[LineField], wire: usize, end: usize) {
        loop {
            let Some((_, line)) = self.best[wire][end].clone() else { return };
            let mut helped = false;
            for (i, field) in fields.iter().enumerate() {
                for value in field.range {
                    let mut line = self.best[wire][end].as_ref().map_or(line.clone(), |(_, line)| line.clone());
                    if line[i] != value {
                        line[i] = value;
                        self.unit.legalise(self.format, &mut line);
                        helped |= self.try_line(&line, Some(wire));
                    }
                }
            }
            if !helped {
                return;
            }
        }
    }
}

/// Searches the ranges of a unit's wires in a format, from the first `lines` of its lines where it cannot try all.
///
/// # Errors
/// An expression of the sheet without a value.
pub fn search(unit: &dyn Unit, format: &UnitFormat, lines: usize, seed: u64) -> Result<Ranges, ExpressionError> {
    let set = Set::new(unit, *format, seed)?;
    let (sheet, fields) = (&set.sheet, &set.fields[0]);
    let mut search = Search {
        unit,
        format,
        set: &set,
        recorder: WireRecorder::default(),
        best: vec![[None, None]; sheet.wires.len()],
        lines: 0,
    };
    let all =
        fields.iter().try_fold(1_u128, |all, field| all.checked_mul((field.range[1] - field.range[0] + 1) as u128));
    let exhaustive = all.is_some_and(|all| all <= MOST_LINES);
    if exhaustive {
        let mut line: Vec<i128> = fields.iter().map(|field| field.range[0]).collect();
        loop {
            let mut legal = line.clone();
            unit.legalise(format, &mut legal);
            search.try_line(&legal, None);
            // The next line, as an odometer counts.
            let Some(turn) = (0..line.len()).find(|&i| line[i] < fields[i].range[1]) else { break };
            line[turn] += 1;
            for i in 0..turn {
                line[i] = fields[i].range[0];
            }
        }
    } else {
        for line in Lines::new(unit, &set)?.take(lines) {
            search.try_line(&line, None);
        }
        for wire in 0..sheet.wires.len() {
            for end in 0..2 {
                search.climb(fields, wire, end);
            }
        }
    }
    let mut wires = Vec::new();
    for (wire, best) in sheet.wires.iter().zip(&search.best) {
        let derived = [format.evaluate(wire.range[0])?, format.evaluate(wire.range[1])?];
        let found = match best {
            [Some((low, _)), Some((high, _))] => Some([*low, *high]),
            _ => None,
        };
        wires.push(WireRange { path: wire.path(), derived, bits: bits_of(derived), found, tight: wire.tight });
    }
    Ok(Ranges { wires, exhaustive, lines: search.lines })
}
