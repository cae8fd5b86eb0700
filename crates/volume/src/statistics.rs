//! What values a volume holds: range and histogram.

use std::ops::Range;

use rayon::prelude::*;

use crate::samples::chunks;
use crate::{NonFinite, Volume, VolumeError, VoxelWords, with_samples};

/// How many samples fall in each of equally wide bins.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Lower edge of the first bin: the least value.
    pub low: f64,
    /// Upper edge of the last bin, which belongs to it: the greatest value.
    pub high: f64,
    /// Samples in each bin; they add up to the voxels of the volume.
    pub counts: Vec<u64>,
}

impl VoxelWords {
    /// How many voxels have each of the 2^bits words.
    pub fn counts(&self) -> Vec<u64> {
        const CHUNK: usize = 1 << 22;
        let size = 1 << self.bits;
        let chunk = |words: &[u16]| {
            // Neighbours are often equal, and one counter after another of the same word would wait for memory: four tables.
            let mut counts = vec![[0_u32; 4]; size];
            let (fours, rest) = words.as_chunks::<4>();
            for four in fours {
                (0..4).for_each(|i| counts[usize::from(four[i])][i] += 1);
            }
            rest.iter().for_each(|&word| counts[usize::from(word)][0] += 1);
            counts
        };
        self.words
            .par_chunks(CHUNK)
            .map(chunk)
            .fold(
                || vec![0; size],
                |mut sum: Vec<u64>, counts| {
                    sum.iter_mut()
                        .zip(counts)
                        .for_each(|(sum, four)| *sum += four.iter().map(|&n| u64::from(n)).sum::<u64>());
                    sum
                },
            )
            .reduce(
                || vec![0; size],
                |mut sum, other| {
                    sum.iter_mut().zip(other).for_each(|(sum, count)| *sum += count);
                    sum
                },
            )
    }

    /// How many voxels of each word lie flat: along two of the three axes both neighbours have the same word but for its
    /// `low_bits`, so that samples beside the voxel have it too. Beyond the border all is the same. Only words that are `asked` for
    /// are counted.
    pub fn flat_counts(&self, low_bits: u32, asked: &[bool]) -> Vec<u64> {
        let [nx, ny, nz] = self.dims;
        let like = |index: usize, other: usize| self.words[index] >> low_bits == self.words[other] >> low_bits;
        let row = |row: usize| {
            let (y, z) = (row % ny, row / ny);
            let flat = move |x: usize| {
                let index = row * nx + x;
                let along = |at: usize, size: usize, stride: usize| {
                    (at == 0 || like(index, index - stride)) && (at + 1 == size || like(index, index + stride))
                };
                [along(x, nx, 1), along(y, ny, nx), along(z, nz, nx * ny)].into_iter().filter(|flat| *flat).count() >= 2
            };
            let words = self.words[row * nx..][..nx].iter().enumerate();
            words.filter(move |&(x, &word)| asked[usize::from(word)] && flat(x)).map(|(_, &word)| word)
        };
        let first = asked.iter().position(|asked| *asked).unwrap_or(asked.len());
        let last = asked.iter().rposition(|asked| *asked).unwrap_or(0);
        // Few rows have any such word, and to see that takes a vector's comparisons.
        let any = |row: &usize| {
            let range = first..=last;
            self.words[row * nx..][..nx].iter().fold(false, |any, &word| any | range.contains(&usize::from(word)))
        };
        let found: Vec<u16> = (0..ny * nz).into_par_iter().filter(any).flat_map_iter(row).collect();
        let mut counts = vec![0; asked.len()];
        found.into_iter().for_each(|word| counts[usize::from(word)] += 1);
        counts
    }
}

impl Volume {
    /// The least and the greatest sample.
    ///
    /// # Errors
    ///
    /// [`NonFinite`] with the first voxel that is NaN or infinite.
    pub fn range(&self) -> Result<(f64, f64), NonFinite> {
        match self.finite_range() {
            (range, 0) => Ok(range),
            _ => Err(self.first_non_finite().unwrap_or(NonFinite { position: [0; 3], value: f64::NAN })),
        }
    }

    /// The least and the greatest of the finite samples, (0, 0) where there are none, and how many
    /// samples are NaN or infinite.
    pub fn finite_range(&self) -> ((f64, f64), u64) {
        let nothing = || (f64::INFINITY, f64::NEG_INFINITY, 0);
        let chunk = |chunk: Range<usize>| {
            with_samples!(&self.samples, v => v[chunk].iter().fold(nothing(), |(lo, hi, bad), &s| {
                let v = f64::from(s);
                if v.is_finite() { (lo.min(v), hi.max(v), bad) } else { (lo, hi, bad + 1) }
            }))
        };
        let all = chunks(self.len()).map(chunk);
        let (lo, hi, bad) = all.reduce(nothing, |a, b| (a.0.min(b.0), a.1.max(b.1), a.2 + b.2));
        (if lo <= hi { (lo, hi) } else { (0.0, 0.0) }, bad)
    }

    /// The first sample in storage order that `is` so.
    pub(crate) fn first(&self, is: impl Fn(f64) -> bool + Sync) -> Option<usize> {
        chunks(self.len()).find_map_first(|chunk| {
            let start = chunk.start;
            with_samples!(&self.samples, v => v[chunk].iter().position(|&s| is(f64::from(s)))).map(|at| start + at)
        })
    }

    /// The first voxel in storage order that is NaN or infinite.
    pub fn first_non_finite(&self) -> Option<NonFinite> {
        if !self.sample_type().is_float() {
            return None;
        }
        let index = self.first(|value| !value.is_finite())?;
        Some(NonFinite { position: self.position(index), value: self.samples.value(index) })
    }

    /// Counts the samples in `bins` equally wide bins from the least to the greatest value. A
    /// volume of one value has them all in the first bin.
    ///
    /// # Errors
    ///
    /// [`VolumeError::Parameter`] when `bins` is 0 or above 2²⁴, [`VolumeError::NonFinite`] as
    /// [`Volume::range`].
    pub fn histogram(&self, bins: usize) -> Result<Histogram, VolumeError> {
        if bins == 0 || bins > 1 << 24 {
            return Err(VolumeError::Parameter {
                name: "histogram bins",
                reason: format!("{bins} bins"),
                remedy: "give 1 to 16777216",
            });
        }
        let (low, high) = self.range()?;
        // Halves, so that a range of the whole f64 line does not overflow.
        let half_span = high / 2.0 - low / 2.0;
        let bin_of = |v: f64| {
            let t = if half_span > 0.0 { (v / 2.0 - low / 2.0) / half_span } else { 0.0 };
            ((t * bins as f64) as usize).min(bins - 1)
        };
        let mut counts = vec![0u64; bins];
        with_samples!(&self.samples, v => {
            for &s in v {
                counts[bin_of(f64::from(s))] += 1;
            }
        });
        Ok(Histogram { low, high, counts })
    }
}
