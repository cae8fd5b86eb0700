//! Small sets of vectors, held in memory.

use crate::expression::ExpressionError;
use crate::{Coverage, Lines, Set, Unit, UnitDefinition, UnitFormat};

/// A small set with its lines, in memory.
#[derive(Clone, Debug)]
pub struct Vectors {
    /// What the lines have in common.
    pub set: Set,
    /// Input fields of each line.
    pub inputs: Vec<Vec<i128>>,
    /// Output fields of each line.
    pub outputs: Vec<Vec<i128>>,
}

impl Vectors {
    /// Lines with these inputs.
    pub fn of(unit: &dyn Unit, set: Set, inputs: Vec<Vec<i128>>) -> Vectors {
        let mut definition = UnitDefinition::new(unit, &set);
        let outputs = inputs.iter().map(|line| definition.answer(line)).collect();
        drop(definition);
        Vectors { set, inputs, outputs }
    }

    /// The first `count` lines of [`Lines`].
    ///
    /// # Errors
    /// An expression of the sheet without a value.
    pub fn generate(unit: &dyn Unit, format: UnitFormat, count: usize, seed: u64) -> Result<Vectors, ExpressionError> {
        let set = Set::new(unit, format, seed)?;
        let inputs = Lines::new(unit, &set)?.take(count).collect();
        Ok(Vectors::of(unit, set, inputs))
    }

    /// The directed lines and those for coverage, however many.
    ///
    /// # Errors
    /// An expression of the sheet without a value.
    pub fn directed(unit: &dyn Unit, format: UnitFormat, seed: u64) -> Result<Vectors, ExpressionError> {
        let set = Set::new(unit, format, seed)?;
        let mut lines = Lines::new(unit, &set)?;
        let inputs = std::iter::from_fn(|| lines.directed()).collect();
        drop(lines);
        Ok(Vectors::of(unit, set, inputs))
    }

    /// What the lines cover.
    ///
    /// # Errors
    /// An expression of the sheet without a value.
    pub fn coverage(&self, unit: &dyn Unit) -> Result<Coverage, ExpressionError> {
        let mut coverage = Coverage::new(&self.set.sheet, &self.set.format)?;
        let mut definition = UnitDefinition::new(unit, &self.set);
        for inputs in &self.inputs {
            let outputs = definition.answer(inputs);
            coverage.see(inputs, definition.seen(), &outputs);
        }
        Ok(coverage)
    }
}
