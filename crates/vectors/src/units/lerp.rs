//! The multiplier of TRILIN.

use crate::unit::Reader;
use crate::{Port, Sheet, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder};
use cube3_word::{LerpLanes, lerp_wires as golden};

/// The wires of a lerp of unsigned words of `S` bits, of a part that is there `count` times.
pub fn lerp_wires(part: &'static str, count: &'static str) -> [Wire; 4] {
    [
        Wire::new("difference", "far − near", "-M", "M"),
        Wire::new("product", "difference · weight", "-M * 2^W", "(M) * 2^W"),
        Wire::new("step", "product / 2^W, rounded", "-M", "M").made_by(WireKind::Rounded { of: "product", bits: "W" }),
        Wire::new("value", "near + step", "0", "M"),
    ]
    .map(|wire| wire.of(part).times(count))
}

/// The lerp.
pub struct LerpSheet;

impl Unit for LerpSheet {
    fn sheet(&self) -> Sheet {
        Sheet {
            name: "lerp",
            title: "Linear interpolation",
            purpose: "One multiplier of TRILIN: between two sample words by a weight of 0 to 1 inclusive. At weight 0 the result is \
                      `near` and at weight 1 `far`, to the bit, and it lies between the two at every other: it cannot overflow.",
            source: "Pfister et al. 1995, section 3; `cube3_word::lerp`",
            parameters: &["voxel_bits", "sample_fraction_bits", "weight_bits", "nearest"],
            module: None,
            inputs: vec![
                Port::unsigned("near", "S", "sample word at weight 0").within("0", "M"),
                Port::unsigned("far", "S", "sample word at weight 1").within("0", "M"),
                Port::unsigned("weight", "W + 1", "a fraction of W bits").within("0", "2^W"),
            ],
            tables: Vec::new(),
            wires: lerp_wires("", "1").to_vec(),
            outputs: vec![Port::unsigned("value", "S", "sample word")],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, _: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let mut fields = Reader::new(inputs);
        let [near, far] = fields.signed_words();
        let words = &format.words;
        vec![golden(near, far, fields.word(), words.weight_bits, words.rounding, probe).into()]
    }

    fn lanes(&self, format: &UnitFormat, _: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let words = &format.words;
        let lanes = LerpLanes::new(words.sample_bits(), words.weight_bits, words.rounding);
        let column = |i: usize| lines.iter().map(|line| line[i] as i32).collect::<Vec<i32>>();
        let weights: Vec<u32> = lines.iter().map(|line| line[2] as u32).collect();
        let mut out = vec![0; lines.len()];
        cube3_word::vectorised(|| lanes.varying(&column(0), &column(1), &weights, &mut out));
        Some(out.into_iter().map(|value| vec![value.into()]).collect())
    }
}
