//! One frame on the machine: picture, throughput, stalls, error.

use crate::checkpoint::Identity;
use crate::clocked::{Stops, run_clocked};
use crate::fidelity::{Fidelity, Timing};
use crate::function::{CanonicalVolume, FunctionRun, render};
use crate::gradient_error;
use crate::inputs::LoadedVolume;
use crate::limits;
use crate::machine::{Machine, Overflows, RunCounters};
use crate::problem::{Outcome, Problem};
use crate::progress::Progress;
use crate::resources;
use cube3_channel::Reason;
use cube3_host::{BasePlane, Frame, ImagePlane, MachineSpec, RaySlots, TemplateRule, frame_setup, warp};
use cube3_metrics::{Picture, compare, difference, footprint, suggested_factor};
use cube3_raycast::{DiscreteOptions, ImageOrderOptions, image_order, sheared, true_3d};
use cube3_report::{
    ChannelReport, DigestReport, ErrorReport, LeftOut, PlanReport, Program, RunReport, SCHEMA, SequenceReport,
    TimingCounts, UnitReport, ViewReport, VolumeReport, WallReport, WordsReport, sha256_hex,
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

/// What the picture is measured against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reference {
    /// Rays from image pixels, uniform steps of a voxel, exact interpolation.
    #[default]
    ImageOrder,
    /// The machine's sample positions, exact interpolation.
    True,
    /// The machine's interpolation in reals.
    Sheared,
    /// Nothing.
    None,
}

impl Reference {
    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Reference::ImageOrder => "image-order",
            Reference::True => "true",
            Reference::Sheared => "sheared",
            Reference::None => "none",
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
        RunOptions { runs: Runs::Both, reference: Reference::ImageOrder, plan: true, seed: 0 }
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

/// What the machine has given: counters, base plane, saturated words, and the seconds each run took.
#[derive(Default)]
pub(crate) struct MachineRun {
    pub(crate) counters: Option<RunCounters>,
    pub(crate) base: Option<BasePlane>,
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
    let frame = frame_setup(scene, machine, &volume.info(), options.plan)?;
    let run = run_machine(&frame, machine, volume, options, stops)?;
    let mut pictures = Pictures::default();
    let mut digest = DigestReport::default();
    if let Some(base) = &run.base {
        (pictures, digest) = show(base, &frame, scene, volume)?;
    }
    let (error, reference_s) = match options.reference {
        Reference::None => (None, None),
        _ if pictures.image.is_none() => (None, None),
        reference => {
            let progress = Progress::new("reference");
            let picture = reference_picture(reference, scene, machine, volume, &frame, &progress)?;
            let seconds = progress.finish();
            let error = measure(reference, scene, &frame, volume, picture, &mut pictures)?;
            (Some(error), Some(seconds))
        }
    };
    let samples = frame.setup.geometry.sample_count();
    let wall = WallReport { reference_s, total_s: Some(total.finish()), ..run.wall(samples) };
    let asked = Asked { scene, machine, volume, options };
    let found = Found { frames: 1, samples, error, digest, wall, sequence: None };
    let report = asked.report(&frame, &run, found)?;
    let mut told = run.told;
    told.extend(notes(scene, volume, run.base.as_ref(), samples));
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
    pub(crate) samples: u64,
    pub(crate) error: Option<ErrorReport>,
    pub(crate) digest: DigestReport,
    pub(crate) wall: WallReport,
    pub(crate) sequence: Option<SequenceReport>,
}

impl Asked<'_> {
    /// The report of a run whose first frame is `frame`, checked.
    pub(crate) fn report(&self, frame: &Frame, run: &MachineRun, found: Found) -> Outcome<RunReport> {
        let &Asked { scene, machine, volume, options } = self;
        let mut interval = 0;
        let (mut limits, mut resources) = (None, None);
        if let Some(counters) = &run.counters {
            let ends = &counters.frame_ends;
            interval = match (ends.first(), ends.last()) {
                (Some(first), Some(last)) if ends.len() > 1 => (last - first) / (ends.len() as u64 - 1),
                _ => limits::frame_interval(machine, std::slice::from_ref(&frame.setup))?,
            };
            if found.sequence.is_none() {
                let passes = std::slice::from_ref(&frame.setup);
                limits = Some(limits::limits(machine, passes, interval)?);
                resources = Some(resources::resources(machine, volume.words.dims, passes, counters, interval));
            }
        }
        let report = RunReport {
            schema: SCHEMA,
            program: Program { name: "cube3".into(), version: env!("CARGO_PKG_VERSION").into() },
            fidelity: options.runs.name().into(),
            seed: options.seed,
            scene: serde_json::to_value(scene)?,
            machine: serde_json::to_value(machine)?,
            volume: VolumeReport {
                source: volume.source.clone(),
                dims: volume.words.dims,
                spacing: volume.words.spacing,
                conversion: volume.conversion.to_string().into(),
            },
            view: view_report(frame),
            plan: PlanReport { enabled: options.plan, left_out: left_out(frame) },
            timing: run.counters.as_ref().map(|counters| {
                TimingCounts {
                    frames: found.frames,
                    cycles: counters.cycles,
                    clock_hz: machine.clock_hz,
                    beams: counters.beams,
                    samples: found.samples,
                    ray_slots: counters.ray_slots,
                    fill_cycles: counters.cycles - counters.steady_cycles,
                    frame_interval_cycles: interval,
                }
                .into()
            }),
            limits,
            resources,
            units: run.counters.as_ref().map_or_else(Vec::new, unit_reports),
            channels: run.counters.as_ref().map_or_else(Vec::new, channel_reports),
            words: words_report(run, volume),
            error: found.error,
            digest: found.digest,
            wall: found.wall,
            sequence: found.sequence,
        };
        report.check()?;
        Ok(report)
    }
}

/// The picture and the base plane over the background, and their digests.
pub(crate) fn show(
    base: &BasePlane,
    frame: &Frame,
    scene: &Scene,
    volume: &LoadedVolume,
) -> Outcome<(Pictures, DigestReport)> {
    let plane = ImagePlane::new(scene, &frame.view, volume.words.dims, volume.words.spacing);
    let image = warp(base, &frame.setup.geometry, &plane, volume.words.spacing, scene.background);
    let image = Picture::new(plane.width, plane.height, image)?;
    let digest = DigestReport {
        base_plane: Some(sha256_hex(&bytes(base))),
        image: Some(sha256_hex(&cube3_report::to_rgb8(&image))),
    };
    let base_plane = Some(Picture::new(base.width, base.height, base.over(scene.background))?);
    Ok((Pictures { image: Some(image), base_plane, ..Pictures::default() }, digest))
}

fn run_machine(
    frame: &Frame,
    machine: &MachineSpec,
    volume: &LoadedVolume,
    options: &RunOptions,
    stops: &Stops,
) -> Outcome<MachineRun> {
    let mut run = MachineRun::default();
    if options.runs == Runs::Function && !stops.is_empty() {
        return Err(Problem::new(
            "--fidelity function has no cycles to trace, save or resume; give --fidelity timing, both or cycle",
        ));
    }
    match options.runs {
        Runs::Both => {
            let (timing, function) = std::thread::scope(|scope| {
                let timing = scope.spawn(|| timing(frame, machine, volume, stops));
                let function = function(frame, volume.words.dims, &volume.words.words, options.plan);
                (timing.join(), function)
            });
            run.take_timing(timing.map_err(|_| Problem::new("the timing run stopped unexpectedly"))??);
            run.take_function(function);
        }
        Runs::Timing => run.take_timing(timing(frame, machine, volume, stops)?),
        Runs::Function => run.take_function(function(frame, volume.words.dims, &volume.words.words, options.plan)),
        Runs::Cycle => {
            let progress = Progress::new("cycle");
            let words = &volume.words;
            let mut cycle = Machine::cycle(machine, vec![frame.setup.clone()], words.dims, &words.words)?;
            run.told = clocked(&mut cycle, Runs::Cycle, frame, machine, volume, stops, &progress)?;
            let machine = cycle;
            run.cycle_s = Some(progress.finish());
            run.counters = Some(machine.counters());
            run.overflows = machine.overflows();
            run.base = machine.into_base_planes().pop();
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

    fn take_function(&mut self, (run, seconds): (FunctionRun, f64)) {
        self.base = Some(run.base);
        self.overflows = run.overflows;
        self.function_s = Some(seconds);
    }
}

/// What a timing run gives: counters, seconds, and what its stops have to tell.
type TimingRun = (RunCounters, f64, Vec<String>);

fn timing(frame: &Frame, machine: &MachineSpec, volume: &LoadedVolume, stops: &Stops) -> Outcome<TimingRun> {
    let progress = Progress::new("timing");
    let mut timing: Machine<Timing> = Machine::timing(machine, vec![frame.setup.clone()])?;
    let told = clocked(&mut timing, Runs::Timing, frame, machine, volume, stops, &progress)?;
    Ok((timing.counters(), progress.finish(), told))
}

fn clocked<F: Fidelity>(
    run: &mut Machine<F>,
    runs: Runs,
    frame: &Frame,
    machine: &MachineSpec,
    volume: &LoadedVolume,
    stops: &Stops,
    progress: &Progress,
) -> Outcome<Vec<String>> {
    let words = &volume.words;
    let frames = std::slice::from_ref(&frame.setup);
    let identity = || Identity::new(runs.name(), machine, frames, words.dims, &words.words);
    run_clocked(run, stops, machine.clock_hz, identity, &|done, all| progress.set(done, all))
}

/// Renders a volume of voxel words, x fastest; also the seconds.
pub(crate) fn function(frame: &Frame, dims: [usize; 3], words: &[u16], skip: bool) -> (FunctionRun, f64) {
    let progress = Progress::new("function");
    let turned = CanonicalVolume::new(&frame.setup.geometry.axes, dims, words);
    let run = render(&frame.setup, &turned, skip, &|done, all| progress.set(done, all));
    (run, progress.finish())
}

/// Why a picture is empty, where it is.
pub(crate) fn notes(scene: &Scene, volume: &LoadedVolume, base: Option<&BasePlane>, samples: u64) -> Vec<String> {
    if base.is_none_or(|base| base.pixels.iter().any(|pixel| pixel[3] > 0)) {
        return Vec::new();
    }
    let [low, high] = volume.words.window;
    let layers = scene.transfer.layers.iter().flat_map(|layer| &layer.opacity);
    let mut points = scene.transfer.opacity.iter().chain(layers).filter(|point| point[1] > 0.0);
    let why = match points.next() {
        _ if samples == 0 => {
            "the volume has no sample in this view; try another view, or rays.offset = 0 in the machine file".to_owned()
        }
        None => "the transfer function is transparent everywhere".to_owned(),
        Some(point) => format!(
            "data values are {low} to {high}, and the transfer function's first opacity above 0 is at {}",
            point[0]
        ),
    };
    vec![format!("nothing is visible: {why}")]
}

/// Raw pixels of a base plane: each word as 32 bits, little-endian.
fn bytes(base: &BasePlane) -> Vec<u8> {
    base.pixels.iter().flatten().flat_map(|word| word.to_le_bytes()).collect()
}

/// The reference of a volume in a frame.
pub(crate) fn reference_picture(
    reference: Reference,
    scene: &Scene,
    machine: &MachineSpec,
    volume: &LoadedVolume,
    frame: &Frame,
    progress: &Progress,
) -> Outcome<Picture> {
    let plane = ImagePlane::new(scene, &frame.view, volume.words.dims, volume.words.spacing);
    let border = volume.words.window[0];
    let geometry = &frame.setup.geometry;
    let rows = match reference {
        Reference::ImageOrder => plane.height,
        _ => geometry.base_plane_size()[1],
    } as u64;
    let report = |done: u64| progress.set(done, rows);
    let discrete = DiscreteOptions { gradient: machine.abc.gradient, border };
    let base = match reference {
        Reference::True => true_3d(&volume.data, scene, geometry, &discrete, Some(&report))?,
        Reference::Sheared => sheared(&volume.data, scene, geometry, &discrete, Some(&report))?,
        Reference::ImageOrder | Reference::None => {
            let options = ImageOrderOptions { border, ..ImageOrderOptions::default() };
            let rendering = image_order(&volume.data, scene, &options, Some(&report))?;
            return Ok(Picture::new(rendering.width, rendering.height, rendering.pixels)?);
        }
    };
    let pixels = base.warp(geometry, &plane, volume.data.spacing, scene.background);
    Ok(Picture::new(plane.width, plane.height, pixels)?)
}

/// The picture against its reference; both and their difference are then among the pictures.
pub(crate) fn measure(
    reference: Reference,
    scene: &Scene,
    frame: &Frame,
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
    error.gradient_mean_deg = gradient_error::mean_angle_deg(&frame.setup, &volume.words);
    Ok(error)
}

fn view_report(frame: &Frame) -> ViewReport {
    let geometry = &frame.setup.geometry;
    let axis = ["x", "y", "z"][geometry.axes.axis[2]];
    let mut flips = [false; 3];
    for i in 0..3 {
        flips[geometry.axes.axis[i]] = geometry.axes.reversed[i];
    }
    let rule = match geometry.rule {
        TemplateRule::SampleFloor => "sample-floor",
        TemplateRule::PlaneFloor => "plane-floor",
    };
    let slots = match geometry.slots {
        RaySlots::Wrapped => "wrapped",
        RaySlots::Padded => "padded",
    };
    ViewReport {
        major_axis: axis.into(),
        flips,
        slopes: geometry.real_slopes(),
        offset: geometry.real_offset(),
        template_rule: format!("{rule}, {slots}"),
        base_plane_size: geometry.base_plane_size(),
    }
}

fn left_out(frame: &Frame) -> Vec<LeftOut> {
    let entry = |left: &cube3_host::LeftOut| LeftOut {
        what: left.what.clone(),
        why: left.why.clone(),
        saves: left.saves.clone(),
    };
    frame.left_out.iter().map(entry).collect()
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

fn channel_reports(counters: &RunCounters) -> Vec<ChannelReport> {
    let report = |reading: &crate::machine::ChannelReading| ChannelReport {
        name: reading.name.into(),
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
    if run.base.is_some() {
        overflows.insert("gradient and colour".into(), run.overflows.shading);
        overflows.insert("pixel".into(), run.overflows.pixel);
    }
    WordsReport { overflows }
}
