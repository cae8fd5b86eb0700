//! Templates: the steps of the discrete rays and the weights between them, in exact integers.

use crate::SLOPE_FRACTION_BITS;
use crate::golden::template::{column, weight};
use cube3_machine::TemplateRule;
use serde::{Deserialize, Serialize};

/// One axis of a parallel view: the column of each plane and the weight of each sample.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Template {
    /// X(k) for k = 0 to n_w inclusive; starts at 0 for an offset that the rule allows, never falls, steps by 0 or 1.
    pub columns: Vec<u32>,
    /// Weight of sample k between its column and the next: a fraction of the machine's weight bits, 0 to 1.
    pub weights: Vec<u32>,
}

/// A slope as its register holds it: the nearest fraction of [`SLOPE_FRACTION_BITS`]. `slope` is 0 to 1.
pub fn slope_register(slope: f64) -> u32 {
    cube3_word::quantise_fraction(slope, SLOPE_FRACTION_BITS)
}

impl Template {
    /// The template of one axis with `depth` planes. `slope` is a register, `offset` a fraction of `weight_bits`.
    pub fn new(rule: TemplateRule, slope: u32, offset: u32, weight_bits: u32, depth: usize) -> Template {
        let columns = (0..=depth).map(|k| column(rule, slope, offset, weight_bits, k)).collect();
        let weights = (0..depth).map(|k| weight(rule, slope, offset, weight_bits, k)).collect();
        Template { columns, weights }
    }

    /// The first plane at which the column has reached `column`; the number of planes + 1 where it never does.
    pub fn first_depth(&self, column: i64) -> usize {
        self.columns.partition_point(|&x| i64::from(x) < column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::golden::template::exact_weight;
    use crate::largest_offset;
    use cube3_cases::cases;
    use proptest::prelude::*;

    fn in_unit(weight: i64, weight_bits: u32) -> bool {
        (0..=1_i64 << (SLOPE_FRACTION_BITS + weight_bits)).contains(&weight)
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn every_weight_of_the_sample_floor_is_in_the_unit_interval_up_to_the_papers_bound(
            slope in 0..=1_u32 << SLOPE_FRACTION_BITS, part in 0.0..=1.0_f64, weight_bits in 1_u32..=12, k in 0_usize..4096,
        ) {
            let bound = largest_offset(TemplateRule::SampleFloor, [slope, 0], weight_bits);
            let offset = (f64::from(bound) * part) as u32;
            let weight = exact_weight(TemplateRule::SampleFloor, slope, offset, weight_bits, k);
            prop_assert!(in_unit(weight, weight_bits), "{weight}");
        }

        #[test]
        fn every_weight_of_the_plane_floor_is_in_the_unit_interval_at_any_offset(
            slope in 0..=1_u32 << SLOPE_FRACTION_BITS, offset in 0_u32..4096, k in 0_usize..4096,
        ) {
            let weight = exact_weight(TemplateRule::PlaneFloor, slope, offset, 12, k);
            prop_assert!(in_unit(weight, 12), "{weight}");
        }

        #[test]
        fn columns_step_by_nothing_or_one(slope in 0..=1_u32 << SLOPE_FRACTION_BITS, rule in 0_usize..3) {
            let rule = [TemplateRule::SampleFloor, TemplateRule::PlaneFloor, TemplateRule::Nearest][rule];
            let offset = largest_offset(rule, [slope, 0], 8);
            let template = Template::new(rule, slope, offset, 8, 600);
            prop_assert_eq!(template.columns[0], 0);
            prop_assert!(template.columns.windows(2).all(|pair| pair[1] - pair[0] <= 1));
        }

        #[test]
        fn first_depth_is_the_first(slope in 0..=1_u32 << SLOPE_FRACTION_BITS, target in -3_i64..700) {
            let template = Template::new(TemplateRule::PlaneFloor, slope, 0, 8, 600);
            let first = template.first_depth(target);
            prop_assert!(template.columns[..first].iter().all(|&x| i64::from(x) < target));
            prop_assert!(template.columns[first..].iter().all(|&x| i64::from(x) >= target));
        }
    }

    #[test]
    fn the_nearest_column_is_half_a_voxel_away_at_most_and_ties_go_up() {
        for (slope, expected) in
            [(0.0, [0; 6]), (0.25, [0, 0, 1, 1, 1, 1]), (0.5, [0, 1, 1, 2, 2, 3]), (1.0, [0, 1, 2, 3, 4, 5])]
        {
            let template = Template::new(TemplateRule::Nearest, slope_register(slope), 0, 8, 5);
            assert_eq!(template.columns, expected, "{slope}");
            assert_eq!(template.weights, [0; 5]);
        }
    }

    #[test]
    fn beyond_the_bound_the_sample_floor_leaves_the_cell() {
        let slope = slope_register(0.75);
        let bound = largest_offset(TemplateRule::SampleFloor, [slope, 0], 8);
        assert_eq!(bound, 64);
        let outside = (0..64).any(|k| !in_unit(exact_weight(TemplateRule::SampleFloor, slope, bound + 32, 8, k), 8));
        assert!(outside, "the bound of equation (3) would not be needed");
    }

    #[test]
    fn at_forty_five_degrees_the_sample_floor_has_no_offset_and_no_weight() {
        let one = slope_register(1.0);
        assert_eq!(largest_offset(TemplateRule::SampleFloor, [one, 0], 8), 0);
        let template = Template::new(TemplateRule::SampleFloor, one, 0, 8, 8);
        assert_eq!(template.columns, (0..=8).collect::<Vec<u32>>());
        assert!(template.weights.iter().all(|&w| w == 0));
    }
}
