//! One frame on the machine: picture, throughput, stalls, error.

use crate::checkpoint::Identity;
use crate::clocked::{Stops, run_clocked};
use crate::directions;
use crate::ends_note;
use crate::fidelity::{Fidelity, Timing};
use crate::function::{CanonicalVolume, FunctionRun, render};
use crate::gradient_error;
use crate::inputs::LoadedVolume;
use crate::limits;
use crate::machine::{Machine, Overflows, RunCounters};
use crate::notes::Findings;
use crate::problem::{Outcome, Problem};
use crate::progress::Progress;
use crate::ray_spacing;
use crate::reference::{self, Reference, check_reference, reference_error, reference_picture};
use crate::resources;
use cube3_cfb::memory::MemoryCounters;
use cube3_channel::Reason;
use cube3_dsb::LinkReading;
use cube3_frame::{BasePlane, FrameSetup, Geometry};
use cube3_host::{PictureFrames, canonical, picture_setup, warp_passes};
use cube3_machine::{MachineSpec, RaySlots, TemplateRule};
use cube3_metrics::{Picture, compare, difference, footprint, suggested_factor};
use cube3_plan::{Item, Savings};
use cube3_report::{
    ChannelReport, DigestReport, ErrorReport, LeftOut, LinkReport, MemoryTraffic, OpacityReport, PassReport,
    PerspectiveReport, PlanReport, Program, ReorderTraffic, RunReport, SCHEMA, SavingsReport, SequenceReport,
    SourcesReport, TimingCounts, TrafficReport, UnitReport, ViewReport, VolumeReport, WallReport, WordsReport,
    sha256_hex,
};
use cube3_scene::Scene;
use std::collections::BTreeMap;

/// Which runs are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Runs {
    /// *timing* and *function* side by side.
    #[default]
    Both,
    /// Cycles only.
    Timing,
    /// The picture only.
    Function,
    /// Both at once: real data in every token.
    Cycle,
}

impl Runs {
    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Runs::Both => "timing+function",
            Runs::Timing => "timing",
            Runs::Function => "function",
            Runs::Cycle => "cycle",
        }
    }
}

/// How a frame is run.
#[derive(Clone, Copy, Debug)]
pub struct RunOptions {
    /// Which runs are made.
    pub runs: Runs,
    /// What the picture is measured against.
    pub reference: Reference,
    /// Leave out what cannot change the picture.
    pub plan: bool,
    /// Written into the report.
    pub seed: u64,
}

impl Default for RunOptions {
    fn default() -> Self {
        RunOptions { runs: Runs::Both, reference: Reference::default(), plan: true, seed: 0 }
    }
}

/// The pictures of a run; those that were not made are missing.
#[derive(Clone, Debug, Default)]
pub struct Pictures {
    /// The warped picture.
    pub image: Option<Picture>,
    /// The base plane over the background.
    pub base_plane: Option<Picture>,
    /// The reference.
    pub reference: Option<Picture>,
    /// Absolute difference, magnified.
    pub difference: Option<Picture>,
}

/// What a run gives.
#[derive(Clone, Debug)]
pub struct RunResult {
    /// The report.
    pub report: RunReport,
    /// The pictures.
    pub pictures: Pictures,
    /// What a person should know, in sentences.
    pub notes: Vec<String>,
    /// The clocked run's counters, where there was one.
    pub counters: Option<RunCounters>,
}

/// What the machine has given over all frames of the picture: counters, base planes, saturated words, and the seconds each run
/// took.
#[derive(Default)]
pub(crate) struct MachineRun {
    pub(crate) counters: Option<RunCounters>,
    pub(crate) bases: Option<Vec<BasePlane>>,
    pub(crate) overflows: Overflows,
    pub(crate) timing_s: Option<f64>,
    pub(crate) function_s: Option<f64>,
    pub(crate) cycle_s: Option<f64>,
    /// What the stops of the clocked run have to tell.
    pub(crate) told: Vec<String>,
}

/// Runs a frame.
///
/// # Errors
/// A scene, machine or volume that cannot be run, and a machine that cannot move.
pub fn run_frame(
    scene: &Scene,
    machine: &MachineSpec,
    volume: &LoadedVolume,
    options: &RunOptions,
) -> Outcome<RunResult> {
    run_frame_with(scene, machine, volume, options, &Stops::default())
}

/// Runs a frame, with stops of the clocked run.
///
/// # Errors
/// As [`run_frame`], and stops that are not in the run.
pub fn run_frame_with(
    scene: &Scene,
    machine: &MachineSpec,
    volume: &LoadedVolume,
    options: &RunOptions,
    stops: &Stops,
) -> Outcome<RunResult> {
    let total = Progress::new("total");
    let as_asked = scene;
    let scene = &*scene.thickened(volume.single);
    let frames = picture_setup(scene, machine, &volume.info(), options.plan)?;
    check_reference(options.reference, &frames)?;
    let findings = Findings::new(scene, machine, volume, &frames);
    let mut run = run_machine(&frames, machine, volume, options, stops)?;
    let mut pictures = Pictures::default();
    let mut digest = DigestReport::default();
    if let Some(bases) = &run.bases {
        (pictures, digest) = show(bases, &frames, scene, volume)?;
    }
    if let Some(image) = &pictures.image {
        run.told.extend(ends_note::note(scene, machine, volume, &frames, image, options.plan)?);
    }
    let (error, reference_s) = match options.reference {
        Reference::None => (None, None),
        _ if pictures.image.is_none() => (None, None),
        reference => {
            let progress = Progress::new("reference");
            let picture = reference_picture(reference, scene, machine, volume, &frames, false, &progress)?;
            let seconds = progress.finish();
            let own = reference_error(reference, scene, volume, &picture)?;
            let mut error = measure(reference, scene, &frames, volume, picture, &mut pictures)?;
            run.told.extend(reference::note(own.as_ref(), &error));
            error.reference = own;
            (Some(error), Some(seconds))
        }
    };
    let samples = frames.setups.iter().map(|setup| setup.geometry.sample_count()).sum();
    let total_s = Some(total.finish() + volume.made_s.unwrap_or(0.0));
    let wall = WallReport { volume_s: volume.made_s, reference_s, total_s, ..run.wall(samples) };
    let asked = Asked { scene: as_asked, machine, volume, options };
    let opacity = findings.opacity();
    let found =
        Found { frames: 1, incoming: None, interval: None, samples, opacity, error, digest, wall, sequence: None };
    let report = asked.report(&frames, &run, found)?;
    let mut told = volume.notes.clone();
    told.extend(run.told);
    told.extend(findings.notes(run.bases.as_deref(), samples));
    told.extend(ray_spacing::notes(volume.dims(), volume.words.spacing));
    Ok(RunResult { report, pictures, notes: told, counters: run.counters })
}

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
            limits = Some(limits::limits(machine, passes, found.incoming)?);
            if found.sequence.is_none() {
                resources = Some(resources::resources(machine, volume.words.dims, passes, counters, interval));
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
                axes: directions::axes_report(&volume.data.world),
            },
            view: view_report(scene, volume, frames)?,
            plan: PlanReport { enabled: options.plan, left_out: left_out(frames) },
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

/// The picture and the base planes over the background, and their digests.
pub(crate) fn show(
    bases: &[BasePlane],
    frames: &PictureFrames,
    scene: &Scene,
    volume: &LoadedVolume,
) -> Outcome<(Pictures, DigestReport)> {
    let passes: Vec<(&BasePlane, &Geometry)> =
        bases.iter().zip(frames.setups.iter().map(|setup| &setup.geometry)).collect();
    let image = warp_passes(&passes, &frames.plane, volume.words.spacing, scene.background);
    let image = Picture::new(frames.plane.width, frames.plane.height, image)?;
    let digest = DigestReport {
        base_plane: Some(sha256_hex(&bases.iter().flat_map(bytes).collect::<Vec<u8>>())),
        image: Some(sha256_hex(&cube3_report::to_rgb8(&image))),
    };
    let base_plane = side_by_side(bases, scene.background)?;
    Ok((Pictures { image: Some(image), base_plane, ..Pictures::default() }, digest))
}

fn run_machine(
    frames: &PictureFrames,
    machine: &MachineSpec,
    volume: &LoadedVolume,
    options: &RunOptions,
    stops: &Stops,
) -> Outcome<MachineRun> {
    if options.runs == Runs::Function && !stops.is_empty() {
        return Err(Problem::new(
            "--fidelity function has no cycles to trace, save or resume; give --fidelity timing, both or cycle",
        ));
    }
    let mut run = MachineRun::default();
    let (setups, words) = (frames.setups.as_slice(), &volume.words);
    if setups.is_empty() {
        run.bases = (options.runs != Runs::Timing).then(Vec::new);
        return Ok(run);
    }
    let function = || function(setups, words.dims, &words.words, options.plan);
    match options.runs {
        Runs::Both => {
            let (timing, function) = std::thread::scope(|scope| {
                let timing = scope.spawn(|| timing(setups, machine, volume, stops));
                let function = function();
                (timing.join(), function)
            });
            run.take_timing(timing.map_err(|_| Problem::new("the timing run stopped unexpectedly"))??);
            run.take_function(function);
        }
        Runs::Timing => run.take_timing(timing(setups, machine, volume, stops)?),
        Runs::Function => run.take_function(function()),
        Runs::Cycle => {
            let progress = Progress::new("cycle");
            let mut cycle = Machine::cycle(machine, setups.to_vec(), words.dims, &words.words)?;
            run.told = clocked(&mut cycle, Runs::Cycle, setups, machine, volume, stops, &progress)?;
            run.cycle_s = Some(progress.finish());
            run.counters = Some(cycle.counters());
            run.overflows = cycle.overflows();
            run.bases = Some(cycle.into_base_planes());
        }
    }
    Ok(run)
}

impl MachineRun {
    fn take_timing(&mut self, (counters, seconds, told): TimingRun) {
        self.counters = Some(counters);
        self.timing_s = Some(seconds);
        self.told = told;
    }

    /// The seconds that the machine's runs took, which gave so many samples.
    pub(crate) fn wall(&self, samples: u64) -> WallReport {
        let image_s = self.function_s.or(self.cycle_s);
        WallReport {
            timing_s: self.timing_s,
            function_s: self.function_s,
            cycle_s: self.cycle_s,
            samples_per_s: image_s.filter(|s| *s > 0.0).map(|seconds| samples as f64 / seconds),
            threads: Some(rayon::current_num_threads()),
            ..WallReport::default()
        }
    }

    fn take_function(&mut self, (runs, seconds): (Vec<FunctionRun>, f64)) {
        self.overflows = runs.iter().fold(Overflows::default(), |sum, run| sum.plus(run.overflows));
        self.bases = Some(runs.into_iter().map(|run| run.base).collect());
        self.function_s = Some(seconds);
    }
}

/// What a timing run gives: counters, seconds, and what its stops have to tell.
type TimingRun = (RunCounters, f64, Vec<String>);

fn timing(setups: &[FrameSetup], machine: &MachineSpec, volume: &LoadedVolume, stops: &Stops) -> Outcome<TimingRun> {
    let progress = Progress::new("timing");
    let mut timing: Machine<Timing> = Machine::timing(machine, setups.to_vec())?;
    let told = clocked(&mut timing, Runs::Timing, setups, machine, volume, stops, &progress)?;
    Ok((timing.counters(), progress.finish(), told))
}

fn clocked<F: Fidelity>(
    run: &mut Machine<F>,
    runs: Runs,
    setups: &[FrameSetup],
    machine: &MachineSpec,
    volume: &LoadedVolume,
    stops: &Stops,
    progress: &Progress,
) -> Outcome<Vec<String>> {
    let words = &volume.words;
    let identity = || Identity::new(runs.name(), machine, setups, words.dims, &words.words);
    run_clocked(run, stops, machine.clock_hz, identity, &|done, all| progress.set(done, all))
}

/// Renders frames of a volume of voxel words, x fastest; also the seconds.
pub(crate) fn function(setups: &[FrameSetup], dims: [usize; 3], words: &[u16], skip: bool) -> (Vec<FunctionRun>, f64) {
    let progress = Progress::new("function");
    let pass = |setup: &FrameSetup| {
        let turned = CanonicalVolume::new(&setup.geometry.axes, dims, words);
        render(setup, &turned, skip, &|done, all| progress.set(done, all))
    };
    let runs = setups.iter().map(pass).collect();
    (runs, progress.finish())
}

/// Columns of background between base planes.
const GAP: usize = 4;

/// All base planes in one picture, side by side over the background; none where there are none.
fn side_by_side(bases: &[BasePlane], background: [f64; 3]) -> Outcome<Option<Picture>> {
    let Some(height) = bases.iter().map(|base| base.height).max() else {
        return Ok(None);
    };
    let width = bases.iter().map(|base| base.width).sum::<usize>() + GAP * (bases.len() - 1);
    let mut pixels = vec![background; width * height];
    let mut left = 0;
    for base in bases {
        for (row, line) in base.over(background).chunks(base.width).enumerate() {
            pixels[row * width + left..][..base.width].copy_from_slice(line);
        }
        left += base.width + GAP;
    }
    Ok(Some(Picture::new(width, height, pixels)?))
}

/// Raw pixels of a base plane: each word as 32 bits, little-endian.
fn bytes(base: &BasePlane) -> Vec<u8> {
    base.pixels.iter().flatten().flat_map(|word| word.to_le_bytes()).collect()
}

/// The picture against its reference; both and their difference are then among the pictures.
pub(crate) fn measure(
    reference: Reference,
    scene: &Scene,
    frames: &PictureFrames,
    volume: &LoadedVolume,
    picture: Picture,
    pictures: &mut Pictures,
) -> Outcome<ErrorReport> {
    let Some(image) = &pictures.image else {
        return Err(Problem::new("there is no picture to measure"));
    };
    let object = footprint(image, &picture, scene.background)?;
    let comparison = compare(image, &picture, Some(&object))?;
    let factor = suggested_factor(comparison.whole.max);
    pictures.difference = Some(difference(image, &picture, f64::from(factor))?);
    pictures.reference = Some(picture);
    let mut error = ErrorReport::new(reference.name(), &comparison, f64::from(factor));
    error.gradient_mean_deg = gradient_error::mean_angle_deg(&frames.setups, &volume.words);
    Ok(error)
}

/// How values became voxel words, and whether they are labels.
pub(crate) fn conversion(scene: &Scene, volume: &LoadedVolume) -> String {
    let conversion = &volume.conversion;
    if scene.volume.labels { format!("labels, not interpolated; {conversion}") } else { conversion.to_string() }
}

fn view_report(scene: &Scene, volume: &LoadedVolume, frames: &PictureFrames) -> Outcome<ViewReport> {
    let central = canonical(frames.view.direction, volume.words.spacing);
    let geometry = frames.setups.first().map(|setup| &setup.geometry);
    let axes = geometry.map_or(central.axes, |geometry| geometry.axes);
    let mut flips = [false; 3];
    for i in 0..3 {
        flips[axes.axis[i]] = axes.reversed[i];
    }
    let (rule, slots) = geometry.map_or(("no frame", ""), |geometry| {
        let rule = match geometry.rule {
            TemplateRule::SampleFloor => "sample-floor",
            TemplateRule::PlaneFloor => "plane-floor",
            TemplateRule::Nearest => "nearest voxel",
        };
        let slots = match geometry.slots {
            _ if geometry.perspective.is_some() => ", a slot for each ray",
            RaySlots::Wrapped => ", wrapped",
            RaySlots::Padded => ", padded",
        };
        (rule, slots)
    });
    let parallel = geometry.filter(|geometry| geometry.perspective.is_none());
    Ok(ViewReport {
        sides: directions::sides_report(&scene.view, &volume.data.world)?,
        major_axis: AXES[axes.axis[2]].into(),
        flips,
        slopes: parallel.map_or(central.slopes, Geometry::real_slopes),
        offset: geometry.map_or(0.0, Geometry::real_offset),
        template_rule: format!("{rule}{slots}"),
        base_plane_size: geometry.map_or([0; 2], Geometry::base_plane_size),
        perspective: frames.eye_voxel.map(|eye_voxel| PerspectiveReport {
            eye_voxel,
            field_of_view_deg: scene.view.perspective.map_or(0.0, |perspective| perspective.field_of_view_deg),
            passes: frames.setups.iter().filter_map(pass_report).collect(),
        }),
    })
}

const AXES: [&str; 3] = ["x", "y", "z"];

fn pass_report(setup: &FrameSetup) -> Option<PassReport> {
    let geometry = &setup.geometry;
    let coverage = geometry.coverage()?;
    let sign = if geometry.axes.reversed[2] { "−" } else { "+" };
    Some(PassReport {
        axis: format!("{sign}{}", AXES[geometry.axes.axis[2]]),
        base_plane_size: geometry.base_plane_size(),
        offset: geometry.real_offset(),
        own_cells: geometry.doubled(),
        gradient: setup.gradient.map(|registers| registers.method.name().into()),
        back_spacing_voxel: coverage.back_spacing,
        unused_voxel_fraction: coverage.unused,
        widest_cell_voxel: coverage.widest_cell,
    })
}

fn left_out(frames: &PictureFrames) -> Vec<LeftOut> {
    let entry = |item: &Item| {
        let (row, savings) = (item.row(), savings(&item.savings));
        LeftOut {
            rule: row.name.into(),
            what: row.what.into(),
            why: item.why.into(),
            saves: savings.in_words(),
            savings,
        }
    };
    frames.left_out.iter().map(entry).collect()
}

fn savings(saved: &Savings) -> SavingsReport {
    let Savings { operators, cycles, bytes, operations, passes } = *saved;
    SavingsReport { operators_per_lane: operators, cycles, bytes, operations, passes }
}

fn unit_reports(counters: &RunCounters) -> Vec<UnitReport> {
    let report = |(name, account): &(&str, cube3_channel::Account)| UnitReport {
        name: (*name).into(),
        busy: account.busy,
        starved: account.starved,
        blocked: account.blocked,
        waiting: Reason::ALL
            .iter()
            .map(|(reason, name)| ((*name).to_owned(), account.waiting[*reason as usize]))
            .filter(|(_, cycles)| *cycles > 0)
            .collect(),
    };
    counters.units.iter().map(report).collect()
}

fn traffic_report(machine: &MachineSpec, counters: &RunCounters) -> TrafficReport {
    let mut sum = MemoryCounters::default();
    counters.memory.iter().for_each(|&frame| sum += frame);
    let memory = (!counters.memory.is_empty()).then_some(MemoryTraffic {
        words: sum.words,
        reads: sum.reads,
        row_hits: sum.row_hits,
        row_misses: sum.row_misses,
        row_conflicts: sum.row_conflicts,
        refreshes: sum.refreshes,
    });
    let reorder = counters.reorder.map(|buffer| ReorderTraffic {
        words: buffer.words,
        peak_words: buffer.peak_words,
        rows: buffer.rows,
        mini_blocks: buffer.mini_blocks,
    });
    let (bus, rays, host) = (&counters.bus, &counters.ray_words, &counters.host);
    let slots = limits::link_slots(machine, counters.cycles);
    let link = |reading: &LinkReading| LinkReport {
        link: reading.link as u64,
        direction: reading.direction().into(),
        words: reading.carried(),
        slots,
        peak_words: reading.peak,
    };
    TrafficReport {
        memory,
        reorder,
        bus_words: bus.words,
        bus_slots: bus.slots,
        link_words: bus.link_words,
        link_peak_words: bus.link_peak,
        ray_words: [rays.trilin, rays.abc, rays.cone],
        links: counters.links.iter().map(link).collect(),
        host_pixels: host.pixels,
        host_bytes: host.bytes,
    }
}

fn channel_reports(counters: &RunCounters) -> Vec<ChannelReport> {
    let report = |reading: &crate::machine::ChannelReading| ChannelReport {
        name: reading.name.into(),
        from: reading.joint.from.into(),
        to: reading.joint.to.into(),
        capacity: reading.capacity as u64,
        latency: reading.latency,
        pushes: reading.counters.pushes,
        pops: reading.counters.pops,
        occupancy: reading.occupancy as u64,
        max_occupancy: reading.counters.max_occupancy,
        mean_occupancy: reading.counters.occupancy_cycles as f64 / counters.cycles.max(1) as f64,
    };
    counters.channels.iter().map(report).collect()
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
