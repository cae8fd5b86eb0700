//! Whether a few far values have taken almost all of the voxel words, and left the rest of the data a handful.

use cube3_inputs::LoadedVolume;
use cube3_volume::{Samples, VoxelWords, with_samples};

/// Voxels on either side that are far values at most, one for each so many.
const FAR: u64 = 200;

/// The rest of the voxels is crowded when it has this many words at most, six bits, ...
const MOST_WORDS: usize = 64;

/// ... and no more than one of so many: data of few bits are not crowded by being coarse.
const ONE_OF: usize = 256;

/// What shares the words that the far values have left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crowding {
    /// Voxels that are not far values.
    pub voxels: u64,
    /// Words from the lowest to the highest of theirs.
    pub words: usize,
    /// Their least and their greatest value.
    pub values: [f64; 2],
}

/// The crowding of a volume with so many voxels of each word. None where the words are spread, and where the voxels of a word have
/// one value: a volume that is empty but for a few voxels loses nothing.
pub fn crowding(volume: &LoadedVolume, counts: &[u64]) -> Option<Crowding> {
    let total: u64 = counts.iter().sum();
    let far = (total / FAR).max(1);
    let low = beyond(far, counts.iter().enumerate())?;
    let high = beyond(far, counts.iter().enumerate().rev())?;
    let words = (high + 1).checked_sub(low)?;
    if words > MOST_WORDS || words > counts.len() / ONE_OF {
        return None;
    }
    let held = held(&volume.data.samples, &volume.words, low, words);
    let merged: u64 = held.iter().filter(|held| held.least < held.greatest).map(|held| held.voxels).sum();
    let voxels: u64 = counts[low..=high].iter().sum();
    let least = held.iter().map(|held| held.least).fold(f64::INFINITY, f64::min);
    let greatest = held.iter().map(|held| held.greatest).fold(f64::NEG_INFINITY, f64::max);
    (2 * merged > voxels).then_some(Crowding { voxels, words, values: [least, greatest] })
}

/// The first word with more than `far` voxels up to it.
fn beyond<'a>(far: u64, mut counts: impl Iterator<Item = (usize, &'a u64)>) -> Option<usize> {
    let mut passed = 0;
    counts.find_map(|(word, count)| {
        passed += count;
        (passed > far).then_some(word)
    })
}

/// The voxels of a word whose values are within the window.
#[derive(Clone)]
struct Held {
    voxels: u64,
    least: f64,
    greatest: f64,
}

/// Those of each of the words from `low` on. Values beyond the window have been left out by whoever set it.
fn held(samples: &Samples, words: &VoxelWords, low: usize, count: usize) -> Vec<Held> {
    let mut held = vec![Held { voxels: 0, least: f64::INFINITY, greatest: f64::NEG_INFINITY }; count];
    let [bottom, top] = words.window;
    with_samples!(samples, samples => {
        for (&sample, &word) in samples.iter().zip(&words.words) {
            let value = f64::from(sample);
            let within = (bottom..=top).contains(&value);
            if let Some(held) = usize::from(word).checked_sub(low).and_then(|i| held.get_mut(i)).filter(|_| within) {
                held.voxels += 1;
                (held.least, held.greatest) = (held.least.min(value), held.greatest.max(value));
            }
        }
    });
    held
}
