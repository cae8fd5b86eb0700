//! The data sheet of a unit as data: ports, tables, and the arithmetic wire by wire with the range of each.
//!
//! Vectors, proofs of range, coverage, test benches and the pages of the book are all made from it.

use crate::UnitFormat;
use crate::expression::ExpressionError;

/// A port, or a row of ports of one name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Port {
    /// Name, of vectors' fields and of the RTL module's port.
    pub name: &'static str,
    /// How many, an expression.
    pub count: &'static str,
    /// Width of each in bits, an expression.
    pub bits: &'static str,
    /// Two's complement, or unsigned.
    pub signed: bool,
    /// Lowest and highest legal value, expressions; all that the width can hold for `None`.
    pub range: Option<[&'static str; 2]>,
    /// What it carries.
    pub meaning: &'static str,
}

impl Port {
    /// An unsigned port that may carry anything.
    pub const fn unsigned(name: &'static str, bits: &'static str, meaning: &'static str) -> Port {
        Port { name, count: "1", bits, signed: false, range: None, meaning }
    }

    /// A signed port that may carry anything.
    pub const fn signed(name: &'static str, bits: &'static str, meaning: &'static str) -> Port {
        Port { signed: true, ..Port::unsigned(name, bits, meaning) }
    }

    /// A row of so many.
    pub const fn times(self, count: &'static str) -> Port {
        Port { count, ..self }
    }

    /// With bounds closer than its width's.
    pub const fn within(self, low: &'static str, high: &'static str) -> Port {
        Port { range: Some([low, high]), ..self }
    }
}

/// What makes a wire's value, where coverage asks for each of its cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WireKind {
    /// Every bit of the result is there.
    Exact,
    /// A wire of the same part without its lowest bits (an expression), rounded.
    Rounded {
        /// The wire that is rounded.
        of: &'static str,
        /// How many bits are dropped.
        bits: &'static str,
    },
    /// A product of unit words of so many bits divided by the full word, rounded.
    UnitProduct {
        /// The product.
        of: &'static str,
        /// Bits of the words.
        bits: &'static str,
    },
    /// A wire of the same part held between two bounds.
    Held {
        /// The wire that is held.
        of: &'static str,
        /// Lower bound.
        low: &'static str,
        /// Upper bound.
        high: &'static str,
    },
    /// One of few values, each a case.
    Cases,
}

/// A wire inside of the unit, or a row of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wire {
    /// The part it belongs to, as the definition's probe names it; empty for the unit itself.
    pub part: &'static str,
    /// Name.
    pub name: &'static str,
    /// How many, an expression.
    pub count: &'static str,
    /// How its value is made.
    pub formula: &'static str,
    /// Lowest and highest value that it can take, expressions.
    pub range: [&'static str; 2],
    /// Whether both ends are reached in every format, as a search shows.
    pub tight: bool,
    /// What makes it.
    pub kind: WireKind,
}

impl Wire {
    /// A wire of the unit itself whose range is reached.
    pub const fn new(name: &'static str, formula: &'static str, low: &'static str, high: &'static str) -> Wire {
        Wire { part: "", name, count: "1", formula, range: [low, high], tight: true, kind: WireKind::Exact }
    }

    /// A wire of a part.
    pub const fn of(self, part: &'static str) -> Wire {
        Wire { part, ..self }
    }

    /// A row of so many.
    pub const fn times(self, count: &'static str) -> Wire {
        Wire { count, ..self }
    }

    /// Made by what coverage looks at.
    pub const fn made_by(self, kind: WireKind) -> Wire {
        Wire { kind, ..self }
    }

    /// With a range that is an upper bound, not reached in every format.
    pub const fn loose(self) -> Wire {
        Wire { tight: false, ..self }
    }

    /// Part and name.
    pub fn path(&self) -> String {
        if self.part.is_empty() { self.name.into() } else { format!("{}.{}", self.part, self.name) }
    }
}

/// A table inside of the unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Table {
    /// Name.
    pub name: &'static str,
    /// Entries, an expression.
    pub entries: &'static str,
    /// Bits of an entry, an expression.
    pub bits: &'static str,
    /// What it holds.
    pub meaning: &'static str,
}

/// The data sheet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sheet {
    /// Name, of the vectors and of the RTL module.
    pub name: &'static str,
    /// What it is.
    pub title: &'static str,
    /// What it does, in a paragraph or two.
    pub purpose: &'static str,
    /// Paper and section, and the definition in the code.
    pub source: &'static str,
    /// What the hardware is built for: names of [`UnitFormat::settings`].
    pub parameters: &'static [&'static str],
    /// RTL module, where it is not `cube3_` and the name, and parameters that it gets beside those.
    pub module: Option<(&'static str, &'static str)>,
    /// Fields that drive it.
    pub inputs: Vec<Port>,
    /// Tables inside.
    pub tables: Vec<Table>,
    /// The arithmetic, in order.
    pub wires: Vec<Wire>,
    /// Fields that it gives.
    pub outputs: Vec<Port>,
    /// Whether a line of its vectors is a cycle of a unit with a memory, not a transaction of its own.
    pub clocked: bool,
}

/// A field of a line: an element of a port in a format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineField {
    /// Name, with the element's number where the port has several.
    pub name: String,
    /// Index of the port.
    pub port: usize,
    /// Width.
    pub bits: u32,
    /// Two's complement.
    pub signed: bool,
    /// Lowest and highest legal value.
    pub range: [i128; 2],
}

impl LineField {
    /// Hexadecimal digits.
    pub fn digits(&self) -> usize {
        self.bits.div_ceil(4) as usize
    }

    /// The field's text.
    pub fn text(&self, value: i128) -> String {
        let mut text = String::new();
        self.write(value, &mut text);
        text
    }

    /// Adds the field's text to another.
    pub fn write(&self, value: i128, text: &mut String) {
        let bits = self.bits_of(value);
        for digit in (0..self.digits()).rev() {
            text.extend(char::from_digit((bits >> (4 * digit) & 0xf) as u32, 16));
        }
    }

    /// A value's bits.
    pub fn bits_of(&self, value: i128) -> u128 {
        value as u128 & (u128::MAX >> (128 - self.bits))
    }

    /// The value of a field's bits.
    pub fn value(&self, bits: u128) -> i128 {
        let value = bits as i128;
        if self.signed && bits >> (self.bits - 1) & 1 == 1 { value - (1 << self.bits) } else { value }
    }
}

impl Sheet {
    /// The fields of ports in a format.
    ///
    /// # Errors
    /// An expression of the sheet without a value.
    pub fn fields(ports: &[Port], format: &UnitFormat) -> Result<Vec<LineField>, ExpressionError> {
        let mut fields = Vec::new();
        for (index, port) in ports.iter().enumerate() {
            let count = format.evaluate(port.count)?;
            let bits = format.evaluate(port.bits)? as u32;
            let width = if port.signed { [-(1 << (bits - 1)), (1 << (bits - 1)) - 1] } else { [0, (1 << bits) - 1] };
            let range = match port.range {
                None => width,
                Some([low, high]) => [format.evaluate(low)?, format.evaluate(high)?],
            };
            for i in 0..count {
                let name = if count == 1 { port.name.to_owned() } else { format!("{}[{i}]", port.name) };
                fields.push(LineField { name, port: index, bits, signed: port.signed, range });
            }
        }
        Ok(fields)
    }

    /// The index of a wire of a part.
    pub fn wire(&self, part: &str, name: &str) -> Option<usize> {
        self.wires.iter().position(|wire| wire.part == part && wire.name == name)
    }

    /// The module of the RTL, and the parameters that it gets beside the format's.
    pub fn rtl(&self) -> (String, &'static str) {
        match self.module {
            Some((module, parameters)) => (module.into(), parameters),
            None => (format!("cube3_{}", self.name.replace('-', "_")), ""),
        }
    }
}

/// Bits that hold every value of a range: unsigned where it has no negative one, else two's complement.
pub fn bits_of([low, high]: [i128; 2]) -> u32 {
    if low < 0 {
        let size = (-(low + 1)).max(high);
        129 - size.leading_zeros()
    } else {
        (128 - high.leading_zeros()).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_needs_so_many_bits() {
        let expected = [([0, 0], 1), ([0, 1], 1), ([0, 255], 8), ([0, 256], 9), ([-1, 0], 1), ([-128, 127], 8)];
        for (range, bits) in expected {
            assert_eq!(bits_of(range), bits, "{range:?}");
        }
        assert_eq!((bits_of([-128, 128]), bits_of([-129, 0]), bits_of([-1, 1])), (9, 9, 2));
    }

    #[test]
    fn a_signed_field_is_twos_complement_in_its_width() {
        let field = LineField { name: "g".into(), port: 0, bits: 17, signed: true, range: [-65536, 65535] };
        for (value, text) in [(0, "00000"), (-1, "1ffff"), (65535, "0ffff"), (-65536, "10000")] {
            assert_eq!(field.text(value), text);
            assert_eq!(field.value(u128::from_str_radix(text, 16).unwrap()), value);
        }
    }
}
