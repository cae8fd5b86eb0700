//! The tree of `report.json`. Field names are the keys that scripts rely on.

use std::collections::BTreeMap;

use cube3_metrics::{ImageComparison, ImageError};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::{
    DigestReport, LimitsReport, OpacityReport, ResourcesReport, SavingsReport, SequenceReport, TrafficReport, measures,
};

/// The number of the present layout. It rises when a key changes its meaning or goes away.
pub const SCHEMA: u32 = 3;

/// Everything that one run of `cube3 run` found out.
///
/// All wall-clock values, and the number of threads behind them, are in [`RunReport::wall`]. The rest
/// depends on the input alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunReport {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Who wrote this.
    pub program: Program,
    /// The command that made it, word by word, without `--threads` and `--out` and their values: they change nothing that is measured. Empty
    /// where the library was called.
    #[serde(default)]
    pub command: Vec<String>,
    /// Where scene and machine came from.
    #[serde(default)]
    pub sources: SourcesReport,
    /// Which of the machine's runs were made, such as `timing + function` or `cycle`.
    pub fidelity: String,
    /// The seed of everything random.
    pub seed: u64,
    /// The scene as resolved: what the scene file would say with every default written out.
    pub scene: Value,
    /// The machine as resolved.
    pub machine: Value,
    /// The volume and how it became voxel words.
    pub volume: VolumeReport,
    /// What the host made of the view.
    pub view: ViewReport,
    /// What was left out because it cannot change the picture.
    pub plan: PlanReport,
    /// Cycles and throughput at the machine's clock. Absent when no clock ran.
    pub timing: Option<TimingReport>,
    /// What limits the frame rate. Absent when no clock ran.
    #[serde(default)]
    pub limits: Option<LimitsReport>,
    /// What the machine is made of. Absent when no clock ran.
    #[serde(default)]
    pub resources: Option<ResourcesReport>,
    /// What went through memory, bus, links and host's port. Absent when no clock ran.
    #[serde(default)]
    pub traffic: Option<TrafficReport>,
    /// What each unit did with its cycles, from the volume to the image.
    pub units: Vec<UnitReport>,
    /// What went through each channel, from the volume to the image.
    pub channels: Vec<ChannelReport>,
    /// What happened to the machine's words.
    pub words: WordsReport,
    /// The image against its reference. Absent when there was no image or no reference.
    pub error: Option<ErrorReport>,
    /// The raw pixels, to tell at a glance whether two runs gave the same bits.
    pub digest: DigestReport,
    /// How long the simulation took on this computer.
    pub wall: WallReport,
    /// Frame by frame, where a sequence was run. View, plan, error and digests above are then those of the first frame,
    /// and timing, units and channels those of all frames together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sequence: Option<SequenceReport>,
}

impl RunReport {
    /// The same report without its wall-clock values: equal for equal input, on every computer.
    pub fn without_wall(&self) -> Self {
        Self { wall: WallReport::default(), ..self.clone() }
    }
}

/// The program that wrote a report.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Its name, `cube3`.
    pub name: String,
    /// Its version, such as `0.1.0`.
    pub version: String,
}

/// Where scene and machine came from, before options changed them. What the library was called with has no source.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SourcesReport {
    /// The scene's file as the user named it. Absent for the built-in scene.
    pub scene_file: Option<String>,
    /// The machine's file as the user named it.
    pub machine_file: Option<String>,
    /// The machine's preset, such as `cube3-128`.
    pub machine_preset: Option<String>,
}

/// The volume that was rendered; in a sequence the first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VolumeReport {
    /// A file as the user named it, or a phantom.
    pub source: String,
    /// Voxels along x, y and z.
    pub dims: [usize; 3],
    /// Distances between voxels along x, y and z, in the unit of the file.
    pub spacing: [f64; 3],
    /// How values became voxel words: a sentence.
    pub conversion: String,
    /// The data values of the smallest and the largest word.
    pub window: [f64; 2],
    /// Bits of a voxel word.
    pub word_bits: u32,
    /// Words for one unit of the data; 0 for a window of one value. Absent for one so narrow that no number holds it.
    pub scale: Option<f64>,
    /// Voxels below the window, which have the smallest word.
    pub clipped_below: u64,
    /// Voxels above the window, which have the largest word.
    pub clipped_above: u64,
    /// Voxels that were not finite, which have word 0.
    pub masked: u64,
    /// How the file's axes became x, y and z; absent where it says nothing of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axes: Option<AxesReport>,
}

/// How a file's axes became those of the frame buffer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AxesReport {
    /// Where the stored axes lead, fastest first: `LPS` to a patient's left, back and head; `+x-y+z` in a space without sides.
    pub stored: String,
    /// Where x, y and z lead.
    pub drawn: String,
    /// Turn between grid and world that permutations and flips of axes leave over.
    pub turned_deg: f64,
    /// How far the axes are from right angles, as after a gantry tilt.
    pub slanted_deg: f64,
}

/// Which side of the picture is which side of the patient: R, L, A, P, S or I, the main one first.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SidesReport {
    /// To the left of the picture.
    pub left: String,
    /// To the right.
    pub right: String,
    /// Above.
    pub top: String,
    /// Below.
    pub bottom: String,
    /// Towards the eye.
    pub front: String,
}

/// What the host derived from the view: design, section 3.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ViewReport {
    /// Which side of the picture is which; absent where the volume's file does not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sides: Option<SidesReport>,
    /// The volume axis nearest to the view, `x`, `y` or `z`.
    pub major_axis: String,
    /// Whether the volume is read backwards along x, y and z.
    pub flips: [bool; 3],
    /// du and dv of the canonical view: voxels along u and v for one voxel along w.
    pub slopes: [f64; 2],
    /// o, the place of a sample between two planes, from 0 to below 1.
    pub offset: f64,
    /// The rule for discrete rays, `sample-floor` or `plane-floor`, and the ray slots.
    pub template_rule: String,
    /// Width and height of the base plane in pixels, in perspective of the first pass.
    pub base_plane_size: [usize; 2],
    /// The eye and the passes of a perspective view.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub perspective: Option<PerspectiveReport>,
}

/// A perspective view and the passes that it takes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PerspectiveReport {
    /// The eye in voxel coordinates.
    pub eye_voxel: [f64; 3],
    /// The vertical field of view.
    pub field_of_view_deg: f64,
    /// The passes, each a frame with a base plane of its own, that of the view's direction first.
    pub passes: Vec<PassReport>,
}

/// A pass and how well its rays cover the volume.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PassReport {
    /// The major axis of its rays and the sign along it, such as `+x`.
    pub axis: String,
    /// Width and height of its base plane in pixels.
    pub base_plane_size: [usize; 2],
    /// o of its samples.
    pub offset: f64,
    /// Whether the eye is so near that each slot has its own cell, and beams are fetched twice.
    pub own_cells: bool,
    /// The gradient estimator, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gradient: Option<String>,
    /// Distance of the rays behind the last plane, in voxels.
    pub back_spacing_voxel: f64,
    /// Voxels between the outermost rays that no ray uses, as a fraction.
    pub unused_voxel_fraction: f64,
    /// Width of the widest cell, in voxels.
    pub widest_cell_voxel: u32,
}

/// What the plan named.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlanReport {
    /// False when the user asked for everything (`--no-plan`).
    pub enabled: bool,
    /// What was neither built nor run.
    pub left_out: Vec<LeftOut>,
}

/// One thing that the scene does not need.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeftOut {
    /// The rule that left it out, such as `gradient-unit`.
    #[serde(default)]
    pub rule: String,
    /// The unit, plane, beam, table or sample.
    pub what: String,
    /// Why it cannot change the picture.
    pub why: String,
    /// What that saves, in words and numbers.
    pub saves: String,
    /// What that saves, in numbers.
    #[serde(default)]
    pub savings: SavingsReport,
}

/// The machine's time, at the machine's clock.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TimingReport {
    /// Frames that were run one behind another.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub frames: u64,
    /// Cycles from the first fetch to the last pixel.
    pub cycles: u64,
    /// Clock rate in hertz.
    pub clock_hz: f64,
    /// `cycles / frames / clock_hz`, in seconds.
    pub frame_time_s: f64,
    /// Frames per second one after another: `1 / frame_time_s`.
    pub fps: f64,
    /// Frames per second in an animation, as measured: `clock_hz / frame_interval_cycles`. Where frames overlap, no frame but the
    /// first pays for filling the pipeline.
    pub fps_sustained: f64,
    /// Cycles from the last pixel of one frame to that of the next, where this frame follows itself.
    pub frame_interval_cycles: u64,
    /// Beams fetched from the cubic frame buffer.
    pub beams: u64,
    /// Samples that the interpolation units put out.
    pub samples: u64,
    /// Ray slots, used or not, that went through the pipelines.
    pub ray_slots: u64,
    /// `samples · clock_hz / cycles`, in samples per second.
    pub samples_per_s: f64,
    /// Cycles of the frame beyond those that the busier of its two sides, beams in or rays out, needs for its tokens.
    pub fill_cycles: u64,
}

/// What a timing run counted. Everything else in [`TimingReport`] follows from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimingCounts {
    /// Frames that were run one behind another.
    pub frames: u64,
    /// Cycles from the first fetch to the last pixel.
    pub cycles: u64,
    /// Clock rate in hertz.
    pub clock_hz: f64,
    /// Beams fetched from the cubic frame buffer.
    pub beams: u64,
    /// Samples that the interpolation units put out.
    pub samples: u64,
    /// Ray slots, used or not.
    pub ray_slots: u64,
    /// Cycles of the frame beyond those that the busier of its two sides, beams in or rays out, needs for its tokens.
    pub fill_cycles: u64,
    /// Cycles from the last pixel of one frame to that of the next.
    pub frame_interval_cycles: u64,
}

impl From<TimingCounts> for TimingReport {
    /// Derives times and rates. A rate over no time at all is 0, not infinite.
    fn from(counts: TimingCounts) -> Self {
        let TimingCounts { frames, cycles, clock_hz, beams, samples, ray_slots, fill_cycles, frame_interval_cycles } =
            counts;
        let each = frames.max(1) as f64;
        let per_s = |amount: f64, cycles: u64| {
            if cycles == 0 { 0.0 } else { amount * clock_hz / cycles as f64 }
        };
        Self {
            frames,
            cycles,
            clock_hz,
            frame_time_s: cycles as f64 / clock_hz / each,
            fps: per_s(each, cycles),
            fps_sustained: per_s(1.0, frame_interval_cycles),
            frame_interval_cycles,
            beams,
            samples,
            ray_slots,
            samples_per_s: per_s(samples as f64, cycles),
            fill_cycles,
        }
    }
}

impl TimingReport {
    /// What was counted, without what follows from it.
    pub fn counts(&self) -> TimingCounts {
        let &Self { frames, cycles, clock_hz, beams, samples, ray_slots, fill_cycles, frame_interval_cycles, .. } =
            self;
        TimingCounts { frames, cycles, clock_hz, beams, samples, ray_slots, fill_cycles, frame_interval_cycles }
    }
}

fn one() -> u64 {
    1
}

fn is_one(frames: &u64) -> bool {
    *frames == 1
}

/// What one unit did with its cycles. The four kinds add up to the cycles of the run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct UnitReport {
    /// The unit's name, such as `trilin`.
    pub name: String,
    /// Cycles of work.
    pub busy: u64,
    /// Cycles without input.
    pub starved: u64,
    /// Cycles with a result that the next channel had no room for.
    pub blocked: u64,
    /// Cycles of waiting for something else, by reason: memory, bus, refresh.
    pub waiting: BTreeMap<String, u64>,
}

/// What went through one channel. What was pushed was popped or is still there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChannelReport {
    /// The channel's name, such as `beams`.
    pub name: String,
    /// The unit that pushes.
    pub from: String,
    /// The unit that pops.
    pub to: String,
    /// The most tokens that it can hold.
    pub capacity: u64,
    /// Cycles from push to the earliest pop.
    pub latency: u64,
    /// Tokens pushed.
    pub pushes: u64,
    /// Tokens popped.
    pub pops: u64,
    /// Tokens in it at the end.
    pub occupancy: u64,
    /// The most tokens that it held.
    pub max_occupancy: u64,
    /// Tokens in it on the average over the run.
    pub mean_occupancy: f64,
}

/// What happened to the machine's words.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WordsReport {
    /// Results that did not fit and were saturated, by wire.
    pub overflows: BTreeMap<String, u64>,
    /// The opacity table against the scene. Absent in modes of a single sample (maximum, minimum), and without a frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opacity: Option<OpacityReport>,
}

/// The remark where neither picture shows an object.
pub const NO_OBJECT: &str = "neither picture shows an object: there is no error to measure";

/// The image against its reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ErrorReport {
    /// What the image was compared with, such as `image-order`.
    pub against: String,
    /// Over the whole image: `mean_relative`, `rms`, `max`, `psnr_db`, `fraction_off`, `percentile_99` and `bias`. Absent where neither
    /// picture shows an object: two empty pictures are equal, and that says nothing.
    #[serde(flatten, with = "measures")]
    pub whole: Option<ImageError>,
    /// Why there are no numbers, where there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remark: Option<String>,
    /// Mean angle of the gradients to the reference's, in degrees. Absent when not measured.
    pub gradient_mean_deg: Option<f64>,
    /// Over the object alone.
    pub footprint: FootprintError,
    /// What the difference picture is magnified by.
    pub difference_factor: f64,
    /// The most that a channel of the reference's pixels is off by. Absent where its method proves no bound.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_bound: Option<f64>,
    /// How far the reference is from the integral that it stands for. Absent where it has no step of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<ReferenceError>,
}

/// The reference's own error: its distance to the converged integral, over the object, on every fourth pixel each way. In the modes that choose
/// a sample there is no integral, and it is the distance to the same reference at half the step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceError {
    /// The reference with its options.
    pub of: String,
    /// What it is held against, with its options.
    pub against: String,
    /// The most that this is itself off by. Absent where it proves no bound.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub against_bound: Option<f64>,
    /// The same keys as for the whole image.
    #[serde(flatten)]
    pub error: ImageError,
    /// The number of pixels that were compared.
    pub pixels: usize,
}

/// The errors over the pixels that the object covers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FootprintError {
    /// The same keys as for the whole image. Absent over no pixels.
    #[serde(flatten, with = "measures")]
    pub error: Option<ImageError>,
    /// The number of pixels that the object covers.
    pub pixels: usize,
}

impl ErrorReport {
    /// The report of a comparison. The gradients' angle is set afterwards where it was measured.
    pub fn new(against: impl Into<String>, comparison: &ImageComparison, difference_factor: f64) -> Self {
        Self {
            against: against.into(),
            whole: comparison.footprint.and(Some(comparison.whole)),
            remark: comparison.footprint.is_none().then(|| NO_OBJECT.into()),
            gradient_mean_deg: None,
            footprint: FootprintError { error: comparison.footprint, pixels: comparison.footprint_pixels },
            difference_factor,
            reference_bound: None,
            reference: None,
        }
    }
}

/// How long the simulation took on this computer, in seconds. Absent where not run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WallReport {
    /// Making or reading the volumes and turning them into words. Absent where the library was given a volume.
    #[serde(default)]
    pub volume_s: Option<f64>,
    /// The timing run.
    pub timing_s: Option<f64>,
    /// The function run.
    pub function_s: Option<f64>,
    /// The cycle run.
    pub cycle_s: Option<f64>,
    /// The reference ray caster.
    pub reference_s: Option<f64>,
    /// Volumes, set-up, runs, reference and measuring together; writing the files is not in it.
    pub total_s: Option<f64>,
    /// Samples per second of the function run.
    pub samples_per_s: Option<f64>,
    /// Threads that were used.
    pub threads: Option<usize>,
}
