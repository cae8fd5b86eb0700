//! The classification tables: opacity and colour over the sample word.

use crate::VolumeInfo;
use crate::golden::{self, Basis, StepLengths};
use crate::in_frame::{corrects_opacity, in_frame};
use cube3_frame::{Classification, FrameSetup, GradientRows};
use cube3_machine::MachineSpec;
use cube3_scene::Scene;
use cube3_word::{quantise_unit, unit_full};

/// Rows of the opacity table, where the scene's opacity depends on the gradient.
pub(crate) fn gradient_rows(
    scene: &Scene,
    machine: &MachineSpec,
    volume: &VolumeInfo,
    basis: &Basis,
) -> Option<GradientRows> {
    scene.transfer.is_two_dimensional().then(|| {
        let unit = golden::magnitude_unit(machine, volume, basis);
        golden::gradient_rows(scene.transfer.largest_gradient(), unit, machine.words.table_gradient_bits)
    })
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
        let steps = StepLengths::new(corrects_opacity(scene), &setup.geometry, volume.spacing);
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
        let value = |index| golden::entry_value(index, scene.volume.labels, words, volume.window);
        let unit = golden::magnitude_unit(machine, volume, basis);
        let magnitudes =
            (0..rows.map_or(1, |rows| rows.rows)).map(|row| golden::row_magnitude(row, rows) * unit).collect();
        let values = (0..1_u32 << words.table_bits).map(value).collect();
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
    let one = whole.unwrap_or(unit_full(words.opacity_bits));
    let word = |alpha: f64, length: f64| golden::opacity_word(alpha, length, one);
    let mut opacity: Vec<u32> =
        lengths.iter().flat_map(|&length| alphas.iter().map(move |&alpha| word(alpha, length))).collect();
    if let Some(whole) = whole {
        opacity.extend(golden::end_tables(&alphas, lengths, scene.mode, words.opacity_bits, whole));
    }
    let colour = values
        .iter()
        .map(|&value| scene.transfer.colour_at(value).map(|c| quantise_unit(c, words.colour_bits)))
        .collect();
    Classification {
        threshold: golden::threshold(scene.threshold.as_ref(), words, volume.window),
        index_shift,
        opacity,
        colour,
        gradient_rows: rows,
    }
}
