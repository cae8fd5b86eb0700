//! A unit whose arithmetic can be evaluated on the fields of a line.

use crate::{Sheet, UnitFormat};
use cube3_word::Probe;

/// The outputs of a unit with a memory for the inputs of a cycle, from reset on.
pub type Device<'a> = Box<dyn FnMut(&[i128]) -> Vec<i128> + 'a>;

/// The tables of a unit, in the order of its sheet.
pub type Tables = Vec<Vec<i128>>;

/// What a wire carried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    /// Part, empty for the unit itself.
    pub part: &'static str,
    /// Name.
    pub name: &'static str,
    /// Which of its row.
    pub place: usize,
    /// Value.
    pub value: i128,
}

/// Writes down what wires carry.
#[derive(Clone, Debug, Default)]
pub struct WireRecorder {
    part: Option<(&'static str, usize)>,
    seen: Vec<Seen>,
}

impl WireRecorder {
    /// What has been seen.
    pub fn seen(&self) -> &[Seen] {
        &self.seen
    }

    /// Forgets what has been seen.
    pub fn clear(&mut self) {
        self.seen.clear();
    }
}

impl Probe for WireRecorder {
    /// Wires of a part are in a row by the part's place, or where the part is there once, by their own.
    fn wire(&mut self, name: &'static str, place: usize, value: i128) {
        let (part, of_part) = self.part.unwrap_or(("", 0));
        self.seen.push(Seen { part, name, place: of_part + place, value });
    }

    fn within<R>(&mut self, part: &'static str, place: usize, work: impl FnOnce(&mut Self) -> R) -> R {
        let outer = self.part.replace((part, place));
        let result = work(self);
        self.part = outer;
        result
    }
}

/// A block of the machine with a sheet and a definition.
pub trait Unit: Sync {
    /// The data sheet.
    fn sheet(&self) -> Sheet;

    /// Evaluates the definition on the fields of a line, and shows the probe its wires. The fields of the result are the outputs.
    fn evaluate(&self, format: &UnitFormat, tables: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128>;

    /// The contents of the tables.
    fn tables(&self, _format: &UnitFormat) -> Tables {
        Tables::new()
    }

    /// Makes a line legal whose fields are legal one by one: what the unit before would never send together.
    fn legalise(&self, _format: &UnitFormat, _inputs: &mut [i128]) {}

    /// Lines that the sheet alone does not lead to.
    fn corners(&self, _format: &UnitFormat) -> Vec<Vec<i128>> {
        Vec::new()
    }

    /// Formats in which the unit is held against its lanes and its wires against their ranges, beside the default.
    fn formats(&self) -> Vec<UnitFormat> {
        word_formats()
    }

    /// The same by the code that runs where that is not the definition itself: the outputs of each line. An output that this code
    /// does not hold is the definition's.
    fn lanes(&self, _format: &UnitFormat, _tables: &Tables, _lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        None
    }

    /// The unit after reset, for one with a memory: it is given the lines in order.
    fn start<'a>(&'a self, _format: &'a UnitFormat) -> Option<Device<'a>> {
        None
    }
}

/// Narrow, default and wide words, rounded and truncated.
pub fn word_formats() -> Vec<UnitFormat> {
    use cube3_word::{Rounding, Words};
    let base = Words::default();
    let narrow = Words {
        voxel_bits: 4,
        weight_bits: 2,
        gradient_bits: 4,
        normal_bits: 4,
        table_bits: 3,
        colour_bits: 3,
        opacity_bits: 2,
        accumulator_bits: 4,
        ..base
    };
    let least = Words {
        voxel_bits: 1,
        weight_bits: 0,
        gradient_bits: 2,
        normal_bits: 4,
        table_bits: 1,
        colour_bits: 1,
        opacity_bits: 1,
        accumulator_bits: 1,
        ..base
    };
    let wide = Words {
        weight_bits: 12,
        sample_fraction_bits: 8,
        gradient_bits: 24,
        normal_bits: 15,
        table_bits: 16,
        colour_bits: 16,
        opacity_bits: 16,
        accumulator_bits: 32,
        ..base
    };
    let volumepro = Words { voxel_bits: 12, gradient_bits: 8, colour_bits: 8, accumulator_bits: 12, ..base };
    let words = [base, narrow, least, wide, volumepro];
    let format = |words: Words| {
        let mut format = UnitFormat { words, ..UnitFormat::default() };
        // A root table holds no more index bits than a square has.
        format.root_bits = format.root_bits.min(2 * words.normal_bits - 3);
        format.power_bits = format.power_bits.min(words.normal_bits - 1);
        format
    };
    [Rounding::Nearest, Rounding::Truncate]
        .into_iter()
        .flat_map(|rounding| words.map(|words| format(Words { rounding, ..words })))
        .collect()
}

/// The fields of a line one after another.
#[derive(Debug)]
pub struct Reader<'a> {
    rest: &'a [i128],
}

impl<'a> Reader<'a> {
    /// From the first field on. A line has all the fields of its sheet: what is missing reads as 0.
    pub fn new(fields: &'a [i128]) -> Reader<'a> {
        Reader { rest: fields }
    }

    /// The next field.
    pub fn field(&mut self) -> i128 {
        match self.rest.split_first() {
            Some((first, rest)) => {
                self.rest = rest;
                *first
            }
            None => 0,
        }
    }

    /// The next field as an unsigned word.
    pub fn word(&mut self) -> u32 {
        self.field() as u32
    }

    /// The next field as a signed word.
    pub fn signed(&mut self) -> i32 {
        self.field() as i32
    }

    /// The next field as a flag.
    pub fn flag(&mut self) -> bool {
        self.field() != 0
    }

    /// The next N unsigned words.
    pub fn words<const N: usize>(&mut self) -> [u32; N] {
        std::array::from_fn(|_| self.word())
    }

    /// The next N signed words.
    pub fn signed_words<const N: usize>(&mut self) -> [i32; N] {
        std::array::from_fn(|_| self.signed())
    }
}
