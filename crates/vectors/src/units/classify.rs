//! Classification: opacity and colour by table.

use super::contents::{colour, colours, words};
use crate::unit::Reader;
use crate::{Port, Sheet, Table, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder, word_formats};
use cube3_abc::golden::TableAddresses;
use cube3_abc::lanes::{ClassifyLanes, ShadedBlock};
use cube3_frame::{Classification, GradientRows};
use cube3_word::unit_full;

/// Classification.
pub struct ClassifySheet;

/// The fields of a line.
struct Line {
    sample: i32,
    magnitude: u32,
    class: u32,
    threshold: [u32; 2],
    row_shift: u32,
}

impl Line {
    fn new(inputs: &[i128]) -> Line {
        let mut fields = Reader::new(inputs);
        Line {
            sample: fields.signed(),
            magnitude: fields.word(),
            class: fields.word(),
            threshold: fields.words(),
            row_shift: fields.word(),
        }
    }
}

fn answer(visible: bool, opacity: u32, colour: [u32; 3]) -> Vec<i128> {
    let [red, green, blue] = colour.map(i128::from);
    vec![visible.into(), opacity.into(), red, green, blue]
}

impl Unit for ClassifySheet {
    fn sheet(&self) -> Sheet {
        Sheet {
            name: "classify",
            title: "Classification",
            purpose: "Opacity and colour of a sample: two tables over its leading bits. The opacity has a row for each step of the \
                      gradient's magnitude where there are several, and in perspective a table for each class of step lengths. A sample \
                      outside of the threshold is not visible: its opacity and colour are 0.",
            source: "Pfister et al. 1995, section 4; `cube3_abc::golden::classify_in`",
            parameters: &[
                "voxel_bits",
                "sample_fraction_bits",
                "gradient_bits",
                "kept_bits",
                "table_bits",
                "colour_bits",
                "opacity_bits",
                "rows",
                "classes",
            ],
            module: None,
            inputs: vec![
                Port::unsigned("sample", "S", "sample word").within("0", "M"),
                Port::unsigned("magnitude", "G + 1", "length of the gradient").within("0", "2^G"),
                Port::unsigned("length_class", "4", "class of the ray's step length").within("0", "CLASSES - 1"),
                Port::unsigned("threshold", "S", "lowest and highest sample that is visible").times("2"),
                Port::unsigned("row_shift", "5", "low bits of the magnitude that make no row").within("0", "30"),
            ],
            tables: vec![
                Table {
                    name: "opacity",
                    entries: "CLASSES * ROWS * 2^T",
                    bits: "O",
                    meaning: "opacity over class, row and index, the index in the low bits; unit words",
                },
                Table {
                    name: "colour",
                    entries: "2^T",
                    bits: "3 * C",
                    meaning: "red in the low bits, green, blue over the index; unit words",
                },
            ],
            wires: vec![
                Wire::new("visible", "lowest ≤ sample ≤ highest", "0", "1").made_by(WireKind::Cases),
                Wire::new("index", "sample / 2^(S − T), bits below dropped", "0", "M / 2^(S - T)"),
                Wire::new("shifted", "magnitude / 2^row_shift, bits below dropped", "0", "2^G"),
                Wire::new("row", "shifted, held in the table", "0", "ROWS - 1").made_by(WireKind::Held {
                    of: "shifted",
                    low: "0",
                    high: "ROWS - 1",
                }),
                Wire::new(
                    "entry",
                    "(class · ROWS + row) · 2^T + index",
                    "0",
                    "(CLASSES * ROWS - 1) * 2^T + M / 2^(S - T)",
                ),
            ],
            outputs: vec![
                Port::unsigned("visible", "1", "whether the sample is within the threshold"),
                Port::unsigned("opacity", "O", "unit word"),
                Port::unsigned("colour", "C", "red, green, blue, unit words").times("3"),
            ],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, tables: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let Line { sample, magnitude, class, threshold, row_shift } = Line::new(inputs);
        let addresses = TableAddresses {
            threshold,
            index_shift: format.words.sample_bits() - format.words.table_bits,
            rows: GradientRows { shift: row_shift, rows: format.rows },
            entries: 1 << format.words.table_bits,
        };
        match addresses.find(class, sample, magnitude, probe) {
            Some([opacity, index]) => {
                answer(true, tables[0][opacity] as u32, colour(tables[1][index], format.words.colour_bits))
            }
            None => answer(false, 0, [0; 3]),
        }
    }

    fn tables(&self, format: &UnitFormat) -> Tables {
        let entries = 1 << format.words.table_bits;
        let opacities = entries * (format.rows * format.classes) as usize;
        let full = unit_full(format.words.opacity_bits);
        vec![words(1, opacities, full.into()), colours(2, entries, format.words.colour_bits)]
    }

    /// One row and four, one class and two, on tables of at most 2^10 entries.
    fn formats(&self) -> Vec<UnitFormat> {
        let formats = word_formats().into_iter().enumerate();
        formats
            .map(|(i, mut format)| {
                format.words.table_bits = format.words.table_bits.min(10);
                let (rows, classes) = [(1, 1), (4, 2), (4, 1), (1, 2)][i % 4];
                UnitFormat { rows, classes, ..format }
            })
            .chain([UnitFormat::default()])
            .collect()
    }

    fn lanes(&self, format: &UnitFormat, tables: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let words = &format.words;
        let mut table = Classification {
            threshold: [0; 2],
            index_shift: words.sample_bits() - words.table_bits,
            opacity: tables[0].iter().map(|&entry| entry as u32).collect(),
            colour: tables[1].iter().map(|&entry| colour(entry, words.colour_bits)).collect(),
            gradient_rows: None,
        };
        let mut out = ShadedBlock::default();
        let mut answer = |line: &Vec<i128>| {
            let line = Line::new(line);
            table.threshold = line.threshold;
            table.gradient_rows =
                (format.rows > 1).then_some(GradientRows { shift: line.row_shift, rows: format.rows });
            let lanes = ClassifyLanes::new(&table);
            out.present[0] = 1;
            let first = |word| std::array::from_fn(|lane| if lane == 0 { word } else { 0 });
            out.samples[0] = line.sample;
            cube3_word::vectorised(|| {
                lanes.opacity(&first(line.magnitude), &first(line.class), &mut out);
                lanes.colour(&mut out);
            });
            let visible = out.present[0] != 0;
            // A sample that does not take part has no colour: the lanes clear it with the transparent ones, behind the light.
            self::answer(visible, out.opacity[0], [0, 1, 2].map(|i| if visible { out.colour[i][0] } else { 0 }))
        };
        Some(lines.iter().map(&mut answer).collect())
    }
}
