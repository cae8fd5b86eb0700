//! The bound: never below the error, and never above the tolerance.

use crate::scenes::{Dice, random};
use cube3_converged::{ConvergedOptions, converged};

/// What a random scene's rays gave.
struct Tried {
    seed: u64,
    /// Error and bound of each pixel.
    pixels: Vec<[f64; 2]>,
    tolerance: f64,
}

fn tried(seed: u64) -> Tried {
    let (volume, scene) = random(seed, 2);
    let tolerance = 10_f64.powf(Dice::new(!seed).between(-6.0, -2.0));
    let at = |tolerance: f64| {
        let options = ConvergedOptions { tolerance, border: 3.0, every: 1 };
        converged(&volume, &scene, &options, None).unwrap()
    };
    let (made, truth) = (at(tolerance), at((tolerance * 1e-6).max(1e-12)));
    let pixels = (0..made.bounds.len()).map(|i| {
        let apart = |k: usize| (made.picture.pixels[i][k] - truth.picture.pixels[i][k]).abs();
        // The truth is known to its own bound.
        [(apart(0).max(apart(1)).max(apart(2)) - truth.bounds[i]).max(0.0), made.bounds[i]]
    });
    Tried { seed, pixels: pixels.collect(), tolerance }
}

#[test]
fn the_bound_of_ten_thousand_rays_is_above_the_error_and_below_the_tolerance() {
    let mut over = Vec::new();
    for seed in 0..2500 {
        let tried = tried(seed);
        for (pixel, [error, bound]) in tried.pixels.iter().enumerate() {
            assert!(error <= bound, "scene {seed}, pixel {pixel}: {error:e} is above the bound {bound:e}");
            if *bound > tried.tolerance {
                over.push((tried.seed, pixel, tried.tolerance, *bound));
            }
        }
    }
    assert!(over.is_empty(), "{} {over:?}", over.len());
}

/// Evaluations that a scene takes by the bound, and by the loosest tolerance with which the error itself is as small as was asked for.
fn evaluations(seed: u64, tolerance: f64) -> [u64; 2] {
    let (volume, scene) = random(seed, 4);
    let at = |tolerance: f64| {
        let options = ConvergedOptions { tolerance, border: 3.0, every: 1 };
        converged(&volume, &scene, &options, None).unwrap()
    };
    let truth = at((tolerance * 1e-6).max(1e-12));
    let made = at(tolerance);
    let looser = (0..24).map(|i| tolerance * 2_f64.powi(i)).take_while(|tolerance| *tolerance < 0.5).map(at);
    let holds = |made: &cube3_converged::ConvergedRendering| {
        let pairs = made.picture.pixels.iter().zip(&truth.picture.pixels);
        pairs.flat_map(|(a, b)| (0..3).map(move |k| (a[k] - b[k]).abs())).all(|error| error <= tolerance)
    };
    let fewest = looser.filter(holds).map(|made| made.evaluations).min().unwrap_or(made.evaluations);
    [made.evaluations, fewest]
}

#[test]
fn evaluations_are_at_most_four_times_those_that_the_true_error_would_stop() {
    for tolerance in [1e-3, 1e-5] {
        let all: Vec<[u64; 2]> = (0..300).map(|seed| evaluations(seed, tolerance)).filter(|[made, _]| *made > 0).collect();
        let sum = |i: usize| all.iter().map(|pair| pair[i]).sum::<u64>() as f64;
        let mut ratios: Vec<f64> = all.iter().map(|[made, fewest]| *made as f64 / (*fewest).max(1) as f64).collect();
        ratios.sort_by(f64::total_cmp);
        println!("{tolerance}: {} of {}: {}; median {}, 90 % {}, worst {:?}", sum(0), sum(1), sum(0) / sum(1), ratios[ratios.len() / 2], ratios[ratios.len() * 9 / 10], &ratios[ratios.len()-5..]);
        assert!(sum(0) <= 4.0 * sum(1));
    }
}
