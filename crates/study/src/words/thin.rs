//! Rays of thin opacity through the cone alone, against the same rays in reals that were never made words.

use super::levels::{ImageLevels, LEVELS};
use super::wire::Order;
use cube3_abc::golden::Shaded;
use cube3_cone::golden::{Node, leaf, pixel, reduce};
use cube3_frame::ConeRegisters;
use cube3_scene::Mode;
use cube3_word::{Words, quantise_unit, unit_full};

/// Samples of a ray.
pub const SAMPLES: usize = 512;
/// Rays.
pub const RAYS: usize = 200;
/// Opacities are uniform from 0 to this, colours from 0 to 1.
pub const THICKEST: f64 = 0.013;
/// Of the random numbers.
pub const SEED: u64 = 1995;

/// A ray: opacity and colour of its samples, and what they are worth.
struct Ray {
    samples: Vec<(f64, f64)>,
    real: f64,
}

/// The rays of the experiment.
pub struct ThinCase {
    rays: Vec<Ray>,
}

impl ThinCase {
    /// Makes the rays.
    pub fn new() -> ThinCase {
        let mut random = random(SEED);
        let mut ray = || {
            let samples: Vec<(f64, f64)> = (0..SAMPLES).map(|_| (THICKEST * random(), random())).collect();
            let real =
                samples.iter().rev().fold(0.0, |behind, (alpha, colour)| alpha * colour + (1.0 - alpha) * behind);
            Ray { samples, real }
        };
        ThinCase { rays: (0..RAYS).map(|_| ray()).collect() }
    }

    /// Error of red. Of the words those of the cone count: opacity, colour, accumulator and rounding.
    pub fn measure(&self, words: &Words, order: Order) -> ImageLevels {
        let cone =
            ConeRegisters { mode: Mode::Composite, order: order.of_cone(), leaves: SAMPLES, opaque: 1, sum_weight: 0 };
        let full = f64::from(unit_full(words.accumulator_bits));
        let error = |ray: &Ray| {
            let leaves: Vec<Node> = ray
                .samples
                .iter()
                .map(|&(alpha, colour)| {
                    let opacity = quantise_unit(alpha, words.opacity_bits);
                    let colour = [quantise_unit(colour, words.colour_bits); 3];
                    leaf(&Shaded { present: true, sample: 0, opacity, colour }, &cone, words)
                })
                .collect();
            let red = pixel(reduce(&leaves, &cone, words), &cone, words).value[0];
            LEVELS * (f64::from(red) / full - ray.real).abs()
        };
        let errors: Vec<f64> = self.rays.iter().map(error).collect();
        let count = errors.len() as f64;
        ImageLevels {
            mean: errors.iter().sum::<f64>() / count,
            rms: (errors.iter().map(|error| error * error).sum::<f64>() / count).sqrt(),
            max: errors.iter().copied().fold(0.0, f64::max),
        }
    }
}

impl Default for ThinCase {
    fn default() -> Self {
        ThinCase::new()
    }
}

/// Numbers 0 to 1 that look random: SplitMix64 (Steele, Lea and Flood 2014).
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
