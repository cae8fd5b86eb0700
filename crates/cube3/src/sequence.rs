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

use crate::machine_run::{MachineRun, function};
use crate::notes::Findings;
pub use crate::options::MOST_FRAMES;
use crate::options::Runs;
use crate::pictures::{Pictures, frame_errors, measure, show};
use crate::reporting::{Asked, Found};
use crate::sequence_clock::clock;
use crate::{Error, Outcome, RunOptions, RunResult, ends_note, reference};
use cube3_cfb::{AcquisitionPort, PortSpec};
use cube3_frame::Schedule;
use cube3_host::{PictureFrames, picture_setup};
use cube3_inputs::{LoadedVolume, Series};
use cube3_machine::{AcquisitionMode, MachineSpec};
use cube3_method::{Subject, own_error};
use cube3_picture::{Picture, Watch};
use cube3_pipeline::acquisition::{Mixture, Sight};
use cube3_report::{AcquisitionReport, DigestReport, FrameReport, NO_OBJECT, SequenceReport, WallReport};
use cube3_scene::Scene;
use std::sync::Arc;
use std::time::Instant;

/// Slowest and fastest playback, in frames per second: browsers hold a frame for a hundredth of a second at least.
const PLAYBACK_FPS: [f64; 2] = [1.0, 30.0];

/// The playback of frames that come at a rate: the same within what a viewer can follow.
pub fn playback_fps(fps: f64) -> f64 {
    fps.clamp(PLAYBACK_FPS[0], PLAYBACK_FPS[1])
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
    watch: Watch<'_>,
) -> Outcome<RunResult> {
    let total = Instant::now();
    let first = series.shared_first();
    let moves = series.count() != Some(1);
    let views: Vec<Scene> =
        (0..frames).map(|frame| scene_at(scene, frame, frames).thickened(first.single).into_owned()).collect();
    let set_up =
        |frame: usize| Ok::<PictureFrames, Error>(picture_setup(&views[frame], machine, &first.info(), options.plan)?);
    check_perspective(scene, machine, moves, options.runs)?;
    if let Some(reference) = &options.reference {
        views.iter().try_for_each(|view| reference.method.check(view))?;
    }
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
            Some(clock(machine, series, (setups, pictures), port, options.runs, &mut run, watch)?)
        }
    };
    let ends: Option<Vec<u64>> = clocked.as_ref().map(|clocked| {
        let end = |&passes: &usize| passes.checked_sub(1).map_or(0, |last| clocked.counters.frame_ends[last]);
        passes.iter().map(end).collect()
    });
    let fps = ends.as_deref().map(|ends| sustained_fps(ends, machine.clock_hz));
    let playback_fps = playback_fps(fps.unwrap_or(f64::INFINITY));

    let (mut pictures, mut first_error, mut first_digest) = (Pictures::default(), None, DigestReport::default());
    let (mut reports, mut samples, mut reference_s, mut function_s) = (Vec::new(), 0, None, None);
    let port = clocked.as_ref().and_then(|clocked| clocked.port.as_ref());
    let mut seen = port.map(AcquisitionPort::seen);
    let (mut first_frame, mut end) = (None, 0);
    for (index, view) in views.iter().enumerate() {
        let frame = set_up(index)?;
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
                    let (made, seconds) = function(setup, first.words.dims, content.words(), options.plan, watch);
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
            if let Some(choice) = &options.reference {
                let expected = series.volume(mixture.oldest)?;
                let subject = Subject { frames: Some(&frame), ..Subject::new(view, machine, &expected) };
                let (rendering, told) = reference::rendered(options, choice, &subject, watch)?;
                run.told.extend(told.filter(|_| index == 0));
                *reference_s.get_or_insert(0.0) += rendering.seconds();
                if index == 0 {
                    let own = own_error(choice, &subject, &rendering.picture)?;
                    let mut report = measure(choice, view, &frame, &expected, rendering, &mut shown)?;
                    run.told.extend(reference::note(own.as_ref(), &report));
                    report.reference = own.as_ref().map(reference::report);
                    (error, object, remark) = (report.whole, report.footprint.error, report.remark.clone());
                    first_error = Some(report);
                } else {
                    [error, object] = frame_errors(&shown, &rendering.picture, view.background)?;
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
        watch("frames", index as u64 + 1, frames as u64);
    }
    run.function_s = function_s;
    let Some(frame) = first_frame else {
        return Err(Error::NoFrames);
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
    let total_s = Some(total.elapsed().as_secs_f64() + first.made_s.unwrap_or(0.0));
    let wall = WallReport { volume_s: Some(series.made_s()), reference_s, total_s, ..run.wall(samples) };
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
    report.words.overflows.insert("voxel".into(), series.clipped());
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
    let volumes = (mixture.oldest..=mixture.newest).map(|index| series.volume(index)).collect::<Result<Vec<_>, _>>()?;
    let words: Vec<&[u16]> = volumes.iter().map(|volume| volume.words.words.as_slice()).collect();
    Ok(Content::Mixed(sight.assemble(mixture.oldest, &words)))
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
        return Err(Error::VolumesUnderAnEye);
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
