//! The folded cone: a segmented reduction of one slot.

use super::modes::{MODE, legal};
use crate::unit::Reader;
use crate::{Port, Sheet, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder};
use cube3_cone::golden::{Node, Segment, circle, tree};
use cube3_frame::{ConeRegisters, DiscreteRay};
use cube3_machine::ConeOrder;
use cube3_scene::Mode;
use cube3_word::Probe;

/// Rays of a slot: u and v each have a seam at most once where rays are wrapped.
const RAYS: usize = 3;

/// The cone.
pub struct ConeSheet;

/// A line: mode, start, the nodes of the leaves by their places on the circle, and their rays.
struct Slot {
    mode: Mode,
    start: usize,
    leaves: Vec<Node>,
    rays: Vec<usize>,
}

impl Slot {
    fn new(inputs: &[i128], leaves: usize) -> Slot {
        let mut fields = Reader::new(inputs);
        let mode = Mode::ALL[fields.word() as usize];
        let start = fields.word() as usize;
        let present: Vec<bool> = (0..leaves).map(|_| fields.flag()).collect();
        let sample: Vec<i32> = (0..leaves).map(|_| fields.signed()).collect();
        let rgba: Vec<[u64; 4]> = (0..leaves).map(|_| std::array::from_fn(|_| fields.field() as u64)).collect();
        let rays = (0..leaves).map(|_| fields.word() as usize).collect();
        let node = |i: usize| Node { present: present[i], sample: sample[i], rgba: rgba[i] };
        Slot { mode, start, leaves: (0..leaves).map(node).collect(), rays }
    }

    /// The place on the circle of a depth.
    fn place(&self, depth: usize) -> usize {
        (self.start + depth) % self.leaves.len()
    }

    /// The output fields: how many rays, and the node of each.
    fn outputs(nodes: &[Node]) -> Vec<i128> {
        let node = |ray: usize| nodes.get(ray).copied().unwrap_or_default();
        let mut outputs = vec![nodes.len() as i128];
        outputs.extend((0..RAYS).map(|ray| i128::from(node(ray).present)));
        outputs.extend((0..RAYS).map(|ray| i128::from(node(ray).sample)));
        outputs.extend((0..RAYS).flat_map(|ray| node(ray).rgba.map(i128::from)));
        outputs
    }
}

impl Unit for ConeSheet {
    fn sheet(&self) -> Sheet {
        Sheet {
            name: "cone",
            title: "Folded cone",
            purpose: "The leaves of a slot stand on a circle, the sample nearest to the eye at `start`. They are paired in order of depth from \
                      there, level by level, one without a neighbour passing; where the slot goes over from one ray to the next, nothing is \
                      combined across. Each ray gets the bits that it would get alone in the tree, nothing at the leaves of others. Every \
                      node is a `node` of its sheet. A slot has up to three rays, and a ray without a leaf gives 0.",
            source: "Pfister et al. 1995, section 6; `cube3_cone::golden::tree`",
            parameters: &["voxel_bits", "sample_fraction_bits", "accumulator_bits", "nearest", "leaves"],
            module: None,
            inputs: vec![
                MODE,
                Port::unsigned("start", "max(log2(LANES), 1)", "place of the first sample").within("0", "LANES - 1"),
                Port::unsigned("leaf_present", "1", "whether a leaf has anything, by place on the circle")
                    .times("LANES"),
                Port::unsigned("leaf_sample", "S", "sample words").times("LANES").within("0", "M"),
                Port::unsigned("leaf_rgba", "A", "of leaf l number 4·l + c: red, green, blue (weighted), opacity")
                    .times("4 * LANES"),
                Port::unsigned("leaf_ray", "2", "ray of the leaf, numbered from 0 in order of depth")
                    .times("LANES")
                    .within("0", "min(2, LANES - 1)"),
            ],
            tables: Vec::new(),
            wires: vec![Wire::new("rays", "rays of the slot", "1", "min(3, LANES)").made_by(WireKind::Cases)],
            outputs: vec![
                Port::unsigned("count", "2", "rays that have a leaf"),
                Port::unsigned("seg_present", "1", "whether a ray has anything").times("3"),
                Port::unsigned("seg_sample", "S", "its sample word").times("3"),
                Port::unsigned("seg_rgba", "N", "of ray r number 4·r + c: red, green, blue (weighted), opacity")
                    .times("12"),
            ],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, _: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let leaves = format.lanes as usize;
        let slot = Slot::new(inputs, leaves);
        let cone = ConeRegisters { mode: slot.mode, order: ConeOrder::Tree, leaves, opaque: 1, sum_weight: 0 };
        let rays = slot.rays.iter().max().map_or(0, |last| last + 1);
        let node = |ray: usize| {
            let of_ray = |depth: usize| {
                let place = slot.place(depth);
                if slot.rays[place] == ray { slot.leaves[place] } else { Node::default() }
            };
            tree(&(0..leaves).map(of_ray).collect::<Vec<Node>>(), &cone, &format.words)
        };
        probe.wire("rays", 0, rays as i128);
        Slot::outputs(&(0..rays).map(node).collect::<Vec<Node>>())
    }

    fn legalise(&self, format: &UnitFormat, inputs: &mut [i128]) {
        let n = format.lanes as usize;
        let (mode, start) = (inputs[0], inputs[1] as usize);
        let (nodes, rays) = inputs.split_at_mut(2 + 6 * n);
        // Numbered from 0 in order of depth, without a gap.
        let mut sorted: Vec<i128> = rays.to_vec();
        sorted.sort_unstable();
        let mut numbers = sorted.clone();
        numbers.dedup();
        for (depth, ray) in sorted.iter().enumerate() {
            let number = numbers.iter().position(|number| number == ray).unwrap_or(0);
            rays[(start + depth) % n] = number as i128;
        }
        for leaf in 0..n {
            let mut rgba: Vec<i128> = nodes[2 + 2 * n + 4 * leaf..][..4].to_vec();
            let (present, mut sample) = (nodes[2 + leaf], nodes[2 + n + leaf]);
            legal(format, mode, present, &mut sample, &mut rgba);
            nodes[2 + n + leaf] = sample;
            nodes[2 + 2 * n + 4 * leaf..][..4].copy_from_slice(&rgba);
        }
    }

    fn formats(&self) -> Vec<UnitFormat> {
        let few = crate::unit::word_formats().into_iter().map(|format| UnitFormat { lanes: 4, ..format });
        let base = UnitFormat::default();
        few.chain([1, 2, 3, 5, 8, 16].map(|lanes| UnitFormat { lanes, ..base })).collect()
    }

    fn lanes(&self, format: &UnitFormat, _: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let leaves = format.lanes as usize;
        let line = |inputs: &Vec<i128>| {
            let slot = Slot::new(inputs, leaves);
            let of = |place: usize| Segment {
                ray: DiscreteRay { u: slot.rays[place] as i64, v: 0 },
                node: slot.leaves[place],
            };
            let segments = circle(leaves, slot.start, of, slot.mode, &format.words);
            Slot::outputs(&segments.iter().map(|segment| segment.node).collect::<Vec<Node>>())
        };
        Some(lines.iter().map(line).collect())
    }
}
