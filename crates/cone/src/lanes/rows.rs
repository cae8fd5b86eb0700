//! The cone for whole rows of rays.

use super::accumulator::Accumulator;
use crate::golden::Node;
use cube3_abc::lanes::ShadedRow;
use cube3_frame::ConeRegisters;
use cube3_machine::ConeOrder;
use cube3_scene::Mode;
use cube3_word::{UnitMul, UnitResize, Words, unit_full};

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
