//! The order of `image_order` in its step, against closed forms; what it does without opacity correction; and beside it opacity that is linear
//! in the step.
//!
//! Rays of which every number is known, s from 0 to L along them: a ramp (the value is linear in s), a bowl (it is s²/2) and a glow (fog of one
//! opacity, its colour linear in s).

use crate::common::fog;
use crate::common::order::{assert_order, order};
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_scene::{ColourPoint, Scene, View, corrected_opacity};
use cube3_volume::Volume;

/// A ray through a volume.
#[derive(Clone)]
pub struct Case {
    pub name: &'static str,
    pub volume: Volume,
    pub scene: Scene,
    /// L.
    pub length: f64,
    /// What a value is at a place of the ray.
    pub value: fn(f64) -> f64,
}

const EXTENT: f64 = 32.0;
const TOP_OPACITY: f64 = 0.1;

fn opacity_up_to(value: f64, opacity: f64) -> Scene {
    let mut scene = fog(0.0);
    scene.transfer.opacity = vec![[0.0, 0.0], [value, opacity]];
    scene
}

/// The value is s.
pub fn ramp() -> Case {
    let volume = Volume::from_fn([3, 33, 3], [1.0; 3], |_, y, _| y as f64).unwrap();
    Case { name: "ramp", volume, scene: opacity_up_to(EXTENT, TOP_OPACITY), length: EXTENT, value: |s| s }
}

/// The value is x·y, which trilinear interpolation has exactly, along the diagonal of x and y: s²/2.
pub fn bowl() -> Case {
    let volume = Volume::from_fn([33, 33, 3], [1.0; 3], |x, y, _| (x * y) as f64).unwrap();
    let scene =
        Scene { view: View::from_direction([1.0, 1.0, 0.0], None), ..opacity_up_to(EXTENT * EXTENT, TOP_OPACITY) };
    Case { name: "bowl", volume, scene, length: EXTENT * 2_f64.sqrt(), value: |s| s * s / 2.0 }
}

const GLOW_OPACITY: f64 = 0.08;

/// Fog of one opacity; the colour is s/L.
fn glow() -> Case {
    let mut scene = fog(GLOW_OPACITY);
    let grey = |value: f64, c: f64| ColourPoint { value, rgb: [c; 3] };
    scene.transfer.colour = vec![grey(0.0, 0.0), grey(EXTENT, 1.0)];
    Case { name: "glow", scene, ..ramp() }
}

/// The pixel in steps of a length.
pub fn pixel_at(case: &Case, step_voxel: f64) -> f64 {
    let options = ImageOrderOptions { step_voxel, ..ImageOrderOptions::default() };
    image_order(&case.volume, &case.scene, &options, None).unwrap().picture.pixels[0][0]
}

/// The pixel in so many steps.
pub fn pixel(case: &Case, steps: u32) -> f64 {
    pixel_at(case, case.length / f64::from(steps))
}

/// Extinction of an opacity of a unit length.
pub fn extinction(opacity: f64) -> f64 {
    -(-opacity).ln_1p()
}

/// Closed forms of a ray: ∫τ, ∫τ² and ∫α along it, and τ' where it ends (where it begins it is `first_slope`).
struct Closed {
    depth: f64,
    square: f64,
    linear: f64,
    first_slope: f64,
    last_slope: f64,
}

/// τ = −ln(1 − k·s), k = 0.1/32: with u = 1 − k·s ∫ln u du = u·ln u − u and ∫ln²u du = u·ln²u − 2u·ln u + 2u.
fn ramp_closed() -> Closed {
    let k = TOP_OPACITY / EXTENT;
    let (u, ln) = (1.0 - TOP_OPACITY, (-TOP_OPACITY).ln_1p());
    Closed {
        depth: (u * ln - u + 1.0) / k,
        square: (2.0 - (u * ln * ln - 2.0 * u * ln + 2.0 * u)) / k,
        linear: TOP_OPACITY * EXTENT / 2.0,
        first_slope: k,
        last_slope: k / u,
    }
}

/// τ = −ln(1 − q·s²), q = 0.1/(2·32²): ∫τ = 2s − s·ln(1 − q·s²) − 2·artanh(√q·s)/√q. ∫τ² by its series, Σ over pairs of (q·s²)^(i+j)/(i·j).
fn bowl_closed() -> Closed {
    let q: f64 = TOP_OPACITY / (2.0 * EXTENT * EXTENT);
    let end = EXTENT * 2_f64.sqrt();
    let x = q * end * end;
    let pairs = (1..30_i32).flat_map(|i| (1..30_i32).map(move |j| (i, j)));
    let term = |(i, j): (i32, i32)| x.powi(i + j) * end / f64::from(i * j * (2 * (i + j) + 1));
    Closed {
        depth: 2.0 * end - end * (-x).ln_1p() - 2.0 * (q.sqrt() * end).atanh() / q.sqrt(),
        square: pairs.map(term).sum(),
        linear: q * end.powi(3) / 3.0,
        first_slope: 0.0,
        last_slope: 2.0 * q * end / (1.0 - x),
    }
}

/// Pixel of the glow: ∫τ·(s/L)·e^(−τs) = (1 − e^(−τL)·(1 + τL))/(τL).
fn glow_pixel() -> f64 {
    let depth = extinction(GLOW_OPACITY) * EXTENT;
    (1.0 - (-depth).exp() * (1.0 + depth)) / depth
}

const STEPS: [u32; 6] = [8, 16, 32, 64, 128, 256];

/// Each case with its pixel and the leading term of the error, over h².
fn cases() -> [(Case, f64, f64); 3] {
    // The trapezoid rule is h²/12·(τ'(L) − τ'(0)) above ∫τ, and the opacity e^(−∫τ) of that.
    let of_opacity = |closed: Closed| {
        let left = (-closed.depth).exp();
        (1.0 - left, left * (closed.last_slope - closed.first_slope) / 12.0)
    };
    let (ramp_pixel, ramp_term) = of_opacity(ramp_closed());
    let (bowl_pixel, bowl_term) = of_opacity(bowl_closed());
    // A sample stands for the h around it: c'·τ²·e^(−τs)·h³/12 too much of each, as what is in front of it is seen better; the half of
    // a step at either end is c'·τ·h²/8 short at the front and long at the back.
    let tau = extinction(GLOW_OPACITY);
    let glow_term = -(1.0 - (-tau * EXTENT).exp()) * tau / EXTENT / 24.0;
    [(ramp(), ramp_pixel, ramp_term), (bowl(), bowl_pixel, bowl_term), (glow(), glow_pixel(), glow_term)]
}

fn steps_of(case: &Case) -> Vec<f64> {
    STEPS.map(|steps| case.length / f64::from(steps)).into()
}

#[test]
fn image_order_is_of_the_second_order_with_the_trapezoids_constant() {
    for (case, exact, term) in cases() {
        let (steps, errors): (_, Vec<f64>) = (steps_of(&case), STEPS.map(|n| pixel(&case, n) - exact).into());
        let sizes: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
        assert_order(case.name, &steps, &sizes, 2.0, 0.03);
        // The constant, sign and all.
        let constant = errors[5] / (steps[5] * steps[5]);
        println!("{}: error/h² {constant:.4e}, closed form {term:.4e}", case.name);
        assert!((constant / term - 1.0).abs() < 0.005, "{}: {constant:e} h², not {term:e}", case.name);
    }
}

#[test]
fn steps_that_do_not_divide_the_ray_are_of_the_second_order_too() {
    for (case, exact, _) in cases() {
        let lengths = STEPS.map(|steps| case.length / (f64::from(steps) + 0.37));
        let errors = lengths.map(|h| (pixel_at(&case, h) - exact).abs());
        assert_order(case.name, &lengths, &errors, 2.0, 0.06);
    }
}

/// A whole step has the opacity of a unit length, so n steps of length h have the depth ∫τ/h: the picture is that of a medium 1/h as dense.
#[test]
fn without_correction_the_depth_grows_as_the_step_shrinks() {
    for (mut case, closed) in [(ramp(), ramp_closed()), (bowl(), bowl_closed())] {
        case.scene.transfer.opacity_correction = false;
        let steps = &steps_of(&case)[..3];
        let depths: Vec<f64> =
            STEPS[..3].iter().zip(steps).map(|(n, h)| -(-pixel(&case, *n)).ln_1p() * h - closed.depth).collect();
        // h times the depth is the integral, of the second order; so the depth itself grows without bound.
        assert_order(case.name, steps, &depths, 2.0, 0.02);
        let (left, expected) = (1.0 - pixel_at(&case, 0.125), (-closed.depth / 0.125).exp());
        assert!((left / expected - 1.0).abs() < 1e-3 && left < 1e-5, "{}: {left}, not {expected}", case.name);
        // It is the corrected picture of the denser medium, to rounding.
        for n in STEPS {
            let plain = pixel(&case, n);
            let h = case.length / f64::from(n);
            let mut dense = case.clone();
            dense.scene.transfer.opacity_correction = true;
            let thin = pixel(&dense, n);
            let expected = corrected_opacity(thin, 1.0 / h);
            assert!((plain - expected).abs() < 1e-12, "{}: {plain}, not {expected} in {n} steps", case.name);
        }
    }
}

/// What is seen in the limit is the colour at the front: the error does not vanish, but tends to that of the front alone, in the first order:
/// Σ i·α·q^(i − ½) = √q/α steps, q = 1 − α, is the mean place that is seen.
#[test]
fn without_correction_only_the_front_is_seen_in_the_limit() {
    let mut case = glow();
    case.scene.transfer.opacity_correction = false;
    let errors = STEPS[2..].iter().map(|n| (pixel(&case, *n) - glow_pixel()).abs());
    assert!(errors.clone().is_sorted(), "it does not come nearer to the integral: {:?}", errors.collect::<Vec<_>>());
    for h in [0.05, 0.01, 0.002] {
        let (seen, expected) = (pixel_at(&case, h), h / EXTENT * (1.0 - GLOW_OPACITY).sqrt() / GLOW_OPACITY);
        assert!((seen / expected - 1.0).abs() < 1e-6, "{seen}, not {expected} at steps of {h}");
    }
}

/// How an opacity becomes that of a part of a step.
#[derive(Clone, Copy, Debug)]
enum Law {
    /// 1 − (1 − α)^h.
    Exponential,
    /// τ·h, at most 1.
    LinearInExtinction,
    /// α·h, at most 1.
    LinearInOpacity,
}

/// The opacity of a ray on the samples of `image_order`, by another law.
fn by_law(case: &Case, steps: u32, law: Law) -> f64 {
    let h = case.length / f64::from(steps);
    let through = (0..=steps).map(|i| {
        let opacity = case.scene.transfer.opacity_at((case.value)(f64::from(i) * h), 0.0);
        let length = if i == 0 || i == steps { h / 2.0 } else { h };
        1.0 - match law {
            Law::Exponential => corrected_opacity(opacity, length),
            Law::LinearInExtinction => (extinction(opacity) * length).min(1.0),
            Law::LinearInOpacity => (opacity * length).min(1.0),
        }
    });
    1.0 - through.product::<f64>()
}

#[test]
fn the_comparison_is_image_orders_but_for_the_law() {
    for case in [ramp(), bowl()] {
        for n in STEPS {
            let (ours, theirs) = (pixel(&case, n), by_law(&case, n, Law::Exponential));
            assert!((ours - theirs).abs() < 1e-12, "{}: {ours}, not {theirs} in {n} steps", case.name);
        }
    }
}

/// Π(1 − τ·h) = exp(−∫τ − h/2·∫τ² − …): the opacity is e^(−∫τ)·h/2·∫τ² too large.
#[test]
fn opacity_linear_in_the_step_is_of_the_first_order() {
    for (case, closed) in [(ramp(), ramp_closed()), (bowl(), bowl_closed())] {
        let exact = -(-closed.depth).exp_m1();
        let steps = &steps_of(&case)[2..];
        let errors: Vec<f64> = STEPS[2..].iter().map(|n| by_law(&case, *n, Law::LinearInExtinction) - exact).collect();
        assert_order(case.name, steps, &errors, 1.0, 0.03);
        let fine = 1 << 14;
        let constant = (by_law(&case, fine, Law::LinearInExtinction) - exact) / (case.length / f64::from(fine));
        let term = (-closed.depth).exp() * closed.square / 2.0;
        assert!((constant / term - 1.0).abs() < 0.002, "{}: {constant:e} h, not {term:e}", case.name);
        // Opacity in place of extinction: the first order to another number, 1 − exp(−∫α).
        let limit = -(-closed.linear).exp_m1();
        let errors: Vec<f64> = STEPS[2..].iter().map(|n| by_law(&case, *n, Law::LinearInOpacity) - limit).collect();
        assert_order(case.name, steps, &errors, 1.0, 0.05);
        assert!(exact - limit > 1e-3, "{}: {limit} is not {exact}", case.name);
        // A step so long that it is clipped is opaque at once.
        assert_eq!(by_law(&Case { length: 40.0, ..case }, 1, Law::LinearInExtinction), 1.0);
    }
}

/// The tables of the section "Order of convergence" in docs/src/raycast.md.
#[test]
#[ignore = "prints the book's table: cargo test --release -p cube3-reference --test all convergence:: -- --ignored --nocapture"]
fn the_orders_as_a_table() {
    println!("| ray, law | order | leading term | error at h = 1 | at h = 1/8 |\n| --- | --- | --- | --- | --- |");
    for (case, exact, term) in cases() {
        let at = |h: f64| pixel_at(&case, h) - exact;
        let errors: Vec<f64> = STEPS.iter().map(|n| (pixel(&case, *n) - exact).abs()).collect();
        let measured = order(&steps_of(&case), &errors);
        println!(
            "| {}, exponential | {measured:.2} | {term:.3e}·h² | {:.2e} | {:.2e} |",
            case.name,
            at(1.0),
            at(0.125)
        );
    }
    for (case, closed) in [(ramp(), ramp_closed()), (bowl(), bowl_closed())] {
        let exact = -(-closed.depth).exp_m1();
        for law in [Law::LinearInExtinction, Law::LinearInOpacity] {
            let error = |n: u32| by_law(&case, n, law) - exact;
            let errors: Vec<f64> = STEPS[2..].iter().map(|n| error(*n).abs()).collect();
            let measured = order(&steps_of(&case)[2..], &errors);
            let term = (-closed.depth).exp() * closed.square / 2.0;
            println!(
                "| {}, {law:?} | {measured:.2} | {term:.3e}·h | {:.2e} | {:.2e} |",
                case.name,
                error(32),
                error(256)
            );
        }
    }
}
