//! Contents of tables that exercise every bit of an entry, and lines that random ones do not lead to.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// Words that look random, the same for a seed.
pub struct Noise(ChaCha8Rng);

impl Noise {
    pub fn new(seed: u64) -> Noise {
        Noise(ChaCha8Rng::seed_from_u64(seed))
    }

    /// From 0 to `top` inclusive.
    pub fn up_to(&mut self, top: i128) -> i128 {
        i128::from(self.0.next_u64()) % (top + 1)
    }
}

/// So many words from 0 to `top`: the first half rises from the one to the other, the second half looks random, and the last is
/// `top`.
pub fn words(seed: u64, count: usize, top: i128) -> Vec<i128> {
    let mut noise = Noise::new(seed);
    let rising = (count / 2).max(1);
    (0..count)
        .map(|i| match i {
            _ if i < rising => top * i as i128 / (rising as i128 - 1).max(1),
            _ if i + 1 == count => top,
            _ => noise.up_to(top),
        })
        .collect()
}

/// So many entries of three words each, red in the low bits.
pub fn colours(seed: u64, count: usize, bits: u32) -> Vec<i128> {
    let top = (1 << bits) - 1;
    let [red, green, blue] = [0, 1, 2].map(|i| words(seed + i, count, top));
    (0..count).map(|i| red[i] | green[i] << bits | blue[i] << (2 * bits)).collect()
}

/// The three words of an entry.
pub fn colour(entry: i128, bits: u32) -> [u32; 3] {
    [0, 1, 2].map(|i| (entry >> (i * bits) & ((1 << bits) - 1)) as u32)
}
