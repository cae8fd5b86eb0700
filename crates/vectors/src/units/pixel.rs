//! The pixel of a ray's last node.

use super::modes::{MODE, legal};
use crate::unit::Reader;
use crate::{Port, Sheet, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder};
use cube3_cone::golden::{Node, pixel_wires};
use cube3_frame::ConeRegisters;
use cube3_machine::ConeOrder;
use cube3_scene::Mode;

/// The pixel.
pub struct PixelSheet;

impl Unit for PixelSheet {
    fn sheet(&self) -> Sheet {
        Sheet {
            name: "pixel",
            title: "Pixel",
            purpose: "A weighted sum is multiplied with the frame's weight, rounded and held at full; every other mode passes. Wires carry \
                      something in weighted sums only.",
            source: "`cube3_cone::golden::pixel`",
            parameters: &["accumulator_bits", "nearest"],
            module: None,
            inputs: vec![
                MODE,
                Port::unsigned("present", "1", "whether the ray has anything"),
                Port::unsigned("rgba", "N", "red, green, blue (weighted), opacity")
                    .times("4")
                    .within("0", "4096 * (2^A - 1)"),
                Port::unsigned("sum_weight", "33", "a fraction of 32 bits").within("0", "2^32"),
            ],
            tables: Vec::new(),
            wires: vec![
                Wire::new("product", "sum · weight", "0", "4096 * (2^A - 1) * 2^32").times("4"),
                Wire::new("mean", "product / 2^32, rounded", "0", "4096 * (2^A - 1)")
                    .times("4")
                    .made_by(WireKind::Rounded { of: "product", bits: "32" }),
                Wire::new("held", "mean, at most full", "0", "2^A - 1").times("4").made_by(WireKind::Held {
                    of: "mean",
                    low: "0",
                    high: "2^A - 1",
                }),
                Wire::new("overflow", "mean > full", "0", "1").times("4").made_by(WireKind::Cases),
            ],
            outputs: vec![
                Port::unsigned("pixel", "A", "unit words: red, green, blue (weighted), opacity").times("4"),
                Port::unsigned("overflow", "1", "which were held").times("4"),
            ],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, _: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let mut fields = Reader::new(inputs);
        let mode = Mode::ALL[fields.word() as usize];
        let present = fields.flag();
        let rgba = std::array::from_fn(|_| fields.field() as u64);
        let sum_weight = fields.field() as u64;
        let cone = ConeRegisters { mode, order: ConeOrder::Tree, leaves: 1, opaque: 1, sum_weight };
        let before = probe.seen().len();
        let pixel = pixel_wires(Node { present, sample: 0, rgba }, &cone, &format.words, probe);
        let mut outputs: Vec<i128> = pixel.value.map(i128::from).to_vec();
        let held = probe.seen()[before..].iter().filter(|seen| seen.name == "overflow").map(|seen| seen.value);
        outputs.extend(held);
        outputs.resize(8, 0);
        outputs
    }

    fn legalise(&self, format: &UnitFormat, inputs: &mut [i128]) {
        let (mode, present) = (inputs[0], inputs[1]);
        legal(format, mode, present, &mut 0, &mut inputs[2..6]);
    }

    /// Ties of the mean, which a random weight does not meet, and sums beyond full.
    fn corners(&self, format: &UnitFormat) -> Vec<Vec<i128>> {
        let full = i128::from(cube3_word::unit_full(format.words.accumulator_bits));
        let half = 1_i128 << 31;
        [(1, half), (3, half), (full, half), (full, 1 << 32), (4096 * full, 1 << 20), (4096 * full, 1 << 32), (1, 1)]
            .map(|(sum, weight)| vec![5, 1, sum, sum, sum, sum, weight])
            .to_vec()
    }
}
