//! Pre-integrated classification, kept in the tests as a comparison: a table over the values at the front and at the back of a segment, of which
//! each entry is the exact integral of the transfer function along a value that is linear between the two (Engel, Kraus and Ertl 2001). What it
//! gains over `image_order` where the transfer function has steps, and what it does not where it is smooth.

use crate::common::order::{assert_order, order};
use crate::convergence::{Case, bowl, extinction, pixel, ramp};
use cube3_scene::{ColourPoint, Transfer};

/// ∫τ over the value, from the first point up to `value`, exactly: over a segment of slope m ∫−ln(1 − α) dv = [(1 − α)·ln(1 − α) + α]/m.
fn antiderivative(points: &[[f64; 2]], value: f64) -> f64 {
    let of_opacity = |alpha: f64| (1.0 - alpha) * (-alpha).ln_1p() + alpha;
    let (first, last) = (points[0], points[points.len() - 1]);
    let mut sum = extinction(first[1]) * (value - first[0]).min(0.0);
    for pair in points.windows(2) {
        let ([from, low], [to, high]) = (pair[0], pair[1]);
        let end = value.min(to);
        if end <= from {
            continue;
        }
        // Where opacity hardly changes the difference below has no digits.
        sum += if (high - low).abs() < 1e-6 {
            extinction(f64::midpoint(low, high)) * (end - from)
        } else {
            let at = low + (high - low) * (end - from) / (to - from);
            (of_opacity(at) - of_opacity(low)) * (to - from) / (high - low)
        };
    }
    sum + extinction(last[1]) * (value - last[0]).max(0.0)
}

/// Mean extinction along a value that is linear from `front` to `back`.
fn mean_extinction(transfer: &Transfer, front: f64, back: f64) -> f64 {
    if (back - front).abs() < 1e-9 {
        return extinction(transfer.opacity_at(f64::midpoint(front, back), 0.0));
    }
    (antiderivative(&transfer.opacity, back) - antiderivative(&transfer.opacity, front)) / (back - front)
}

/// Opacity-weighted colour and opacity of a segment of length h: ∫c·τ·e^(−∫τ), by adaptive parts between the points of the functions.
fn segment(transfer: &Transfer, front: f64, back: f64, h: f64) -> [f64; 2] {
    let opacity = -(-h * mean_extinction(transfer, front, back)).exp_m1();
    let mut kinks: Vec<f64> = transfer.opacity.iter().map(|point| point[0]).collect();
    kinks.extend(transfer.colour.iter().map(|point| point.value));
    let mut places: Vec<f64> = kinks.iter().map(|kink| (kink - front) / (back - front)).collect();
    places.retain(|place| place.is_finite() && *place > 0.0 && *place < 1.0);
    places.extend([0.0, 1.0]);
    places.sort_by(f64::total_cmp);
    let light = |place: f64| {
        let value = front + (back - front) * place;
        let depth = h * place * mean_extinction(transfer, front, value);
        let [red, _, _] = transfer.colour_at(value);
        red * h * extinction(transfer.opacity_at(value, 0.0)) * (-depth).exp()
    };
    // A function with a step has two values at it: the parts do not touch their ends.
    let part = |ends: &[f64]| gauss(&light, ends[0], ends[1], 0);
    [places.windows(2).map(part).sum(), opacity]
}

/// Gauss' rule of five points, halved until halves agree with the whole.
fn gauss(f: &impl Fn(f64) -> f64, from: f64, to: f64, depth: u32) -> f64 {
    const POINTS: [[f64; 2]; 5] = [
        [0.0, 0.568_888_888_888_888_9],
        [0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
        [-0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
        [0.906_179_845_938_664, 0.236_926_885_056_189_1],
        [-0.906_179_845_938_664, 0.236_926_885_056_189_1],
    ];
    let rule = |from: f64, to: f64| {
        let (middle, half) = (f64::midpoint(from, to), (to - from) / 2.0);
        POINTS.iter().map(|[at, weight]| half * weight * f(middle + half * at)).sum::<f64>()
    };
    let middle = f64::midpoint(from, to);
    let (whole, halves) = (rule(from, to), rule(from, middle) + rule(middle, to));
    if (whole - halves).abs() < 1e-13 || depth > 12 {
        return halves;
    }
    gauss(f, from, middle, depth + 1) + gauss(f, middle, to, depth + 1)
}

/// The table of one step's length: `side` values from 0 to `top` along each axis, linear between entries, which are made when they are asked for.
struct Table<'a> {
    transfer: &'a Transfer,
    top: f64,
    side: usize,
    h: f64,
}

impl Table<'_> {
    fn entry(&self, front: usize, back: usize) -> [f64; 2] {
        let value = |i: usize| self.top * i as f64 / (self.side - 1) as f64;
        segment(self.transfer, value(front), value(back), self.h)
    }

    fn at(&self, front: f64, back: f64) -> [f64; 2] {
        let place = |value: f64| {
            let at = (value / self.top).clamp(0.0, 1.0) * (self.side - 1) as f64;
            let index = (at as usize).min(self.side - 2);
            (index, at - index as f64)
        };
        let ((x, right), (y, down)) = (place(front), place(back));
        let entries = [0, 1].map(|j| [0, 1].map(|i| self.entry(x + i, y + j)));
        [0, 1].map(|i| {
            let row = |j: usize| entries[j][0][i] * (1.0 - right) + entries[j][1][i] * right;
            row(0) * (1.0 - down) + row(1) * down
        })
    }
}

/// A ray in so many segments, each by `look_up(front, back, h)`.
fn pre_integrated(case: &Case, steps: u32, look_up: impl Fn(f64, f64, f64) -> [f64; 2]) -> f64 {
    let h = case.length / f64::from(steps);
    let value = |i: u32| (case.value)(f64::from(i) * h);
    let front_to_back = |[colour, left]: [f64; 2], i: u32| {
        let [red, opacity] = look_up(value(i), value(i + 1), h);
        [colour + left * red, left * (1.0 - opacity)]
    };
    (0..steps).fold([0.0, 1.0], front_to_back)[0]
}

/// By a table of `side` values.
fn by_table(case: &Case, steps: u32, side: usize) -> f64 {
    let table = Table { transfer: &case.scene.transfer, top: TOP, side, h: case.length / f64::from(steps) };
    pre_integrated(case, steps, |front, back, _| table.at(front, back))
}

/// Without a table, or with one of infinitely many entries.
fn exactly(case: &Case, steps: u32) -> f64 {
    pre_integrated(case, steps, |front, back, h| segment(&case.scene.transfer, front, back, h))
}

/// A transfer function with steps, slopes and two colours.
fn jagged() -> Transfer {
    let point = |value: f64, c: f64| ColourPoint { value, rgb: [c; 3] };
    Transfer {
        opacity: vec![
            [3.0, 0.0],
            [5.0, 0.2],
            [7.0, 0.2],
            [7.0, 0.02],
            [20.0, 0.1],
            [20.0, 0.0],
            [25.0, 0.0],
            [25.0, 0.3],
        ],
        colour: vec![point(6.0, 0.2), point(6.0, 1.0), point(22.0, 0.4)],
        ..Transfer::default()
    }
}

#[test]
fn an_entry_is_the_integral_along_a_linear_value() {
    let transfer = jagged();
    for (front, back, h) in [(0.0, 32.0, 32.0), (32.0, 0.0, 3.0), (4.0, 4.5, 1.0), (6.0, 6.0, 2.0), (19.9, 20.1, 10.0)]
    {
        let [red, opacity] = segment(&transfer, front, back, h);
        let parts = 400_000;
        let (mut colour, mut left) = (0.0, 1.0);
        for i in 0..parts {
            let value = front + (back - front) * (f64::from(i) + 0.5) / f64::from(parts);
            let alpha = -(-extinction(transfer.opacity_at(value, 0.0)) * h / f64::from(parts)).exp_m1();
            colour += left * alpha * transfer.colour_at(value)[0];
            left *= 1.0 - alpha;
        }
        let off = [red - colour, opacity - (1.0 - left)];
        assert!(off.iter().all(|off| off.abs() < 1e-5), "{front} to {back} over {h}: {off:?}");
    }
}

/// Segments are linear there, so any number of them gives the same; sampling comes to it as steps shrink.
#[test]
fn where_the_value_is_linear_pre_integration_has_no_step() {
    let mut case = ramp();
    case.scene.transfer = jagged();
    let exact = exactly(&case, 1);
    for steps in [2, 3, 17, 100] {
        let got = exactly(&case, steps);
        assert!((got - exact).abs() < 1e-9, "{got}, not {exact} in {steps} segments");
    }
    let errors = [32, 1 << 9, 1 << 13].map(|steps| (pixel(&case, steps) - exact).abs());
    assert!(errors[0] > 10.0 * errors[1] && errors[1] > 10.0 * errors[2] && errors[2] < 2e-4, "{errors:?}");
}

const TOP: f64 = 1024.0;
const STEPS: [u32; 5] = [16, 32, 64, 128, 256];
const OPACITY: f64 = 0.06;

/// The bowl with a step of the transfer function where s = `place`: of opacity, or of colour in fog.
fn stepped(place: f64, of_colour: bool) -> (Case, f64) {
    let mut case = bowl();
    let value = place * place / 2.0;
    let (tau, transfer) = (extinction(OPACITY), &mut case.scene.transfer);
    if of_colour {
        let point = |c: f64| ColourPoint { value, rgb: [c; 3] };
        (transfer.opacity, transfer.colour) = (vec![[0.0, OPACITY]], vec![point(0.0), point(1.0)]);
        let exact = (-tau * place).exp() - (-tau * case.length).exp();
        return (case, exact);
    }
    transfer.opacity = vec![[value, 0.0], [value, OPACITY]];
    let exact = -(-tau * (case.length - place)).exp_m1();
    (case, exact)
}

/// The largest error over steps of the transfer function at many places: one alone may lie well.
fn worst(steps: u32, of_colour: bool, method: impl Fn(&Case, u32) -> f64) -> f64 {
    let places = (0..40).map(|i| 20.0 + 5.0 * (f64::from(i) * 0.618_033_988_75).fract());
    let error = |place: f64| {
        let (case, exact) = stepped(place, of_colour);
        (method(&case, steps) - exact).abs()
    };
    places.map(error).fold(0.0, f64::max)
}

fn lengths() -> [f64; 5] {
    STEPS.map(|steps| bowl().length / f64::from(steps))
}

#[test]
fn at_a_step_of_the_transfer_function_sampling_is_of_the_first_order_and_pre_integration_of_the_second() {
    for (what, of_colour) in [("opacity", false), ("colour", true)] {
        let sampled = STEPS.map(|steps| worst(steps, of_colour, pixel));
        let by_segments = STEPS.map(|steps| worst(steps, of_colour, exactly));
        assert_order(&format!("a step of {what}, sampled"), &lengths(), &sampled, 1.0, 0.1);
        assert_order(&format!("a step of {what}, pre-integrated"), &lengths(), &by_segments, 2.0, 0.1);
        assert!((0..5).all(|i| by_segments[i] < 0.1 * sampled[i]), "{by_segments:?} of {sampled:?}");
    }
}

/// A segment's value is above the bowl by t·(h − t)/2, h²/12 on the mean: the depth is h²/12·∫τ'(v) ds off, = √q·artanh(√q·L)·h²/6 with
/// τ = −ln(1 − q·s²); the trapezoid has the curve of τ itself, which counts the transfer function's as well.
#[test]
fn where_the_transfer_function_is_smooth_both_are_of_the_second_order() {
    let case = bowl();
    let q = case.scene.transfer.opacity[1][1] / TOP / 2.0;
    let end = case.length;
    let depth = 2.0 * end - end * (-q * end * end).ln_1p() - 2.0 * (q.sqrt() * end).atanh() / q.sqrt();
    let exact = -(-depth).exp_m1();
    let errors = STEPS.map(|steps| exactly(&case, steps) - exact);
    assert_order("smooth, pre-integrated", &lengths(), &errors, 2.0, 0.03);
    let term = (-depth).exp() * q.sqrt() * (q.sqrt() * end).atanh() / 6.0;
    let constant = errors[4] / lengths()[4].powi(2);
    assert!((constant / term - 1.0).abs() < 0.005, "{constant:e} h², not {term:e}");
    let sampled = STEPS.map(|steps| pixel(&case, steps) - exact);
    assert!((1.0..1.2).contains(&(sampled[4] / errors[4])), "nothing is gained: {sampled:?}, {errors:?}");
}

/// The table's own error: linear between its entries across a step of the transfer function, it is in proportion to their distance.
#[test]
fn a_table_of_few_entries_has_its_own_error() {
    let errors = [65, 129, 257].map(|side| worst(256, false, |case, steps| by_table(case, steps, side)));
    println!("65, 129, 257 entries: {errors:?}");
    let by_segments = worst(256, false, exactly);
    assert!(errors[0] > errors[1] && errors[1] > errors[2] && errors[2] > 10.0 * by_segments, "{errors:?}");
}

/// The table of the section "Order of convergence" in docs/src/raycast.md.
#[test]
#[ignore = "prints the book's table: cargo test --release -p cube3-reference --test all preintegration:: -- --ignored --nocapture"]
fn sampling_and_pre_integration_as_a_table() {
    println!(
        "| transfer function | method | order | h = 1.41 | h = 0.71 | h = 0.35 | h = 0.18 |\n| --- | --- | --- | --- | --- | --- | --- |"
    );
    let row = |function: &str, method: &str, errors: [f64; 5]| {
        let shown: Vec<String> = errors[1..].iter().map(|error| format!("{error:.1e}")).collect();
        println!("| {function} | {method} | {:.2} | {} |", order(&lengths(), &errors), shown.join(" | "));
    };
    for (function, of_colour) in [("step of opacity", false), ("step of colour in fog", true)] {
        row(function, "samples", STEPS.map(|steps| worst(steps, of_colour, pixel)));
        row(function, "pre-integrated", STEPS.map(|steps| worst(steps, of_colour, exactly)));
        let tabled = |steps| worst(steps, of_colour, |case, steps| by_table(case, steps, 257));
        row(function, "pre-integrated, 257² entries", STEPS.map(tabled));
    }
}
