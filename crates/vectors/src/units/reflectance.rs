//! Light by table over the gradient's direction.

use super::contents::{Noise, colour, colours};
use crate::unit::Reader;
use crate::{Port, Sheet, Table, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder, word_formats};
use cube3_abc::golden::direction_index_wires;
use cube3_frame::GradientScale;
use cube3_machine::GradientMethod;

/// The reflectance table.
pub struct ReflectanceSheet;

impl Unit for ReflectanceSheet {
    fn sheet(&self) -> Sheet {
        let meaning = "over face, second and first coordinate, that in the low bits; red in the low bits of an entry";
        let table = |name| Table { name, entries: "6 * 4^Q", bits: "3 * (C + 4)", meaning };
        Sheet {
            name: "reflectance",
            title: "Reflectance table",
            purpose: "Light on a sample by the direction of its gradient: the face of a cube that it points at, of the largest component \
                      (u before v before w where equal), and on it the two others, next in the order u, v, w, u, divided by the largest. \
                      A gradient of 0 has the light `flat` and no highlight.",
            source: "Pfister et al. 1995, section 4, shading by lookup tables; `cube3_abc::golden::reflectance`",
            parameters: &["gradient_bits", "kept_bits", "colour_bits", "reflectance_bits"],
            module: None,
            inputs: vec![
                Port::signed("g", "G", "gradient along u, v, w").times("3"),
                Port::unsigned("flat", "C + 4", "intensity of a sample without a gradient, a fraction of C bits"),
            ],
            tables: vec![table("diffuse"), table("specular")],
            wires: vec![
                Wire::new("size", "magnitude of a component", "0", "2^(G - 1)").times("3"),
                Wire::new("largest", "the largest size", "0", "2^(G - 1)"),
                Wire::new("face", "2 · axis of the largest, and 1 where it is negative", "0", "5")
                    .made_by(WireKind::Cases),
                Wire::new(
                    "dividend",
                    "size of the first and of the second other · 2^(Q − 1)",
                    "0",
                    "2^(G - 1) * 2^(Q - 1)",
                )
                .times("2"),
                Wire::new("quotient", "dividend / largest, rounded down", "0", "2^(Q - 1)").times("2"),
                Wire::new("held", "quotient, held on the face", "0", "2^(Q - 1) - 1")
                    .times("2")
                    .made_by(WireKind::Held { of: "quotient", low: "0", high: "2^(Q - 1) - 1" }),
                Wire::new(
                    "coordinate",
                    "2^(Q − 1) + held, or 2^(Q − 1) − 1 − held where the component is negative",
                    "0",
                    "2^Q - 1",
                )
                .times("2"),
                Wire::new("entry", "(face · 2^Q + second) · 2^Q + first", "0", "6 * 4^Q - 1"),
            ],
            outputs: vec![
                Port::unsigned("diffuse", "C + 4", "what multiplies the colour, fractions of C bits").times("3"),
                Port::unsigned("specular", "C + 4", "what is added to it, on the scale of a unit word").times("3"),
            ],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, tables: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let mut fields = Reader::new(inputs);
        let (gradient, flat) = (fields.signed_words(), fields.word());
        let bits = format.words.colour_bits + 4;
        let [diffuse, specular] = match direction_index_wires(gradient, format.reflectance_bits, probe) {
            Some(index) => [colour(tables[0][index], bits), colour(tables[1][index], bits)],
            None => [[flat; 3], [0; 3]],
        };
        [diffuse, specular].concat().into_iter().map(i128::from).collect()
    }

    fn tables(&self, format: &UnitFormat) -> Tables {
        let (entries, bits) = (6 << (2 * format.reflectance_bits), format.words.colour_bits + 4);
        vec![colours(3, entries, bits), colours(6, entries, bits)]
    }

    /// Gradients towards the middles and the edges of the cube's faces.
    fn corners(&self, format: &UnitFormat) -> Vec<Vec<i128>> {
        let mut noise = Noise::new(9);
        let low = -(1 << (format.words.gradient_bits + format.kept_bits - 1));
        let high = -low - 1;
        let flat = noise.up_to((16 << format.words.colour_bits) - 1);
        let places = [low, -high, 0, high];
        let edges = places.into_iter().flat_map(|u| places.into_iter().flat_map(move |v| places.map(|w| [u, v, w])));
        edges.map(|[u, v, w]| vec![u, v, w, flat]).collect()
    }

    /// Small tables, as narrow gradients reach few entries; the default; what a scale keeps. With one bit of colour every line of the
    /// narrow words can be tried.
    fn formats(&self) -> Vec<UnitFormat> {
        let room = |format: &UnitFormat| {
            GradientScale::FACTOR_BITS.min(GradientScale::room(GradientMethod::Six, &format.words))
        };
        let small = word_formats().into_iter().take(5).map(|mut format| {
            if format.words.gradient_bits == 4 {
                format.words.colour_bits = 1;
            }
            UnitFormat { reflectance_bits: 2, ..format }
        });
        let default = UnitFormat::default();
        small.chain([default, UnitFormat { kept_bits: room(&default), reflectance_bits: 4, ..default }]).collect()
    }
}
