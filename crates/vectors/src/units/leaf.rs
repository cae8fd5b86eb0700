//! A leaf of the cone.

use super::modes::MODE;
use crate::unit::Reader;
use crate::{Port, Sheet, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder};
use cube3_abc::golden::Shaded;
use cube3_abc::lanes::ShadedRow;
use cube3_cone::golden::leaf_wires;
use cube3_cone::lanes::{Accumulator, ConeLanes};
use cube3_frame::ConeRegisters;
use cube3_machine::ConeOrder;
use cube3_scene::Mode;

/// The wires of a product of unit words of `A` bits.
pub fn unit_mul_wires(part: &'static str, count: &'static str) -> [Wire; 3] {
    [
        Wire::new("product", "the product of the words", "0", "(2^A - 1) * (2^A - 1)"),
        Wire::new(
            "carried",
            "s + (s >> A), s = product + 2^(A−1) to nearest; product + (product >> A) + 1 truncated",
            "NEAREST * 2^(A - 1) + 1 - NEAREST",
            "(2^A - 1) * (2^A - 1) + NEAREST * 2^(A - 1) + ((2^A - 1) * (2^A - 1) + NEAREST * 2^(A - 1)) / 2^A + 1 - NEAREST",
        ),
        Wire::new("value", "product / (2^A − 1), rounded: carried >> A", "0", "2^A - 1")
            .made_by(WireKind::UnitProduct { of: "product", bits: "A" }),
    ]
    .map(|wire| wire.of(part).times(count))
}

/// The leaf.
pub struct LeafSheet;

/// The sample of a line and the registers of a cone of one leaf, whose weighted sum is the sum.
fn line(inputs: &[i128]) -> (Shaded, ConeRegisters) {
    let mut fields = Reader::new(inputs);
    let mode = Mode::ALL[fields.word() as usize];
    let opaque = fields.word();
    let (present, sample, opacity, colour) = (fields.flag(), fields.signed(), fields.word(), fields.words());
    let cone = ConeRegisters { mode, order: ConeOrder::Tree, leaves: 1, opaque, sum_weight: 1 << 32 };
    (Shaded { present, sample, opacity, colour }, cone)
}

/// The pixel of a row of one ray that has one sample.
fn pixel<T: Accumulator>(shaded: &Shaded, cone: ConeRegisters, format: &UnitFormat) -> [u32; 4] {
    let row = ShadedRow {
        present: vec![shaded.present.into()],
        opacity: vec![shaded.opacity],
        colour: shaded.colour.map(|word| vec![word]),
        span: (0, 1),
        ..ShadedRow::default()
    };
    let mut lanes = ConeLanes::<T>::new(cone, format.words);
    lanes.push(Some((0, &row, |_: usize| shaded.sample)));
    let mut pixel = [0; 4];
    lanes.finish(|_, rgba| pixel = rgba);
    pixel
}

impl Unit for LeafSheet {
    fn sheet(&self) -> Sheet {
        let mut wires = vec![
            Wire::new("resized", "opacity in A bits: repeated bits, or the leading ones", "0", "2^A - 1"),
            Wire::new("colour", "colour in A bits, likewise", "0", "2^A - 1").times("3"),
            Wire::new("opaque", "opacity ≥ the register `opaque`", "0", "1").made_by(WireKind::Cases),
            Wire::new("present", "in modes 1 and 2 opaque, else 1", "0", "1").made_by(WireKind::Cases),
        ];
        wires.extend(unit_mul_wires("weighted", "3"));
        Sheet {
            name: "leaf",
            title: "Leaf",
            purpose: "A shaded sample becomes a node: colour is weighted with opacity. In first-opaque and last-opaque a sample below the \
                      register `opaque` is nothing, and one above it is fully opaque. Nothing is all 0. Wires carry something only where the \
                      sample is present.",
            source: "`cube3_cone::golden::leaf`",
            parameters: &[
                "voxel_bits",
                "sample_fraction_bits",
                "colour_bits",
                "opacity_bits",
                "accumulator_bits",
                "nearest",
            ],
            module: None,
            inputs: vec![
                MODE,
                Port::unsigned("opaque", "O", "least opacity of an opaque sample").within("1", "2^O - 1"),
                Port::unsigned("present", "1", "whether the sample takes part"),
                Port::unsigned("sample", "S", "sample word").within("0", "M"),
                Port::unsigned("opacity", "O", "unit word"),
                Port::unsigned("colour", "C", "unit words: red, green, blue").times("3"),
            ],
            tables: Vec::new(),
            wires,
            outputs: vec![
                Port::unsigned("out_present", "1", "whether there is anything"),
                Port::unsigned("out_sample", "S", "sample word"),
                Port::unsigned("out_rgba", "A", "unit words: weighted red, green, blue; opacity").times("4"),
            ],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, _: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let (shaded, cone) = line(inputs);
        let node = leaf_wires(&shaded, &cone, &format.words, probe);
        let mut outputs = vec![node.present.into(), node.sample.into()];
        outputs.extend(node.rgba.map(i128::from));
        outputs
    }

    /// The rows of the cone hold colours and opacities; where nothing is they are 0, and whether there is anything is no word of theirs.
    fn lanes(&self, format: &UnitFormat, tables: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let answer = |inputs: &Vec<i128>| {
            let (shaded, cone) = line(inputs);
            let rgba = match format.words.accumulator_bits {
                ..=16 => pixel::<u32>(&shaded, cone, format),
                _ => pixel::<u64>(&shaded, cone, format),
            };
            let mut outputs = self.evaluate(format, tables, inputs, &mut WireRecorder::default());
            outputs.splice(2.., rgba.map(i128::from));
            outputs
        };
        Some(lines.iter().map(answer).collect())
    }

    /// A sample that is not present is all 0.
    fn legalise(&self, _: &UnitFormat, inputs: &mut [i128]) {
        if inputs[2] == 0 {
            inputs[3..].fill(0);
        }
    }
}
