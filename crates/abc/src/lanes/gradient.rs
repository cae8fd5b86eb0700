//! Gradients of a block from its neighbourhood, and which neighbours each estimator reads.

use super::around::{Around, HERE, Neighbour, Neighbours};
use crate::perspective::LocalBlock;
use cube3_frame::{GradientRegisters, GradientScale};
use cube3_machine::{Differences, GradientMethod};
use cube3_word::{BLOCK_LANES, LaneBlock, Shift, Words};

/// Whether a gradient method reads the neighbour at a displacement.
pub(crate) fn reads(method: GradientMethod, by: [i64; 3]) -> bool {
    let distance: i64 = by.iter().map(|x| x.abs()).sum();
    match method.row().differences {
        Differences::Central => distance == 1,
        Differences::Weighted => true,
        // The feet of the perpendiculars: behind towards lower rays and before towards higher ones.
        Differences::Feet => distance == 1 || (distance == 2 && (by[0] + by[1]) * by[2] < 0),
        // Behind on the side of the eye's lower slopes, before on the other.
        Differences::Bilinear => distance == 1 || (by[2] != 0 && by[0] * by[2] <= 0 && by[1] * by[2] <= 0),
    }
}

/// The neighbours that a frame reads; where rays may run either way, those of any of them.
pub(super) fn neighbours(method: Option<GradientMethod>, mirrored: bool) -> Vec<Neighbours> {
    let signs: &[i64] = if mirrored { &[1, -1] } else { &[1] };
    let all = (0..27).map(|place| Neighbour { place, w: place / 9, v: place / 3 % 3, u: place % 3 });
    let read = |&Neighbour { place, w, v, u }: &Neighbour| {
        let [u, v, w] = [u, v, w].map(|i| i as i64 - 1);
        let any = |method| signs.iter().any(|su| signs.iter().any(|sv| reads(method, [su * u, sv * v, w])));
        place != HERE && method.is_some_and(any)
    };
    let read: Vec<Neighbour> = all.filter(read).collect();
    read.chunks(4).map(|some| std::array::from_fn(|i| some[i.min(some.len() - 1)])).collect()
}

/// The gradient unit's lanes.
#[derive(Clone, Copy, Debug)]
pub struct GradientLanes {
    differences: Differences,
    sheared: bool,
    weights: [i32; 2],
    factors: Option<[u32; 3]>,
    lerp: Shift,
    scaling: Shift,
    whole: Shift,
    drop: Shift,
    top: i32,
    narrow: bool,
}

/// The place of a neighbour.
const fn place(w: usize, v: usize, u: usize) -> usize {
    9 * w + 3 * v + u
}

/// The four samples behind a sample that a gradient of 12 neighbours takes: along w, and also along u, along v, along both.
const BEHIND: [usize; 4] = [place(2, 1, 1), place(2, 1, 0), place(2, 0, 1), place(2, 0, 0)];

/// Those before it.
const BEFORE: [usize; 4] = [place(0, 1, 1), place(0, 1, 2), place(0, 2, 1), place(0, 2, 2)];

impl GradientLanes {
    /// Lanes for the registers of a frame.
    pub fn new(registers: GradientRegisters, words: &Words) -> GradientLanes {
        let row = registers.method.row();
        // Bits of a difference, of a product of it, and of a sum of two.
        let bits = words.sample_bits() + row.difference_bits();
        let weight_bits = words.weight_bits.max(if registers.scale.is_some() { GradientScale::FACTOR_BITS } else { 0 });
        let kept = registers.scale.map_or(0, |scale| scale.kept_bits);
        GradientLanes {
            differences: row.differences,
            sheared: row.sheared,
            weights: registers.weights.map(|weight| weight as i32),
            factors: registers.scale.map(|scale| scale.factors),
            lerp: words.rounding.by(words.weight_bits),
            scaling: words.rounding.by(GradientScale::FACTOR_BITS - kept),
            whole: words.rounding.by(GradientScale::FACTOR_BITS),
            drop: words.rounding.by(words.gradient_drop() + row.extra_bits()),
            top: ((1_i64 << (words.gradient_bits + kept - 1)) - 1) as i32,
            narrow: bits + weight_bits <= 30,
        }
    }

    /// Gradients of a block of a parallel frame, and in `overflow` how many words of each lane were saturated, added to what is there;
    /// see [`crate::golden::gradient`].
    #[inline(always)]
    pub fn run(&self, around: &Around, out: &mut [LaneBlock<i32>; 3], overflow: &mut LaneBlock<u32>) {
        if self.narrow {
            self.parallel::<false>(around, out, overflow);
        } else {
            self.parallel::<true>(around, out, overflow);
        }
    }

    #[inline(always)]
    fn parallel<const WIDE: bool>(
        &self,
        around: &Around,
        out: &mut [LaneBlock<i32>; 3],
        overflow: &mut LaneBlock<u32>,
    ) {
        let [du, dv] = self.weights;
        match self.differences {
            Differences::Central => central(around, out),
            Differences::Weighted => weighted(around, out),
            Differences::Feet => feet::<WIDE>(around, [du, dv], self.lerp, out),
            Differences::Bilinear => {
                let [u, v, w] = out;
                for i in 0..BLOCK_LANES {
                    u[i] = around[place(1, 1, 2)][i] - around[place(1, 1, 0)][i];
                    v[i] = around[place(1, 2, 1)][i] - around[place(1, 0, 1)][i];
                    let far = bilinear::<WIDE>(corners(around, BEHIND, i), du, dv, self.lerp);
                    let near = bilinear::<WIDE>(corners(around, BEFORE, i), du, dv, self.lerp);
                    w[i] = far - near;
                }
            }
        }
        if self.sheared {
            let [u, v, w] = out;
            for i in 0..BLOCK_LANES {
                w[i] -= self.along::<WIDE>([u[i], v[i]], [du, dv]);
            }
        }
        if let Some(factors) = self.factors {
            self.scale::<WIDE>(&factors.map(|factor| [factor as i32; BLOCK_LANES]), out);
        }
        self.drop_low_bits(out, overflow);
    }

    /// The same for a block of a perspective frame, each lane with weights and factors of its own. All of the block's rays run against or
    /// along u, and against or along v, as `mirrored` says; the neighbourhood is already in the mirror.
    #[inline(always)]
    pub fn run_local(
        &self,
        around: &Around,
        local: &LocalBlock,
        mirrored: [bool; 2],
        out: &mut [LaneBlock<i32>; 3],
        overflow: &mut LaneBlock<u32>,
    ) {
        if self.narrow {
            self.local::<false>(around, local, mirrored, out, overflow);
        } else {
            self.local::<true>(around, local, mirrored, out, overflow);
        }
    }

    #[inline(always)]
    fn local<const WIDE: bool>(
        &self,
        around: &Around,
        local: &LocalBlock,
        mirrored: [bool; 2],
        out: &mut [LaneBlock<i32>; 3],
        overflow: &mut LaneBlock<u32>,
    ) {
        if self.differences == Differences::Weighted {
            weighted(around, out);
        } else {
            central(around, out);
        }
        let [u, v, w] = &mut *out;
        if self.differences == Differences::Bilinear {
            let LocalBlock { behind: [behind_u, behind_v], before: [before_u, before_v], .. } = local;
            for i in 0..BLOCK_LANES {
                let far = bilinear::<WIDE>(corners(around, BEHIND, i), behind_u[i], behind_v[i], self.lerp);
                let near = bilinear::<WIDE>(corners(around, BEFORE, i), before_u[i], before_v[i], self.lerp);
                w[i] = far - near;
            }
        }
        if let Some(nearness) = &local.nearness {
            for i in 0..BLOCK_LANES {
                w[i] = self.whole.apply(i64::from(w[i]) * i64::from(nearness[i])) as i32;
            }
        }
        if self.sheared {
            let [here_u, here_v] = &local.here;
            for i in 0..BLOCK_LANES {
                w[i] -= self.along::<WIDE>([u[i], v[i]], [here_u[i], here_v[i]]);
            }
        }
        for (component, mirrored) in [u, v].into_iter().zip(mirrored) {
            if mirrored {
                component.iter_mut().for_each(|word| *word = -*word);
            }
        }
        self.scale::<WIDE>(&local.factors, out);
        self.drop_low_bits(out, overflow);
    }

    /// The part of differences along u and v that is one along the ray.
    #[inline(always)]
    fn along<const WIDE: bool>(&self, differences: [i32; 2], weights: [i32; 2]) -> i32 {
        if WIDE {
            let product = |i: usize| i64::from(differences[i]) * i64::from(weights[i]);
            self.lerp.apply(product(0) + product(1)) as i32
        } else {
            self.lerp.apply32(differences[0] * weights[0] + differences[1] * weights[1])
        }
    }

    #[inline(always)]
    fn scale<const WIDE: bool>(&self, factors: &[LaneBlock<i32>; 3], [u, v, w]: &mut [LaneBlock<i32>; 3]) {
        for i in 0..BLOCK_LANES {
            u[i] = mul::<WIDE>(u[i], factors[0][i], self.scaling);
            v[i] = mul::<WIDE>(v[i], factors[1][i], self.scaling);
            w[i] = mul::<WIDE>(w[i], factors[2][i], self.scaling);
        }
    }

    /// Drops the low bits of scaled differences, and holds them to the gradient's word.
    #[inline(always)]
    fn drop_low_bits(&self, [u, v, w]: &mut [LaneBlock<i32>; 3], overflow: &mut LaneBlock<u32>) {
        let GradientLanes { drop, top, .. } = *self;
        for i in 0..BLOCK_LANES {
            let dropped = [drop.apply32(u[i]), drop.apply32(v[i]), drop.apply32(w[i])];
            u[i] = dropped[0].clamp(-top - 1, top);
            v[i] = dropped[1].clamp(-top - 1, top);
            w[i] = dropped[2].clamp(-top - 1, top);
            overflow[i] +=
                u32::from(u[i] != dropped[0]) + u32::from(v[i] != dropped[1]) + u32::from(w[i] != dropped[2]);
        }
    }
}

#[inline(always)]
fn corners(around: &Around, places: [usize; 4], i: usize) -> [i32; 4] {
    [around[places[0]][i], around[places[1]][i], around[places[2]][i], around[places[3]][i]]
}

/// Central differences.
#[inline(always)]
fn central(around: &Around, [u, v, w]: &mut [LaneBlock<i32>; 3]) {
    for i in 0..BLOCK_LANES {
        u[i] = around[place(1, 1, 2)][i] - around[place(1, 1, 0)][i];
        v[i] = around[place(1, 2, 1)][i] - around[place(1, 0, 1)][i];
        w[i] = around[place(2, 1, 1)][i] - around[place(0, 1, 1)][i];
    }
}

/// Sums of nine differences along each axis, with weights 1, 2, 1 both ways across it.
#[inline(always)]
fn weighted(around: &Around, [u, v, w]: &mut [LaneBlock<i32>; 3]) {
    for i in 0..BLOCK_LANES {
        let sum = |pair: fn(usize, usize) -> [usize; 2]| {
            let difference = |a: usize, b: usize| {
                let [far, near] = pair(a, b);
                around[far][i] - around[near][i]
            };
            let across = |a: usize| difference(a, 0) + 2 * difference(a, 1) + difference(a, 2);
            across(0) + 2 * across(1) + across(2)
        };
        u[i] = sum(|a, b| [place(a, b, 2), place(a, b, 0)]);
        v[i] = sum(|a, b| [place(a, 2, b), place(a, 0, b)]);
        w[i] = sum(|a, b| [place(2, a, b), place(0, a, b)]);
    }
}

/// Differences of the feet of perpendiculars along u and v, and along the ray.
#[inline(always)]
fn feet<const WIDE: bool>(around: &Around, [du, dv]: [i32; 2], shift: Shift, [u, v, w]: &mut [LaneBlock<i32>; 3]) {
    for i in 0..BLOCK_LANES {
        let foot = |near: usize, far: usize, weight| lerp::<WIDE>(around[near][i], around[far][i], weight, shift);
        u[i] = foot(place(1, 1, 2), place(0, 1, 2), du) - foot(place(1, 1, 0), place(2, 1, 0), du);
        v[i] = foot(place(1, 2, 1), place(0, 2, 1), dv) - foot(place(1, 0, 1), place(2, 0, 1), dv);
        w[i] = around[place(2, 1, 1)][i] - around[place(0, 1, 1)][i];
    }
}

#[inline(always)]
fn bilinear<const WIDE: bool>(corners: [i32; 4], du: i32, dv: i32, shift: Shift) -> i32 {
    let near = lerp::<WIDE>(corners[0], corners[1], du, shift);
    let far = lerp::<WIDE>(corners[2], corners[3], du, shift);
    lerp::<WIDE>(near, far, dv, shift)
}

#[inline(always)]
fn lerp<const WIDE: bool>(near: i32, far: i32, weight: i32, shift: Shift) -> i32 {
    near + mul::<WIDE>(far - near, weight, shift)
}

/// A rounded product, in 32 bits or through 64.
#[inline(always)]
fn mul<const WIDE: bool>(a: i32, b: i32, shift: Shift) -> i32 {
    if WIDE { shift.apply(i64::from(a) * i64::from(b)) as i32 } else { shift.apply32(a * b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::golden;
    use cube3_word::Words;

    /// Whether a sample at a displacement changes a gradient.
    fn changes(method: GradientMethod, by: [i64; 3]) -> bool {
        let words = Words::default();
        let full = 1 << words.weight_bits;
        let word = |case: i32, place: i32| (case * 7919 + place * 10_429 + case * place * 631) % 20_011;
        let [u, v, w] = by.map(|i| (i + 1) as usize);
        (0..400).any(|case| {
            let weights = [case % 5, case / 5 % 5].map(|quarters| quarters * full / 4);
            let registers = GradientRegisters { method, weights, scale: None, border: 0 };
            let mut s: golden::Neighbourhood =
                [0, 1, 2].map(|w| [0, 1, 2].map(|v| [0, 1, 2].map(|u| word(case as i32, 9 * w + 3 * v + u))));
            let before = golden::gradient(&s, &registers, &words);
            s[w][v][u] += 20_000;
            golden::gradient(&s, &registers, &words) != before
        })
    }

    #[test]
    fn the_neighbours_read_are_those_that_change_a_gradient() {
        assert_eq!((neighbours(None, false), neighbours(None, true)), (Vec::new(), Vec::new()));
        for (method, _) in GradientMethod::ALL {
            let [one_way, any_way] = [false, true].map(|mirrored| neighbours(Some(method), mirrored));
            let listed = |list: &[Neighbours], place: usize| list.as_flattened().iter().any(|read| read.place == place);
            let mut farthest = [0; 2];
            for place in 0..27 {
                let [w, v, u] = [place / 9, place / 3 % 3, place % 3].map(|i| i as i64 - 1);
                let needed = |mirror: [i64; 2]| place != HERE && changes(method, [mirror[0] * u, mirror[1] * v, w]);
                if place != HERE {
                    assert_eq!(reads(method, [u, v, w]), needed([1, 1]), "{method:?} at {:?}", [u, v, w]);
                }
                for (against, farthest) in farthest.iter_mut().enumerate() {
                    if needed([1 - 2 * against as i64, 1]) {
                        *farthest = (*farthest).max((u + w).unsigned_abs() as usize);
                    }
                }
                assert_eq!(listed(&one_way, place), needed([1, 1]), "{method:?}, place {place}");
                let either_way = [[1, 1], [1, -1], [-1, 1], [-1, -1]].into_iter().any(needed);
                assert_eq!(listed(&any_way, place), either_way, "{method:?}, place {place}, rays either way");
            }
            assert_eq!([false, true].map(|against| crate::reach(method, 1, against)), farthest, "{method:?}");
        }
    }
}
