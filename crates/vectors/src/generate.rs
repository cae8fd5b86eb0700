//! Making the lines: directed corners first, then what coverage still lacks, then constrained random.

use crate::coverage::Coverage;
use crate::expression::ExpressionError;
use crate::{LineField, Set, Unit, UnitFormat, WireRecorder};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use std::collections::HashSet;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::vec::IntoIter;

/// Random lines that are tried for a point that no line has hit.
const TRIES: usize = 4000;

/// The inputs of a unit's lines, one after another without end, for a set's format and seed: a shorter file is the beginning of a
/// longer one. Beside a line or two it holds a number for each directed line.
pub struct Lines<'a> {
    set: &'a Set,
    random: Random<'a>,
    steps: IntoIter<Step>,
    corners: Option<IntoIter<Vec<i128>>>,
    /// Hashes of the directed lines. Ends and corners may meet, and each is there once; lines of a clocked unit are a story and stay.
    seen: HashSet<u64>,
    coverage: Coverage,
    recorder: WireRecorder,
    /// Lines that may still be drawn for what is not covered; none once all is.
    tries: usize,
}

impl<'a> Lines<'a> {
    /// From the first line on.
    ///
    /// # Errors
    /// An expression of the sheet without a value.
    pub fn new(unit: &'a dyn Unit, set: &'a Set) -> Result<Lines<'a>, ExpressionError> {
        Ok(Lines {
            set,
            random: Random::new(unit, &set.format, &set.fields[0], set.seed),
            steps: steps(&set.fields[0]).into_iter(),
            corners: None,
            seen: HashSet::new(),
            coverage: Coverage::new(&set.sheet, &set.format)?,
            recorder: WireRecorder::default(),
            tries: if set.sheet.clocked { 0 } else { TRIES },
        })
    }

    /// The next of the directed lines and of those for coverage; none where only random ones follow.
    pub fn directed(&mut self) -> Option<Vec<i128>> {
        while let Some(line) = self.end_or_corner() {
            if self.set.sheet.clocked {
                return Some(line);
            }
            let mut hasher = DefaultHasher::new();
            line.hash(&mut hasher);
            if self.seen.insert(hasher.finish()) {
                self.see(&line);
                return Some(line);
            }
        }
        self.seen = HashSet::new();
        while self.tries > 0 && self.coverage.missed().next().is_some() {
            let line = self.random.line();
            self.tries -= 1;
            if self.see(&line) {
                self.tries = TRIES;
                return Some(line);
            }
        }
        self.tries = 0;
        None
    }

    /// What ports alone give, then what the unit knows of itself.
    fn end_or_corner(&mut self) -> Option<Vec<i128>> {
        if let Some(step) = self.steps.next() {
            return Some(self.random.directed(step));
        }
        let Random { unit, format, slots, .. } = &self.random;
        let mut line = self.corners.get_or_insert_with(|| unit.corners(format).into_iter()).next()?;
        for (slot, value) in slots.iter().zip(&mut line) {
            *value = (*value).clamp(slot.range[0], slot.range[1]);
        }
        Some(line)
    }

    /// Whether a line hits a new point of coverage.
    fn see(&mut self, line: &[i128]) -> bool {
        self.recorder.clear();
        let outputs = self.random.unit.evaluate(&self.set.format, &self.set.tables, line, &mut self.recorder);
        self.coverage.see(line, self.recorder.seen(), &outputs)
    }
}

impl Iterator for Lines<'_> {
    type Item = Vec<i128>;

    fn next(&mut self) -> Option<Vec<i128>> {
        self.directed().or_else(|| Some(self.random.line()))
    }
}

/// A corner that ports alone give.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// All fields 0, or what is nearest to it.
    Zero,
    /// All fields at an end: 0 the lowest, 1 the highest.
    End(usize),
    /// Ends alternating, the first field at this one.
    Alternating(usize),
    /// A port at a value while the others are random.
    Port(usize, i128),
    /// An element at an end, all others of its port at the other one.
    Alone(usize, usize),
}

/// The corners that ports alone give: all at an end; each port, and each element, at an end while others are not; elements
/// alternating.
fn steps(fields: &[LineField]) -> Vec<Step> {
    let mut steps = vec![Step::Zero, Step::End(0), Step::End(1), Step::Alternating(0), Step::Alternating(1)];
    for of_port in fields.chunk_by(|one, next| one.port == next.port) {
        let (port, [low, high]) = (of_port[0].port, of_port[0].range);
        let values = if high - low < 16 { (low..=high).collect() } else { vec![low, low + 1, high - 1, high] };
        steps.extend(values.into_iter().flat_map(|value| [Step::Port(port, value); 2]));
    }
    let mut first = 0;
    for of_port in fields.chunk_by(|one, next| one.port == next.port) {
        if of_port.len() > 1 {
            steps.extend((first..first + of_port.len()).flat_map(|i| [Step::Alone(i, 0), Step::Alone(i, 1)]));
        }
        first += of_port.len();
    }
    steps
}

/// Where a field of a line may be.
#[derive(Clone, Copy, Debug)]
struct Slot {
    port: usize,
    range: [i128; 2],
}

/// Random lines of a unit.
struct Random<'a> {
    rng: ChaCha8Rng,
    slots: Vec<Slot>,
    /// Range of the first element of each port; none of a port without elements.
    ports: Vec<Option<[i128; 2]>>,
    unit: &'a dyn Unit,
    format: &'a UnitFormat,
}

impl<'a> Random<'a> {
    fn new(unit: &'a dyn Unit, format: &'a UnitFormat, fields: &[LineField], seed: u64) -> Random<'a> {
        let slots: Vec<Slot> = fields.iter().map(|field| Slot { port: field.port, range: field.range }).collect();
        let mut ports = vec![None; slots.last().map_or(0, |slot| slot.port + 1)];
        for slot in &slots {
            ports[slot.port].get_or_insert(slot.range);
        }
        Random { rng: ChaCha8Rng::seed_from_u64(seed), slots, ports, unit, format }
    }

    fn below(&mut self, count: u128) -> u128 {
        let word = u128::from(self.rng.next_u64()) << 64 | u128::from(self.rng.next_u64());
        word % count
    }

    fn between(&mut self, [low, high]: [i128; 2]) -> i128 {
        low + self.below((high - low) as u128 + 1) as i128
    }

    fn one_in(&mut self, count: u128) -> bool {
        self.below(count) == 0
    }

    /// A value of a range: anywhere, at an end, beside an end, a power of two.
    fn value(&mut self, range: [i128; 2]) -> i128 {
        let [low, high] = range;
        let value = match self.below(8) {
            0 => low,
            1 => high,
            2 => low + 1,
            3 => high - 1,
            4 => {
                let power = 1 << self.below(u128::from(crate::sheet::bits_of(range)));
                if low < 0 && self.one_in(2) { -power } else { power }
            }
            _ => return self.between(range),
        };
        value.clamp(low, high)
    }

    /// A legal line in one of several styles.
    fn line(&mut self) -> Vec<i128> {
        let style = self.below(6);
        let base: Vec<i128> =
            (0..self.ports.len()).map(|port| self.ports[port].map_or(0, |range| self.value(range))).collect();
        let mut line: Vec<i128> = (0..self.slots.len())
            .map(|i| {
                let Slot { port, range } = self.slots[i];
                match style {
                    0 | 1 => self.between(range),
                    2 => range[self.below(2) as usize],
                    // Elements of a port close to each other.
                    3 => {
                        let [low, high] = range;
                        let near = ((high - low) / 64).max(1);
                        (base[port] + self.between([-near, near])).clamp(low, high)
                    }
                    // All elements of a port alike.
                    4 => base[port],
                    _ => self.value(range),
                }
            })
            .collect();
        self.unit.legalise(self.format, &mut line);
        line
    }

    /// A corner that ports alone give, made legal.
    fn directed(&mut self, step: Step) -> Vec<i128> {
        let mut line: Vec<i128> = match step {
            Step::Zero => self.slots.iter().map(|slot| 0.clamp(slot.range[0], slot.range[1])).collect(),
            Step::End(end) => self.slots.iter().map(|slot| slot.range[end]).collect(),
            Step::Alternating(first) => {
                self.slots.iter().enumerate().map(|(i, slot)| slot.range[(i + first) % 2]).collect()
            }
            Step::Port(..) | Step::Alone(..) => self.line(),
        };
        for (i, (slot, field)) in self.slots.iter().zip(&mut line).enumerate() {
            match step {
                Step::Port(port, value) if slot.port == port => *field = value,
                Step::Alone(alone, end) if slot.port == self.slots[alone].port => {
                    *field = slot.range[if i == alone { end } else { 1 - end }];
                }
                _ => {}
            }
        }
        self.unit.legalise(self.format, &mut line);
        line
    }
}
