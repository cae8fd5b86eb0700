//! The same reduction for one ray from any leaf of the circle, and for whole rows of rays at once.

use crate::golden::{Node, Segment, combine};
use cube3_abc::ShadedSamples;
use cube3_abc::lanes::ShadedRow;
use cube3_frame::ConeRegisters;
use cube3_machine::ConeOrder;
use cube3_scene::Mode;
use cube3_word::{BLOCK_LANES, LaneBlock, UnitMul, UnitResize, Words, unit_full, vectorised};
use std::ops::Range;

/// A tree over the leaves of one ray among those of a circle, in the order of the circle from its start: `leaves[0]` is the leaf
/// at place `first` behind the start. Equals the ray's segment of [`circle`](crate::golden::circle): places of other rays have nothing. The leaves are
/// overwritten.
pub fn tree_of_ray(leaves: &mut [Node], first: usize, mode: Mode, words: &Words) -> Node {
    let (mut first, mut end) = (first, first + leaves.len());
    // One node is left: the levels above it pass it on.
    while end > first + 1 {
        let (from, to) = (first / 2, (end - 1) / 2 + 1);
        for node in from..to {
            // A level is made in the place of the one before, which it never overtakes.
            let child =
                |place: usize| if (first..end).contains(&place) { leaves[place - first] } else { Node::default() };
            let combined = combine(mode, child(2 * node), child(2 * node + 1), words);
            leaves[node - from] = combined;
        }
        (first, end) = (from, to);
    }
    leaves.first().copied().unwrap_or_default()
}

/// The same front to back, for a chain or an accumulator: `of(depth)` is the sample at a depth.
pub fn in_order(depths: usize, of: impl Fn(usize) -> Segment, mode: Mode, words: &Words) -> Vec<Segment> {
    in_order_by(depths, of, &mut |left, right| combine(mode, left, right, words))
}

/// [`in_order`] with `node(left, right)` for each node.
#[inline]
pub fn in_order_by(
    depths: usize,
    of: impl Fn(usize) -> Segment,
    node: &mut impl FnMut(Node, Node) -> Node,
) -> Vec<Segment> {
    let mut segments: Vec<Segment> = Vec::new();
    for next in (0..depths).map(of) {
        match segments.last_mut().filter(|last| last.ray == next.ray) {
            Some(last) => last.node = node(last.node, next.node),
            None => segments.push(next),
        }
    }
    segments
}

/// Appends the segments of what lies behind.
pub fn join(left: &mut Vec<Segment>, right: Vec<Segment>, mode: Mode, words: &Words) {
    join_by(left, right, &mut |left, right| combine(mode, left, right, words));
}

/// [`join`] with `node(left, right)` for the node that joins two stretches of a ray.
#[inline]
pub fn join_by(left: &mut Vec<Segment>, right: Vec<Segment>, node: &mut impl FnMut(Node, Node) -> Node) {
    let mut right = right.into_iter();
    if let Some(last) = left.last_mut()
        && let Some(first) = right.next()
    {
        if last.ray == first.ray {
            last.node = node(last.node, first.node);
        } else {
            left.push(first);
        }
    }
    left.extend(right);
}

/// A word of the accumulators in a lane: 32 bits where the accumulators have 16 at most, else 64.
pub trait Accumulator: Copy + Default + PartialEq + Send + Sync {
    /// From a word of at most 32 bits.
    fn of(word: u32) -> Self;
    /// As a wide word.
    fn wide(self) -> u64;
    /// Sum.
    fn plus(self, other: Self) -> Self;
    /// Product of unit words.
    fn unit_mul(self, other: Self, product: UnitMul) -> Self;
    /// `full − self`.
    fn complement(self, full: u32) -> Self;
}

macro_rules! accumulator {
    ($word:ty, $product:ident) => {
        impl Accumulator for $word {
            #[inline(always)]
            fn of(word: u32) -> Self {
                word as $word
            }
            #[inline(always)]
            fn wide(self) -> u64 {
                self as u64
            }
            #[inline(always)]
            fn plus(self, other: Self) -> Self {
                self + other
            }
            #[inline(always)]
            fn unit_mul(self, other: Self, product: UnitMul) -> Self {
                product.$product(self, other)
            }
            #[inline(always)]
            fn complement(self, full: u32) -> Self {
                full as $word - self
            }
        }
    };
}

accumulator!(u32, narrow);
accumulator!(u64, wide);

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

/// A row of nodes: one for each ray from `start` on; rays beyond the row have nothing.
#[derive(Clone, Debug, Default)]
pub struct RowNode<T> {
    /// Ray u of the first node.
    pub start: i64,
    /// Red, green, blue, opacity.
    pub rgba: [Vec<T>; 4],
    /// Sample words in minimum and maximum; empty in other modes. A ray with nothing has the word that never wins.
    pub sample: Vec<i32>,
}

impl<T: Accumulator> RowNode<T> {
    /// How many rays.
    pub fn len(&self) -> usize {
        self.rgba[3].len()
    }

    /// Whether no ray has anything.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn clear(&mut self) {
        self.rgba.iter_mut().for_each(Vec::clear);
        self.sample.clear();
    }

    fn end(&self) -> i64 {
        self.start + self.len() as i64
    }
}

/// The cone for whole rows: rows of leaves in order of depth in, a row of pixels out.
#[derive(Clone, Debug)]
pub struct ConeLanes<T> {
    cone: ConeRegisters,
    words: Words,
    product: UnitMul,
    stack: Vec<(u32, RowNode<T>)>,
    sum: RowNode<T>,
    in_chunk: usize,
    /// Depths of a chunk: the leaves of a tree, one front to back.
    chunk: usize,
    pool: Vec<RowNode<T>>,
}

impl<T: Accumulator> ConeLanes<T> {
    /// A cone with nothing in it.
    pub fn new(cone: ConeRegisters, words: Words) -> ConeLanes<T> {
        ConeLanes {
            cone,
            words,
            product: UnitMul::new(words.accumulator_bits, words.rounding),
            stack: Vec::new(),
            sum: RowNode { start: 0, rgba: Default::default(), sample: Vec::new() },
            in_chunk: 0,
            chunk: match cone.order {
                ConeOrder::Tree => cone.leaves,
                ConeOrder::FrontToBack => 1,
            },
            pool: Vec::new(),
        }
    }

    fn empty(&mut self) -> RowNode<T> {
        self.pool.pop().unwrap_or(RowNode { start: 0, rgba: Default::default(), sample: Vec::new() })
    }

    /// The next depth: `shaded` are the samples of the rays from `start` on, `sample(lane)` their words; none is a depth
    /// without samples.
    #[inline(always)]
    pub fn push(&mut self, leaves: Option<(i64, &ShadedRow, impl Fn(usize) -> i32)>) {
        let mut node = self.empty();
        node.clear();
        if let Some((start, shaded, sample)) = leaves {
            self.leaves(start, shaded, sample, &mut node);
        }
        let mut level = 0;
        while self.stack.last().is_some_and(|(top, _)| *top == level) {
            if let Some((_, mut left)) = self.stack.pop() {
                self.combine(&mut left, &node);
                self.pool.push(std::mem::replace(&mut node, left));
                level += 1;
            }
        }
        self.stack.push((level, node));
        self.in_chunk += 1;
        if self.in_chunk == self.chunk {
            self.end_chunk();
        }
    }

    /// The next depths, which are without samples.
    pub fn pass(&mut self, depths: usize) {
        for _ in 0..depths {
            self.push(None::<(i64, &ShadedRow, fn(usize) -> i32)>);
        }
    }

    /// Leaves of a row.
    #[inline(always)]
    fn leaves(&self, start: i64, shaded: &ShadedRow, sample: impl Fn(usize) -> i32, node: &mut RowNode<T>) {
        let extreme = self.extreme();
        let (from, to) = if extreme.is_some() { (0, shaded.opacity.len()) } else { shaded.span };
        let n = to - from;
        node.start = start + from as i64;
        for row in &mut node.rgba {
            row.resize(n, T::default());
        }
        let words = &self.words;
        let bits = words.accumulator_bits;
        let opacity = &shaded.opacity[from..to];
        let [.., alpha] = &mut node.rgba;
        let alpha = &mut alpha[..n];
        let opaque = matches!(self.cone.mode, Mode::FirstOpaque | Mode::LastOpaque);
        let full = unit_full(bits);
        let widen = UnitResize::new(words.opacity_bits, bits);
        for i in 0..n {
            let word = widen.apply(opacity[i]);
            let word = if !opaque {
                word
            } else if opacity[i] >= self.cone.opaque && shaded.present[from + i] != 0 {
                full
            } else {
                0
            };
            alpha[i] = T::of(word);
        }
        let widen = UnitResize::new(words.colour_bits, bits);
        let [red, green, blue, alpha] = &mut node.rgba;
        for (out, colour) in [red, green, blue].into_iter().zip(&shaded.colour) {
            let (out, colour, alpha) = (&mut out[..n], &colour[from..to], &alpha[..n]);
            for i in 0..n {
                out[i] = T::of(widen.apply(colour[i])).unit_mul(alpha[i], self.product);
            }
        }
        if let Some(never) = extreme {
            node.sample.clear();
            node.sample.extend((0..n).map(|i| if shaded.present[i] != 0 { sample(i) } else { never }));
        }
    }

    /// The sample word that never wins, in minimum and maximum.
    fn extreme(&self) -> Option<i32> {
        match self.cone.mode {
            Mode::Maximum => Some(i32::MIN),
            Mode::Minimum => Some(i32::MAX),
            _ => None,
        }
    }

    /// `left` becomes left and right together: the node of the cone for each ray, `left` nearer to the eye.
    #[inline(always)]
    pub fn combine(&self, left: &mut RowNode<T>, right: &RowNode<T>) {
        if right.is_empty() {
            return;
        }
        if left.is_empty() {
            left.start = right.start;
        }
        self.cover(left, right.start, right.end());
        let at = (right.start - left.start) as usize;
        let n = right.len();
        let [r, g, b, a] = &mut left.rgba;
        let (r, g, b, a) = (&mut r[at..at + n], &mut g[at..at + n], &mut b[at..at + n], &mut a[at..at + n]);
        let [r2, g2, b2, a2] = &right.rgba;
        let (r2, g2, b2, a2) = (&r2[..n], &g2[..n], &b2[..n], &a2[..n]);
        match self.cone.mode {
            Mode::Composite => {
                let full = unit_full(self.words.accumulator_bits);
                let product = self.product;
                for i in 0..n {
                    let through = a[i].complement(full);
                    r[i] = r[i].plus(through.unit_mul(r2[i], product));
                    g[i] = g[i].plus(through.unit_mul(g2[i], product));
                    b[i] = b[i].plus(through.unit_mul(b2[i], product));
                    a[i] = a[i].plus(through.unit_mul(a2[i], product));
                }
            }
            Mode::WeightedSum => {
                for i in 0..n {
                    r[i] = r[i].plus(r2[i]);
                    g[i] = g[i].plus(g2[i]);
                    b[i] = b[i].plus(b2[i]);
                    a[i] = a[i].plus(a2[i]);
                }
            }
            mode => {
                let zero = T::default();
                for i in 0..n {
                    let wins = match mode {
                        Mode::FirstOpaque => a[i] == zero,
                        Mode::LastOpaque => a2[i] != zero,
                        Mode::Maximum => right.sample[i] > left.sample[at + i],
                        _ => right.sample[i] < left.sample[at + i],
                    };
                    if wins {
                        (r[i], g[i], b[i], a[i]) = (r2[i], g2[i], b2[i], a2[i]);
                        if let (Some(into), Some(from)) = (left.sample.get_mut(at + i), right.sample.get(i)) {
                            *into = *from;
                        }
                    }
                }
            }
        }
    }

    /// Widens a row to cover rays `from` to `to`.
    #[inline(always)]
    fn cover(&self, row: &mut RowNode<T>, from: i64, to: i64) {
        let before = (row.start - from).max(0) as usize;
        let after = (to - row.end()).max(0) as usize;
        let never = self.extreme().unwrap_or(0);
        let keeps_samples = self.extreme().is_some();
        if before > 0 {
            for part in &mut row.rgba {
                part.splice(0..0, std::iter::repeat_n(T::default(), before));
            }
            if keeps_samples {
                row.sample.splice(0..0, std::iter::repeat_n(never, before));
            }
            row.start -= before as i64;
        }
        if after > 0 {
            let len = row.len() + after;
            for part in &mut row.rgba {
                part.resize(len, T::default());
            }
            if keeps_samples {
                row.sample.resize(len, never);
            }
        }
    }

    #[inline(always)]
    fn end_chunk(&mut self) {
        self.in_chunk = 0;
        while self.stack.len() > 1 {
            if let (Some((_, right)), Some((level, mut left))) = (self.stack.pop(), self.stack.pop()) {
                self.combine(&mut left, &right);
                self.pool.push(right);
                self.stack.push((level, left));
            }
        }
        if let Some((_, tree)) = self.stack.pop() {
            let mut sum =
                std::mem::replace(&mut self.sum, RowNode { start: 0, rgba: Default::default(), sample: Vec::new() });
            self.combine(&mut sum, &tree);
            self.sum = sum;
            self.pool.push(tree);
        }
    }

    /// Ends the rays: `pixel(u, rgba)` for each ray that has anything; returns the words that were saturated. The cone is
    /// empty again.
    #[inline(always)]
    pub fn finish(&mut self, mut pixel: impl FnMut(i64, [u32; 4])) -> u64 {
        if self.in_chunk > 0 {
            self.end_chunk();
        }
        let mut overflows = 0;
        for i in 0..self.sum.len() {
            let node = Node { present: true, sample: 0, rgba: [0, 1, 2, 3].map(|c| self.sum.rgba[c][i].wide()) };
            let counted = crate::golden::pixel(node, &self.cone, &self.words);
            overflows += u64::from(counted.overflows);
            pixel(self.sum.start + i as i64, counted.value);
        }
        self.sum.clear();
        overflows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::golden::{leaf, pixel, reduce};
    use cube3_abc::golden::Shaded;
    use cube3_cases::cases;
    use cube3_word::Rounding;
    use proptest::prelude::*;

    /// Samples of a slot: stretches that are absent, transparent, or anything.
    fn samples(bits: [u32; 2]) -> impl Strategy<Value = Vec<Shaded>> {
        let [colour, opacity] = bits.map(unit_full);
        let any = (0..=opacity, [0..=colour, 0..=colour, 0..=colour]).prop_map(|(opacity, colour)| Shaded {
            present: true,
            sample: 1,
            opacity,
            colour: if opacity == 0 { [0; 3] } else { colour },
        });
        let clear = Shaded { present: true, ..Shaded::default() };
        let one = |kind: u8| match kind {
            0 => Just(Shaded::default()).boxed(),
            1 => Just(clear).boxed(),
            _ => any.clone().boxed(),
        };
        let one = [one(0), one(1), one(2)];
        let stretch =
            (0..3_usize, 1..20_usize).prop_flat_map(move |(kind, n)| prop::collection::vec(one[kind].clone(), n));
        prop::collection::vec(stretch, 1..6).prop_map(|stretches| stretches.concat())
    }

    fn case() -> impl Strategy<Value = (ConeRegisters, Words, Vec<Shaded>, Vec<Range<usize>>)> {
        let mode = prop::sample::select(vec![Mode::Composite, Mode::WeightedSum]);
        let leaves = prop_oneof![1_usize..=64, Just(16_usize), Just(32_usize)];
        let bits = (1_u32..=16, 1_u32..=16, 1_u32..=16, any::<bool>());
        (mode, leaves, bits).prop_flat_map(|(mode, leaves, (colour_bits, opacity_bits, accumulator_bits, truncate))| {
            let rounding = if truncate { Rounding::Truncate } else { Rounding::Nearest };
            let words = Words { colour_bits, opacity_bits, accumulator_bits, rounding, ..Words::default() };
            samples([colour_bits, opacity_bits]).prop_flat_map(move |samples| {
                let n = samples.len();
                let cone = ConeRegisters {
                    mode,
                    order: ConeOrder::Tree,
                    leaves,
                    sum_weight: (1_u64 << ConeRegisters::WEIGHT_BITS) / n as u64,
                    opaque: 1,
                };
                let range = (0..n).prop_flat_map(move |start| (Just(start), start + 1..=n));
                let ranges = prop::collection::vec(range.prop_map(|(start, end)| start..end), 1..8);
                (Just(cone), Just(words), Just(samples), ranges)
            })
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(2000) })]

        #[test]
        fn rays_of_a_slot_have_the_golden_bits((cone, words, samples, ranges) in case()) {
            let mut lanes = SlotLanes::new(&cone, &words).unwrap();
            // What the slot before left must not show.
            lanes.leaves(&ShadedSamples::new(&samples.iter().rev().copied().collect::<Vec<_>>()));
            lanes.leaves(&ShadedSamples::new(&samples));
            for range in ranges {
                let leaf = |depth: usize| {
                    if range.contains(&depth) { leaf(&samples[depth], &cone, &words) } else { Node::default() }
                };
                let leaves: Vec<Node> = (0..samples.len()).map(leaf).collect();
                let expected = pixel(reduce(&leaves, &cone, &words), &cone, &words);
                prop_assert_eq!(pixel(lanes.ray(range.clone()), &cone, &words), expected, "{:?}", range);
            }
        }
    }
}
