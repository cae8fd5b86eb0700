//! The bound over the error of some 2,900 rays, as a plot of the book and a table: `cargo test --release -p cube3-converged --test all -- --ignored
//! --nocapture calibration`.

use crate::scenes::random;
use cube3_converged::{ConvergedOptions, TOLERANCES, converged};
use std::fmt::Write;

/// Exponents of ten of the tolerances, and the colour of each.
const ASKED: [(i32, &str); 7] = [
    (-2, "#b2182b"),
    (-3, "#e08214"),
    (-4, "#c8a800"),
    (-5, "#1b9e3c"),
    (-6, "#1f9bb5"),
    (-7, "#2c5fc4"),
    (-8, "#7b3294"),
];

/// Scenes of a tolerance, of four rays each; of six rays one meets something.
const SCENES: u64 = 625;

/// Decades of the axes: bounds, and errors, of which those below are drawn at the edge.
const BOUNDS: [f64; 2] = [-17.0, 0.0];
const ERRORS: [f64; 2] = [-17.0, 0.0];

/// A bound of rounding alone, which no tolerance makes less.
const ROUNDED: f64 = 1e-12;

/// Bound and error of a ray that meets something.
type Point = [f64; 2];

/// What the rays of a tolerance gave.
struct Tried {
    tolerance: f64,
    colour: &'static str,
    points: Vec<Point>,
    /// Rays that no tighter tolerance knows a hundred times better.
    unknown: usize,
    /// Rays whose bound is above the tolerance.
    over: usize,
    evaluations: f64,
}

fn tried((exponent, colour): (i32, &'static str)) -> Tried {
    let tolerance = 10_f64.powi(exponent);
    let mut tried = Tried { tolerance, colour, points: Vec::new(), unknown: 0, over: 0, evaluations: 0.0 };
    for seed in 0..SCENES {
        // Each tolerance has scenes of its own.
        let (volume, scene) = random(1_000_000 * exponent.unsigned_abs() as u64 + seed, 2);
        let at = |tolerance: f64| {
            let options = ConvergedOptions { tolerance, border: 3.0, every: 1 };
            converged(&volume, &scene, &options, None).unwrap()
        };
        let made = at(tolerance);
        if made.bounds.iter().all(|bound| *bound == 0.0) {
            continue;
        }
        // A millionth of the tolerance, and where rounding leaves nothing at that, more of it.
        let truths = [1e-6, 1e-5, 1e-4, 1e-3].map(|part| at((tolerance * part).max(TOLERANCES[0])));
        tried.evaluations += made.evaluations as f64;
        for (i, bound) in made.bounds.iter().enumerate().filter(|(_, bound)| **bound > 0.0) {
            tried.over += usize::from(*bound > tolerance);
            let Some(truth) = truths.iter().find(|truth| truth.bounds[i] <= (0.01 * bound).max(ROUNDED)) else {
                tried.unknown += 1;
                continue;
            };
            let apart = |k: usize| (made.picture.pixels[i][k] - truth.picture.pixels[i][k]).abs();
            let error = apart(0).max(apart(1)).max(apart(2));
            assert!(error <= bound + truth.bounds[i], "scene {seed} at {tolerance:e}: {error:e} is above {bound:e}");
            tried.points.push([*bound, error]);
        }
    }
    tried.evaluations /= (tried.points.len() + tried.unknown) as f64;
    tried
}

/// The value that a share of some numbers is not above.
fn quantile(mut numbers: Vec<f64>, share: f64) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[((numbers.len() - 1) as f64 * share).round() as usize]
}

fn row(tried: &Tried) -> String {
    let of = |f: &dyn Fn(&Point) -> f64| tried.points.iter().map(f).collect::<Vec<f64>>();
    let used = quantile(of(&|[bound, _]| bound / tried.tolerance), 0.5);
    let ratios = of(&|[bound, error]| error / bound);
    let [median, most, worst] = [0.5, 0.99, 1.0].map(|share| quantile(ratios.clone(), share));
    let rays = tried.points.len() + tried.unknown;
    let share = |count: usize| 100.0 * count as f64 / rays as f64;
    format!(
        "| {:.0e} | {rays} | {used:.3} | {median:.1e} | {most:.2} | {worst:.2} | {:.1} % | {:.1} % | {:.0} |",
        tried.tolerance,
        share(tried.over),
        share(tried.unknown),
        tried.evaluations
    )
}

/// A log–log plot of errors over bounds.
fn plot(all: &[Tried]) -> String {
    let [left, top, width, height] = [78.0, 16.0, 510.0, 510.0];
    let across = |decade: f64| left + width * (decade - BOUNDS[0]) / (BOUNDS[1] - BOUNDS[0]);
    let down = |decade: f64| top + height * (ERRORS[1] - decade) / (ERRORS[1] - ERRORS[0]);
    let (right, bottom) = (left + width, top + height);
    let mut svg = String::new();
    let mut put = |text: std::fmt::Arguments<'_>| writeln!(svg, "{text}").unwrap();
    put(format_args!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 760 600" width="760" height="600" font-family="sans-serif" font-size="13">"#
    ));
    put(format_args!(r##"<rect width="760" height="600" fill="#fff"/>"##));
    let power = |exponent: i32| {
        let sign = if exponent < 0 { "−" } else { "" };
        format!(r#"10<tspan dy="-5" font-size="10">{sign}{}</tspan>"#, exponent.abs())
    };
    for exponent in (-16..=0).step_by(2) {
        let (x, y) = (across(f64::from(exponent)), down(f64::from(exponent)));
        put(format_args!(r##"<path d="M{x:.1} {top}V{bottom}M{left} {y:.1}H{right}" stroke="#e4e4e4"/>"##));
        put(format_args!(
            r#"<text x="{x:.1}" y="{:.1}" text-anchor="middle">{}</text>"#,
            bottom + 20.0,
            power(exponent)
        ));
        put(format_args!(
            r#"<text x="{:.1}" y="{:.1}" text-anchor="end">{}</text>"#,
            left - 8.0,
            y + 5.0,
            power(exponent)
        ));
    }
    for tried in all {
        put(format_args!(r#"<g fill="{}" fill-opacity="0.55">"#, tried.colour));
        for [bound, error] in &tried.points {
            let x = across(bound.log10().clamp(BOUNDS[0], BOUNDS[1]));
            let y = down(error.max(1e-300).log10().clamp(ERRORS[0], ERRORS[1]));
            put(format_args!(r#"<circle cx="{x:.1}" cy="{y:.1}" r="1.6"/>"#));
        }
        put(format_args!("</g>"));
    }
    put(format_args!(r##"<path d="M{left} {bottom}L{right} {top}" stroke="#000" stroke-width="1.5"/>"##));
    put(format_args!(r##"<rect x="{left}" y="{top}" width="{width}" height="{height}" fill="none" stroke="#000"/>"##));
    let middle = f64::midpoint(left, right);
    put(format_args!(r#"<text x="{middle}" y="{}" text-anchor="middle">bound, of full scale</text>"#, bottom + 44.0));
    let label = "error, of full scale (below 10⁻¹⁷ at the lower edge)";
    let middle = f64::midpoint(top, bottom);
    put(format_args!(r#"<text transform="translate(24 {middle}) rotate(-90)" text-anchor="middle">{label}</text>"#));
    let [x, y] = [across(-13.6), down(-12.3)];
    put(format_args!(r#"<text transform="translate({x:.1} {y:.1}) rotate(-45)">error = bound</text>"#));
    put(format_args!(r#"<text x="{}" y="36">tolerance</text>"#, right + 20.0));
    for (i, (tried, (exponent, _))) in all.iter().zip(ASKED).enumerate() {
        let y = 60.0 + 22.0 * i as f64;
        put(format_args!(r#"<circle cx="{}" cy="{y}" r="5" fill="{}"/>"#, right + 26.0, tried.colour));
        put(format_args!(r#"<text x="{}" y="{}">{}</text>"#, right + 40.0, y + 5.0, power(exponent)));
    }
    put(format_args!("</svg>"));
    svg
}

#[test]
#[ignore = "writes a picture of the book, in half a minute"]
fn calibration() {
    let all: Vec<Tried> = ASKED.into_iter().map(tried).collect();
    println!(
        "| tolerance | rays | bound/tolerance, median | error/bound, median | 99 % | largest | bound above tolerance | not known better | evaluations a ray |"
    );
    println!("|---:|---:|---:|---:|---:|---:|---:|---:|---:|");
    for tried in &all {
        println!("{}", row(tried));
        assert!(tried.points.iter().all(|[bound, error]| *error <= 1.02 * bound + ROUNDED));
    }
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/src/images/converged-calibration.svg");
    std::fs::write(file, plot(&all)).unwrap();
}
