//! The trees of one slot, blocks of leaves at once.

use super::accumulator::Accumulator;
use super::ray::tree_of_ray;
use crate::golden::{Node, combine};
use cube3_abc::ShadedSamples;
use cube3_frame::ConeRegisters;
use cube3_machine::ConeOrder;
use cube3_scene::Mode;
use cube3_word::{BLOCK_LANES, LaneBlock, UnitMul, UnitResize, Words, unit_full, vectorised};
use std::ops::Range;

/// The leaves and trees of one slot, for modes whose nodes add up, and accumulators of 16 bits at most: a sum that a transparent sample
/// does not change. Blocks of leaves are reduced at once.
#[derive(Clone, Debug)]
pub(crate) struct SlotLanes {
    cone: ConeRegisters,
    words: Words,
    opacity: UnitResize,
    colour: UnitResize,
    sums: Sums,
    /// Red, green, blue, opacity of the leaves in order of depth, block by block; any where a block has none that is not transparent.
    leaves: Vec<Leaves>,
    /// Which leaves of each block are not transparent: a bit each, the first the lowest.
    seen: Vec<u16>,
    /// Nodes of a ray above its blocks.
    nodes: Vec<Node>,
}

/// Red, green, blue, opacity of a block of leaves, each a line of the cache.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
struct Leaves([LaneBlock<u32>; 4]);

/// What the nodes of a slot compute with.
#[derive(Clone, Copy, Debug)]
struct Sums {
    product: UnitMul,
    full: u32,
    /// Whether a node hides what is behind.
    over: bool,
}

impl SlotLanes {
    /// Lanes for a frame, where its mode and words let them be used.
    pub fn new(cone: &ConeRegisters, words: &Words) -> Option<SlotLanes> {
        let adds = matches!(cone.mode, Mode::Composite | Mode::WeightedSum);
        let bits = words.accumulator_bits;
        let over = cone.mode == Mode::Composite;
        (adds && cone.order == ConeOrder::Tree && bits <= 16).then(|| SlotLanes {
            cone: *cone,
            words: *words,
            opacity: UnitResize::new(words.opacity_bits, bits),
            colour: UnitResize::new(words.colour_bits, bits),
            sums: Sums { product: UnitMul::new(bits, words.rounding), full: unit_full(bits), over },
            leaves: Vec::new(),
            seen: Vec::new(),
            nodes: Vec::new(),
        })
    }

    /// Takes the samples of a slot.
    pub fn leaves(&mut self, input: &ShadedSamples) {
        let SlotLanes { opacity, colour, sums: Sums { product, .. }, .. } = *self;
        self.leaves.resize(input.0.len(), Leaves::default());
        self.seen.resize(input.0.len(), 0);
        for ((leaves, seen), shaded) in self.leaves.iter_mut().zip(&mut self.seen).zip(&input.0) {
            *seen = if shaded.opacity.iter().fold(0, |any, opacity| any | opacity) == 0 {
                0
            } else {
                vectorised(
                    #[inline(always)]
                    || weighted(&shaded.opacity, &shaded.colour, opacity, colour, product, &mut leaves.0),
                )
            };
        }
    }

    /// A ray, the samples from `range`: a tree over each chunk of the cone's leaves, whose results are combined in order.
    #[inline]
    pub fn ray(&mut self, range: Range<usize>) -> Node {
        if self.sees(range.clone()) { self.trees(range) } else { Node::default() }
    }

    fn trees(&mut self, range: Range<usize>) -> Node {
        let (leaves, mode) = (self.cone.leaves, self.cone.mode);
        if range.end <= leaves.min(BLOCK_LANES) {
            return self.block(0, range);
        }
        let mut sum = Node::default();
        let mut start = range.start - range.start % leaves;
        while start < range.end {
            let end = start + leaves;
            self.nodes.clear();
            for first in (start..end.min(range.end)).step_by(BLOCK_LANES) {
                let part = range.start.max(first)..range.end.min(first + BLOCK_LANES).min(end);
                self.nodes.push(self.block(first, part));
            }
            let node = match self.nodes.as_mut_slice() {
                [node] => *node,
                nodes => tree_of_ray(nodes, 0, mode, &self.words),
            };
            sum = if sum.present { combine(mode, sum, node, &self.words) } else { node };
            start = end;
        }
        sum
    }

    /// Whether any leaf of a range, which is not empty, is not transparent.
    #[inline]
    fn sees(&self, range: Range<usize>) -> bool {
        let (first, last) = (range.start / BLOCK_LANES, (range.end - 1) / BLOCK_LANES);
        (first..=last).any(|block| {
            let behind = if block == first { u16::MAX << (range.start % BLOCK_LANES) } else { u16::MAX };
            let before =
                if block == last { u16::MAX >> (BLOCK_LANES - 1 - (range.end - 1) % BLOCK_LANES) } else { u16::MAX };
            self.seen[block] & behind & before != 0
        })
    }

    /// The tree over a block of leaves from depth `first` on, of which those of `part` are of the ray.
    #[inline]
    fn block(&self, first: usize, part: Range<usize>) -> Node {
        let sums = self.sums;
        if part.is_empty() {
            return Node::default();
        }
        let moved;
        let leaves = if first.is_multiple_of(BLOCK_LANES) {
            if !self.sees(part.clone()) {
                return Node::default();
            }
            &self.leaves[first / BLOCK_LANES].0
        } else {
            // Chunks that begin within a block: of lanes that are no multiple of one.
            let leaf = |depth: usize, i: usize| match self.seen.get(depth / BLOCK_LANES) {
                None | Some(0) => 0,
                Some(_) => self.leaves[depth / BLOCK_LANES].0[i][depth % BLOCK_LANES],
            };
            moved = [0, 1, 2, 3].map(|i| std::array::from_fn(|lane| leaf(first + lane, i)));
            &moved
        };
        let (from, to) = ((part.start - first) as u32, (part.end - first) as u32);
        let mut rgba = [[0]; 4];
        vectorised(
            #[inline(always)]
            || {
                let mut ray = [[0; BLOCK_LANES]; 4];
                let [red, green, blue, alpha] = &mut ray;
                for i in 0..BLOCK_LANES {
                    let of_ray = from <= i as u32 && (i as u32) < to;
                    red[i] = if of_ray { leaves[0][i] } else { 0 };
                    green[i] = if of_ray { leaves[1][i] } else { 0 };
                    blue[i] = if of_ray { leaves[2][i] } else { 0 };
                    alpha[i] = if of_ray { leaves[3][i] } else { 0 };
                }
                let (mut eight, mut four, mut two) = ([[0; 8]; 4], [[0; 4]; 4], [[0; 2]; 4]);
                if sums.over {
                    level::<true, _, _>(&ray, sums, &mut eight);
                    level::<true, _, _>(&eight, sums, &mut four);
                    level::<true, _, _>(&four, sums, &mut two);
                    level::<true, _, _>(&two, sums, &mut rgba);
                } else {
                    level::<false, _, _>(&ray, sums, &mut eight);
                    level::<false, _, _>(&eight, sums, &mut four);
                    level::<false, _, _>(&four, sums, &mut two);
                    level::<false, _, _>(&two, sums, &mut rgba);
                }
            },
        );
        Node { present: true, sample: 0, rgba: rgba.map(|[word]| word.into()) }
    }
}

/// Opacities in the accumulators' width and colours weighted by them, and a bit for each lane that is not transparent.
#[inline(always)]
fn weighted(
    alpha: &LaneBlock<u32>,
    colours: &[LaneBlock<u32>; 3],
    opacity: UnitResize,
    colour: UnitResize,
    product: UnitMul,
    [red, green, blue, through]: &mut [LaneBlock<u32>; 4],
) -> u16 {
    for i in 0..BLOCK_LANES {
        let a = opacity.apply_narrow(alpha[i]);
        red[i] = colour.apply_narrow(colours[0][i]).unit_mul(a, product);
        green[i] = colour.apply_narrow(colours[1][i]).unit_mul(a, product);
        blue[i] = colour.apply_narrow(colours[2][i]).unit_mul(a, product);
        through[i] = a;
    }
    let mut seen = [0; BLOCK_LANES];
    for i in 0..BLOCK_LANES {
        seen[i] = if alpha[i] == 0 { 0 } else { 1_u32 << i };
    }
    seen.iter().fold(0, |word, bit| word | bit) as u16
}

/// A level of a tree: each node is made of two neighbours, of which the left one hides the right one where it is `OVER` it.
#[inline(always)]
fn level<const OVER: bool, const N: usize, const HALF: usize>(
    nodes: &[[u32; N]; 4],
    sums: Sums,
    [red, green, blue, alpha]: &mut [[u32; HALF]; 4],
) {
    for i in 0..HALF {
        let (left, right) = (2 * i, 2 * i + 1);
        if OVER {
            let through = sums.full - nodes[3][left];
            red[i] = nodes[0][left] + through.unit_mul(nodes[0][right], sums.product);
            green[i] = nodes[1][left] + through.unit_mul(nodes[1][right], sums.product);
            blue[i] = nodes[2][left] + through.unit_mul(nodes[2][right], sums.product);
            alpha[i] = nodes[3][left] + through.unit_mul(nodes[3][right], sums.product);
        } else {
            red[i] = nodes[0][left] + nodes[0][right];
            green[i] = nodes[1][left] + nodes[1][right];
            blue[i] = nodes[2][left] + nodes[2][right];
            alpha[i] = nodes[3][left] + nodes[3][right];
        }
    }
}
