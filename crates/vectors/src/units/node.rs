//! A node of the cone.

use super::leaf::unit_mul_wires;
use super::modes::{MODE, legal};
use crate::unit::Reader;
use crate::{Port, Sheet, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder};
use cube3_cone::golden::{Node as GoldenNode, combine_wires};
use cube3_cone::lanes::{Accumulator, ConeLanes, RowNode};
use cube3_frame::ConeRegisters;
use cube3_machine::ConeOrder;
use cube3_scene::Mode;

/// The node.
pub struct NodeSheet;

/// The mode of a line, and the nodes on the left and on the right.
fn line(inputs: &[i128]) -> (Mode, [GoldenNode; 2]) {
    let mut fields = Reader::new(inputs);
    let mode = Mode::ALL[fields.word() as usize];
    let mut node = || GoldenNode {
        present: fields.flag(),
        sample: fields.signed(),
        rgba: std::array::from_fn(|_| fields.field() as u64),
    };
    (mode, [node(), node()])
}

/// A row of one ray. Where samples are compared, one that has nothing has the word that never wins.
fn row<T: Accumulator>(mode: Mode, node: &GoldenNode, word: impl Fn(u64) -> T) -> RowNode<T> {
    let sample = match mode {
        Mode::Maximum if !node.present => vec![i32::MIN],
        Mode::Minimum if !node.present => vec![i32::MAX],
        Mode::Maximum | Mode::Minimum => vec![node.sample],
        _ => Vec::new(),
    };
    RowNode { start: 0, rgba: node.rgba.map(|raw| vec![word(raw)]), sample }
}

/// Both rows together: red, green, blue, opacity, and the sample where samples are compared.
fn combined<T: Accumulator>(
    mode: Mode,
    nodes: &[GoldenNode; 2],
    format: &UnitFormat,
    word: impl Fn(u64) -> T,
) -> ([u64; 4], Option<i32>) {
    let cone = ConeRegisters { mode, order: ConeOrder::Tree, leaves: 2, opaque: 1, sum_weight: 0 };
    let [mut left, right] = nodes.each_ref().map(|node| row(mode, node, &word));
    ConeLanes::<T>::new(cone, format.words).combine(&mut left, &right);
    (left.rgba.each_ref().map(|row| row[0].wide()), left.sample.first().copied())
}

impl Unit for NodeSheet {
    fn sheet(&self) -> Sheet {
        let mut wires = vec![Wire::new("through", "2^A − 1 − left opacity", "0", "2^A - 1")];
        wires.extend(unit_mul_wires("behind", "4"));
        wires.extend([
            Wire::new(
                "over",
                "composite: left + behind; at most full, as no colour exceeds its opacity",
                "0",
                "2^A - 1",
            )
            .times("4"),
            Wire::new(
                "order",
                "maximum and minimum compare: right sample − left, of which only the sign counts",
                "-M",
                "M",
            ),
            Wire::new("wins", "maximum: right sample > left; minimum: right sample < left", "0", "1")
                .made_by(WireKind::Cases),
            Wire::new("sum", "weighted-sum: left + right, of 4096 samples at most", "0", "4096 * (2^A - 1)").times("4"),
        ]);
        let side = |name: [&'static str; 3], which: &'static str| {
            [
                Port::unsigned(name[0], "1", which),
                Port::unsigned(name[1], "S", "sample word").within("0", "M"),
                Port::unsigned(name[2], "N", "red, green, blue (weighted), opacity")
                    .times("4")
                    .within("0", "2048 * (2^A - 1)"),
            ]
        };
        let mut inputs = vec![MODE];
        inputs
            .extend(side(["left_present", "left_sample", "left_rgba"], "whether there is anything nearer to the eye"));
        inputs.extend(side(["right_present", "right_sample", "right_rgba"], "whether there is anything behind it"));
        Sheet {
            name: "node",
            title: "Node",
            purpose: "Two neighbouring stretches of a ray become one; the left one is nearer to the eye. A stretch that has nothing is all 0, \
                      and nothing beside something gives the something, all fields of it. Composite: C = C_L + (1 − α_L)·C_R and α \
                      likewise; there no opacity is above 2^A − 1 and no colour above its opacity. A weighted sum adds. Both keep the left \
                      sample. First- and last-opaque pass on the left and the right stretch, maximum and minimum the one whose sample is \
                      larger or smaller, the left one where equal, with all its fields.",
            source: "Pfister et al. 1995, section 6; `cube3_cone::golden::combine`",
            parameters: &["voxel_bits", "sample_fraction_bits", "accumulator_bits", "nearest"],
            module: None,
            inputs,
            tables: Vec::new(),
            wires,
            outputs: vec![
                Port::unsigned("present", "1", "whether there is anything"),
                Port::unsigned("sample", "S", "sample word"),
                Port::unsigned("rgba", "N", "red, green, blue (weighted), opacity").times("4"),
            ],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, _: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let (mode, [left, right]) = line(inputs);
        let node = combine_wires(mode, left, right, &format.words, probe);
        let mut outputs = vec![node.present.into(), node.sample.into()];
        outputs.extend(node.rgba.map(i128::from));
        outputs
    }

    /// The rows of the cone hold colours and opacities, and samples where these are compared; where nothing is they are 0, and whether
    /// there is anything is no word of theirs.
    fn lanes(&self, format: &UnitFormat, tables: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let answer = |inputs: &Vec<i128>| {
            let (mode, nodes) = line(inputs);
            let mut outputs = self.evaluate(format, tables, inputs, &mut WireRecorder::default());
            // In these modes a leaf is fully opaque, or nothing: the rows know what is there by its opacity.
            let by_opacity = matches!(mode, Mode::FirstOpaque | Mode::LastOpaque);
            if by_opacity && nodes.iter().any(|node| node.present && node.rgba[3] == 0) {
                return outputs;
            }
            let (rgba, sample) = match format.words.accumulator_bits {
                ..=16 => combined(mode, &nodes, format, |raw| raw as u32),
                _ => combined(mode, &nodes, format, |raw| raw),
            };
            if let Some(sample) = sample.filter(|sample| ![i32::MIN, i32::MAX].contains(sample)) {
                outputs[1] = sample.into();
            }
            outputs.splice(2.., rgba.map(i128::from));
            outputs
        };
        Some(lines.iter().map(answer).collect())
    }

    fn legalise(&self, format: &UnitFormat, inputs: &mut [i128]) {
        let mode = inputs[0];
        for side in inputs[1..].chunks_mut(6) {
            if let [present, sample, rgba @ ..] = side {
                legal(format, mode, *present, sample, rgba);
            }
        }
    }
}
