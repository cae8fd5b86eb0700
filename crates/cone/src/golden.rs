//! A leaf, a node and a whole ray of the cone. The definition.

use cube3_abc::golden::{Counted, Shaded};
use cube3_host::{ConeOrder, ConeRegisters};
use cube3_scene::Mode;
use cube3_word::{Words, unit_full, unit_mul, unit_resize};

/// What a node passes on: nothing, or a stretch of a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Node {
    /// Whether any sample takes part.
    pub present: bool,
    /// The sample word that the minimum or maximum is of.
    pub sample: i32,
    /// Opacity-weighted red, green, blue, and opacity: unit words of `accumulator_bits`, in a weighted sum their sums.
    pub rgba: [u64; 4],
}

/// A sample at a leaf.
pub fn leaf(shaded: &Shaded, cone: &ConeRegisters, words: &Words) -> Node {
    let bits = words.accumulator_bits;
    if !shaded.present {
        return Node::default();
    }
    let opacity = unit_resize(shaded.opacity, words.opacity_bits, bits);
    let colour = shaded.colour.map(|c| unit_resize(c, words.colour_bits, bits));
    let pixel = |opacity: u32| {
        let weighted = colour.map(|c| u64::from(unit_mul(c, opacity, bits, words.rounding)));
        [weighted[0], weighted[1], weighted[2], u64::from(opacity)]
    };
    match cone.mode {
        Mode::FirstOpaque | Mode::LastOpaque if shaded.opacity < cone.opaque => Node::default(),
        Mode::FirstOpaque | Mode::LastOpaque => {
            Node { present: true, sample: shaded.sample, rgba: pixel(unit_full(bits)) }
        }
        _ => Node { present: true, sample: shaded.sample, rgba: pixel(opacity) },
    }
}

/// Two neighbouring stretches of a ray, the left one nearer to the eye. Nothing beside something gives the something.
pub fn combine(mode: Mode, left: Node, right: Node, words: &Words) -> Node {
    if !left.present || !right.present {
        return if left.present { left } else { right };
    }
    match mode {
        Mode::Composite => {
            let bits = words.accumulator_bits;
            let through = unit_full(bits) - left.rgba[3] as u32;
            let over =
                |i: usize| left.rgba[i] + u64::from(unit_mul(through, right.rgba[i] as u32, bits, words.rounding));
            Node { rgba: [over(0), over(1), over(2), over(3)], ..left }
        }
        Mode::FirstOpaque => left,
        Mode::LastOpaque => right,
        Mode::Maximum => {
            if right.sample > left.sample {
                right
            } else {
                left
            }
        }
        Mode::Minimum => {
            if right.sample < left.sample {
                right
            } else {
                left
            }
        }
        Mode::WeightedSum => Node { rgba: [0, 1, 2, 3].map(|i| left.rgba[i] + right.rgba[i]), ..left },
    }
}

/// A ray, in the order of the cone's nodes.
pub fn reduce(leaves: &[Node], cone: &ConeRegisters, words: &Words) -> Node {
    match cone.order {
        ConeOrder::Tree => tree(leaves, cone, words),
        ConeOrder::FrontToBack => front_to_back(leaves, cone, words),
    }
}

/// A ray in a chain of nodes or in one accumulator: each sample is put behind all before it.
pub fn front_to_back(leaves: &[Node], cone: &ConeRegisters, words: &Words) -> Node {
    leaves.iter().fold(Node::default(), |sum, leaf| combine(cone.mode, sum, *leaf, words))
}

/// A ray in a tree: trees over chunks of the cone's leaves, whose results are combined in order. In a tree, neighbours are
/// paired level by level from the front; one without a neighbour passes.
pub fn tree(leaves: &[Node], cone: &ConeRegisters, words: &Words) -> Node {
    let tree = |chunk: &[Node]| {
        let mut level = chunk.to_vec();
        while level.len() > 1 {
            level = level
                .chunks(2)
                .map(|pair| if let [left, right] = pair { combine(cone.mode, *left, *right, words) } else { pair[0] })
                .collect();
        }
        level[0]
    };
    leaves.chunks(cone.leaves).map(tree).fold(Node::default(), |sum, part| combine(cone.mode, sum, part, words))
}

/// The pixel of a ray's node: red, green, blue (opacity-weighted) and opacity, and whether a sum was saturated.
pub fn pixel(node: Node, cone: &ConeRegisters, words: &Words) -> Counted<[u32; 4]> {
    if cone.mode != Mode::WeightedSum {
        return Counted { value: node.rgba.map(|word| word as u32), overflows: 0 };
    }
    let full = u128::from(unit_full(words.accumulator_bits));
    let mut overflows = 0;
    let value = node.rgba.map(|sum| {
        let shift = words.rounding.by(ConeRegisters::WEIGHT_BITS);
        let mean = (u128::from(sum) * u128::from(cone.sum_weight) + shift.half as u128) >> shift.bits;
        overflows += u32::from(mean > full);
        mean.min(full) as u32
    });
    Counted { value, overflows }
}
