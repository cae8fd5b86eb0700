//! What words cost, in bits: cells of logic, and bits of tables and buffers.
//!
//! The operators are those of [`cube3_resources`], one for one, here with the width that each has for given words. A multiplier
//! of a by b bits is a·b cells (an adder cell for each pair of bits); an adder, subtracter or comparator of w bits is w cells; a
//! divider is a cell for each bit of divisor and quotient. Pipeline registers, multiplexers and control are not counted.

use cube3_cone::ConeSpec;
use cube3_frame::{ConeRegisters, FrameSetup, GradientScale, HalfSpace, LARGEST_SIDE, LinearFactor};
use cube3_machine::OperatorCounts;
use cube3_machine::{GradientMethod, MachineSpec, ShadingUnit};
use cube3_resources::{FRAME_BUFFER, memory};
use cube3_scene::{MOST_CUTS, MOST_LIGHTS};
use cube3_word::Rounding;
use serde::Serialize;

/// What a design costs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Cost {
    /// Cells of all operators of the machine.
    pub logic_bits: u64,
    /// Bits of tables, templates, skewed buffers and planes of samples: all memory but the frame buffer.
    pub memory_bits: u64,
    /// Bits of the frame buffer, which is no part of [`Cost::total_bits`].
    pub frame_buffer_bits: u64,
}

impl Cost {
    /// Logic and memory.
    pub fn total_bits(&self) -> u64 {
        self.logic_bits + self.memory_bits
    }
}

/// Operators of one part, with the cells of all of them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PartCost {
    /// The part, named as in [`cube3_resources`].
    pub part: &'static str,
    /// How many there are.
    pub count: u64,
    /// Operators of each.
    pub operators: OperatorCounts,
    /// Cells of each.
    pub cells: u64,
}

/// Operators while they are added up, with their cells.
#[derive(Clone, Copy, Default)]
struct Sum {
    operators: OperatorCounts,
    cells: u64,
}

impl Sum {
    fn multipliers(mut self, count: u64, a: u64, b: u64) -> Sum {
        self.operators.multipliers += count;
        self.cells += count * a * b;
        self
    }

    fn adders(mut self, count: u64, width: u64) -> Sum {
        self.operators.adders += count;
        self.cells += count * width;
        self
    }

    fn comparators(mut self, count: u64, width: u64) -> Sum {
        self.operators.comparators += count;
        self.cells += count * width;
        self
    }

    fn dividers(mut self, count: u64, quotient: u64, divisor: u64) -> Sum {
        self.operators.dividers += count;
        self.cells += count * quotient * divisor;
        self
    }

    fn and(mut self, count: u64, other: Sum) -> Sum {
        self.operators = [self.operators, other.operators.times(count)].into_iter().sum();
        self.cells += count * other.cells;
        self
    }
}

/// The cost of a machine for a volume of `dims` voxels and a parallel frame.
pub fn cost(machine: &MachineSpec, dims: [usize; 3], setup: &FrameSetup) -> Cost {
    let logic_bits = parts(machine, setup).iter().map(|part| part.count * part.cells).sum();
    let memory = memory(machine, dims, std::slice::from_ref(setup));
    let of = |frame_buffer: bool| {
        memory.iter().filter(|kind| (kind.what == FRAME_BUFFER) == frame_buffer).map(|kind| kind.bits).sum()
    };
    Cost { logic_bits, memory_bits: of(false), frame_buffer_bits: of(true) }
}

/// Operators of each part.
pub fn parts(machine: &MachineSpec, setup: &FrameSetup) -> Vec<PartCost> {
    let words = &machine.words;
    // The adder that rounds to nearest, where any bits are dropped.
    let rounds = |dropped: u64| u64::from(words.rounding == Rounding::Nearest && dropped > 0);
    let round = rounds(words.weight_bits.into());
    let lanes = machine.lanes as u64;
    let sample = u64::from(words.sample_bits());
    let fraction = u64::from(words.weight_bits) + 1;
    let none = Sum::default();
    let mut parts = Vec::new();
    let mut part = |part: &'static str, count: u64, each: Sum| {
        if each.operators != OperatorCounts::default() && count > 0 {
            parts.push(PartCost { part, count, operators: each.operators, cells: each.cells });
        }
    };
    // A difference has a bit more than its operands; a weight holds 1 too.
    let lerp = none
        .adders(1, sample + 1)
        .multipliers(1, sample + 1, fraction)
        .adders(round, sample + 1 + fraction)
        .adders(1, sample);
    part("trilin", lanes, none.and(u64::from(machine.trilin.reuse.lerps()), lerp));

    let method = machine.abc.gradient;
    let (each, difference) = gradient(method, sample, fraction, round, lerp);
    part("abc: gradient", lanes, each);
    let kept = setup.gradient.and_then(|registers| registers.scale).map_or(0, |scale| u64::from(scale.kept_bits));
    if method.row().normalised {
        let factor = u64::from(GradientScale::FACTOR_BITS) + 1;
        part(
            "abc: gradient scale",
            lanes,
            none.multipliers(3, difference, factor).adders(3 * rounds(factor - 1 - kept), difference + factor),
        );
    }
    // The difference without what is dropped is compared with both ends of the word.
    let gradient_word = u64::from(words.gradient_bits) + kept;
    let round_word = rounds(u64::from(words.gradient_drop()) + u64::from(method.row().extra_bits()));
    let dropped = gradient_word + difference - (sample + 1) - u64::from(method.row().extra_bits());
    part("abc: gradient word", lanes, none.adders(3 * round_word, difference + kept).comparators(6, dropped));

    let normal = u64::from(words.normal_bits);
    let normaliser = none
        .adders(3, gradient_word)
        .multipliers(3, normal, normal)
        .adders(2, 2 * normal + 2)
        .multipliers(3, normal, normal + 1)
        .adders(3, 2 * normal + 1)
        .comparators(3, normal + 1)
        .adders(3, normal);
    part("abc: normaliser", lanes, normaliser);
    part("abc: magnitude", lanes, none.multipliers(3, normal, normal).adders(3, 2 * normal + 2));

    // Intensities are below 16; eight lights of them are below 2⁸.
    let colour = u64::from(words.colour_bits);
    let (intensity, light_sum) = (colour + 4, colour + 8);
    match machine.abc.shading {
        ShadingUnit::Phong => {
            let one_bits = normal - 1;
            let cosine = none
                .multipliers(3, normal, normal)
                .adders(2 + 1 + rounds(one_bits), 2 * normal + 2)
                .comparators(1, normal + 1);
            let light = none
                .and(2, cosine)
                .adders(rounds(one_bits.saturating_sub(machine.abc.power_bits.into())), normal)
                .multipliers(3, intensity, normal)
                .adders(3 * rounds(one_bits), intensity + normal)
                .multipliers(3, intensity, colour + 1)
                .adders(3 * rounds(colour), intensity + colour + 1)
                .adders(6, light_sum);
            part("abc: a light", lanes * lights(setup), light);
        }
        ShadingUnit::ReflectanceTable => {
            let bits = u64::from(machine.abc.reflectance_bits);
            let direction = none
                .adders(3, gradient_word)
                .comparators(2, gradient_word)
                .dividers(2, bits, gradient_word)
                .comparators(2, bits)
                .adders(2, bits);
            part("abc: direction", lanes, direction);
        }
    }
    let lit = none
        .multipliers(3, colour, light_sum)
        .adders(3 * rounds(colour), colour + light_sum)
        .adders(3, light_sum)
        .comparators(3, light_sum);
    part("abc: lit colour", lanes, lit);
    part("abc: threshold and row", lanes, none.comparators(2, sample).comparators(1, gradient_word + 1));
    // Linear functions of ray and depth do not depend on the words: fractions, and the places of the largest volume.
    let place = u64::from(LARGEST_SIDE.ilog2()) + 1;
    let (cue, factor) = (u64::from(LinearFactor::FRACTION_BITS) + place, u64::from(LinearFactor::WORD_BITS) + 1);
    let depth_cue = none
        .adders(1, cue)
        .comparators(2, cue)
        .multipliers(3, colour, factor)
        .adders(3 * rounds(factor - 1), colour + factor);
    part("abc: depth cue", lanes, depth_cue);
    let clip = u64::from(HalfSpace::FRACTION_BITS) + place;
    let clips = MOST_CUTS as u64 + 6;
    part("abc: cut planes and crop box", lanes, none.adders(clips, clip).comparators(clips, clip));

    let accumulator = u64::from(words.accumulator_bits);
    let unit_mul = none.multipliers(1, accumulator, accumulator).adders(2, 2 * accumulator);
    part("cone: leaf", lanes, none.and(3, unit_mul).comparators(1, words.opacity_bits.into()));
    // Sums of a weighted sum grow with the depth.
    let sum = accumulator + u64::from(setup.geometry.size[2].next_power_of_two().ilog2());
    let node = none.adders(1, accumulator).comparators(1, sample).and(4, unit_mul).adders(4, sum);
    part("cone: node", ConeSpec::of(machine, machine.lanes).nodes() as u64, node);
    let weight = u64::from(ConeRegisters::WEIGHT_BITS) + 1;
    part(
        "cone: weight of a sum",
        1,
        none.multipliers(4, sum, weight).adders(4 * rounds(weight - 1), sum + weight).comparators(4, sum),
    );
    parts
}

/// Operators of a gradient estimator, and the width of its differences.
fn gradient(method: GradientMethod, sample: u64, fraction: u64, round: u64, lerp: Sum) -> (Sum, u64) {
    let none = Sum::default();
    let (row, pairs) = (method.row(), u64::from(method.row().pairs()));
    // The differences of each component, and their sum.
    let sums = none.adders(3 * pairs, sample + 1).adders(3 * (pairs - 1), sample + 1 + u64::from(row.extra_bits()));
    let difference = sample + 1 + u64::from(row.extra_bits());
    let all = sums.and(u64::from(row.lerps()), lerp);
    if !row.sheared {
        return (all, difference);
    }
    let along = difference + fraction + 1;
    let shear =
        none.multipliers(2, difference, fraction).adders(1, along).adders(round, along).adders(1, difference + 2);
    (all.and(1, shear), difference + 2)
}

/// Lights that the shading units hold: those of the frame, or one.
fn lights(setup: &FrameSetup) -> u64 {
    match &setup.shading {
        Some(cube3_frame::Shading::Phong(phong)) => phong.lights.len().clamp(1, MOST_LIGHTS) as u64,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::super::wire::{Design, Order, Variant, Wire, uniform, widest};
    use super::*;
    use cube3_cases::cases;
    use cube3_host::{VolumeInfo, frame_setup};
    use cube3_machine::{Abc, GradientMethod};
    use cube3_scene::{Scene, View};
    use cube3_word::Words;
    use proptest::prelude::*;

    const DIMS: [usize; 3] = [16; 3];

    fn setup(machine: &MachineSpec, spacing: [f64; 3]) -> FrameSetup {
        let scene = Scene { view: View::from_direction([0.5, 0.25, 1.0], None), ..Scene::default() };
        let volume = VolumeInfo { dims: DIMS, spacing, window: [0.0, 255.0] };
        frame_setup(&scene, machine, &volume, true).unwrap().setup
    }

    fn of(machine: &MachineSpec, spacing: [f64; 3]) -> Cost {
        cost(machine, DIMS, &setup(machine, spacing))
    }

    /// The same parts with the same operators as the resources of a run.
    #[test]
    fn operators_are_those_of_the_resources() {
        for (method, _) in GradientMethod::ALL {
            for shading in [ShadingUnit::Phong, ShadingUnit::ReflectanceTable] {
                for variant in Variant::ALL {
                    let machine = MachineSpec {
                        lanes: 16,
                        abc: Abc { gradient: method, shading, ..Abc::default() },
                        ..MachineSpec::default()
                    };
                    let machine = Design::of(Words::default(), variant).machine(&machine);
                    let setup = setup(&machine, [1.0, 1.0, 1.5]);
                    let found = parts(&machine, &setup);
                    let expected = cube3_resources::operators(&machine, std::slice::from_ref(&setup));
                    assert_eq!(found.len(), expected.len());
                    for (found, expected) in found.iter().zip(expected) {
                        assert_eq!(
                            (found.part, found.count, found.operators),
                            (expected.part.as_str(), expected.count, expected.each),
                            "{method:?} {shading:?} {variant:?}"
                        );
                    }
                }
            }
        }
    }

    /// By hand, for a machine of one lane: three lerps of 8-bit samples with 4-bit weights.
    #[test]
    fn a_lerp_is_a_multiplier_of_difference_and_weight() {
        let words = Words { voxel_bits: 8, weight_bits: 4, gradient_bits: 9, table_bits: 8, ..Words::default() };
        for (rounding, round) in [(Rounding::Nearest, 14), (Rounding::Truncate, 0)] {
            let machine = MachineSpec { lanes: 1, words: Words { rounding, ..words }, ..MachineSpec::default() };
            let trilin = parts(&machine, &setup(&machine, [1.0; 3])).remove(0);
            assert_eq!((trilin.part, trilin.cells), ("trilin", 3 * (9 + 9 * 5 + round + 8)));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(256) })]

        #[test]
        fn a_longer_word_costs_more(
            wire in 0_usize..10, start in 4_u32..=16, method in 0_usize..7, table: bool, truncated: bool, wide: bool,
            long_voxels: bool,
        ) {
            let wire = Wire::ALL[wire];
            let variant = Variant { order: Order::Tree, truncated };
            let spacing = if long_voxels { [1.0, 1.0, 2.0] } else { [1.0; 3] };
            let shading = if table { ShadingUnit::ReflectanceTable } else { ShadingUnit::Phong };
            let machine = MachineSpec {
                lanes: 4,
                abc: Abc { gradient: GradientMethod::ALL[method].0, shading, ..Abc::default() },
                ..MachineSpec::default()
            };
            let words = if wide { widest(variant.rounding()) } else { uniform(start, variant.rounding()) };
            let costs: Vec<(Words, Cost)> = wire
                .lengths()
                .map(|bits| (bits, wire.with(words, bits)))
                .filter(|(bits, words)| wire.of(words) == *bits)
                .map(|(_, words)| (words, of(&Design::of(words, variant).machine(&machine), spacing)))
                .collect();
            for pair in costs.windows(2) {
                let [short, long] = [pair[0].1, pair[1].1];
                // The index over the magnitude is read by two-dimensional tables only; and a gradient that drops nothing has no
                // adders that round.
                let same = wire == Wire::TableGradient && short == long;
                let unrounded = wire == Wire::Gradient && !truncated && pair[1].0.gradient_drop() == 0;
                prop_assert!(short.total_bits() < long.total_bits() || same || unrounded, "{wire:?}: {pair:?}");
            }
        }
    }
}
