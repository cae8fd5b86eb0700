//! The light unit: Phong's formula in integers.

use crate::unit::Reader;
use crate::{Port, Sheet, Table, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder, word_formats};
use cube3_abc::golden::phong_wires;
use cube3_abc::lanes::phong_rows;
use cube3_frame::{Phong as Registers, PhongLight};
use cube3_scene::Material;

/// Phong's formula.
pub struct PhongSheet;

/// The normal and the registers of a line.
fn line(format: &UnitFormat, tables: &Tables, inputs: &[i128]) -> ([i32; 3], Registers) {
    let mut fields = Reader::new(inputs);
    let (normal, ambient, two_sided) = (fields.signed_words(), fields.word(), fields.flag());
    let mut lights = vec![
        PhongLight { direction: [0; 3], halfway: [0; 3], diffuse: [0; 3], specular: [0; 3] };
        format.lights as usize
    ];
    lights.iter_mut().for_each(|light| light.direction = fields.signed_words());
    lights.iter_mut().for_each(|light| light.halfway = fields.signed_words());
    lights.iter_mut().for_each(|light| light.diffuse = fields.words());
    lights.iter_mut().for_each(|light| light.specular = fields.words());
    let power = tables[0].iter().map(|&entry| entry as u32).collect();
    (normal, Registers { ambient, two_sided, lights, power, power_bits: format.power_bits })
}

/// A cosine between the normal and a direction, of `part`.
fn cosine(part: &'static str) -> Vec<Wire> {
    [
        Wire::new("dot", "normal · direction", "-3 * 2^(2 * B - 2)", "3 * 2^(2 * B - 2)"),
        Wire::new("positive", "|dot| where lit from both sides, else dot or 0", "0", "3 * 2^(2 * B - 2)"),
        Wire::new("rounded", "positive / 2^(B − 1), rounded", "0", "3 * 2^(B - 1)")
            .made_by(WireKind::Rounded { of: "positive", bits: "B - 1" }),
        Wire::new("cosine", "rounded, held at 1", "0", "2^(B - 1)").made_by(WireKind::Held {
            of: "rounded",
            low: "0",
            high: "2^(B - 1)",
        }),
    ]
    .map(|wire| wire.of(part).times("LIGHTS"))
    .to_vec()
}

/// The shares of the lights, for each light red, green, blue.
fn shares() -> Vec<Wire> {
    [
        Wire::new("diffuse_product", "light_diffuse · towards.cosine", "0", "(2^(C + 4) - 1) * 2^(B - 1)"),
        Wire::new("diffuse", "diffuse_product / 2^(B − 1), rounded", "0", "2^(C + 4) - 1")
            .made_by(WireKind::Rounded { of: "diffuse_product", bits: "B - 1" }),
        Wire::new("specular_product", "light_specular · half.power", "0", "(2^(C + 4) - 1) * 2^C"),
        Wire::new("specular", "specular_product / 2^C, rounded", "0", "2^(C + 4) - 1")
            .made_by(WireKind::Rounded { of: "specular_product", bits: "C" }),
    ]
    .map(|wire| wire.of("light").times("3 * LIGHTS"))
    .to_vec()
}

impl Unit for PhongSheet {
    fn sheet(&self) -> Sheet {
        let half = [
            Wire::new("index", "cosine / 2^(B − 1 − P), rounded", "0", "2^P")
                .made_by(WireKind::Rounded { of: "cosine", bits: "B - 1 - P" }),
            Wire::new("power", "the table at index; 0 for a light behind one that lights from one side", "0", "2^C"),
        ]
        .map(|wire| wire.of("half").times("LIGHTS"));
        let sums = [
            Wire::new("diffuse", "ambient and the shares' sum", "0", "(LIGHTS + 1) * (2^(C + 4) - 1)"),
            Wire::new("specular", "the shares' sum", "0", "LIGHTS * (2^(C + 4) - 1)"),
        ]
        .map(|wire| wire.times("3"));
        Sheet {
            name: "phong",
            title: "Phong's light",
            purpose: "Diffuse and specular light on a normal from lights that are far away: for each light the cosine between the normal \
                      and the light, which its diffuse intensity is multiplied with, and the cosine between the normal and the vector \
                      halfway to the eye, whose power a table holds. Vectors point as gradients do, against the normal of a surface. \
                      Components have any value here, and so the cosines are held at 1: of vectors of length 1 they are at most a \
                      rounding above it.",
            source: "Pfister et al. 1995, section 4; `cube3_abc::golden::phong_from`",
            parameters: &["normal_bits", "colour_bits", "nearest", "power_bits", "lights"],
            module: None,
            inputs: vec![
                Port::signed("normal", "B + 1", "direction of the gradient, fractions of B − 1 bits")
                    .times("3")
                    .within("-2^(B - 1)", "2^(B - 1)"),
                Port::unsigned("ambient", "C + 4", "ambient intensity, a fraction of C bits"),
                Port::unsigned("two_sided", "1", "lit from both sides"),
                Port::signed("light_direction", "B + 1", "towards each light, negated")
                    .times("3 * LIGHTS")
                    .within("-2^(B - 1)", "2^(B - 1)"),
                Port::signed("light_halfway", "B + 1", "halfway between it and the eye, likewise")
                    .times("3 * LIGHTS")
                    .within("-2^(B - 1)", "2^(B - 1)"),
                Port::unsigned("light_diffuse", "C + 4", "diffuse intensity of red, green, blue").times("3 * LIGHTS"),
                Port::unsigned("light_specular", "C + 4", "specular intensity, on the scale of a unit word")
                    .times("3 * LIGHTS"),
            ],
            tables: vec![Table {
                name: "power",
                entries: "2^P + 1",
                bits: "C + 1",
                meaning: "x^shininess from 0 to 1 inclusive, fractions of C bits",
            }],
            wires: [cosine("towards"), cosine("half"), half.to_vec(), shares(), sums.to_vec()].concat(),
            outputs: vec![
                Port::unsigned("diffuse", "C + 8", "what multiplies the colour, fractions of C bits").times("3"),
                Port::unsigned("specular", "C + 8", "what is added to it, on the scale of a unit word").times("3"),
            ],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, tables: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let (normal, registers) = line(format, tables, inputs);
        let towards = |light: usize| [registers.lights[light].direction, registers.lights[light].halfway];
        let light = phong_wires(normal, &registers, towards, &format.words, probe);
        [light.diffuse, light.specular].concat().into_iter().map(i128::from).collect()
    }

    /// The powers of the material that a scene has unless it says otherwise.
    fn tables(&self, format: &UnitFormat) -> Tables {
        let powers = Registers::powers(Material::default().shininess, format.power_bits, format.words.colour_bits);
        vec![powers.into_iter().map(i128::from).collect()]
    }

    /// One light, and of some words three.
    fn formats(&self) -> Vec<UnitFormat> {
        let formats = word_formats();
        let three = [0, 1, 8].map(|i| UnitFormat { lights: 3, ..formats[i] });
        formats.into_iter().chain(three).collect()
    }

    fn lanes(&self, format: &UnitFormat, tables: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let answer = |inputs: &Vec<i128>| {
            let (normal, registers) = line(format, tables, inputs);
            let rows = phong_rows(normal.map(|component| vec![component]), &registers, &format.words);
            rows.iter().flatten().map(|row| row[0].into()).collect()
        };
        Some(lines.iter().map(answer).collect())
    }
}
