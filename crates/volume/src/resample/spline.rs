//! Interpolation along one axis: weights, and the coefficients of a cubic B-spline.
//!
//! s(p) = Σ c_k·β³(p − k), with c such that s(k) is sample k; Unser 1999, "Splines: a perfect fit for signal and image
//! processing", boxes 1 and 2. Beyond the first and the last sample the signal is its mirror image: c_{−k} = c_k.

use rayon::prelude::*;

use super::filter::Filter;

/// The pole of the filter that makes coefficients, √3 − 2.
const POLE: f64 = -0.267_949_192_431_122_7;
/// Its gain, (1 − z)(1 − 1/z).
const GAIN: f64 = 6.0;
/// Powers of the pole from here on are below 1e-22 and change no bit.
const HORIZON: usize = 40;
/// A place so close to a voxel is the voxel's: more than the rounding of a product, in voxels.
const SNAP: f64 = 1e-10;
/// Numbers from which a row is worth several threads.
const PARALLEL: usize = 1 << 15;

/// The voxels that make a value, with their weights; at most four.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Taps {
    index: [usize; 4],
    weight: [f64; 4],
}

impl Taps {
    /// At a place between voxel `cell` of `size` and the next: `behind` of a step behind it, `before` = 1 − `behind` before the next.
    pub fn new(filter: Filter, size: usize, cell: usize, before: f64, behind: f64) -> Self {
        match filter {
            Filter::Nearest => {
                let nearest = if behind >= 0.5 { (cell + 1).min(size - 1) } else { cell };
                Self { index: [nearest, 0, 0, 0], weight: [1.0, 0.0, 0.0, 0.0] }
            }
            Filter::Linear => {
                Self { index: [cell, (cell + 1).min(size - 1), 0, 0], weight: [before, behind, 0.0, 0.0] }
            }
            Filter::Cubic => {
                let mirror = |k: isize| {
                    let last = size as isize - 1;
                    (if k > last { 2 * last - k } else { k.abs() }).clamp(0, last) as usize
                };
                let far = |t: f64| t * t * t / 6.0;
                let near = |t: f64| (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0;
                let cell = cell as isize;
                Self {
                    index: [cell - 1, cell, cell + 1, cell + 2].map(mirror),
                    weight: [far(before), near(behind), near(before), far(behind)],
                }
            }
        }
    }

    /// At `place`, in voxels; places before the first and behind the last are theirs.
    pub fn at(filter: Filter, size: usize, place: f64) -> Self {
        let whole = place.round();
        let place = if (place - whole).abs() < SNAP { whole } else { place };
        let place = place.clamp(0.0, (size - 1) as f64);
        let behind = place.fract();
        Self::new(filter, size, place as usize, 1.0 - behind, behind)
    }

    /// Voxels and their weights, without those that weigh nothing, so that a NaN stays where it is.
    #[inline]
    pub fn iter(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.index.iter().copied().zip(self.weight).filter(|tap| tap.1 != 0.0)
    }
}

/// The values at `taps` along the first axis of `rows`, each of `width` numbers, into `new` rows.
pub(super) fn interpolate(rows: &[f64], width: usize, taps: &[Taps], new: &mut [f64]) {
    for (row, taps) in new.chunks_exact_mut(width).zip(taps) {
        row.fill(0.0);
        for (index, weight) in taps.iter() {
            for (sum, number) in row.iter_mut().zip(&rows[index * width..][..width]) {
                *sum += weight * number;
            }
        }
    }
}

/// Samples become coefficients along the first axis of `rows`, each of `width` numbers.
pub(super) fn to_coefficients(rows: &mut [f64], width: usize) {
    let size = rows.len() / width;
    if size < 2 {
        return;
    }
    let mut first = vec![0.0; width];
    for (k, weight) in first_weights(size).enumerate() {
        combine(&mut first, 1.0, &rows[k * width..][..width], GAIN * weight);
    }
    rows[..width].copy_from_slice(&first);
    for k in 1..size {
        let (done, rest) = rows.split_at_mut(k * width);
        combine(&mut rest[..width], GAIN, &done[(k - 1) * width..], POLE);
    }
    let (done, last) = rows.split_at_mut((size - 1) * width);
    let end = POLE / (POLE * POLE - 1.0);
    combine(last, end, &done[(size - 2) * width..], end * POLE);
    for k in (0..size - 1).rev() {
        let (rest, done) = rows.split_at_mut((k + 1) * width);
        combine(&mut rest[k * width..], -POLE, &done[..width], POLE);
    }
}

/// The weights of the first samples in the first number of the pass forward: the sum over all of the mirrored signal, of period
/// 2·size − 2, before it.
fn first_weights(size: usize) -> impl Iterator<Item = f64> {
    let period = 2 * size - 2;
    let power = |k: usize| if k < 2 * HORIZON { POLE.powi(k as i32) } else { 0.0 };
    let whole = 1.0 - power(period);
    let weight = move |k: usize| {
        let mirrored = if k == 0 || k == size - 1 { 0.0 } else { power(period - k) };
        (power(k) + mirrored) / whole
    };
    (0..size.min(HORIZON)).map(weight)
}

/// to = keep·to + weight·from, number by number.
fn combine(to: &mut [f64], keep: f64, from: &[f64], weight: f64) {
    let combine = |(to, from): (&mut [f64], &[f64])| {
        to.iter_mut().zip(from).for_each(|(to, from)| *to = keep * *to + weight * from);
    };
    if to.len() < PARALLEL {
        combine((to, from));
    } else {
        to.par_chunks_mut(PARALLEL / 4).zip(from.par_chunks(PARALLEL / 4)).for_each(combine);
    }
}
