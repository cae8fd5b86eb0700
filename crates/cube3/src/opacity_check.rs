//! The opacity table against the transfer function that it stands for, over the words that voxels have.
//!
//! ```text
//!   scene at the voxel's value ──────► scene in the middle of its entry ──────► the table's word
//!                         entries: too wide                         rounding: too few bits
//! ```
//!
//! Voxels are looked at, not the samples between them: where voxels of one value lie together, samples have that value too.

use cube3_frame::{Classification, FrameSetup};
use cube3_host::{OpacityEntries, whole_step_opacity};
use cube3_inputs::LoadedVolume;
use cube3_machine::MachineSpec;
use cube3_report::{OpacityChange, OpacityReport};
use cube3_scene::{Mode, Scene, corrected_opacity};
use cube3_word::{Words, quantise_unit, unit_full, unit_resize};
use rayon::prelude::*;

/// An opacity is off when it differs by more than this part of what it should be.
const OFF: f64 = 0.1;

/// A change is worth a note when the opacities of a mean ray miss, or have too much, a level of an 8-bit display in sum: less
/// cannot be seen in the picture as a whole, however many voxels it is spread over.
const WORTH_A_NOTE: f64 = 1.0 / 255.0;

/// Most bits of an opacity and of a table's index.
const MOST_BITS: u32 = 16;

/// Whether a change can be seen.
pub fn is_worth_a_note(change: &OpacityChange) -> bool {
    change.of_a_ray() >= WORTH_A_NOTE
}

/// What a frame's opacity table was found to be.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OpacityCheck {
    /// Shares and sums.
    pub report: OpacityReport,
    /// Where rounding changes most: the scene's opacity, and the word's.
    pub rounded: [f64; 2],
    /// Where the width of entries changes most: a voxel's value, its opacity, and the table's.
    pub misplaced: [f64; 3],
}

/// A frame, what it was set up for, and how many voxels have each word.
#[derive(Clone, Copy)]
pub struct CheckedFrame<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The machine.
    pub machine: &'a MachineSpec,
    /// The volume.
    pub volume: &'a LoadedVolume,
    /// Its registers and tables.
    pub setup: &'a FrameSetup,
    /// Voxels by word.
    pub counts: &'a [u64],
}

impl CheckedFrame<'_> {
    /// The check of the frame's own table.
    pub fn check(&self) -> OpacityCheck {
        self.against(&self.setup.words, Some(&self.setup.classification))
    }

    /// The shortest words with which something is left, and no change by rounding is worth a note.
    pub fn words_that_hold(&self) -> Option<Words> {
        let words = self.setup.words;
        let with = |bits: u32| Words {
            opacity_bits: words.opacity_bits.max(bits),
            accumulator_bits: words.accumulator_bits.max(bits),
            ..words
        };
        let holds = |words: &Words| {
            let report = self.against(words, None).report;
            report.lost_fraction < report.shown_fraction && !is_worth_a_note(&report.rounding)
        };
        let least = words.opacity_bits.min(words.accumulator_bits) + 1;
        (least..=MOST_BITS).map(with).find(holds)
    }

    /// The shortest index of the table with which something is left, and no change by the width of its entries is worth a note.
    pub fn table_bits_that_hold(&self) -> Option<u32> {
        let words = self.setup.words;
        let holds = |&table_bits: &u32| {
            let report = self.against(&Words { table_bits, ..words }, None).report;
            report.lost_fraction < report.shown_fraction && !is_worth_a_note(&report.entries)
        };
        (words.table_bits + 1..=words.sample_bits().min(MOST_BITS)).find(holds)
    }

    /// The value of the voxels with a word; of whole numbers the one that the word was made of.
    fn value_of(&self, word: usize) -> f64 {
        let words = &self.volume.words;
        let value = words.value_of(word as f64);
        let whole = value.round();
        let is_whole = !self.volume.data.sample_type().is_float() && (words.word_of(whole) - word as f64).abs() < 1.0;
        if is_whole { whole } else { value }
    }

    /// The check of the frame's table, or of the one that it would have with other words.
    fn against(&self, words: &Words, table: Option<&Classification>) -> OpacityCheck {
        let &CheckedFrame { scene, volume, setup, counts, .. } = self;
        let machine = self.machine.clone().with_words(*words);
        let entries = OpacityEntries::of(scene, &machine, &volume.info(), setup);
        let index_shift = words.sample_bits() - words.table_bits;
        let seen = Seen::of(scene, words);
        // Where ends of rays are exact, the word of a whole step need not be the full one.
        let whole = match (table, &setup.ends) {
            (Some(_), Some(_)) => whole_step_opacity(scene.mode, words, setup.geometry.bounding_planes()),
            _ => unit_full(words.opacity_bits),
        };
        let scale = f64::from(unit_full(words.opacity_bits)) / f64::from(whole);
        let of_word = |word: usize| {
            let index = word << words.sample_fraction_bits >> index_shift;
            let (value, middle) = (self.value_of(word), entries.values[index]);
            let unit = |value: f64, row: usize| scene.transfer.opacity_at(value, entries.magnitudes[row]);
            // The gradients of voxels are not looked at: the one is taken with which they show most.
            let most = |most: usize, row: usize| if unit(value, row) > unit(value, most) { row } else { most };
            let row = (1..entries.magnitudes.len()).fold(0, most);
            let units = [unit(value, row), unit(middle, row)];
            let opacities = entries.lengths.iter().enumerate().map(|(class, &length)| {
                let [real, centre] = units.map(|unit| corrected_opacity(unit, length));
                let entry = (class * entries.magnitudes.len() + row) * entries.values.len() + index;
                let held =
                    table.map_or_else(|| quantise_unit(centre, words.opacity_bits), |table| table.opacity[entry]);
                [seen.of_real(real), seen.of_real(centre), seen.of_word(held) * scale]
            });
            (word, value, opacities.collect())
        };
        let [low, high] = setup.classification.threshold;
        let within = |word: &usize| (low..=high).contains(&((*word as u32) << words.sample_fraction_bits));
        // In the order of the words, so that the sums do not depend on the threads.
        let found: Vec<(usize, f64, Vec<[f64; 3]>)> =
            (0..counts.len()).into_par_iter().filter(|&word| counts[word] > 0).filter(within).map(of_word).collect();

        let voxels = counts.iter().sum::<u64>() as f64;
        let samples = match scene.mode {
            Mode::WeightedSum => 1.0,
            _ => setup.geometry.size[2] as f64,
        };
        let asked = |(_, _, opacities): &&(usize, f64, Vec<[f64; 3]>)| {
            opacities.iter().any(|[real, _, held]| differ(*real, *held))
        };
        let mut off = vec![false; counts.len()];
        found.iter().filter(asked).for_each(|(word, _, _)| off[*word] = true);
        let flat = match off.contains(&true) {
            true => volume.words.flat_counts(index_shift.saturating_sub(words.sample_fraction_bits), &off),
            false => vec![0; counts.len()],
        };
        let mut sums = Sums::default();
        sums.check.report.smallest_opacity = seen.smallest();
        for (word, value, opacities) in &found {
            let voxels = [counts[*word], flat[*word]].map(|count| count as f64 / opacities.len() as f64);
            opacities.iter().for_each(|&opacities| sums.add(*value, opacities, voxels));
        }
        // By halves, for a window as wide as numbers go.
        let [low, high] = volume.words.window.map(|end| end / 2.0 / f64::from(unit_full(words.voxel_bits)));
        let halves = f64::from(2_u32 << index_shift) / f64::from(1_u32 << words.sample_fraction_bits);
        let OpacityReport { shown_fraction, lost_fraction, off_fraction, rounding, entries, .. } =
            &mut sums.check.report;
        for change in [&mut *rounding, &mut *entries] {
            change.ray_less *= samples / voxels;
            change.ray_more *= samples / voxels;
        }
        // Whole voxels were summed: of all of them the fraction is 1.
        for fraction in [shown_fraction, lost_fraction, off_fraction, &mut rounding.fraction, &mut entries.fraction] {
            *fraction /= voxels;
        }
        sums.check.report.entry_width = ((high - low) * halves).min(f64::MAX);
        sums.check
    }
}

/// How a mode sees an opacity: as it is, or as opaque or not.
struct Seen<'a> {
    words: &'a Words,
    /// The opacity from which a sample is opaque, where that is all that counts: in reals, and as a word.
    opaque: Option<(f64, u32)>,
}

impl<'a> Seen<'a> {
    fn of(scene: &Scene, words: &'a Words) -> Seen<'a> {
        let alpha = scene.transfer.opaque_alpha;
        let surface = matches!(scene.mode, Mode::FirstOpaque | Mode::LastOpaque);
        Seen { words, opaque: surface.then(|| (alpha, quantise_unit(alpha, words.opacity_bits).max(1))) }
    }

    fn of_real(&self, opacity: f64) -> f64 {
        self.opaque.map_or(opacity, |(opaque, _)| f64::from(opacity >= opaque))
    }

    fn of_word(&self, word: u32) -> f64 {
        self.opaque.map_or_else(|| self.accumulated(word), |(_, opaque)| f64::from(word >= opaque))
    }

    /// The opacity of a word as a leaf of the cone has it.
    fn accumulated(&self, word: u32) -> f64 {
        let bits = self.words.accumulator_bits;
        f64::from(unit_resize(word, self.words.opacity_bits, bits)) / f64::from(unit_full(bits))
    }

    /// The least opacity above 0 that a leaf can have.
    fn smallest(&self) -> f64 {
        let dropped = self.words.opacity_bits.saturating_sub(self.words.accumulator_bits);
        self.accumulated(1 << dropped)
    }
}

/// What has been summed, and the largest changes so far.
#[derive(Default)]
struct Sums {
    check: OpacityCheck,
    largest: [f64; 2],
}

impl Sums {
    /// Voxels, and those of them that lie flat, whose opacity is `real`, in the middle of their entry `centre`, and in the table
    /// `held`.
    fn add(&mut self, value: f64, [real, centre, held]: [f64; 3], [voxels, flat]: [f64; 2]) {
        let OpacityCheck { report, rounded, misplaced } = &mut self.check;
        if real > 0.0 {
            report.shown_fraction += voxels;
        }
        if real > 0.0 && held == 0.0 {
            report.lost_fraction += voxels;
        }
        if !differ(real, held) {
            return;
        }
        report.off_fraction += voxels;
        if (held - centre).abs() >= (centre - real).abs() {
            let change = add(&mut report.rounding, [real, held], [voxels, voxels]);
            if change > self.largest[0] {
                (self.largest[0], *rounded) = (change, [real, held]);
            }
        } else {
            let change = add(&mut report.entries, [real, held], [voxels, flat]);
            if change > self.largest[1] {
                (self.largest[1], *misplaced) = (change, [value, real, held]);
            }
        }
    }
}

/// Whether an opacity is off from what it should be.
fn differ(from: f64, to: f64) -> bool {
    (from - to).abs() > OFF * from
}

/// Adds voxels whose opacity changes, and how many of them are felt, and gives how much changes.
fn add(change: &mut OpacityChange, [from, to]: [f64; 2], [voxels, felt]: [f64; 2]) -> f64 {
    change.fraction += voxels;
    change.ray_less += felt * (from - to).max(0.0);
    change.ray_more += felt * (to - from).max(0.0);
    voxels * (from - to).abs()
}
