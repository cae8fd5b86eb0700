//! The report of a run.

use crate::machine_run::MachineRun;
use crate::{Outcome, RunOptions, limits};
use cube3_host::PictureFrames;
use cube3_inputs::LoadedVolume;
use cube3_machine::MachineSpec;
use cube3_report::{
    DigestReport, ErrorReport, OpacityReport, PlanReport, Program, RunReport, SCHEMA, SequenceReport, SourcesReport,
    TimingCounts, VolumeReport, WallReport, WordsReport, axes_report, channel_reports, left_out, traffic_report,
    unit_reports, view_report,
};
use cube3_scene::Scene;
use std::collections::BTreeMap;

/// What was asked for.
pub(crate) struct Asked<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) machine: &'a MachineSpec,
    pub(crate) volume: &'a LoadedVolume,
    pub(crate) options: &'a RunOptions,
}

/// What was found out beside the machine's own counters.
pub(crate) struct Found {
    pub(crate) frames: u64,
    /// Voxels along x, y, z of the volumes that come in, where any do.
    pub(crate) incoming: Option<[usize; 3]>,
    /// Cycles from a picture's last pixel to the next one's; measured on the picture following itself where it is not given.
    pub(crate) interval: Option<u64>,
    pub(crate) samples: u64,
    pub(crate) opacity: Option<OpacityReport>,
    pub(crate) error: Option<ErrorReport>,
    pub(crate) digest: DigestReport,
    pub(crate) wall: WallReport,
    pub(crate) sequence: Option<SequenceReport>,
}

impl Asked<'_> {
    /// The report of a run whose first picture is `frames`, checked.
    pub(crate) fn report(&self, frames: &PictureFrames, run: &MachineRun, found: Found) -> Outcome<RunReport> {
        let &Asked { scene, machine, volume, options } = self;
        let passes = frames.setups.as_slice();
        let mut interval = 0;
        let (mut limits, mut resources) = (None, None);
        if let Some(counters) = &run.counters {
            interval = found.interval.map_or_else(|| limits::frame_interval(machine, passes), Ok)?;
            if options.limits {
                limits = Some(limits::limits(machine, passes, found.incoming)?);
            }
            if found.sequence.is_none() {
                resources = Some(cube3_resources::resources(machine, volume.words.dims, passes, counters, interval));
            }
        }
        let report = RunReport {
            schema: SCHEMA,
            program: Program { name: "cube3".into(), version: env!("CARGO_PKG_VERSION").into() },
            command: Vec::new(),
            sources: SourcesReport::default(),
            fidelity: options.runs.name().into(),
            seed: options.seed,
            scene: serde_json::to_value(scene)?,
            machine: serde_json::to_value(machine)?,
            volume: VolumeReport {
                source: volume.source.clone(),
                dims: volume.dims(),
                spacing: volume.words.spacing,
                conversion: conversion(scene, volume),
                window: volume.conversion.window,
                word_bits: volume.conversion.bits,
                scale: Some(volume.conversion.scale).filter(|scale| scale.is_finite()),
                clipped_below: volume.conversion.clipped_below,
                clipped_above: volume.conversion.clipped_above,
                masked: volume.conversion.masked,
                axes: axes_report(&volume.data.world),
            },
            view: view_report(scene, volume.words.spacing, &volume.data.world, frames)?,
            plan: PlanReport { enabled: options.plan, left_out: left_out(&frames.left_out) },
            timing: run.counters.as_ref().map(|counters| {
                TimingCounts {
                    frames: found.frames,
                    cycles: counters.cycles,
                    clock_hz: machine.clock_hz,
                    beams: counters.beams,
                    samples: found.samples,
                    ray_slots: counters.ray_slots,
                    fill_cycles: match found.frames {
                        1 if machine.frames.overlap => counters.cycles - interval,
                        _ => counters.cycles - counters.steady_cycles,
                    },
                    frame_interval_cycles: interval,
                }
                .into()
            }),
            limits,
            resources,
            traffic: run.counters.as_ref().map(|counters| traffic_report(machine, counters)),
            units: run.counters.as_ref().map_or_else(Vec::new, unit_reports),
            channels: run.counters.as_ref().map_or_else(Vec::new, channel_reports),
            words: WordsReport { opacity: found.opacity, ..words_report(run, volume) },
            error: found.error,
            digest: found.digest,
            wall: found.wall,
            sequence: found.sequence,
        };
        report.check()?;
        Ok(report)
    }
}

/// How values became voxel words, and whether they are labels.
pub fn conversion(scene: &Scene, volume: &LoadedVolume) -> String {
    let conversion = &volume.conversion;
    if scene.volume.labels { format!("labels, not interpolated; {conversion}") } else { conversion.to_string() }
}

fn words_report(run: &MachineRun, volume: &LoadedVolume) -> WordsReport {
    let mut overflows = BTreeMap::new();
    overflows.insert("voxel".into(), volume.conversion.clipped_below + volume.conversion.clipped_above);
    if run.bases.is_some() {
        overflows.insert("gradient and colour".into(), run.overflows.shading);
        overflows.insert("pixel".into(), run.overflows.pixel);
    }
    WordsReport { overflows, opacity: None }
}
