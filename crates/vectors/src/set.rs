//! Sets of vectors: what their lines have in common, and what the definition says to a line.

use crate::expression::ExpressionError;
use crate::{Device, LineField, Seen, Sheet, Tables, Unit, UnitFormat, WireRecorder};

/// What the lines of a set have in common.
#[derive(Clone, Debug)]
pub struct Set {
    /// The sheet.
    pub sheet: Sheet,
    /// The format.
    pub format: UnitFormat,
    /// The seed of all that is random.
    pub seed: u64,
    /// Contents of the tables.
    pub tables: Tables,
    /// Fields of the inputs, and of the outputs.
    pub fields: [Vec<LineField>; 2],
}

impl Set {
    /// A set with the unit's own contents of its tables.
    ///
    /// # Errors
    /// An expression of the sheet without a value.
    pub fn new(unit: &dyn Unit, format: UnitFormat, seed: u64) -> Result<Set, ExpressionError> {
        Set::with_tables(unit, format, seed, unit.tables(&format))
    }

    /// A set with other contents of the tables than the unit's own.
    ///
    /// # Errors
    /// An expression of the sheet without a value.
    pub fn with_tables(unit: &dyn Unit, format: UnitFormat, seed: u64, tables: Tables) -> Result<Set, ExpressionError> {
        let sheet = unit.sheet();
        let fields = [Sheet::fields(&sheet.inputs, &format)?, Sheet::fields(&sheet.outputs, &format)?];
        Ok(Set { sheet, format, seed, tables, fields })
    }

    /// Fields of a line, inputs and outputs.
    pub fn width(&self) -> usize {
        self.fields.iter().map(Vec::len).sum()
    }
}

/// The definition of a unit, line after line from reset on.
pub struct UnitDefinition<'a> {
    unit: &'a dyn Unit,
    set: &'a Set,
    device: Option<Device<'a>>,
    recorder: WireRecorder,
}

impl<'a> UnitDefinition<'a> {
    /// After reset.
    pub fn new(unit: &'a dyn Unit, set: &'a Set) -> UnitDefinition<'a> {
        UnitDefinition { unit, set, device: unit.start(&set.format), recorder: WireRecorder::default() }
    }

    /// The output fields of the next line.
    pub fn answer(&mut self, inputs: &[i128]) -> Vec<i128> {
        self.recorder.clear();
        match &mut self.device {
            Some(device) => device(inputs),
            None => self.unit.evaluate(&self.set.format, &self.set.tables, inputs, &mut self.recorder),
        }
    }

    /// What the wires carried in that line; nothing of a unit with a memory.
    pub fn seen(&self) -> &[Seen] {
        self.recorder.seen()
    }
}
