//! One frame on the machine: picture, throughput, stalls, error.

use crate::fidelity::Timing;
use crate::function::{CanonicalVolume, FunctionRun, render};
use crate::gradient_error;
use crate::inputs::LoadedVolume;
use crate::machine::{Machine, Overflows, RunCounters};
use crate::problem::Outcome;
use crate::progress::Progress;
use cube3_channel::Reason;
use cube3_host::{BasePlane, Frame, ImagePlane, MachineSpec, RaySlots, TemplateRule, frame_setup, warp};
use cube3_metrics::{Picture, compare, difference, footprint, suggested_factor};
use cube3_raycast::{DiscreteOptions, ImageOrderOptions, image_order, sheared, true_3d};
use cube3_report::{
    ChannelReport, DigestReport, ErrorReport, LeftOut, PlanReport, Program, RunReport, SCHEMA, TimingCounts,
    UnitReport, ViewReport, VolumeReport, WallReport, WordsReport, sha256_hex,
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
}

/// What the machine has given: counters, base plane, saturated words, and the seconds each run took.
#[derive(Default)]
struct MachineRun {
    counters: Option<RunCounters>,
    base: Option<BasePlane>,
    overflows: Overflows,
    timing_s: Option<f64>,
    function_s: Option<f64>,
    cycle_s: Option<f64>,
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
    let total = Progress::new("total");
    let frame = frame_setup(scene, machine, &volume.info(), options.plan)?;
    let run = run_machine(&frame, machine, volume, options)?;
    let plane = ImagePlane::new(scene, &frame.view, volume.words.dims, volume.words.spacing);
    let mut pictures = Pictures::default();
    let mut digest = DigestReport::default();
    if let Some(base) = &run.base {
        let geometry = &frame.setup.geometry;
        let image = warp(base, geometry, &plane, volume.words.spacing, scene.background);
        let image = Picture::new(plane.width, plane.height, image)?;
        digest.base_plane = Some(sha256_hex(&bytes(base)));
        digest.image = Some(sha256_hex(&cube3_report::to_rgb8(&image)));
        pictures.base_plane = Some(Picture::new(base.width, base.height, base.over(scene.background))?);
        pictures.image = Some(image);
    }
    let (error, reference_s) = match options.reference {
        Reference::None => (None, None),
        _ if pictures.image.is_none() => (None, None),
        reference => {
            let progress = Progress::new("reference");
            let picture = reference_picture(reference, scene, machine, volume, &frame, &plane, &progress)?;
            let seconds = progress.finish();
            let error = measure(reference, scene, &frame, volume, picture, &mut pictures)?;
            (Some(error), Some(seconds))
        }
    };
    let samples = frame.setup.geometry.sample_count();
    let image_s = run.function_s.or(run.cycle_s);
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
        view: view_report(&frame),
        plan: PlanReport { enabled: options.plan, left_out: left_out(&frame) },
        timing: run.counters.as_ref().map(|counters| {
            TimingCounts {
                cycles: counters.cycles,
                clock_hz: machine.clock_hz,
                beams: counters.beams,
                samples,
                ray_slots: counters.ray_slots,
                fill_cycles: counters.cycles - counters.steady_cycles,
            }
            .into()
        }),
        units: run.counters.as_ref().map_or_else(Vec::new, unit_reports),
        channels: run.counters.as_ref().map_or_else(Vec::new, channel_reports),
        words: words_report(&run, volume),
        error,
        digest,
        wall: WallReport {
            timing_s: run.timing_s,
            function_s: run.function_s,
            cycle_s: run.cycle_s,
            reference_s,
            total_s: Some(total.finish()),
            samples_per_s: image_s.filter(|s| *s > 0.0).map(|seconds| samples as f64 / seconds),
            threads: Some(rayon::current_num_threads()),
        },
    };
    report.check()?;
    let notes = notes(scene, volume, run.base.as_ref(), samples);
    Ok(RunResult { report, pictures, notes })
}

fn run_machine(
    frame: &Frame,
    machine: &MachineSpec,
    volume: &LoadedVolume,
    options: &RunOptions,
) -> Outcome<MachineRun> {
    let mut run = MachineRun::default();
    match options.runs {
        Runs::Both => {
            let (timing, function) = std::thread::scope(|scope| {
                let timing = scope.spawn(|| timing(frame, machine));
                let function = function(frame, volume, options.plan);
                (timing.join(), function)
            });
            let timing = timing.map_err(|_| crate::problem::Problem::new("the timing run stopped unexpectedly"))?;
            (run.counters, run.timing_s) = timing.map(|(counters, seconds)| (Some(counters), Some(seconds)))?;
            run.take_function(function);
        }
        Runs::Timing => (run.counters, run.timing_s) = timing(frame, machine).map(|(c, s)| (Some(c), Some(s)))?,
        Runs::Function => run.take_function(function(frame, volume, options.plan)),
        Runs::Cycle => {
            let progress = Progress::new("cycle");
            let words = &volume.words;
            let mut machine = Machine::cycle(machine, vec![frame.setup.clone()], words.dims, &words.words)?;
            machine.run(&|done, all| progress.set(done, all))?;
            run.cycle_s = Some(progress.finish());
            run.counters = Some(machine.counters());
            run.overflows = machine.overflows();
            run.base = machine.into_base_planes().pop();
        }
    }
    Ok(run)
}

impl MachineRun {
    fn take_function(&mut self, (run, seconds): (FunctionRun, f64)) {
        self.base = Some(run.base);
        self.overflows = run.overflows;
        self.function_s = Some(seconds);
    }
}

fn timing(frame: &Frame, machine: &MachineSpec) -> Outcome<(RunCounters, f64)> {
    let progress = Progress::new("timing");
    let mut machine: Machine<Timing> = Machine::timing(machine, vec![frame.setup.clone()])?;
    machine.run(&|done, all| progress.set(done, all))?;
    Ok((machine.counters(), progress.finish()))
}

fn function(frame: &Frame, volume: &LoadedVolume, skip: bool) -> (FunctionRun, f64) {
    let progress = Progress::new("function");
    let turned = CanonicalVolume::new(&frame.setup.geometry.axes, volume.words.dims, &volume.words.words);
    let run = render(&frame.setup, &turned, skip, &|done, all| progress.set(done, all));
    (run, progress.finish())
}

/// Why a picture is empty, where it is.
fn notes(scene: &Scene, volume: &LoadedVolume, base: Option<&BasePlane>, samples: u64) -> Vec<String> {
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

fn reference_picture(
    reference: Reference,
    scene: &Scene,
    machine: &MachineSpec,
    volume: &LoadedVolume,
    frame: &Frame,
    plane: &ImagePlane,
    progress: &Progress,
) -> Outcome<Picture> {
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
    let pixels = base.warp(geometry, plane, volume.data.spacing, scene.background);
    Ok(Picture::new(plane.width, plane.height, pixels)?)
}

fn measure(
    reference: Reference,
    scene: &Scene,
    frame: &Frame,
    volume: &LoadedVolume,
    picture: Picture,
    pictures: &mut Pictures,
) -> Outcome<ErrorReport> {
    let Some(image) = &pictures.image else {
        return Err(crate::problem::Problem::new("there is no picture to measure"));
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
