//! What a probe sees of a cell: seven lerps, each on its own place, with the wires of its own operands.

use cube3_cases::cases;
use cube3_trilin::golden::{Weights, cell_wires};
use cube3_word::{Probe, Words, lerp};
use proptest::prelude::*;

/// A wire by its part, the place of that, its own name and place, and its value.
type Seen = (&'static str, usize, &'static str, usize, i128);

#[derive(Default)]
struct Wires {
    part: (&'static str, usize),
    seen: Vec<Seen>,
}

impl Probe for Wires {
    fn wire(&mut self, name: &'static str, place: usize, value: i128) {
        self.seen.push((self.part.0, self.part.1, name, place, value));
    }

    fn within<R>(&mut self, part: &'static str, place: usize, work: impl FnOnce(&mut Self) -> R) -> R {
        let outer = std::mem::replace(&mut self.part, (part, place));
        let result = work(self);
        self.part = outer;
        result
    }
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn each_lerp_shows_its_operands_on_its_own_place(
        voxels: [[[u16; 2]; 2]; 2], weights in prop::array::uniform3(0_u32..=256),
    ) {
        let words = Words { weight_bits: 8, ..Words::default() };
        let corners = voxels.map(|plane| plane.map(|row| row.map(i32::from)));
        let weights = Weights { w: weights[0], u: weights[1], v: weights[2] };
        let mut expected = Vec::new();
        let mut expect = |part, place, near: i32, far: i32, weight: u32| {
            let difference = i128::from(far) - i128::from(near);
            let value = lerp(near, far, weight, words.weight_bits, words.rounding);
            expected.push((part, place, "difference", 0, difference));
            expected.push((part, place, "product", 0, difference * i128::from(weight)));
            expected.push((part, place, "step", 0, i128::from(value) - i128::from(near)));
            expected.push((part, place, "value", 0, i128::from(value)));
            value
        };
        // Edges along w on the discrete rays (u, v), (u+1, v), (u, v+1), (u+1, v+1), in this order.
        let edges = [[0, 0], [0, 1], [1, 0], [1, 1]].iter().zip(0..).map(|(&[v, u], place)| {
            expect("along_w", place, corners[0][v][u], corners[1][v][u], weights.w)
        });
        let edges: Vec<i32> = edges.collect();
        let sides = [0, 1].map(|v| expect("along_u", v, edges[2 * v], edges[2 * v + 1], weights.u));
        let sample = expect("along_v", 0, sides[0], sides[1], weights.v);
        let mut wires = Wires::default();
        prop_assert_eq!(cell_wires(corners, weights, &words, &mut wires), sample);
        prop_assert_eq!(wires.seen, expected);
    }
}
