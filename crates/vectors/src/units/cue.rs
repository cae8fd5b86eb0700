//! Depth cueing.

use super::frame::{coloured, shaded};
use crate::unit::Reader;
use crate::{Port, Sheet, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder};
use cube3_abc::golden::cued_wires;
use cube3_frame::{FrameSetup, Linear, LinearFactor};

/// The depth cue.
pub struct CueSheet;

impl Unit for CueSheet {
    fn sheet(&self) -> Sheet {
        Sheet {
            name: "cue",
            title: "Depth cue",
            purpose: "A colour behind the depth cue's factor, 0 to 1 inclusive: it cannot overflow, and at a factor of 1 it is the colour, \
                      to the bit.",
            source: "`cube3_abc::golden::cued`",
            parameters: &["colour_bits", "nearest"],
            module: None,
            inputs: vec![
                Port::unsigned("colour", "C", "red, green, blue, unit words").times("3"),
                Port::unsigned("factor", "13", "a fraction of 12 bits").within("0", "2^12"),
            ],
            tables: Vec::new(),
            wires: vec![
                Wire::new("product", "colour · factor", "0", "(2^C - 1) * 2^12").times("3"),
                Wire::new("value", "product / 2^12, rounded", "0", "2^C - 1")
                    .times("3")
                    .made_by(WireKind::Rounded { of: "product", bits: "12" }),
            ],
            outputs: vec![Port::unsigned("value", "C", "red, green, blue, unit words").times("3")],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, _: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let mut fields = Reader::new(inputs);
        let colour = fields.words();
        cued_wires(colour, fields.word(), &format.words, probe).map(i128::from).to_vec()
    }

    fn lanes(&self, format: &UnitFormat, _: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let answer = |inputs: &Vec<i128>| {
            let mut fields = Reader::new(inputs);
            let colour = fields.words();
            let constant = i64::from(fields.word()) << (LinearFactor::FRACTION_BITS - LinearFactor::WORD_BITS);
            let factor = Linear { u: 0, v: 0, k: 0, constant };
            let cue = FrameSetup { depth_cue: Some(LinearFactor { factor }), ..coloured(colour, &format.words) };
            shaded(&cue).0.map(i128::from).to_vec()
        };
        Some(lines.iter().map(answer).collect())
    }
}
