//! The classification tables: opacity and colour over the sample word.

use crate::setup::{StepLengths, in_frame};
use crate::{Basis, VolumeInfo, ends, gradient_scale};
use cube3_frame::{Classification, FrameSetup, GradientRows};
use cube3_machine::MachineSpec;
use cube3_scene::{Scene, corrected_opacity};
use cube3_word::{quantise_unit, unit_full};

/// Rows of the opacity table, where the scene's opacity depends on the gradient.
pub(crate) fn gradient_rows(
    scene: &Scene,
    machine: &MachineSpec,
    volume: &VolumeInfo,
    basis: &Basis,
) -> Option<GradientRows> {
    if !scene.transfer.is_two_dimensional() {
        return None;
    }
    let rows = 1_u32 << machine.words.table_gradient_bits;
    let unit = magnitude_unit(machine, volume, basis);
    let shift = (0..=30)
        .find(|&shift| f64::from(rows) * f64::from(1_u32 << shift) * unit >= scene.transfer.largest_gradient())
        .unwrap_or(30);
    Some(GradientRows { shift, rows })
}

/// The gradient, in data values for each smallest voxel spacing, that a magnitude word of 1 stands for.
fn magnitude_unit(machine: &MachineSpec, volume: &VolumeInfo, basis: &Basis) -> f64 {
    let words = &machine.words;
    let smallest = volume.spacing.iter().copied().fold(f64::INFINITY, f64::min);
    let (_, length) = basis.scale(machine.abc.gradient);
    let kept = gradient_scale(machine, basis).kept_bits;
    let dropped = f64::from(1_u32 << words.gradient_drop()) / f64::from(1_u32 << (words.sample_fraction_bits + kept));
    let value = (volume.window[1] - volume.window[0]) / f64::from(unit_full(words.voxel_bits));
    value * dropped * 0.5 * smallest / length
}

/// What the entries of a frame's opacity tables stand for.
#[derive(Clone, Debug, PartialEq)]
pub struct OpacityEntries {
    /// The data value in the middle of the samples that share an entry; of labels the first, which is the only one where the table is wide
    /// enough.
    pub values: Vec<f64>,
    /// The gradient in the middle of a row, in data values for each smallest voxel spacing; one where opacity depends on the value
    /// alone.
    pub magnitudes: Vec<f64>,
    /// The step lengths that opacity is corrected to, in units of the smallest spacing: a table for each.
    pub lengths: Vec<f64>,
}

impl OpacityEntries {
    /// Those of the tables of a frame that was set up for scene, machine and volume.
    pub fn of(scene: &Scene, machine: &MachineSpec, volume: &VolumeInfo, setup: &FrameSetup) -> OpacityEntries {
        let machine = &*in_frame(machine, &setup.geometry);
        let basis = Basis::new(&setup.geometry, volume.spacing, machine.abc.gradient);
        let steps = StepLengths::new(scene, &setup.geometry, volume.spacing);
        OpacityEntries::new(scene, machine, volume, steps.lengths, setup.classification.gradient_rows, &basis)
    }

    pub(crate) fn new(
        scene: &Scene,
        machine: &MachineSpec,
        volume: &VolumeInfo,
        lengths: Vec<f64>,
        rows: Option<GradientRows>,
        basis: &Basis,
    ) -> OpacityEntries {
        let words = &machine.words;
        let full = f64::from(unit_full(words.voxel_bits));
        let fraction = f64::from(1_u32 << words.sample_fraction_bits);
        let [low, high] = volume.window;
        let value_of = |sample: f64| low + sample / fraction / full * (high - low);
        let wide = f64::from(1_u32 << (words.sample_bits() - words.table_bits));
        // The product comes before the quotient: whole multiples come out exact.
        let label_of = |sample: f64| (low + sample / fraction * (high - low) / full).floor();
        let value = |index: u32| match scene.volume.labels {
            true => label_of(f64::from(index) * wide),
            false => value_of((f64::from(index) + 0.5) * wide - 0.5),
        };
        let values = (0..1_u32 << words.table_bits).map(value).collect();
        let unit = magnitude_unit(machine, volume, basis);
        let row_count = rows.map_or(1, |rows| rows.rows);
        let row_width = rows.map_or(0.0, |rows| f64::from(1_u32 << rows.shift));
        let magnitudes = (0..row_count).map(|row| ((f64::from(row) + 0.5) * row_width - 0.5).max(0.0) * unit).collect();
        OpacityEntries { values, magnitudes, lengths }
    }
}

/// The tables, each entry for the middle of the samples (and magnitudes) that share it; opacity for each of the step lengths, and for the
/// ends of rays where these have parts, with the word that is opacity 1 over a `whole` step.
pub(crate) fn tables(
    scene: &Scene,
    machine: &MachineSpec,
    volume: &VolumeInfo,
    entries: &OpacityEntries,
    rows: Option<GradientRows>,
    whole: Option<u32>,
) -> Classification {
    let words = &machine.words;
    let index_shift = words.sample_bits() - words.table_bits;
    let OpacityEntries { values, magnitudes, lengths } = entries;
    let alphas: Vec<f64> = magnitudes
        .iter()
        .flat_map(|&magnitude| values.iter().map(move |&value| scene.transfer.opacity_at(value, magnitude)))
        .collect();
    let one = f64::from(whole.unwrap_or(unit_full(words.opacity_bits)));
    let word = |alpha: f64, length: f64| (corrected_opacity(alpha, length) * one).round() as u32;
    let mut opacity: Vec<u32> =
        lengths.iter().flat_map(|&length| alphas.iter().map(move |&alpha| word(alpha, length))).collect();
    if let Some(whole) = whole {
        opacity.extend(ends::tables(&alphas, lengths, scene.mode, words.opacity_bits, whole));
    }
    let colour = values
        .iter()
        .map(|&value| scene.transfer.colour_at(value).map(|c| quantise_unit(c, words.colour_bits)))
        .collect();
    Classification { threshold: threshold(scene, machine, volume), index_shift, opacity, colour, gradient_rows: rows }
}

/// The scene's threshold as sample words, inclusive.
fn threshold(scene: &Scene, machine: &MachineSpec, volume: &VolumeInfo) -> [u32; 2] {
    let words = &machine.words;
    let top = unit_full(words.voxel_bits) << words.sample_fraction_bits;
    let [low, high] = volume.window;
    let word_of = |value: f64| (value - low) / (high - low) * f64::from(top);
    let bounds = scene.threshold.as_ref().map_or((None, None), |threshold| (threshold.low, threshold.high));
    let last = unit_full(words.sample_bits());
    [
        bounds.0.map_or(0, |value| word_of(value).ceil().clamp(0.0, f64::from(last)) as u32),
        bounds.1.map_or(last, |value| word_of(value).floor().clamp(0.0, f64::from(last)) as u32),
    ]
}
