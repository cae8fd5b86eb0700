//! One frame on the machine: picture, throughput, stalls, error.

use crate::clocked::Stops;
use crate::machine_run::run_machine;
use crate::notes::Findings;
use crate::pictures::{Pictures, measure, show};
use crate::reporting::{Asked, Found};
use crate::{Outcome, RunOptions, ends_note, ray_spacing, reference};
use cube3_host::picture_setup;
use cube3_inputs::LoadedVolume;
use cube3_machine::MachineSpec;
use cube3_method::{Subject, own_error};
use cube3_picture::Watch;
use cube3_pipeline::RunCounters;
use cube3_report::{DigestReport, RunReport, WallReport};
use cube3_scene::Scene;
use std::time::Instant;

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

/// Runs a frame of a scene on a machine.
///
/// # Errors
/// As [`run_frame`].
///
/// A machine that cannot move is told apart from everything else:
///
/// ```
/// use cube3::{Error, Machine, RunOptions, Runs, Scene, load, run};
/// use cube3_pipeline::RunError;
/// use cube3_scene::VolumeSource;
///
/// let scene = Scene { volume: VolumeSource::from_phantom("sphere", 16), ..Scene::default() };
/// let mut machine = Machine { lanes: 16, ..Machine::default() };
/// machine.dsb.planes = 1;
/// let volume = load(&scene, &machine)?;
/// let options = RunOptions { runs: Runs::Timing, ..RunOptions::default() };
/// match run(&scene, &machine, &volume, &options) {
///     Err(Error::Run(RunError::Deadlock(deadlock))) => println!("{deadlock}"),
///     other => panic!("one plane is too few: {:?}", other.map(|result| result.report.timing)),
/// }
/// # Ok::<(), Error>(())
/// ```
pub fn run(scene: &Scene, machine: &MachineSpec, volume: &LoadedVolume, options: &RunOptions) -> Outcome<RunResult> {
    run_frame(scene, machine, volume, options, &Stops::default(), &|_, _, _| {})
}

/// Runs a frame of a scene on a machine, with stops of the clocked run; `watch` is told how far each part is.
///
/// # Errors
/// A scene, machine or volume that cannot be run, a machine that cannot move, stops that are not in the run.
pub fn run_frame(
    scene: &Scene,
    machine: &MachineSpec,
    volume: &LoadedVolume,
    options: &RunOptions,
    stops: &Stops,
    watch: Watch<'_>,
) -> Outcome<RunResult> {
    let start = Instant::now();
    let as_asked = scene;
    let scene = &*scene.thickened(volume.single);
    if let Some(reference) = &options.reference {
        reference.method.check(scene)?;
    }
    let frames = picture_setup(scene, machine, &volume.info(), options.plan)?;
    let findings = Findings::new(scene, machine, volume, &frames);
    let mut run = run_machine(&frames, machine, volume, options, stops, watch)?;
    let mut pictures = Pictures::default();
    let mut digest = DigestReport::default();
    if let Some(bases) = &run.bases {
        (pictures, digest) = show(bases, &frames, scene, volume)?;
    }
    if let Some(image) = &pictures.image {
        run.told.extend(ends_note::note(scene, machine, volume, &frames, image, options.plan)?);
    }
    let (mut error, mut reference_s) = (None, None);
    if let (Some(choice), Some(_)) = (&options.reference, &pictures.image) {
        let subject = Subject { frames: Some(&frames), ..Subject::new(scene, machine, volume) };
        let (rendering, told) = reference::rendered(options, choice, &subject, watch)?;
        run.told.extend(told);
        reference_s = Some(rendering.seconds());
        let own = own_error(choice, &subject, &rendering.picture)?;
        let mut report = measure(choice, scene, &frames, volume, rendering, &mut pictures)?;
        run.told.extend(reference::note(own.as_ref(), &report));
        report.reference = own.as_ref().map(reference::report);
        error = Some(report);
    }
    let samples = frames.setups.iter().map(|setup| setup.geometry.sample_count()).sum();
    let total_s = Some(start.elapsed().as_secs_f64() + volume.made_s.unwrap_or(0.0));
    let wall = WallReport { volume_s: volume.made_s, reference_s, total_s, ..run.wall(samples) };
    let asked = Asked { scene: as_asked, machine, volume, options };
    let opacity = findings.opacity();
    let found =
        Found { frames: 1, incoming: None, interval: None, samples, opacity, error, digest, wall, sequence: None };
    let report = asked.report(&frames, &run, found)?;
    let mut notes = volume.notes.clone();
    notes.extend(run.told);
    notes.extend(findings.notes(run.bases.as_deref(), samples));
    notes.extend(ray_spacing::notes(volume.dims(), volume.words.spacing));
    Ok(RunResult { report, pictures, notes, counters: run.counters })
}
