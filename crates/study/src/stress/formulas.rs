//! Formulas of the units at their limits against closed forms, each beside the classic one that fails there.

use super::LEVELS;
use crate::words::thin::{SAMPLES, THICKEST, ThinCase};
use crate::words::wire::Order;
use cube3_abc::golden::normalise;
use cube3_cone::golden::{Node, leaf, pixel, reduce};
use cube3_frame::{ConeRegisters, Normaliser};
use cube3_machine::ConeOrder;
use cube3_scene::{Mode, corrected_opacity};
use cube3_word::{Rounding, Words, lerp, quantise_unit, unit_full, unit_mul};
use glam::DVec3;
use std::f64::consts::LN_2;

/// A way to compute, and how far it is off at worst.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tried {
    /// The way.
    pub name: &'static str,
    /// Its worst error, in the formula's unit.
    pub error: f64,
}

/// A formula at its limits.
pub struct Formula {
    /// What is computed, and where.
    pub name: &'static str,
    /// What errors are counted in.
    pub unit: &'static str,
    /// The classic way, where one fails.
    pub classic: Option<fn() -> Tried>,
    /// Ours.
    pub ours: fn() -> Tried,
    /// The most that ours may be off by: derived in the book, page *Stress*.
    pub bound: f64,
}

/// Rounding of a formula of a few operations in 64-bit reals.
const FEW_ROUNDINGS: f64 = 8.0 * f64::EPSILON;

/// Every formula.
pub const FORMULAS: &[Formula] = &[
    Formula {
        name: "opacity of an optical depth of 1.4 to 42",
        unit: "levels",
        classic: Some(|| {
            worst("tau, at most 1", |k| LEVELS * ((k * LN_2).min(1.0) - (1.0 - (-k).exp2())).abs(), &DEPTHS)
        }),
        ours: || worst("1 - (1 - a)^l", |k| LEVELS * (corrected_opacity(0.5, k) - (1.0 - (-k).exp2())).abs(), &DEPTHS),
        bound: LEVELS * FEW_ROUNDINGS,
    },
    Formula {
        name: "opacity of half a step of 2^-20 to 2^-100",
        unit: "relative",
        classic: Some(|| {
            worst("1 - (1 - a)^l by pow", |k| off(1.0 - (1.0 - (-k).exp2()).powf(0.5), half_step(k)), &FAINT)
        }),
        ours: || worst("-expm1(l·log1p(-a))", |k| off(corrected_opacity((-k).exp2(), 0.5), half_step(k)), &FAINT),
        bound: FEW_ROUNDINGS,
    },
    Formula {
        name: "opacity of 2^-40 of a step of 1 - 2^-10 to 1 - 2^-53",
        unit: "relative",
        classic: Some(|| worst("1 - (1 - a)^l by pow", |k| off(1.0 - (-k).exp2().powf(TINY), short_step(k)), &DENSE)),
        ours: || {
            worst("-expm1(l·log1p(-a))", |k| off(corrected_opacity(1.0 - (-k).exp2(), TINY), short_step(k)), &DENSE)
        },
        bound: FEW_ROUNDINGS,
    },
    Formula {
        name: "opacity of 1e-15 and of 1e15 steps of 1/2",
        unit: "relative",
        classic: Some(|| worst("1 - (1 - a)^l by pow", |l| off(1.0 - 0.5_f64.powf(l), many_steps(l)), &STEPS)),
        ours: || worst("-expm1(l·log1p(-a))", |l| off(corrected_opacity(0.5, l), many_steps(l)), &STEPS),
        bound: FEW_ROUNDINGS,
    },
    Formula {
        name: "emission through a depth of 2^-20 to 2^-100: (1 - e^-t)/t",
        unit: "relative",
        classic: Some(|| {
            worst("(1 - e^-t)/t by exp", |k| off((1.0 - (-(-k).exp2()).exp()) / (-k).exp2(), emission(k)), &FAINT)
        }),
        ours: || worst("-expm1(-t)/t", |k| off(-libm::expm1(-(-k).exp2()) / (-k).exp2(), emission(k)), &FAINT),
        bound: FEW_ROUNDINGS,
    },
    Formula {
        name: "density of an opacity of 2^-20 to 2^-100: ln(1/(1 - A))",
        unit: "relative",
        classic: Some(|| worst("ln(1/(1 - A))", |k| off((1.0 / (1.0 - (-k).exp2())).ln(), density(k)), &FAINT)),
        ours: || worst("-log1p(-A)", |k| off(-libm::log1p(-(-k).exp2()), density(k)), &FAINT),
        bound: FEW_ROUNDINGS,
    },
    Formula {
        name: "512 faint samples, composited",
        unit: "levels",
        classic: Some(|| Tried {
            name: "in order, 8 bits cut off",
            error: faint(8, 8, Rounding::Truncate, Order::InOrder),
        }),
        ours: || Tried { name: "tree, 16 bits rounded", error: faint(16, 16, Rounding::Nearest, Order::Tree) },
        bound: LEVELS * 2.0 / 65535.0 * (SAMPLES as f64 + THICKEST * (SAMPLES * SAMPLES) as f64 / 2.0),
    },
    Formula {
        name: "fog of 512 voxels of opacity 0.0019",
        unit: "levels",
        classic: Some(|| Tried { name: "opacity of 8 bits", error: thin_fog(8) }),
        ours: || Tried { name: "opacity of 16 bits", error: thin_fog(16) },
        bound: LEVELS * 512.0 * 0.5 / 65535.0,
    },
    Formula {
        name: "place of a ray at 511 planes, in weights' last bits",
        unit: "bits of 8",
        classic: Some(|| Tried { name: "DDA of 16 fraction bits", error: template(16) }),
        ours: || Tried { name: "DDA of 17 fraction bits", error: template(17) },
        bound: 0.5,
    },
    Formula {
        name: "lerp of all words of 6 bits by all weights of 6",
        unit: "last bits",
        classic: None,
        ours: || Tried { name: "near + round(w·(far - near))", error: lerps(Rounding::Nearest) },
        bound: 0.5,
    },
    Formula {
        name: "lerp, bits cut off",
        unit: "last bits",
        classic: None,
        ours: || Tried { name: "near + floor(w·(far - near))", error: lerps(Rounding::Truncate) },
        bound: 1.0,
    },
    Formula {
        name: "product of all unit words of 1 to 8 bits",
        unit: "last bits",
        classic: None,
        ours: || Tried { name: "Blinn's rule", error: products() },
        bound: 0.5,
    },
    Formula {
        name: "normal of 15 bits of gradients of 1 to 2^23, on axes, off them, on diagonals",
        unit: "length",
        classic: Some(|| Tried {
            name: "the largest bits shifted, no root: |g| by its largest component",
            error: normals(&largest_alone),
        }),
        ours: || Tried { name: "block shift, table of reciprocal roots", error: normals(&by_table) },
        bound: normal_bound(),
    },
    Formula {
        name: "opacity and colour of 1 to 16 bits, to the nearest word",
        unit: "last bits",
        classic: None,
        ours: || Tried { name: "round(x·(2^b - 1))", error: unit_words() },
        bound: 0.5 + 1e-9,
    },
    Formula {
        name: "growth of error, bits cut off: order in the samples, less 1",
        unit: "order",
        classic: None,
        ours: || Tried { name: "in order, 24 bits cut off", error: (growth(Rounding::Truncate) - 1.0).abs() },
        bound: 0.15,
    },
    Formula {
        name: "growth of error, rounded: order in the samples, less 1/2",
        unit: "order",
        classic: None,
        ours: || Tried { name: "in order, 24 bits rounded", error: (growth(Rounding::Nearest) - 0.5).abs() },
        bound: 0.15,
    },
];

const DEPTHS: [f64; 4] = [2.0, 5.0, 20.0, 60.0];
const FAINT: [f64; 4] = [20.0, 40.0, 60.0, 100.0];
const DENSE: [f64; 3] = [10.0, 30.0, 53.0];
const STEPS: [f64; 2] = [1e-15, 1e15];
const TINY: f64 = 1.0 / (1_u64 << 40) as f64;

fn worst(name: &'static str, error: impl Fn(f64) -> f64, places: &[f64]) -> Tried {
    Tried { name, error: places.iter().map(|&k| error(k)).fold(0.0, f64::max) }
}

/// The relative error.
fn off(value: f64, expected: f64) -> f64 {
    (value / expected - 1.0).abs()
}

/// 1 − √(1 − a) for a = 2^−k by its series.
fn half_step(k: f64) -> f64 {
    let a = (-k).exp2();
    a / 2.0 * (1.0 + a / 4.0 * (1.0 + a / 2.0))
}

/// 1 − 2^(−k·ℓ) by its series.
fn short_step(k: f64) -> f64 {
    let depth = k * LN_2 * TINY;
    depth * (1.0 - depth / 2.0)
}

/// 1 − 2^−ℓ by its series, or 1.
fn many_steps(l: f64) -> f64 {
    let depth = l * LN_2;
    if depth > 1.0 { 1.0 } else { depth * (1.0 - depth / 2.0) }
}

/// (1 − e^−t)/t for t = 2^−k by its series.
fn emission(k: f64) -> f64 {
    let t = (-k).exp2();
    1.0 - t / 2.0 * (1.0 - t / 3.0)
}

/// −ln(1 − A) for A = 2^−k by its series.
fn density(k: f64) -> f64 {
    let a = (-k).exp2();
    a * (1.0 + a / 2.0 * (1.0 + a * 2.0 / 3.0))
}

/// The largest error of the study's rays.
fn faint(opacity_bits: u32, accumulator_bits: u32, rounding: Rounding, order: Order) -> f64 {
    let words =
        Words { opacity_bits, accumulator_bits, colour_bits: accumulator_bits.min(16), rounding, ..Words::default() };
    ThinCase::new().measure(&words, order).max
}

/// Fog whose opacity is a word.
fn thin_fog(bits: u32) -> f64 {
    let alpha = 0.0019;
    let word = f64::from(quantise_unit(alpha, bits)) / f64::from(unit_full(bits));
    LEVELS * (corrected_opacity(word, 512.0) - corrected_opacity(alpha, 512.0)).abs()
}

/// How far a slope of so many fraction bits is off after 511 planes, over slopes of thousandths.
fn template(bits: i32) -> f64 {
    let one = f64::from(bits).exp2();
    let off = |slope: f64| 511.0 * ((slope * one).round() / one - slope).abs();
    256.0 * (0..=1000).map(|i| off(f64::from(i) / 1000.0)).fold(0.0, f64::max)
}

/// Bits of a normal's component, and of the index of its table of reciprocal roots.
const NORMAL_BITS: u32 = 15;
const ROOT_BITS: u32 = 10;

/// The most that the normaliser's vector is off the unit vector by: bits cut off below the block's last, half a bin of the table and its word,
/// three rounded products (the book, *A bound of the error*).
const fn normal_bound() -> f64 {
    let root_of_three = 1.732_050_807_568_877_2;
    let last = 1.0 / (1_u64 << (NORMAL_BITS - 1)) as f64;
    let bin = 1.0 / (1_u64 << (ROOT_BITS + 2)) as f64;
    2.0 * root_of_three * last
        + bin * (1.0 + 1.0 / (1_u64 << ROOT_BITS) as f64)
        + root_of_three * last
        + 0.5 * root_of_three * last
}

fn by_table(gradient: [i32; 3], table: &Normaliser) -> DVec3 {
    let words = Words { normal_bits: NORMAL_BITS, gradient_bits: 24, ..Words::default() };
    let one = f64::from(1 << (NORMAL_BITS - 1));
    DVec3::from(normalise(gradient, table, &words).direction.map(|component| f64::from(component) / one))
}

fn largest_alone(gradient: [i32; 3], _: &Normaliser) -> DVec3 {
    let gradient = DVec3::from(gradient.map(f64::from));
    gradient / gradient.abs().max_element()
}

/// The farthest that a vector is from the gradient's unit vector.
fn normals(of: &dyn Fn([i32; 3], &Normaliser) -> DVec3) -> f64 {
    let table = Normaliser::new(NORMAL_BITS, ROOT_BITS);
    let mut most = 0.0_f64;
    for shift in 0..23 {
        let one = 1_i32 << shift;
        for rest in [0, 1, one / 7, one / 3, one / 2, one - 1, one] {
            for gradient in [[one, 0, 0], [rest, one, 0], [one, rest, -rest], [-rest, one / 3, one], [one, -one, one]] {
                let exact = DVec3::from(gradient.map(f64::from)).normalize();
                most = most.max((of(gradient, &table) - exact).length());
            }
        }
    }
    most
}

fn unit_words() -> f64 {
    let mut most = 0.0_f64;
    for bits in 1..=16 {
        let full = f64::from(unit_full(bits));
        for i in 0..=4096 {
            let x = f64::from(i) / 4096.0;
            most = most.max((f64::from(quantise_unit(x, bits)) - x * full).abs());
        }
    }
    most
}

fn lerps(rounding: Rounding) -> f64 {
    let mut most = 0.0_f64;
    for near in 0..64 {
        for far in 0..64 {
            for weight in 0..=64_u32 {
                let real = f64::from(near) + f64::from(far - near) * f64::from(weight) / 64.0;
                most = most.max((f64::from(lerp(near, far, weight, 6, rounding)) - real).abs());
            }
        }
    }
    most
}

fn products() -> f64 {
    let mut most = 0.0_f64;
    for bits in 1..=8 {
        let full = unit_full(bits);
        for a in 0..=full {
            for b in 0..=full {
                let real = f64::from(a) * f64::from(b) / f64::from(full);
                most = most.max((f64::from(unit_mul(a, b, bits, Rounding::Nearest)) - real).abs());
            }
        }
    }
    most
}

/// The order in the number of samples with which the mean error of a composited ray grows: the slope of a line through its logarithms.
fn growth(rounding: Rounding) -> f64 {
    let counts = [32_usize, 64, 128, 256, 512, 1024];
    let points = counts.map(|count| ((count as f64).ln(), mean_error(count, rounding).ln()));
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let product: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    product / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// The mean error of rays of samples so faint that all are seen; opacities and colours are exactly words, so only compositing rounds.
fn mean_error(count: usize, rounding: Rounding) -> f64 {
    const RAYS: usize = 60;
    let bits = 24;
    let words = Words { opacity_bits: 16, colour_bits: 16, accumulator_bits: bits, rounding, ..Words::default() };
    let cone =
        ConeRegisters { mode: Mode::Composite, order: ConeOrder::FrontToBack, leaves: count, opaque: 1, sum_weight: 0 };
    let full = f64::from(unit_full(bits));
    let mut state = 1_u64;
    let mut random = |below: u32| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as u32) % below
    };
    let mut sum = 0.0;
    for _ in 0..RAYS {
        let leaves: Vec<Node> = (0..count)
            .map(|_| {
                let (opacity, colour) = (random(30), [random(65536); 3]);
                leaf(&cube3_abc::golden::Shaded { present: true, sample: 0, opacity, colour }, &cone, &words)
            })
            .collect();
        let real = leaves
            .iter()
            .rev()
            .fold(0.0, |behind, node| node.rgba[0] as f64 / full + (1.0 - node.rgba[3] as f64 / full) * behind);
        sum += (f64::from(pixel(reduce(&leaves, &cone, &words), &cone, &words).value[0]) / full - real).abs();
    }
    sum / RAYS as f64
}
