//! The machine's voxel words, and the way there from any samples.

use std::fmt;

use rayon::prelude::*;

use crate::error::show_dims;
use crate::readable;
use crate::samples::CHUNK;
use crate::volume::check_grid;
use crate::{Samples, Volume, VolumeError, with_samples};

/// A grid of unsigned words of 1 to 16 bits, as the cubic frame buffer stores it.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelWords {
    /// Voxels along x, y and z.
    pub dims: [usize; 3],
    /// Distance between voxel centres along x, y and z.
    pub spacing: [f64; 3],
    /// Bits of a word, 1 to 16.
    pub bits: u32,
    /// The data values that word 0 and word 2^bits − 1 stand for.
    pub window: [f64; 2],
    /// The words, x fastest, then y, then z; each below 2^bits.
    pub words: Vec<u16>,
}

/// What becomes of a value that falls between two words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WordRounding {
    /// The nearest word, a half upwards.
    #[default]
    Nearest,
    /// The word below.
    Truncate,
}

/// What becomes of NaN and infinities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NonFiniteRule {
    /// They are an error, with the voxel's position.
    #[default]
    Refuse,
    /// They become word 0 and are counted.
    Mask,
}

/// How samples become words.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WordConversion {
    /// The values [lo, hi] that become word 0 and word 2^bits − 1; `None`: the least and the
    /// greatest (finite) sample.
    pub window: Option<[f64; 2]>,
    /// What becomes of values between two words.
    pub rounding: WordRounding,
    /// What becomes of NaN and infinities.
    pub non_finite: NonFiniteRule,
}

impl WordConversion {
    /// Word = value: the window [0, 2^bits − 1], for data that are words already.
    pub fn identity(bits: u32) -> Self {
        let top = if bits < 32 { ((1u64 << bits) - 1) as f64 } else { f64::from(u32::MAX) };
        Self { window: Some([0.0, top]), ..Self::default() }
    }

    /// The conversion of labels up to `largest` to words of `bits`, for tables that are indexed by the leading `table_bits` of a word: a
    /// label is its own word, moved up by as many bits as the index drops, if there is room, so that each label has an entry of its own. A
    /// label without a word becomes the largest one.
    pub fn labels(largest: f64, bits: u32, table_bits: u32) -> Self {
        let dropped = bits.saturating_sub(table_bits);
        let top = f64::from((1_u32 << bits) - 1);
        let moved = |shift: u32| top / f64::from(1_u32 << shift);
        let shift = (0..=dropped).rev().find(|&shift| moved(shift).floor() >= largest).unwrap_or(0);
        Self { window: Some([0.0, moved(shift)]), ..Self::default() }
    }
}

/// What a conversion did, for the person who must trust it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConversionReport {
    /// The window used, [lo, hi].
    pub window: [f64; 2],
    /// Bits of a word.
    pub bits: u32,
    /// Words for one unit of the data, (2^bits − 1)/(hi − lo); 0 when lo = hi.
    pub scale: f64,
    /// The rounding used.
    pub rounding: WordRounding,
    /// Samples below the window, now word 0.
    pub clipped_below: u64,
    /// Samples above the window, now word 2^bits − 1 (word 0 when lo = hi).
    pub clipped_above: u64,
    /// Samples that were NaN or infinite, now word 0.
    pub masked: u64,
}

impl fmt::Display for ConversionReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounding = match self.rounding {
            WordRounding::Nearest => "rounded to nearest",
            WordRounding::Truncate => "truncated",
        };
        writeln!(
            f,
            "window {} to {} -> {}-bit words, {} words per unit, {rounding}",
            readable(self.window[0]),
            readable(self.window[1]),
            self.bits,
            readable(self.scale)
        )?;
        write!(
            f,
            "clipped {} below and {} above, masked {} not finite",
            self.clipped_below, self.clipped_above, self.masked
        )
    }
}

/// word = (value − lo)·top/(hi − lo). The product comes before the quotient, so that words that
/// are the data (lo = 0, hi = top, and every whole multiple) come out exact even when truncated;
/// only where the product overflows do halves take its place.
fn word_of(value: f64, [lo, hi]: [f64; 2], top: f64) -> f64 {
    if lo == hi {
        return 0.0;
    }
    let word = (value - lo) * top / (hi - lo);
    if word.is_finite() && (hi - lo).is_finite() {
        word
    } else {
        (value / 2.0 - lo / 2.0) / (hi / 2.0 - lo / 2.0) * top
    }
}

/// value = lo + word·(hi − lo)/top, by halves where that overflows.
fn value_of(word: f64, [lo, hi]: [f64; 2], top: f64) -> f64 {
    let value = lo + word * (hi - lo) / top;
    if value.is_finite() { value } else { lo * (1.0 - word / top) + hi * (word / top) }
}

fn check_bits(bits: u32) -> Result<(), VolumeError> {
    if (1..=16).contains(&bits) {
        return Ok(());
    }
    Err(VolumeError::Parameter {
        name: "voxel bits",
        reason: format!("{bits} bits"),
        remedy: "a voxel word has 1 to 16 bits",
    })
}

fn check_window(window: [f64; 2]) -> Result<(), VolumeError> {
    let [lo, hi] = window;
    if lo.is_finite() && hi.is_finite() && lo <= hi {
        return Ok(());
    }
    Err(VolumeError::Parameter {
        name: "window",
        reason: format!("{lo} to {hi} is no range of values"),
        remedy: "give two finite values, the lower first",
    })
}

impl VoxelWords {
    /// Words of checked parts.
    ///
    /// # Errors
    ///
    /// [`VolumeError::Parameter`] for bits outside 1 to 16 or a bad window, [`VolumeError::Grid`]
    /// for a bad grid, a wrong number of words, or a word of more bits.
    pub fn new(
        dims: [usize; 3],
        spacing: [f64; 3],
        bits: u32,
        window: [f64; 2],
        words: Vec<u16>,
    ) -> Result<Self, VolumeError> {
        check_bits(bits)?;
        check_window(window)?;
        check_grid(dims, spacing, [0.0; 3])?;
        if dims.iter().try_fold(1usize, |p, &d| p.checked_mul(d)) != Some(words.len()) {
            return Err(VolumeError::Grid {
                what: "words",
                reason: format!("{} given for {} voxels", words.len(), show_dims(&dims)),
                remedy: "give one word for each voxel",
            });
        }
        if let Some(&word) = words.iter().find(|&&w| u32::from(w) >> bits != 0) {
            return Err(VolumeError::Grid {
                what: "words",
                reason: format!("{word} has more than {bits} bits"),
                remedy: "give words below 2^bits",
            });
        }
        Ok(Self { dims, spacing, bits, window, words })
    }

    /// Words that stand for themselves (window [0, 2^bits − 1]), at unit spacing, computed voxel
    /// by voxel: `word(x, y, z)`.
    ///
    /// # Errors
    ///
    /// As [`VoxelWords::new`].
    pub fn from_fn(
        dims: [usize; 3],
        bits: u32,
        word: impl Fn(usize, usize, usize) -> u16 + Sync,
    ) -> Result<Self, VolumeError> {
        check_bits(bits)?;
        match Volume::from_fn(dims, [1.0; 3], word)?.samples {
            Samples::U16(words) => Self::new(dims, [1.0; 3], bits, [0.0, ((1u32 << bits) - 1) as f64], words),
            _ => unreachable!("a volume of u16 has u16 samples"),
        }
    }

    /// The greatest word, 2^bits − 1.
    pub fn top(&self) -> u16 {
        ((1u32 << self.bits) - 1) as u16
    }

    /// Index of voxel (x, y, z) in `words`.
    #[inline]
    pub fn index(&self, x: usize, y: usize, z: usize) -> usize {
        (z * self.dims[1] + y) * self.dims[0] + x
    }

    /// The word at voxel (x, y, z).
    ///
    /// # Panics
    ///
    /// When the voxel is outside the volume.
    #[inline]
    pub fn word(&self, x: usize, y: usize, z: usize) -> u16 {
        assert!(x < self.dims[0] && y < self.dims[1] && z < self.dims[2], "voxel outside the volume");
        self.words[self.index(x, y, z)]
    }

    /// The data value that a word (or a fraction of one) stands for.
    pub fn value_of(&self, word: f64) -> f64 {
        value_of(word, self.window, f64::from(self.top()))
    }

    /// The word, neither rounded nor clipped, that stands for a data value; 0 when the window is
    /// one value.
    pub fn word_of(&self, value: f64) -> f64 {
        word_of(value, self.window, f64::from(self.top()))
    }
}

impl Volume {
    /// The largest of a volume's labels. Samples that are not finite are left to [`Volume::to_words`].
    ///
    /// # Errors
    ///
    /// [`VolumeError::Parameter`] with the first voxel that is no whole number from 0 up, and for labels above 2^bits − 1.
    pub fn largest_label(&self, bits: u32) -> Result<f64, VolumeError> {
        check_bits(bits)?;
        let wrong = |reason, remedy| Err(VolumeError::Parameter { name: "labels", reason, remedy });
        let is_none = |value: f64| value.is_finite() && !(value >= 0.0 && value.fract() == 0.0);
        let first = self.first(is_none).map(|index| (index, self.samples.value(index)));
        if let Some((index, value)) = first {
            let [nx, ny, _] = self.dims;
            let at = [index % nx, index / nx % ny, index / nx / ny];
            return wrong(
                format!("voxel ({}, {}, {}) is {value}, and a label is a whole number from 0 up", at[0], at[1], at[2]),
                "give a segmentation, or leave labels out",
            );
        }
        let ((_, largest), _) = self.finite_range();
        let top = f64::from((1_u32 << bits) - 1);
        if largest > top {
            let remedy = match bits {
                16 => "number the labels anew, from 0 to 65535",
                _ => "raise words.voxel_bits in the machine file, up to 16, or number the labels anew",
            };
            return wrong(format!("the largest is {largest}, and a voxel word of {bits} bits holds {top}"), remedy);
        }
        Ok(largest)
    }

    /// The volume as words of `bits` bits: round((value − lo)/(hi − lo)·(2^bits − 1)), saturated;
    /// all 0 when lo = hi.
    ///
    /// # Errors
    ///
    /// [`VolumeError::Parameter`] for bits outside 1 to 16 or a bad window;
    /// [`VolumeError::NonFinite`] with the position of a NaN or an infinity, unless masked;
    /// [`VolumeError::TooLarge`] when the memory cannot be had.
    pub fn to_words(
        &self,
        bits: u32,
        conversion: &WordConversion,
    ) -> Result<(VoxelWords, ConversionReport), VolumeError> {
        check_bits(bits)?;
        if conversion.non_finite == NonFiniteRule::Refuse
            && let Some(bad) = self.first_non_finite()
        {
            return Err(bad.into());
        }
        let window = match conversion.window {
            Some(window) => window,
            None => {
                let ((lo, hi), _) = self.finite_range();
                [lo, hi]
            }
        };
        check_window(window)?;
        let [lo, hi] = window;
        let top = ((1u32 << bits) - 1) as f64;
        let rounding = conversion.rounding;

        let mut words = crate::limits::reserve::<u16>(self.len(), self.dims, crate::SampleType::U16, "voxel words")?;
        words.resize(self.len(), 0);
        let convert = |value: f64, count: &mut [u64; 3]| -> u16 {
            if !value.is_finite() {
                count[2] += 1;
                return 0;
            }
            count[0] += u64::from(value < lo);
            count[1] += u64::from(value > hi);
            let word = word_of(value.clamp(lo, hi), window, top);
            match rounding {
                WordRounding::Nearest => word.round() as u16,
                WordRounding::Truncate => word as u16,
            }
        };
        let chunk = |(i, words): (usize, &mut [u16])| {
            let mut count = [0; 3];
            with_samples!(&self.samples, v => {
                words.iter_mut().zip(&v[i * CHUNK..]).for_each(|(word, &s)| *word = convert(f64::from(s), &mut count));
            });
            count
        };
        let chunks = words.par_chunks_mut(CHUNK).enumerate().map(chunk);
        let count = chunks.reduce(|| [0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
        let report = ConversionReport {
            window,
            bits,
            scale: if lo == hi { 0.0 } else { top / (hi - lo) },
            rounding,
            clipped_below: count[0],
            clipped_above: count[1],
            masked: count[2],
        };
        let words = VoxelWords { dims: self.dims, spacing: self.spacing, bits, window, words };
        Ok((words, report))
    }
}
