//! Making the lines: directed corners first, then what coverage still lacks, then constrained random.

use crate::coverage::Coverage;
use crate::expression::ExpressionError;
use crate::{Field, Format, Recorder, Sheet, Tables, Unit};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use std::collections::HashSet;

/// Random lines that are tried for a point that no line has hit.
const TRIES: usize = 4000;

/// Lines of a unit with what the definition says to them.
#[derive(Clone, Debug)]
pub struct Vectors {
    /// The sheet.
    pub sheet: Sheet,
    /// The format.
    pub format: Format,
    /// The seed of all that is random.
    pub seed: u64,
    /// Contents of the tables.
    pub tables: Tables,
    /// Fields of the inputs, and of the outputs.
    pub fields: [Vec<Field>; 2],
    /// Input fields of each line.
    pub inputs: Vec<Vec<i128>>,
    /// Output fields of each line.
    pub outputs: Vec<Vec<i128>>,
}

impl Vectors {
    /// Lines with these inputs.
    ///
    /// # Errors
    /// An expression of the sheet without a value.
    pub fn of(unit: &dyn Unit, format: Format, seed: u64, inputs: Vec<Vec<i128>>) -> Result<Vectors, ExpressionError> {
        let tables = unit.tables(&format);
        Vectors::with_tables(unit, format, seed, tables, inputs)
    }

    /// Lines with these inputs, and other contents of the tables than the unit's own.
    ///
    /// # Errors
    /// An expression of the sheet without a value.
    pub fn with_tables(
        unit: &dyn Unit,
        format: Format,
        seed: u64,
        tables: Tables,
        inputs: Vec<Vec<i128>>,
    ) -> Result<Vectors, ExpressionError> {
        let sheet = unit.sheet();
        let fields = [Sheet::fields(&sheet.inputs, &format)?, Sheet::fields(&sheet.outputs, &format)?];
        let outputs = unit.run(&format, &tables, &inputs);
        Ok(Vectors { sheet, format, seed, tables, fields, inputs, outputs })
    }

    /// At least `count` lines; the directed ones are never left out.
    ///
    /// # Errors
    /// An expression of the sheet without a value.
    pub fn generate(unit: &dyn Unit, format: Format, count: usize, seed: u64) -> Result<Vectors, ExpressionError> {
        let sheet = unit.sheet();
        let fields = Sheet::fields(&sheet.inputs, &format)?;
        let mut random = Lines { rng: ChaCha8Rng::seed_from_u64(seed), fields: &fields, unit, format: &format };
        let mut lines = random.directed();
        lines.extend(unit.corners(&format).into_iter().map(|mut line| {
            for (field, value) in fields.iter().zip(&mut line) {
                *value = (*value).clamp(field.range[0], field.range[1]);
            }
            line
        }));
        if !sheet.clocked {
            // Ends and corners may meet; lines of a clocked unit are a story and stay.
            let mut seen = HashSet::new();
            lines.retain(|line| seen.insert(line.clone()));
            let mut coverage = Coverage::new(&sheet, &format)?;
            let (tables, mut recorder) = (unit.tables(&format), Recorder::default());
            let mut see = |coverage: &mut Coverage, line: &Vec<i128>| {
                recorder.clear();
                let outputs = unit.evaluate(&format, &tables, line, &mut recorder);
                coverage.see(line, recorder.seen(), &outputs)
            };
            for line in &lines {
                see(&mut coverage, line);
            }
            let mut tries = TRIES;
            while tries > 0 && coverage.missed().next().is_some() {
                let line = random.line();
                tries -= 1;
                if see(&mut coverage, &line) {
                    lines.push(line);
                    tries = TRIES;
                }
            }
        }
        while lines.len() < count {
            lines.push(random.line());
        }
        Vectors::of(unit, format, seed, lines)
    }

    /// What the lines cover.
    ///
    /// # Errors
    /// An expression of the sheet without a value.
    pub fn coverage(&self, unit: &dyn Unit) -> Result<Coverage, ExpressionError> {
        let mut coverage = Coverage::new(&self.sheet, &self.format)?;
        let mut recorder = Recorder::default();
        for (inputs, outputs) in self.inputs.iter().zip(&self.outputs) {
            recorder.clear();
            if !self.sheet.clocked {
                unit.evaluate(&self.format, &self.tables, inputs, &mut recorder);
            }
            coverage.see(inputs, recorder.seen(), outputs);
        }
        Ok(coverage)
    }
}

/// Random lines of a unit.
struct Lines<'a> {
    rng: ChaCha8Rng,
    fields: &'a [Field],
    unit: &'a dyn Unit,
    format: &'a Format,
}

impl Lines<'_> {
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
        let ports = self.fields.last().map_or(0, |field| field.port + 1);
        let base: Vec<i128> = (0..ports)
            .map(|port| self.fields.iter().find(|field| field.port == port).map(|field| field.range))
            .map(|range| range.map_or(0, |range| self.value(range)))
            .collect();
        let fields: Vec<Field> = self.fields.to_vec();
        let mut line: Vec<i128> = fields
            .iter()
            .map(|field| match style {
                0 | 1 => self.between(field.range),
                2 => field.range[self.below(2) as usize],
                // Elements of a port close to each other.
                3 => {
                    let [low, high] = field.range;
                    let near = ((high - low) / 64).max(1);
                    (base[field.port] + self.between([-near, near])).clamp(low, high)
                }
                // All elements of a port alike.
                4 => base[field.port],
                _ => self.value(field.range),
            })
            .collect();
        self.unit.legalise(self.format, &mut line);
        line
    }

    /// The corners that ports alone give: all at an end; each port, and each element, at an end while others are not; elements
    /// alternating.
    fn directed(&mut self) -> Vec<Vec<i128>> {
        let fields: Vec<Field> = self.fields.to_vec();
        let ports = fields.last().map_or(0, |field| field.port + 1);
        let mut lines = Vec::new();
        let ends = |end: usize| fields.iter().map(|field| field.range[end]).collect::<Vec<i128>>();
        lines.push(fields.iter().map(|field| 0.clamp(field.range[0], field.range[1])).collect());
        lines.push(ends(0));
        lines.push(ends(1));
        for parity in 0..2 {
            lines.push(fields.iter().enumerate().map(|(i, field)| field.range[(i + parity) % 2]).collect());
        }
        for port in 0..ports {
            let Some([low, high]) = fields.iter().find(|field| field.port == port).map(|field| field.range) else {
                continue;
            };
            let values = if high - low < 16 { (low..=high).collect() } else { vec![low, low + 1, high - 1, high] };
            for value in values {
                for _ in 0..2 {
                    let mut line = self.line();
                    for (field, value_of) in fields.iter().zip(&mut line) {
                        if field.port == port {
                            *value_of = value;
                        }
                    }
                    lines.push(line);
                }
            }
        }
        // One element against all others of its port.
        for (i, field) in fields.iter().enumerate() {
            let alone = fields.iter().filter(|other| other.port == field.port).count() == 1;
            if alone {
                continue;
            }
            for end in 0..2 {
                let mut line = self.line();
                for (j, other) in fields.iter().enumerate() {
                    if other.port == field.port {
                        line[j] = other.range[if i == j { end } else { 1 - end }];
                    }
                }
                lines.push(line);
            }
        }
        for line in &mut lines {
            self.unit.legalise(self.format, line);
        }
        lines
    }
}
