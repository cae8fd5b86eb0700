//! A sequence of frames: volumes that come in while the machine renders, and a view that moves.
//!
//! ```text
//!   setups of all frames ──► one timing run with the acquisition port ──► what each beam has seen
//!                                                                              │
//!   volume 0, 1, 2 … ──► the volume as frame f saw it ◄────────────────────────┘
//!                                   │
//!                                   └──► function ──► picture, error, animation
//! ```
//!
//! Only a few volumes and one picture are held at a time.

use crate::acquisition::{Mixture, Sight};
use crate::animation::playback_fps;
use crate::directions;
use crate::ends_note;
use crate::fidelity::Timing;
use crate::inputs::{self, Incoming, LoadedVolume};
use crate::machine::{Machine, Overflows, RunCounters};
use crate::notes::Findings;
use crate::problem::{Outcome, Problem};
use crate::progress::{Progress, Waiting};
use crate::reference::{self, Reference, check_reference, reference_error, reference_picture};
use crate::run::{Asked, Found, MachineRun, Pictures, RunOptions, RunResult, Runs, function, measure, show};
use cube3_cfb::{AcquisitionPort, PortSpec};
use cube3_frame::{BasePlane, FrameSetup, Schedule};
use cube3_host::{PictureFrames, picture_setup};
use cube3_machine::{AcquisitionMode, MachineSpec};
use cube3_metrics::{ImageError, Picture, compare, footprint};
use cube3_report::{AcquisitionReport, DigestReport, FrameReport, NO_OBJECT, SequenceReport, WallReport};
use cube3_scene::{Scene, VolumeSource};
use cube3_volume::{Phantom, ReadOptions};
use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;
use std::sync::Arc;

/// Most frames of a sequence.
pub const MOST_FRAMES: usize = 100_000;

/// Spacings that differ by less, as a part, are one: single precision has 6·10⁻⁸.
const SAME_SPACING: f64 = 1e-6;

/// Volumes that are kept: a torn frame shows two or three, and the next frame the last of them again.
pub(crate) const KEPT_VOLUMES: usize = 4;

/// The volumes of a sequence, in the order of time.
pub struct Series {
    source: VolumeSource,
    machine: MachineSpec,
    options: ReadOptions,
    mask: bool,
    /// The first volume's, which all share.
    window: [f64; 2],
    phase_per_volume: f64,
    /// Each volume's file and its place in it; empty where a phantom is computed.
    items: Vec<(PathBuf, usize)>,
    first: Arc<LoadedVolume>,
    kept: VecDeque<(u64, Arc<LoadedVolume>)>,
    /// Words held at the ends of the window, of each volume that has been loaded.
    clipped: BTreeMap<u64, u64>,
    /// Seconds that all volumes together took to read or make.
    made_s: f64,
}

impl Series {
    /// The volumes of a scene for a sequence of `frames`; the first is loaded.
    ///
    /// # Errors
    /// A volume that cannot be read or made, and a phase for something that does not move.
    pub fn open(
        scene: &Scene,
        machine: &MachineSpec,
        options: &ReadOptions,
        mask: bool,
        frames: usize,
    ) -> Outcome<Series> {
        let source = scene.volume.clone();
        if let (Some(name), Some(_)) = (&source.phantom, source.phase_per_frame)
            && !name.parse::<Phantom>()?.moves()
        {
            return Err(Problem::new(format!(
                "phantom {name} does not move; leave phase_per_frame out, or take beating-heart"
            )));
        }
        let phase_per_volume = source.phase_per_frame.unwrap_or(1.0 / frames.max(1) as f64);
        let items = items(&source, options)?;
        let mut first = load(&source, &items, 0, phase_per_volume, source.window, machine, options, mask)?;
        first.notes.extend(directions::old_format_note(scene, &first.data.world));
        let clipped = BTreeMap::from([(0, first.conversion.clipped_below + first.conversion.clipped_above)]);
        Ok(Series {
            window: first.words.window,
            made_s: first.made_s.unwrap_or(0.0),
            source,
            machine: machine.clone(),
            options: options.clone(),
            mask,
            phase_per_volume,
            items,
            first: Arc::new(first),
            kept: VecDeque::new(),
            clipped,
        })
    }

    /// The first volume.
    pub fn first(&self) -> &LoadedVolume {
        &self.first
    }

    /// How many volumes there are; a phantom that moves has no end.
    pub fn count(&self) -> Option<u64> {
        count(&self.source, self.items.len())
    }

    /// Whether a source has more than one volume.
    ///
    /// # Errors
    /// A file whose header cannot be read.
    pub fn moves(source: &VolumeSource, options: &ReadOptions) -> Outcome<bool> {
        Ok(count(source, items(source, options)?.len()) != Some(1))
    }

    /// Volume `index`, from 0; behind the last, the last.
    ///
    /// # Errors
    /// A volume that cannot be read or made, or whose grid is not that of the first.
    pub fn volume(&mut self, index: u64) -> Outcome<Arc<LoadedVolume>> {
        let index = self.count().map_or(index, |count| index.min(count - 1));
        if index == 0 {
            return Ok(Arc::clone(&self.first));
        }
        if let Some((_, volume)) = self.kept.iter().find(|(kept, _)| *kept == index) {
            return Ok(Arc::clone(volume));
        }
        let Series { source, items, machine, options, .. } = &*self;
        let window = Some(self.window);
        let mut volume = load(source, items, index, self.phase_per_volume, window, machine, options, self.mask)?;
        let (first, here) = (&self.first.words, &volume.words);
        // Headers keep spacing as decimals or in single precision: the last digits may differ.
        let one = |a: f64, b: f64| (a - b).abs() <= SAME_SPACING * b;
        if here.dims != first.dims || !here.spacing.iter().zip(first.spacing).all(|(a, b)| one(*a, b)) {
            return Err(Problem::new(format!(
                "{} has {:?} voxels of {:?}, and {} has {:?} of {:?}: the volumes of a series need one grid",
                volume.source, here.dims, here.spacing, self.first.source, first.dims, first.spacing
            )));
        }
        self.made_s += volume.made_s.unwrap_or(0.0);
        (volume.words.spacing, volume.data.spacing) = (first.spacing, first.spacing);
        self.clipped.insert(index, volume.conversion.clipped_below + volume.conversion.clipped_above);
        let volume = Arc::new(volume);
        if self.kept.len() == KEPT_VOLUMES {
            self.kept.pop_front();
        }
        self.kept.push_back((index, Arc::clone(&volume)));
        Ok(volume)
    }
}

/// Each volume's file and its place in it; none where a phantom is computed.
fn items(source: &VolumeSource, options: &ReadOptions) -> Outcome<Vec<(PathBuf, usize)>> {
    let mut items = Vec::new();
    for file in source.file.iter().chain(&source.files) {
        let about = cube3_volume::inspect(file, &inputs::read_options(source, options))?;
        match source.time {
            Some(time) => items.push((file.clone(), time)),
            None => items.extend((0..about.volumes).map(|time| (file.clone(), time))),
        }
    }
    Ok(items)
}

/// How many volumes a source has, of so many in files; a phantom that moves has no end.
fn count(source: &VolumeSource, items: usize) -> Option<u64> {
    let moves = source.phantom.as_ref().is_some_and(|name| name.parse().is_ok_and(Phantom::moves));
    (!moves).then_some(items.max(1) as u64)
}

/// Volume `index` of a source, one of these `items` where it is files.
#[allow(clippy::too_many_arguments)]
fn load(
    source: &VolumeSource,
    items: &[(PathBuf, usize)],
    index: u64,
    phase_per_volume: f64,
    window: Option<[f64; 2]>,
    machine: &MachineSpec,
    options: &ReadOptions,
    mask: bool,
) -> Outcome<LoadedVolume> {
    let waiting = Waiting::new("volume");
    let mut one = source.clone();
    if let Some((file, time)) = items.get(index as usize) {
        (one.file, one.files, one.time) = (Some(file.clone()), Vec::new(), Some(*time));
    } else if let Some(name) = &source.phantom
        && name.parse::<Phantom>()?.moves()
    {
        one.phase = Some(source.phase.unwrap_or_default() + phase_per_volume * index as f64);
    }
    let Incoming { source: name, data, notes } = inputs::data(&one, options)?;
    let loaded = if source.labels {
        inputs::labels_to_words(name, data, window, machine, mask)?
    } else {
        inputs::to_words(name, data, window, machine, mask)?
    };
    Ok(LoadedVolume { notes, made_s: Some(waiting.seconds()), ..loaded })
}

/// A frame of the sequence, as it is made.
pub struct Shown<'a> {
    /// The frame, from 0.
    pub frame: usize,
    /// The warped picture.
    pub picture: &'a Picture,
    /// Frames per second at which an animation plays.
    pub playback_fps: f64,
}

/// What the clock gave.
struct Clocked {
    counters: RunCounters,
    port: Option<AcquisitionPort>,
    /// In runs with real data, the base planes.
    bases: Vec<BasePlane>,
    overflows: Overflows,
}

/// Runs a sequence of frames; each picture is given to `take` as soon as it is there.
///
/// # Errors
/// A scene, machine or volume that cannot be run, a machine that cannot move, and what `take` refuses.
pub fn run_sequence(
    scene: &Scene,
    machine: &MachineSpec,
    series: &mut Series,
    frames: usize,
    options: &RunOptions,
    take: &mut dyn FnMut(Shown<'_>) -> Outcome<()>,
) -> Outcome<RunResult> {
    let total = Progress::new("total");
    let first = Arc::clone(&series.first);
    let moves = series.count() != Some(1);
    let views: Vec<Scene> =
        (0..frames).map(|frame| scene_at(scene, frame, frames).thickened(first.single).into_owned()).collect();
    let set_up = |frame: usize| {
        Ok::<PictureFrames, Problem>(picture_setup(&views[frame], machine, &first.info(), options.plan)?)
    };
    check_perspective(scene, machine, moves, options.runs)?;
    let mut run = MachineRun::default();
    // Frames of the machine behind each picture: a picture of an eye has several.
    let mut passes = Vec::with_capacity(frames);
    let clocked = match options.runs {
        Runs::Function => None,
        _ => {
            let mut setups = Vec::with_capacity(frames);
            for frame in 0..frames {
                setups.extend(set_up(frame)?.setups);
                passes.push(setups.len());
            }
            let port = moves
                .then(|| PortSpec::new(machine, first.words.dims, series.count().map(|count| count.saturating_sub(1))));
            let before = passes.iter().take(frames.saturating_sub(1)).map(|&end| end as u32);
            let pictures = std::iter::once(0).chain(before).collect();
            Some(clock(machine, series, (setups, pictures), port, options.runs, &mut run)?)
        }
    };
    let ends: Option<Vec<u64>> = clocked.as_ref().map(|clocked| {
        let end = |&passes: &usize| passes.checked_sub(1).map_or(0, |last| clocked.counters.frame_ends[last]);
        passes.iter().map(end).collect()
    });
    let fps = ends.as_deref().map(|ends| sustained_fps(ends, machine.clock_hz));
    let playback_fps = playback_fps(fps.unwrap_or(f64::INFINITY));

    let progress = Progress::new("frames");
    let (mut pictures, mut first_error, mut first_digest) = (Pictures::default(), None, DigestReport::default());
    let (mut reports, mut samples, mut reference_s, mut function_s) = (Vec::new(), 0, None, None);
    let port = clocked.as_ref().and_then(|clocked| clocked.port.as_ref());
    let mut seen = port.map(AcquisitionPort::seen);
    let (mut first_frame, mut end) = (None, 0);
    for (index, view) in views.iter().enumerate() {
        let frame = set_up(index)?;
        if options.reference != Reference::None {
            check_reference(options.reference, &frame)?;
        }
        samples += frame.setups.iter().map(|setup| setup.geometry.sample_count()).sum::<u64>();
        let whole = match options.runs {
            Runs::Function => series.count().map_or(index as u64, |count| (index as u64).min(count - 1)),
            _ => 0,
        };
        let sights: Option<Vec<Sight<'_>>> = seen.as_mut().map(|seen| {
            let sight = |geometry| Sight::next(geometry, Schedule::new(machine, geometry), first.words.dims, seen);
            frame.setups.iter().map(|setup| &setup.geometry).map(sight).collect()
        });
        let mixtures: Vec<Mixture> = match &sights {
            Some(sights) => sights.iter().map(Sight::mixture).collect(),
            None => vec![Mixture::whole(whole); frame.setups.len()],
        };
        let mixture = mixtures.iter().copied().reduce(Mixture::and).unwrap_or(Mixture::whole(whole));
        let bases = match options.runs {
            Runs::Timing => None,
            Runs::Cycle => clocked.as_ref().map(|clocked| {
                let first = index.checked_sub(1).map_or(0, |before| passes[before]);
                clocked.bases[first..passes[index]].to_vec()
            }),
            Runs::Both | Runs::Function => {
                let mut bases = Vec::new();
                for (pass, mixture) in mixtures.iter().enumerate() {
                    let content = content(series, sights.as_ref().map(|sights| &sights[pass]), mixture)?;
                    let setup = std::slice::from_ref(&frame.setups[pass]);
                    let (made, seconds) = function(setup, first.words.dims, content.words(), options.plan);
                    *function_s.get_or_insert(0.0) += seconds;
                    for made in made {
                        run.overflows = run.overflows.plus(made.overflows);
                        bases.push(made.base);
                    }
                }
                Some(bases)
            }
        };
        let (mut error, mut object, mut remark, mut digest) = (None, None, None, DigestReport::default());
        if let Some(bases) = &bases {
            let (mut shown, made) = show(bases, &frame, view, &first)?;
            digest = made;
            if options.reference != Reference::None {
                let expected = series.volume(mixture.oldest)?;
                let waiting = Progress::new("reference");
                let picture = reference_picture(options.reference, view, machine, &expected, &frame, false, &waiting)?;
                *reference_s.get_or_insert(0.0) += waiting.finish();
                if index == 0 {
                    let own = reference_error(options.reference, view, &expected, &picture)?;
                    let mut report = measure(options.reference, view, &frame, &expected, picture, &mut shown)?;
                    run.told.extend(reference::note(own.as_ref(), &report));
                    report.reference = own;
                    (error, object, remark) = (report.whole, report.footprint.error, report.remark.clone());
                    first_error = Some(report);
                } else {
                    [error, object] = difference(&shown, &picture, view.background)?;
                    remark = error.is_none().then(|| NO_OBJECT.into());
                }
            }
            if let Some(picture) = &shown.image {
                take(Shown { frame: index, picture, playback_fps })?;
            }
            if let (0, Some(image)) = (index, &shown.image) {
                run.told.extend(ends_note::note(view, machine, &first, &frame, image, options.plan)?);
            }
            if index == 0 {
                (pictures, first_digest) = (shown, digest.clone());
                run.bases = Some(bases.clone());
            }
        }
        let this = ends.as_ref().map(|ends| ends[index]);
        reports.push(FrameReport {
            angles_deg: view.view.direction.is_none().then_some([
                view.view.yaw_deg,
                view.view.tilt_deg,
                view.view.roll_deg,
            ]),
            cycles: this.map(|this| this - end),
            end_cycle: this,
            volume: mixture.oldest,
            newest_volume: mixture.newest,
            newer_fraction: mixture.newer as f64 / mixture.voxels.max(1) as f64,
            torn: mixture.is_torn(),
            mixed_beams: mixture.mixed_beams,
            first_torn_plane: mixture.first_torn_plane,
            error,
            footprint: object,
            remark,
            digest,
        });
        end = this.unwrap_or_default();
        if index == 0 {
            first_frame = Some(frame);
        }
        progress.set(index as u64 + 1, frames as u64);
    }
    progress.finish();
    run.function_s = function_s;
    let Some(frame) = first_frame else {
        return Err(Problem::new(format!("--frames 0: give 1 to {MOST_FRAMES}")));
    };

    let torn_frames = reports.iter().filter(|frame| frame.torn).count();
    let cycles = clocked.as_ref().map_or(0, |clocked| clocked.counters.cycles);
    let acquisition = port.map(|port| acquisition(port, machine, cycles, torn_frames));
    let sequence = SequenceReport {
        fps_sustained: fps,
        time_s: clocked.as_ref().map(|clocked| clocked.counters.cycles as f64 / machine.clock_hz),
        playback_fps: pictures.image.is_some().then_some(playback_fps),
        acquisition,
        animation: None,
        frames: reports,
    };
    let clocked_port = port.is_some();
    if let Some(clocked) = clocked {
        run.counters = Some(clocked.counters);
        if options.runs == Runs::Cycle {
            run.overflows = clocked.overflows;
        }
    }
    // The first volume was there before the clock ran.
    let total_s = Some(total.finish() + first.made_s.unwrap_or(0.0));
    let wall = WallReport { volume_s: Some(series.made_s), reference_s, total_s, ..run.wall(samples) };
    let asked = Asked { scene, machine, volume: &first, options };
    let findings = Findings::new(&views[0], machine, &first, &frame);
    let found = Found {
        frames: frames as u64,
        incoming: clocked_port.then_some(first.words.dims),
        interval: ends.as_deref().and_then(|ends| match ends {
            [first, .., last] => Some((last - first) / (ends.len() as u64 - 1)),
            _ => None,
        }),
        samples,
        opacity: findings.opacity(),
        error: first_error,
        digest: first_digest,
        wall,
        sequence: Some(sequence),
    };
    let mut report = asked.report(&frame, &run, found)?;
    report.words.overflows.insert("voxel".into(), series.clipped.values().sum());
    let seen = frame.setups.iter().map(|setup| setup.geometry.sample_count()).sum();
    let mut told = first.notes.clone();
    told.extend(run.told);
    told.extend(findings.notes(run.bases.as_deref(), seen));
    Ok(RunResult { report, pictures, notes: told, counters: run.counters })
}

/// The scene of one frame: its view is where the path is then.
fn scene_at(scene: &Scene, frame: usize, frames: usize) -> Scene {
    let view = scene.path.as_ref().map_or_else(|| scene.view.clone(), |path| path.view_at(&scene.view, frame, frames));
    Scene { view, ..scene.clone() }
}

/// Runs the clock over all frames, of which some begin a picture, with or without data.
fn clock(
    machine: &MachineSpec,
    series: &mut Series,
    (setups, pictures): (Vec<FrameSetup>, Vec<u32>),
    port: Option<PortSpec>,
    runs: Runs,
    run: &mut MachineRun,
) -> Outcome<Clocked> {
    let progress = Progress::new("timing");
    let data = (runs == Runs::Cycle).then(|| setups.clone());
    let mut timing: Machine<Timing> = Machine::timing(machine, setups)?;
    if let Some(port) = port {
        timing.acquire(port);
        timing.begin_pictures(pictures.clone());
    }
    timing.run(&|done, all| progress.set(done, all))?;
    let (counters, after) = (timing.counters(), timing.port().cloned());
    let seconds = progress.finish();
    let Some(setups) = data else {
        run.timing_s = Some(seconds);
        return Ok(Clocked { counters, port: after, bases: Vec::new(), overflows: Overflows::default() });
    };
    let progress = Progress::new("cycle");
    let first = Arc::clone(&series.first);
    let mut machine = Machine::cycle(machine, setups, first.words.dims, &first.words.words)?;
    if let (Some(spec), Some(port)) = (port, &after) {
        let begun = port.written().div_ceil(spec.voxels);
        let limit = series.options.limit();
        let bytes = begun.saturating_mul(spec.voxels * 2);
        if bytes > limit {
            return Err(Problem::new(format!(
                "--fidelity cycle holds the {begun} volumes that come in, {bytes} bytes, and {limit} are free: give fewer frames, or another fidelity"
            )));
        }
        let words = (1..=begun).map(|index| Ok(series.volume(index)?.words.words.clone()));
        machine.acquire_volumes(spec, words.collect::<Outcome<Vec<Vec<u16>>>>()?);
        machine.begin_pictures(pictures);
    }
    machine.run(&|done, all| progress.set(done, all))?;
    run.cycle_s = Some(progress.finish());
    let (counters, port, overflows) = (machine.counters(), machine.port().cloned(), machine.overflows());
    Ok(Clocked { counters, port, bases: machine.into_base_planes(), overflows })
}

/// What a frame shows.
enum Content {
    /// A volume as it came.
    Whole(Arc<LoadedVolume>),
    /// Words put together from several.
    Mixed(Vec<u16>),
}

impl Content {
    /// Voxel words, x fastest.
    fn words(&self) -> &[u16] {
        match self {
            Content::Whole(volume) => &volume.words.words,
            Content::Mixed(words) => words,
        }
    }
}

fn content(series: &mut Series, sight: Option<&Sight<'_>>, mixture: &Mixture) -> Outcome<Content> {
    let Some(sight) = sight.filter(|_| mixture.is_torn()) else {
        return Ok(Content::Whole(series.volume(mixture.oldest)?));
    };
    let volumes = (mixture.oldest..=mixture.newest).map(|index| series.volume(index)).collect::<Outcome<Vec<_>>>()?;
    let words: Vec<&[u16]> = volumes.iter().map(|volume| volume.words.words.as_slice()).collect();
    Ok(Content::Mixed(sight.assemble(mixture.oldest, &words)))
}

/// The errors of a frame over the whole picture and over the object; none where neither picture shows one.
fn difference(shown: &Pictures, reference: &Picture, background: [f64; 3]) -> Outcome<[Option<ImageError>; 2]> {
    let image = shown.image.as_ref().ok_or_else(|| Problem::new("there is no picture to measure"))?;
    let object = footprint(image, reference, background)?;
    let comparison = compare(image, reference, Some(&object))?;
    Ok([comparison.footprint.and(Some(comparison.whole)), comparison.footprint])
}

/// Frames per second between the ends of the first and the last frame; of one frame, from its start.
fn sustained_fps(ends: &[u64], clock_hz: f64) -> f64 {
    let (frames, cycles) = match ends {
        [] => (0, 0),
        [only] => (1, *only),
        [first, .., last] => (ends.len() - 1, last - first),
    };
    frames as f64 * clock_hz / cycles.max(1) as f64
}

/// Refuses volumes that change under an eye's frames: these may read a voxel several times, and each time of another volume.
fn check_perspective(scene: &Scene, machine: &MachineSpec, moves: bool, runs: Runs) -> Outcome<()> {
    let mixes = machine.acquisition.mode != AcquisitionMode::DoubleBuffer && runs != Runs::Function;
    if scene.view.perspective.is_some() && moves && mixes {
        return Err(Problem::new(
            "in perspective a frame may read a voxel more than once, and a volume that changes meanwhile has no one picture: \
             give acquisition.mode = \"double-buffer\" in the machine file, or a volume that stands still",
        ));
    }
    Ok(())
}

fn acquisition(port: &AcquisitionPort, machine: &MachineSpec, cycles: u64, torn_frames: usize) -> AcquisitionReport {
    let (spec, written) = (port.spec(), port.written());
    let (mode, buffers) = match spec.mode {
        AcquisitionMode::DualPort => ("dual-port", 1),
        AcquisitionMode::CycleStealing => ("cycle-stealing", 1),
        AcquisitionMode::DoubleBuffer => ("double-buffer", 2),
    };
    let volumes = |words: f64, cycles: f64| words / spec.voxels as f64 * machine.clock_hz / cycles;
    AcquisitionReport {
        mode: mode.into(),
        words_per_cycle: spec.words_per_cycle(),
        words_written: written,
        volumes_written: written / spec.voxels,
        updates_per_s: volumes(written as f64, cycles.max(1) as f64),
        updates_per_s_limit: volumes(spec.words_per_cycle(), 1.0),
        stolen_cycles: port.stolen(),
        buffers,
        torn_frames,
    }
}
