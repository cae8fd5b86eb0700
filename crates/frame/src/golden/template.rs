//! Columns and weights of a template.

use crate::bits::SLOPE_FRACTION_BITS;
use cube3_machine::TemplateRule;

/// The largest legal offset of a rule, as a fraction of `weight_bits` rounded down: equation (3) of the paper for the
/// sample floor, just below 1 for the plane floor, and 0 for the nearest voxel.
pub fn largest_offset(rule: TemplateRule, slopes: [u32; 2], weight_bits: u32) -> u32 {
    match rule {
        TemplateRule::SampleFloor => {
            let room = (1_u64 << SLOPE_FRACTION_BITS) - u64::from(slopes[0].max(slopes[1]));
            let bound = ((room << weight_bits) >> SLOPE_FRACTION_BITS) as u32;
            bound.min((1 << weight_bits) - 1)
        }
        TemplateRule::PlaneFloor => (1 << weight_bits) - 1,
        TemplateRule::Nearest => 0,
    }
}

/// X(k) in exact integers.
pub(crate) fn column(rule: TemplateRule, slope: u32, offset: u32, weight_bits: u32, k: usize) -> u32 {
    match rule {
        TemplateRule::SampleFloor => {
            (position(slope, offset, weight_bits, k) >> (SLOPE_FRACTION_BITS + weight_bits)) as u32
        }
        TemplateRule::PlaneFloor => ((k as u64 * u64::from(slope)) >> SLOPE_FRACTION_BITS) as u32,
        TemplateRule::Nearest => {
            ((k as u64 * u64::from(slope) + (1 << (SLOPE_FRACTION_BITS - 1))) >> SLOPE_FRACTION_BITS) as u32
        }
    }
}

/// The sample's displacement `(k+o)·du`, a fraction of slope and weight bits.
fn position(slope: u32, offset: u32, weight_bits: u32, k: usize) -> u64 {
    (((k as u64) << weight_bits) + u64::from(offset)) * u64::from(slope)
}

/// The weight before it is rounded, `p − lerp(X(k), X(k+1), o)`, a fraction of slope and weight bits.
pub(crate) fn exact_weight(rule: TemplateRule, slope: u32, offset: u32, weight_bits: u32, k: usize) -> i64 {
    let near = i64::from(column(rule, slope, offset, weight_bits, k));
    let far = i64::from(column(rule, slope, offset, weight_bits, k + 1));
    let left = (near << weight_bits) + (far - near) * i64::from(offset);
    position(slope, offset, weight_bits, k) as i64 - (left << SLOPE_FRACTION_BITS)
}

/// The weight of a sample between its column and the next, rounded to nearest; none by the rule of the nearest voxel.
pub(crate) fn weight(rule: TemplateRule, slope: u32, offset: u32, weight_bits: u32, k: usize) -> u32 {
    if rule == TemplateRule::Nearest {
        return 0;
    }
    let half = 1_i64 << (SLOPE_FRACTION_BITS - 1);
    ((exact_weight(rule, slope, offset, weight_bits, k) + half) >> SLOPE_FRACTION_BITS) as u32
}
