//! What a probe sees of a comparing node and of a pixel, and where a sum begins to overflow.

use cube3_cone::golden::{Node, combine_wires, pixel, pixel_wires};
use cube3_frame::ConeRegisters;
use cube3_machine::ConeOrder;
use cube3_scene::Mode;
use cube3_word::{Probe, Rounding, Words, unit_full};

/// Wires by name and place, with their values.
#[derive(Default)]
struct Wires(Vec<(&'static str, usize, i128)>);

impl Probe for Wires {
    fn wire(&mut self, name: &'static str, place: usize, value: i128) {
        self.0.push((name, place, value));
    }

    fn within<R>(&mut self, _: &'static str, _: usize, work: impl FnOnce(&mut Self) -> R) -> R {
        work(self)
    }
}

#[test]
fn a_comparing_node_shows_by_how_much_the_right_word_is_the_larger() {
    let of = |sample| Node { present: true, sample, rgba: [1, 2, 3, 4] };
    for (left, right) in [(0, 0), (3, 5), (5, 3), (0, i32::MAX), (i32::MAX, 0)] {
        let order = i128::from(right) - i128::from(left);
        for (mode, wins) in [(Mode::Maximum, order > 0), (Mode::Minimum, order < 0)] {
            let mut wires = Wires::default();
            let node = combine_wires(mode, of(left), of(right), &Words::default(), &mut wires);
            assert_eq!(node.sample, if wins { right } else { left }, "{mode} of {left} and {right}");
            assert_eq!(wires.0, [("order", 0, order), ("wins", 0, i128::from(wins))]);
        }
    }
}

#[test]
fn a_sum_overflows_above_white_and_not_at_it() {
    for accumulator_bits in [1, 2, 8, 16, 31, 32] {
        let words = Words { accumulator_bits, ..Words::default() };
        let full = u64::from(unit_full(accumulator_bits));
        // With a weight of 1 the mean is the sum.
        let cone = ConeRegisters {
            mode: Mode::WeightedSum,
            order: ConeOrder::Tree,
            leaves: 1,
            opaque: 1,
            sum_weight: 1 << ConeRegisters::WEIGHT_BITS,
        };
        let sums = [full - 1, full, full + 1, 2 * full + 1];
        let node = Node { present: true, sample: 0, rgba: sums };
        let mut wires = Wires::default();
        let counted = pixel_wires(node, &cone, &words, &mut wires);
        assert_eq!(counted.value.map(u64::from), [full - 1, full, full, full]);
        assert_eq!(counted.overflows, 2);
        assert_eq!(counted, pixel(node, &cone, &words));
        let overflow: Vec<_> = wires.0.into_iter().filter(|(name, ..)| *name == "overflow").collect();
        assert_eq!(overflow, [("overflow", 0, 0), ("overflow", 1, 0), ("overflow", 2, 1), ("overflow", 3, 1)]);
    }
}

#[test]
fn a_mean_is_rounded_as_the_words_say() {
    let cone = |sum_weight| ConeRegisters {
        mode: Mode::WeightedSum,
        order: ConeOrder::Tree,
        leaves: 1,
        opaque: 1,
        sum_weight,
    };
    let node = Node { present: true, sample: 0, rgba: [1, 2, 3, 5] };
    let one = 1_u64 << ConeRegisters::WEIGHT_BITS;
    for (rounding, half, fourth) in
        [(Rounding::Nearest, [1, 1, 2, 3], [0, 1, 1, 1]), (Rounding::Truncate, [0, 1, 1, 2], [0, 0, 0, 1])]
    {
        let words = Words { rounding, ..Words::default() };
        assert_eq!(pixel(node, &cone(one / 2), &words).value, half, "{rounding:?}");
        assert_eq!(pixel(node, &cone(one / 4), &words).value, fourth, "{rounding:?}");
        // Just below one half.
        assert_eq!(pixel(node, &cone(one / 2 - 1), &words).value[0], 0, "{rounding:?}");
    }
}
