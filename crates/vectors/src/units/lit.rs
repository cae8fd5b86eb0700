//! The colour of a lit sample.

use super::frame::{coloured, shaded};
use crate::unit::Reader;
use crate::{Port, Sheet, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder};
use cube3_abc::golden::{ReflectedLight, lit_wires};
use cube3_frame::{FrameSetup, GradientRegisters, ReflectanceTable, Shading};
use cube3_machine::GradientMethod;
use cube3_word::Words;

/// The lit colour.
pub struct LitSheet;

/// The fields of a line.
fn line(inputs: &[i128]) -> ([u32; 3], ReflectedLight) {
    let mut fields = Reader::new(inputs);
    (fields.words(), ReflectedLight { diffuse: fields.words(), specular: fields.words() })
}

/// A frame with this light from every direction.
fn frame(colour: [u32; 3], light: ReflectedLight, words: &Words) -> FrameSetup {
    let entries = |of: [u32; 3]| vec![of; 24];
    let (diffuse, specular) = (entries(light.diffuse), entries(light.specular));
    FrameSetup {
        gradient: Some(GradientRegisters { method: GradientMethod::Six, weights: [0; 2], scale: None, border: 0 }),
        shading: Some(Shading::Table(ReflectanceTable { bits: 1, diffuse, specular, flat: 0 })),
        ..coloured(colour, words)
    }
}

impl Unit for LitSheet {
    fn sheet(&self) -> Sheet {
        Sheet {
            name: "lit",
            title: "Lit colour",
            purpose: "The colour that the table gives, multiplied with the diffuse light, and the specular light added; held at the full \
                      word.",
            source: "Pfister et al. 1995, section 4; `cube3_abc::golden::lit`",
            parameters: &["colour_bits", "nearest"],
            module: None,
            inputs: vec![
                Port::unsigned("colour", "C", "red, green, blue, unit words").times("3"),
                Port::unsigned("diffuse", "C + 8", "what multiplies, fractions of C bits").times("3"),
                Port::unsigned("specular", "C + 8", "what is added, on the scale of a unit word").times("3"),
            ],
            tables: Vec::new(),
            wires: [
                Wire::new("product", "colour · diffuse", "0", "(2^C - 1) * (2^(C + 8) - 1)"),
                Wire::new(
                    "scaled",
                    "product / 2^C, rounded",
                    "0",
                    "((2^C - 1) * (2^(C + 8) - 1) + NEAREST * (2^C / 2)) / 2^C",
                )
                .made_by(WireKind::Rounded { of: "product", bits: "C" }),
                Wire::new(
                    "sum",
                    "scaled + specular",
                    "0",
                    "((2^C - 1) * (2^(C + 8) - 1) + NEAREST * (2^C / 2)) / 2^C + 2^(C + 8) - 1",
                ),
                Wire::new("value", "sum, held at the full word", "0", "2^C - 1").made_by(WireKind::Held {
                    of: "sum",
                    low: "0",
                    high: "2^C - 1",
                }),
            ]
            .map(|wire| wire.times("3"))
            .to_vec(),
            outputs: vec![
                Port::unsigned("value", "C", "red, green, blue, unit words").times("3"),
                Port::unsigned("overflow", "1", "whether the word was held").times("3"),
            ],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, _: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let (colour, light) = line(inputs);
        let words = lit_wires(colour, light, &format.words, probe);
        [words.map(|(word, _)| word.into()), words.map(|(_, saturated)| saturated.into())].concat()
    }

    fn lanes(&self, format: &UnitFormat, _: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let answer = |inputs: &Vec<i128>| {
            let (colour, light) = line(inputs);
            let (value, _) = shaded(&frame(colour, light, &format.words));
            // The lanes count a sample's words; a component without colour and highlight has none.
            let overflow = [0, 1, 2].map(|i| {
                let alone = |words: [u32; 3]| std::array::from_fn(|j| if i == j { words[j] } else { 0 });
                let light = ReflectedLight { specular: alone(light.specular), ..light };
                shaded(&frame(alone(colour), light, &format.words)).1.into()
            });
            [value.map(i128::from), overflow].concat()
        };
        Some(lines.iter().map(answer).collect())
    }
}
