//! A leaf, a node and a whole ray of the cone. The definition.

use cube3_abc::golden::{Counted, Shaded};
use cube3_frame::{ConeRegisters, DiscreteRay};
use cube3_machine::ConeOrder;
use cube3_scene::Mode;
use cube3_word::{Probe, Words, unit_full, unit_mul_wires, unit_resize};

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
    leaf_wires(shaded, cone, words, &mut ())
}

/// [`leaf`], and what its wires carry.
pub fn leaf_wires(shaded: &Shaded, cone: &ConeRegisters, words: &Words, probe: &mut impl Probe) -> Node {
    if !shaded.present {
        return Node::default();
    }
    let bits = words.accumulator_bits;
    let resized = unit_resize(shaded.opacity, words.opacity_bits, bits);
    let colour = shaded.colour.map(|c| unit_resize(c, words.colour_bits, bits));
    let surface = matches!(cone.mode, Mode::FirstOpaque | Mode::LastOpaque);
    let opaque = shaded.opacity >= cone.opaque;
    let opacity = if surface { unit_full(bits) } else { resized };
    let weighted = [0, 1, 2]
        .map(|i| probe.within("weighted", i, |probe| unit_mul_wires(colour[i], opacity, bits, words.rounding, probe)));
    let present = opaque || !surface;
    probe.wire("resized", 0, resized.into());
    (0..3).for_each(|i| probe.wire("colour", i, colour[i].into()));
    probe.wire("opaque", 0, opaque.into());
    probe.wire("present", 0, present.into());
    if !present {
        return Node::default();
    }
    let [red, green, blue] = weighted.map(u64::from);
    Node { present, sample: shaded.sample, rgba: [red, green, blue, opacity.into()] }
}

/// Two neighbouring stretches of a ray, the left one nearer to the eye. Nothing beside something gives the something.
#[inline]
pub fn combine(mode: Mode, left: Node, right: Node, words: &Words) -> Node {
    combine_wires(mode, left, right, words, &mut ())
}

/// [`combine`], and what its wires carry.
#[inline]
pub fn combine_wires(mode: Mode, left: Node, right: Node, words: &Words, probe: &mut impl Probe) -> Node {
    if !left.present || !right.present {
        return if left.present { left } else { right };
    }
    match mode {
        Mode::Composite => {
            let bits = words.accumulator_bits;
            let through = unit_full(bits) - left.rgba[3] as u32;
            probe.wire("through", 0, through.into());
            let rgba = [0, 1, 2, 3].map(|i| {
                let behind = probe.within("behind", i, |probe| {
                    unit_mul_wires(through, right.rgba[i] as u32, bits, words.rounding, probe)
                });
                let over = left.rgba[i] + u64::from(behind);
                probe.wire("over", i, over.into());
                over
            });
            Node { rgba, ..left }
        }
        Mode::FirstOpaque => left,
        Mode::LastOpaque => right,
        Mode::Maximum | Mode::Minimum => {
            let wins = if mode == Mode::Maximum { right.sample > left.sample } else { right.sample < left.sample };
            probe.wire("order", 0, (i64::from(right.sample) - i64::from(left.sample)).into());
            probe.wire("wins", 0, wins.into());
            if wins { right } else { left }
        }
        Mode::WeightedSum => {
            let rgba = [0, 1, 2, 3].map(|i| left.rgba[i] + right.rgba[i]);
            (0..4).for_each(|i| probe.wire("sum", i, rgba[i].into()));
            Node { rgba, ..left }
        }
    }
}

/// A ray, in the order of the cone's nodes.
pub fn reduce(leaves: &[Node], cone: &ConeRegisters, words: &Words) -> Node {
    reduce_wires(leaves, cone, words, &mut ())
}

/// [`reduce`], and what the wires of its nodes carry.
pub fn reduce_wires(leaves: &[Node], cone: &ConeRegisters, words: &Words, probe: &mut impl Probe) -> Node {
    let mut nodes = 0;
    let mut node = |left, right| {
        nodes += 1;
        probe.within("node", nodes - 1, |probe| combine_wires(cone.mode, left, right, words, probe))
    };
    match cone.order {
        ConeOrder::Tree => tree_by(leaves, cone, &mut node),
        ConeOrder::FrontToBack => leaves.iter().fold(Node::default(), |sum, leaf| node(sum, *leaf)),
    }
}

/// A ray in a chain of nodes or in one accumulator: each sample is put behind all before it.
pub fn front_to_back(leaves: &[Node], cone: &ConeRegisters, words: &Words) -> Node {
    reduce(leaves, &ConeRegisters { order: ConeOrder::FrontToBack, ..*cone }, words)
}

/// A ray in a tree: trees over chunks of the cone's leaves, whose results are combined in order. In a tree, neighbours are
/// paired level by level from the front; one without a neighbour passes.
pub fn tree(leaves: &[Node], cone: &ConeRegisters, words: &Words) -> Node {
    reduce(leaves, &ConeRegisters { order: ConeOrder::Tree, ..*cone }, words)
}

/// [`tree`] with `node(left, right)` for each node.
fn tree_by(leaves: &[Node], cone: &ConeRegisters, node: &mut impl FnMut(Node, Node) -> Node) -> Node {
    let mut sum = Node::default();
    for chunk in leaves.chunks(cone.leaves) {
        let mut level = chunk.to_vec();
        while level.len() > 1 {
            level = level
                .chunks(2)
                .map(|pair| if let [left, right] = pair { node(*left, *right) } else { pair[0] })
                .collect();
        }
        sum = node(sum, level[0]);
    }
    sum
}

/// The pixel of a ray's node: red, green, blue (opacity-weighted) and opacity, and whether a sum was saturated.
pub fn pixel(node: Node, cone: &ConeRegisters, words: &Words) -> Counted<[u32; 4]> {
    pixel_wires(node, cone, words, &mut ())
}

/// [`pixel`], and what its wires carry.
pub fn pixel_wires(node: Node, cone: &ConeRegisters, words: &Words, probe: &mut impl Probe) -> Counted<[u32; 4]> {
    if cone.mode != Mode::WeightedSum {
        return Counted { value: node.rgba.map(|word| word as u32), overflows: 0 };
    }
    let full = u128::from(unit_full(words.accumulator_bits));
    let mut overflows = 0;
    let value = [0, 1, 2, 3].map(|i| {
        let shift = words.rounding.by(ConeRegisters::WEIGHT_BITS);
        let product = u128::from(node.rgba[i]) * u128::from(cone.sum_weight);
        let mean = (product + shift.half as u128) >> shift.bits;
        let held = mean.min(full);
        overflows += u32::from(mean > full);
        probe.wire("product", i, product as i128);
        probe.wire("mean", i, mean as i128);
        probe.wire("held", i, held as i128);
        probe.wire("overflow", i, i128::from(mean > full));
        held as u32
    });
    Counted { value, overflows }
}

/// A stretch of one ray at a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// The ray.
    pub ray: DiscreteRay,
    /// Its samples so far.
    pub node: Node,
}

/// A segmented reduction of one slot: the leaves of a circle from `start` on, each with the ray that it belongs to, and
/// `of(place)` the leaf at a place of the circle. Each ray that has a leaf gives a segment, in order of depth.
///
/// Level by level, neighbours are paired relative to the start: the cross-links of the folded tree. A
/// node joins the last segment of its left child with the first of its right one if they are of the same ray, and
/// passes on the others.
pub fn circle(count: usize, start: usize, of: impl Fn(usize) -> Segment, mode: Mode, words: &Words) -> Vec<Segment> {
    circle_by(count, start, of, &mut |left, right| combine(mode, left, right, words))
}

/// [`circle`] with `node(left, right)` for each node that joins two stretches of a ray, level by level from the start.
#[inline]
pub fn circle_by(
    count: usize,
    start: usize,
    of: impl Fn(usize) -> Segment,
    node: &mut impl FnMut(Node, Node) -> Node,
) -> Vec<Segment> {
    // The segments of all nodes of a level, one node after the other, and how many each has. A level is made in the place of
    // the one before, which it never overtakes.
    let mut segments: Vec<Segment> = (0..count).map(|i| of((start + i) % count)).collect();
    let mut counts = vec![1; count];
    while counts.len() > 1 {
        let nodes = counts.len();
        let (mut read, mut written) = (0, 0);
        for place in 0..nodes.div_ceil(2) {
            let left = counts[2 * place];
            segments.copy_within(read..read + left, written);
            read += left;
            let mut end = written + left;
            if let Some(&right) = counts.get(2 * place + 1) {
                let behind = read + right;
                if segments[end - 1].ray == segments[read].ray {
                    segments[end - 1].node = node(segments[end - 1].node, segments[read].node);
                    read += 1;
                }
                segments.copy_within(read..behind, end);
                end += behind - read;
                read = behind;
            }
            counts[place] = end - written;
            written = end;
        }
        counts.truncate(nodes.div_ceil(2));
        segments.truncate(written);
    }
    segments
}
