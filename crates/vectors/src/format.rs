//! The formats of a unit: word lengths and what else its hardware is built for.

use crate::expression::{ExpressionError, evaluate};
use cube3_frame::Normaliser;
use cube3_machine::{Layout, MachineSpec};
use cube3_word::{Rounding, WordError, Words};

/// Word lengths, and the sizes that a unit is built for. A name in an expression of a data sheet is one of these.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitFormat {
    /// Word lengths and rounding.
    pub words: Words,
    /// Bits that the gradient keeps below its word, where its components are scaled.
    pub kept_bits: u32,
    /// Index bits of the table of reciprocal roots.
    pub root_bits: u32,
    /// Index bits of the table of powers.
    pub power_bits: u32,
    /// Bits of each coordinate on a face of the reflectance table.
    pub reflectance_bits: u32,
    /// Lights of a shading unit.
    pub lights: u32,
    /// Rows of the opacity table, over the gradient's magnitude.
    pub rows: u32,
    /// Classes of step lengths of the opacity table.
    pub classes: u32,
    /// Modules, lanes and leaves.
    pub lanes: u32,
    /// Voxels along x, y, z of the volume that the frame buffer addresses.
    pub dims: [u32; 3],
    /// Coefficients a, b, c of the skew.
    pub skew: [i64; 3],
    /// Where a voxel lies in its module.
    pub layout: Layout,
    /// Tokens that a channel holds.
    pub capacity: u32,
    /// Cycles from push to pop of a channel.
    pub latency: u32,
}

impl Default for UnitFormat {
    /// The default machine's words, with eight lanes so that vectors of whole beams stay short.
    fn default() -> UnitFormat {
        UnitFormat::of(&MachineSpec::default())
    }
}

/// Why a format cannot be had.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnitFormatError {
    /// Not two numbers.
    #[error("the format \"{0}\" is not of the form 16.8: bits of a voxel, a point, bits of a weight")]
    Form(String),
    /// A word.
    #[error(transparent)]
    Word(#[from] WordError),
    /// A size.
    #[error("{name} = {value} is outside {low} to {high}")]
    Size {
        /// Its name.
        name: &'static str,
        /// The value.
        value: u32,
        /// The smallest.
        low: u32,
        /// The largest.
        high: u32,
    },
}

impl UnitFormat {
    /// The formats of a machine; of its lanes, eight.
    pub fn of(machine: &MachineSpec) -> UnitFormat {
        UnitFormat {
            words: machine.words,
            kept_bits: 0,
            root_bits: machine.abc.root_bits,
            power_bits: machine.abc.power_bits,
            reflectance_bits: machine.abc.reflectance_bits,
            lights: 1,
            rows: 1,
            classes: 1,
            lanes: 8,
            dims: [16, 16, 16],
            skew: machine.cfb.skew,
            layout: machine.cfb.layout,
            capacity: 4,
            latency: 2,
        }
    }

    /// The default words with small tables: for sets of vectors that are kept.
    pub fn reference() -> UnitFormat {
        let words = Words { table_bits: 6, ..Words::default() };
        UnitFormat { words, root_bits: 4, power_bits: 5, reflectance_bits: 2, ..UnitFormat::default() }
    }

    /// With voxels and weights of other lengths, from a text like `16.8`. Words that are bound to the voxel's follow it: a gradient
    /// holds a whole difference, a table's index no more than a sample.
    ///
    /// # Errors
    /// A text of another form, a length that no unit has.
    pub fn with_lengths(mut self, text: &str) -> Result<UnitFormat, UnitFormatError> {
        let form = || UnitFormatError::Form(text.to_owned());
        let (voxel, weight) = text.split_once('.').ok_or_else(form)?;
        self.words.voxel_bits = voxel.parse().map_err(|_| form())?;
        self.words.weight_bits = weight.parse().map_err(|_| form())?;
        self.words.gradient_bits =
            self.words.voxel_bits.saturating_add(self.words.sample_fraction_bits).saturating_add(1);
        self.fit(&[]);
        self.words.check()?;
        Ok(self)
    }

    /// Shortens words that others bind and that were not set by name: a gradient holds a whole difference at most, tables have no more
    /// index bits than what they are indexed with.
    pub fn fit(&mut self, set: &[&str]) {
        let UnitFormat { words, root_bits, power_bits, .. } = self;
        let sample = words.voxel_bits.saturating_add(words.sample_fraction_bits);
        let normal = words.normal_bits;
        for (name, bits, most) in [
            ("gradient_bits", &mut words.gradient_bits, sample.saturating_add(1).min(24)),
            ("table_bits", &mut words.table_bits, sample.min(16)),
            ("root_bits", root_bits, normal.saturating_mul(2).saturating_sub(3)),
            ("power_bits", power_bits, normal.saturating_sub(1)),
        ] {
            if !set.contains(&name) {
                *bits = (*bits).min(most);
            }
        }
    }

    /// Whether hardware can be built for the format.
    ///
    /// # Errors
    /// The first length or size that no unit has.
    pub fn check(&self) -> Result<(), UnitFormatError> {
        self.words.check()?;
        let index = self.words.normal_bits;
        let sizes = [
            ("kept_bits", self.kept_bits, 0, 31 - self.words.gradient_bits.min(31)),
            ("root_bits", self.root_bits, 1, 2 * index - 3),
            ("power_bits", self.power_bits, 1, index - 1),
            ("reflectance_bits", self.reflectance_bits, 1, 8),
            ("lights", self.lights, 1, 8),
            ("rows", self.rows, 1, 256),
            ("classes", self.classes, 1, 16),
            ("lanes", self.lanes, 1, 4096),
            ("nx", self.dims[0], 1, 4096),
            ("ny", self.dims[1], 1, 4096),
            ("nz", self.dims[2], 1, 4096),
            ("capacity", self.capacity, 1, 255),
            ("latency", self.latency, 1, 255),
        ];
        let size = |&(name, value, low, high): &(&'static str, u32, u32, u32)| {
            if (low..=high).contains(&value) { Ok(()) } else { Err(UnitFormatError::Size { name, value, low, high }) }
        };
        sizes.iter().try_for_each(size)
    }

    /// The value of a name in expressions.
    pub fn value_of(&self, name: &str) -> Option<i128> {
        let words = &self.words;
        let value: i64 = match name {
            "V" => words.voxel_bits.into(),
            "F" => words.sample_fraction_bits.into(),
            "M" => i64::from(cube3_word::unit_full(words.voxel_bits)) << words.sample_fraction_bits,
            "S" => words.sample_bits().into(),
            "W" => words.weight_bits.into(),
            "K" => self.kept_bits.into(),
            "G" => (words.gradient_bits + self.kept_bits).into(),
            "D" => words.gradient_drop().into(),
            "B" => words.normal_bits.into(),
            "T" => words.table_bits.into(),
            "R" => self.root_bits.into(),
            "P" => self.power_bits.into(),
            "Q" => self.reflectance_bits.into(),
            "C" => words.colour_bits.into(),
            "O" => words.opacity_bits.into(),
            "A" => words.accumulator_bits.into(),
            "N" => (words.accumulator_bits + 12).into(),
            // The largest product of the normaliser.
            "LONGEST" => self.products().map(|(_, product)| i64::from(product)).max()?,
            "LIGHTS" => self.lights.into(),
            "ROWS" => self.rows.into(),
            "CLASSES" => self.classes.into(),
            "LANES" => self.lanes.into(),
            "NX" => self.dims[0].into(),
            "NY" => self.dims[1].into(),
            "NZ" => self.dims[2].into(),
            "SKEW_LOW" => self.skew_sum(i64::min),
            "SKEW_HIGH" => self.skew_sum(i64::max),
            "TERM" if self.layout == Layout::MiniBlocks => {
                let sides = [2 * self.lanes, 8, 8];
                128 * sides.iter().zip(self.dims).map(|(&side, n)| i64::from(n.div_ceil(side))).product::<i64>()
            }
            "TERM" => self.dims.iter().map(|&n| i64::from(n)).product::<i64>() * i64::from(self.lanes).pow(3),
            "CAPACITY" => self.capacity.into(),
            "LATENCY" => self.latency.into(),
            "NEAREST" => i64::from(words.rounding == Rounding::Nearest),
            _ => return None,
        };
        Some(value.into())
    }

    /// Lowest or highest sum of the skew over the volume.
    fn skew_sum(&self, end: fn(i64, i64) -> i64) -> i64 {
        let side = if self.layout == Layout::MiniBlocks { 2 } else { 1 };
        self.skew.iter().zip(self.dims).map(|(&c, n)| end(0, c * ((i64::from(n) - 1) / side))).sum()
    }

    /// The blocks that the normaliser makes of gradients along an axis: `normal_bits` with the highest one, of which a gradient holds
    /// one less than its own, beside the sign.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = u32> + use<> {
        let (bits, gradient_bits) = (self.words.normal_bits, self.words.gradient_bits + self.kept_bits);
        (1 << (bits - 1)..1 << bits).step_by(1 << (bits + 1).saturating_sub(gradient_bits))
    }

    /// Those blocks and their products with the table of reciprocal roots. Other components only make the square larger and its root
    /// smaller: no product is above the largest of these.
    fn products(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (bits, root_bits) = (self.words.normal_bits, self.root_bits);
        let table = Normaliser::new(bits, root_bits);
        self.blocks().map(move |block| {
            let index = ((block * block) >> (2 * bits - 2 - root_bits)) as usize - (1 << root_bits);
            (block, block * table.root[index])
        })
    }

    /// The block of the largest product.
    pub(crate) fn longest_block(&self) -> Option<u32> {
        self.products().max_by_key(|(_, product)| *product).map(|(block, _)| block)
    }

    /// The value of an expression of a data sheet.
    ///
    /// # Errors
    /// What is no expression, or has no value in this format.
    pub fn evaluate(&self, expression: &str) -> Result<i128, ExpressionError> {
        evaluate(expression, &|name| self.value_of(name))
    }

    /// Sets what [`UnitFormat::settings`] names; whether there is such a name and the value fits it.
    pub fn set(&mut self, name: &str, value: i64) -> bool {
        let UnitFormat { words, .. } = self;
        if let "skew_a" | "skew_b" | "skew_c" = name {
            self.skew[usize::from(name.as_bytes()[5] - b'a')] = value;
            return true;
        }
        let Ok(value) = u32::try_from(value) else {
            return false;
        };
        let place = match name {
            "voxel_bits" => &mut words.voxel_bits,
            "weight_bits" => &mut words.weight_bits,
            "sample_fraction_bits" => &mut words.sample_fraction_bits,
            "gradient_bits" => &mut words.gradient_bits,
            "kept_bits" => &mut self.kept_bits,
            "normal_bits" => &mut words.normal_bits,
            "table_bits" => &mut words.table_bits,
            "colour_bits" => &mut words.colour_bits,
            "opacity_bits" => &mut words.opacity_bits,
            "accumulator_bits" => &mut words.accumulator_bits,
            "root_bits" => &mut self.root_bits,
            "power_bits" => &mut self.power_bits,
            "reflectance_bits" => &mut self.reflectance_bits,
            "lights" => &mut self.lights,
            "rows" => &mut self.rows,
            "classes" => &mut self.classes,
            "lanes" | "leaves" => &mut self.lanes,
            "nx" => &mut self.dims[0],
            "ny" => &mut self.dims[1],
            "nz" => &mut self.dims[2],
            "capacity" => &mut self.capacity,
            "latency" => &mut self.latency,
            "nearest" => {
                words.rounding = if value == 0 { Rounding::Truncate } else { Rounding::Nearest };
                return value <= 1;
            }
            "blocks" => {
                let Some(&layout) = Layout::ALL.get(value as usize) else { return false };
                self.layout = layout;
                return true;
            }
            _ => return false,
        };
        *place = value;
        true
    }

    /// Everything that a format sets, by the names of RTL parameters in lower case.
    pub fn settings(&self) -> Vec<(&'static str, i64)> {
        let words = &self.words;
        vec![
            ("voxel_bits", words.voxel_bits.into()),
            ("weight_bits", words.weight_bits.into()),
            ("sample_fraction_bits", words.sample_fraction_bits.into()),
            ("gradient_bits", words.gradient_bits.into()),
            ("kept_bits", self.kept_bits.into()),
            ("normal_bits", words.normal_bits.into()),
            ("table_bits", words.table_bits.into()),
            ("colour_bits", words.colour_bits.into()),
            ("opacity_bits", words.opacity_bits.into()),
            ("accumulator_bits", words.accumulator_bits.into()),
            ("nearest", i64::from(words.rounding == Rounding::Nearest)),
            ("root_bits", self.root_bits.into()),
            ("power_bits", self.power_bits.into()),
            ("reflectance_bits", self.reflectance_bits.into()),
            ("lights", self.lights.into()),
            ("rows", self.rows.into()),
            ("classes", self.classes.into()),
            ("lanes", self.lanes.into()),
            ("leaves", self.lanes.into()),
            ("nx", self.dims[0].into()),
            ("ny", self.dims[1].into()),
            ("nz", self.dims[2].into()),
            ("skew_a", self.skew[0]),
            ("skew_b", self.skew[1]),
            ("skew_c", self.skew[2]),
            ("blocks", self.layout as i64),
            ("capacity", self.capacity.into()),
            ("latency", self.latency.into()),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_setting_can_be_set() {
        let mut format = UnitFormat::default();
        for (i, (name, _)) in UnitFormat::default().settings().into_iter().enumerate() {
            let value = if matches!(name, "nearest" | "blocks") { 0 } else { i as i64 + 3 };
            assert!(format.set(name, value), "{name}");
            assert!(format.settings().contains(&(name, value)), "{name}");
        }
        assert!(!format.set("no_such", 1) && !format.set("lanes", -1) && !format.set("nearest", 2));
        assert!(Layout::ALL.iter().enumerate().all(|(i, &layout)| layout as usize == i));
        assert!(format.set("blocks", 2) && format.layout == Layout::MiniBlocks && !format.set("blocks", 3));
        assert!(format.set("skew_b", -4) && format.skew[1] == -4);
    }

    #[test]
    fn a_format_of_two_lengths_sets_what_hangs_on_them() {
        let format = UnitFormat::default().with_lengths("8.4").unwrap();
        assert_eq!((format.words.voxel_bits, format.words.weight_bits), (8, 4));
        assert_eq!((format.words.gradient_bits, format.words.table_bits), (9, 8));
        assert!(matches!(UnitFormat::default().with_lengths("16"), Err(UnitFormatError::Form(_))));
        assert!(matches!(UnitFormat::default().with_lengths("17.8"), Err(UnitFormatError::Word(_))));
        assert!(UnitFormat::default().with_lengths("4294967295.8").is_err());
    }
}
