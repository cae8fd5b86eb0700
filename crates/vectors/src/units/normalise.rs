//! The normaliser: direction and length of a gradient.

use super::contents::Noise;
use crate::unit::Reader;
use crate::{Port, Sheet, Table, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder, word_formats};
use cube3_abc::golden::{normalise, normalise_wires};
use cube3_abc::lanes::normalise_rows;
use cube3_frame::{GradientScale, Normaliser};
use cube3_machine::GradientMethod;
use cube3_word::Rounding;

/// The normaliser.
pub struct NormaliseSheet;

/// The table as the unit crates hold it.
fn table(format: &UnitFormat, tables: &Tables) -> Normaliser {
    Normaliser { root: tables[0].iter().map(|&entry| entry as u32).collect(), root_bits: format.root_bits }
}

/// Gradients of which a block holds all, so that their length is rounded; the last, whose length, the product with its direction,
/// lies halfway between two words.
fn small(format: &UnitFormat, table: &Normaliser) -> Vec<Vec<i128>> {
    let one_bits = format.words.normal_bits - 1;
    let mut noise = Noise::new(5);
    let top = (1 << one_bits.min(format.words.gradient_bits + format.kept_bits - 1)) - 1;
    let mut gradient = || [0; 3].map(|_: i32| noise.up_to(2 * top) as i32 - top as i32);
    let tied = |gradient: &[i32; 3]| {
        let direction = normalise(*gradient, table, &format.words).direction;
        let length: i64 = gradient.iter().zip(direction).map(|(g, d)| i64::from(*g) * i64::from(d)).sum();
        length & ((1 << one_bits) - 1) == 1 << (one_bits - 1)
    };
    let mut lines: Vec<[i32; 3]> = (0..32).map(|_| gradient()).collect();
    lines.extend((0..1 << 20).map(|_| gradient()).find(tied));
    lines.into_iter().map(|gradient| gradient.map(i128::from).to_vec()).collect()
}

impl Unit for NormaliseSheet {
    fn sheet(&self) -> Sheet {
        Sheet {
            name: "normalise",
            title: "Normaliser",
            purpose: "Direction and length of a gradient. All three components are shifted alike until the largest has its highest one at \
                      the top of B bits; a table of reciprocal roots over the squared length of that block makes its components those of \
                      a unit vector, fractions of B − 1 bits; block times direction, shifted back, is the length. The direction is odd in \
                      every component. Direction and length of a gradient that is 0 are 0, and the other wires then carry nothing. It \
                      rounds to nearest in every format.",
            source: "Pfister et al. 1995, section 4; `cube3_abc::golden::normalise`",
            parameters: &["gradient_bits", "kept_bits", "normal_bits", "root_bits"],
            module: None,
            inputs: vec![Port::signed("g", "G", "gradient along u, v, w").times("3")],
            tables: vec![Table {
                name: "root",
                entries: "11 * 2^R",
                bits: "B + 1",
                meaning: "2^(2B−1) / √m² in the middle of bin i of m², bins of 2^(2B−2−R) from 2^(2B−2) on",
            }],
            wires: vec![
                Wire::new("size", "magnitude of a component", "0", "2^(G - 1)").times("3"),
                Wire::new("highest", "place of the highest one in any of the sizes", "0", "G - 1"),
                Wire::new("block", "size · 2^(B − 1 − highest), bits below dropped", "0", "2^B - 2^max(B - G + 1, 0)")
                    .times("3"),
                Wire::new("square", "sum of the blocks' squares", "2^(2 * B - 2)", "3 * (2^B - 2^max(B - G + 1, 0))^2"),
                Wire::new(
                    "index",
                    "square / 2^(2B − 2 − R), bits below dropped, − 2^R",
                    "0",
                    "3 * (2^B - 2^max(B - G + 1, 0))^2 / 2^(2 * B - 2 - R) - 2^R",
                ),
                Wire::new("reciprocal", "the table at index", "0", "2^B").loose(),
                Wire::new("product", "block · reciprocal", "0", "LONGEST").times("3"),
                Wire::new("rounded", "product / 2^B, rounded to nearest", "0", "(LONGEST + 2^(B - 1)) / 2^B")
                    .times("3")
                    .made_by(WireKind::Rounded { of: "product", bits: "B" }),
                Wire::new("unit", "rounded, held at 1", "0", "min((LONGEST + 2^(B - 1)) / 2^B, 2^(B - 1))")
                    .times("3")
                    .made_by(WireKind::Held { of: "rounded", low: "0", high: "2^(B - 1)" }),
                Wire::new(
                    "direction",
                    "unit with the component's sign",
                    "-min((LONGEST + 2^(B - 1)) / 2^B, 2^(B - 1))",
                    "min((LONGEST + 2^(B - 1)) / 2^B, 2^(B - 1))",
                )
                .times("3"),
                Wire::new("length", "sum of block · unit", "0", "2^(2 * B)").loose(),
                Wire::new("aligned", "length · 2^highest", "0", "2^(2 * B + G - 1)").loose(),
                Wire::new("magnitude", "aligned / 2^(2B − 2), rounded to nearest", "0", "2^G")
                    .loose()
                    .made_by(WireKind::Rounded { of: "aligned", bits: "2 * B - 2" }),
            ],
            outputs: vec![
                Port::signed("direction", "B + 1", "components of the direction, fractions of B − 1 bits")
                    .times("3")
                    .within("-2^(B - 1)", "2^(B - 1)"),
                Port::unsigned("magnitude", "G + 1", "length, in the gradient's words").within("0", "2^G"),
            ],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, tables: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let gradient = Reader::new(inputs).signed_words();
        let normal = normalise_wires(gradient, &table(format, tables), &format.words, probe);
        let [u, v, w] = normal.direction.map(i128::from);
        vec![u, v, w, normal.magnitude.into()]
    }

    fn tables(&self, format: &UnitFormat) -> Tables {
        let table = Normaliser::new(format.words.normal_bits, format.root_bits);
        vec![table.root.into_iter().map(i128::from).collect()]
    }

    /// Gradients along an axis: of every highest bit, and those whose component is the longest; and one for each part of a product
    /// that rounding drops.
    fn corners(&self, format: &UnitFormat) -> Vec<Vec<i128>> {
        let bits = format.words.normal_bits;
        let gradient_bits = format.words.gradient_bits + format.kept_bits;
        let mut lines: Vec<Vec<i128>> = Vec::new();
        for bit in 0..gradient_bits {
            for axis in 0..3 {
                let along = |size: i128| (0..3).map(|i| if i == axis { size } else { 0 }).collect();
                lines.push(along(-(1 << bit)));
                lines.push(along((1 << bit) - 1));
            }
        }
        // A gradient of G − 1 bits beside its sign holds so much of a block.
        let blocks: Vec<u32> = format.blocks().collect();
        let word = |block: u32| (i128::from(block) << gradient_bits) >> (bits + 1);
        if let Some(block) = format.longest_block() {
            for sign in [-1, 1] {
                lines.extend(
                    (0..3).map(|axis| (0..3).map(|i| if i == axis { sign * word(block) } else { 0 }).collect()),
                );
            }
        }
        let table = Normaliser::new(bits, format.root_bits);
        let tie = blocks.iter().flat_map(|&a| blocks.iter().map(move |&c| [a, c])).find(|&[a, c]| {
            let index = ((a * a + c * c) >> (2 * bits - 2 - format.root_bits)) as usize - (1 << format.root_bits);
            (a * table.root[index]) & ((1 << bits) - 1) == 1 << (bits - 1)
        });
        lines.extend(tie.map(|[a, c]| vec![word(a), -word(c), 0]));
        lines.extend(small(format, &table));
        lines
    }

    /// Gradients as wide as differences, and with what a scale keeps below them: the narrowest alone hold too little for products of
    /// every kind.
    fn formats(&self) -> Vec<UnitFormat> {
        let kept = |format: UnitFormat| UnitFormat {
            kept_bits: GradientScale::FACTOR_BITS.min(GradientScale::room(GradientMethod::Six, &format.words)),
            ..format
        };
        let nearest = word_formats().into_iter().filter(|format| format.words.rounding == Rounding::Nearest);
        let formats: Vec<UnitFormat> = nearest.collect();
        let default = formats[0];
        [default]
            .into_iter()
            .chain(formats.into_iter().map(kept))
            .chain([UnitFormat { root_bits: 10, ..default }])
            .collect()
    }

    fn lanes(&self, format: &UnitFormat, tables: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let gradient = [0, 1, 2].map(|i| lines.iter().map(|line| line[i] as i32).collect());
        let (direction, magnitude) = normalise_rows(gradient, &table(format, tables), &format.words);
        let answer = |lane: usize| {
            let [u, v, w] = [0, 1, 2].map(|i| direction[i][lane].into());
            vec![u, v, w, magnitude[lane].into()]
        };
        Some((0..lines.len()).map(answer).collect())
    }
}
