//! Fans: columns, weights and valid rays follow from places and slopes, and are made again.
//!
//! The last ray's right column is that of a ray which was left out. It is as far from the last as the others are from each other, to the
//! rounding of the registers, so one of nine neighbours explains every entry.

use super::{Checked, differs, follows, length, range, ranges as each_in_range, ranges_at};
use crate::perspective::MARGIN;
use crate::{Fan, Geometry, PerspectivePass, SLOPE_FRACTION_BITS};

const RAYS: &str = "the places and slopes of the rays";

/// Lengths of the lists, and each entry by itself.
pub(super) fn ranges(fan: &Fan, path: &str, geometry: &Geometry, [steepest, farthest]: [i64; 2]) -> Checked {
    let field = |name: &str| format!("{path}.{name}");
    let (rays, depths) = (fan.starts.len(), geometry.size[2]);
    if rays == 0 {
        length(&field("starts"), 0, 1, "a pass, which has a ray in the volume")?;
    }
    length(&field("slopes"), fan.slopes.len(), rays, "the number of starts")?;
    for (name, entries) in [("near", fan.near.len()), ("right", fan.right.len()), ("weights", fan.weights.len())] {
        length(&field(name), entries, rays * depths, "the number of starts and geometry.size")?;
    }
    length(&field("valid"), fan.valid.len(), depths, "geometry.size")?;
    range(&field("first"), fan.first, -(1_i64 << 32), 1_i64 << 32)?;
    each_in_range(&field("starts"), &fan.starts, -farthest, farthest)?;
    each_in_range(&field("slopes"), &fan.slopes, -steepest, steepest)?;
    each_in_range(&field("weights"), &fan.weights, 0, 1 << geometry.weight_bits)?;
    let valid = fan.valid.iter().flatten().map(|&ray| ray as i128);
    ranges_at(|i| format!("{path}.valid[{}][{}]", i / 2, i % 2), valid, 0, rays as i128)
}

/// Places and slopes agree with the grid, and the rest with them.
pub(super) fn follows_from_rays(
    fan: &Fan,
    path: &str,
    geometry: &Geometry,
    pass: &PerspectivePass,
    columns: usize,
) -> Checked {
    rays(fan, path, pass)?;
    let shape = geometry.fan_shape();
    let count = fan.count();
    // All but the last, whose next one is there.
    let made = Fan::of(fan.first, &fan.starts, &fan.slopes, &shape);
    let last = last_ray(fan, geometry, pass);
    for k in 0..shape.depths {
        for i in 0..count {
            let (made, at) = if i + 1 < count { (&made, i) } else { (&last, 0) };
            let entry = |name: &str| format!("{path}.{name}[{}]", k * count + i);
            follow(|| entry("near"), fan.near(i, k), made.near(at, k))?;
            follow(|| entry("right"), fan.right(i, k), made.right(at, k))?;
            follow(|| entry("weights"), fan.weight(i, k), made.weight(at, k))?;
        }
    }
    let shape = &shape;
    let valid = |whole| {
        let at = move |k| if k < shape.first_depth { [0; 2] } else { fan.valid_at(k, shape, columns as i32, whole) };
        (0..shape.depths).map(at)
    };
    let wrong = |whole: &usize| valid(*whole).zip(&fan.valid).filter(|(made, given)| made != *given).count();
    let whole = whole(fan, pass).min_by_key(wrong).unwrap_or(count);
    for (k, made) in valid(whole).enumerate() {
        for (end, (&given, made)) in fan.valid[k].iter().zip(made).enumerate() {
            follow(|| format!("{path}.valid[{k}][{end}]"), given, made)?;
        }
    }
    Ok(())
}

/// The rays that may have samples: all, or all but the last in a fan that ends because its rays are too steep. Where the last ray is as
/// steep as they come, to the rounding of the registers, it may be either.
fn whole(fan: &Fan, pass: &PerspectivePass) -> impl Iterator<Item = usize> {
    let (count, margin) = (fan.count(), MARGIN as i64 + i64::from(pass.most_reach) + i64::from(pass.overlap));
    let beyond = fan.slopes[count - 1] - ((1 << SLOPE_FRACTION_BITS) + margin * pass.spacing[1]);
    let rounded = margin / 2 + 2;
    let [from, to] = [count - usize::from(beyond >= -rounded), count - usize::from(beyond > rounded)];
    from..=to
}

/// An entry of a list is what follows from the rays.
fn follow<T: PartialEq + std::fmt::Debug>(field: impl Fn() -> String, value: T, expected: T) -> Checked {
    if value == expected { Ok(()) } else { Err(differs(field(), value, expected, RAYS)) }
}

/// Rays are one spacing apart, and cross the grid plane at whole numbers.
fn rays(fan: &Fan, path: &str, pass: &PerspectivePass) -> Checked {
    let one = 1_i128 << SLOPE_FRACTION_BITS;
    let away = i128::from(pass.grid_plane) - pass.first_depth as i128 * one;
    // To the rounding of place, slope and plane; places on the base plane are whole.
    let rounded = |i: usize| match pass.doubled {
        true => 3 + (away.abs() + i128::from(fan.slopes[i].abs())) / one,
        false => 0,
    };
    let beside = |i: usize| {
        let crossing = i128::from(fan.starts[i]) + ((away * i128::from(fan.slopes[i])) >> SLOPE_FRACTION_BITS);
        crossing - (i128::from(fan.first) + i as i128) * one
    };
    let count = fan.count();
    if [0, count - 1].into_iter().all(|i| beside(i).abs() > rounded(i)) {
        let first = fan.first as i128 + (beside(0) + one / 2).div_euclid(one);
        follows(&format!("{path}.first"), i128::from(fan.first), first, "where the first ray crosses the grid plane")?;
    }
    for i in 0..count {
        let off = beside(i);
        if off.abs() > rounded(i) {
            let start = i128::from(fan.starts[i]);
            let from = "the ray's number and its slope";
            follows(&format!("{path}.starts[{i}]"), start, start - off, from)?;
        }
    }
    for (list, values, step) in [("starts", &fan.starts, pass.spacing[0]), ("slopes", &fan.slopes, pass.spacing[1])] {
        for (i, pair) in values.windows(2).enumerate() {
            let next = format!("{path}.{list}[{}]", i + 1);
            range(&next, pair[1], pair[0] + step - 1, pair[0] + step + 1)?;
        }
    }
    Ok(())
}

/// The last ray of a fan alone, with the neighbour that explains most of its entries.
fn last_ray(fan: &Fan, geometry: &Geometry, pass: &PerspectivePass) -> Fan {
    let (shape, last) = (geometry.fan_shape(), fan.count() - 1);
    let [start, slope] = [fan.starts[last], fan.slopes[last]];
    let with_next = |by: [i64; 2]| {
        let next = [start + pass.spacing[0] + by[0], slope + pass.spacing[1] + by[1]];
        Fan::of(fan.first + last as i64, &[start, next[0]], &[slope, next[1]], &shape)
    };
    let wrong = |made: &Fan| {
        (0..shape.depths)
            .filter(|&k| made.right(0, k) != fan.right(last, k) || made.weight(0, k) != fan.weight(last, k))
            .count()
    };
    let (mut best, rest) = (with_next([0, 0]), (0..9).map(|i| [i / 3 - 1, i % 3 - 1]));
    for by in rest {
        let made = with_next(by);
        if wrong(&made) < wrong(&best) {
            best = made;
        }
    }
    best
}
