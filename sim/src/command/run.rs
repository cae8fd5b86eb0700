//! `cube3 run`: one frame on the machine, or a sequence of frames.

use super::kept::CacheArguments;
use super::scene::SceneArguments;
use super::{fits, on_threads, threads};
use crate::output::{ANIMATION, SequenceFiles, write_run, write_whole};
use crate::problem::{Outcome, Problem};
use crate::progress::{Bars, Waiting};
use clap::{Args, Parser, ValueEnum};
use cube3::clocked::{Stops, TraceRequest};
use cube3::memory::{Case, Grid};
use cube3::sequence::{MOST_FRAMES, Shown, run_sequence};
use cube3::{Error, RunOptions, Runs, conversion, run_frame};
use cube3_inputs::{self as inputs, KEPT_VOLUMES, LoadedVolume, Series};
use cube3_machine::{AcquisitionMode, MachineSpec, PRESETS, RayEnds, RaySlots, TemplateRule};
use cube3_method::Choice;
use cube3_pipeline::checkpoint;
use cube3_rendering::MethodError;
use cube3_report::{Drawing, JSON_SCHEMA, SourcesReport, table};
use cube3_scene::{Path, Scene};
use cube3_trace::{CycleWindow, TraceFormat};
use cube3_volume::ReadOptions;
use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;

/// Arguments of `cube3 run`.
#[derive(Debug, Args)]
pub struct RunArguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Machine file, or the name of a preset: cube3-128, cube3-256, cube3-512, cube3-board, cube4-teramac, em-cube or
    /// volumepro-500.
    #[arg(long, value_name = "FILE.toml|NAME", default_value = "cube3-128")]
    machine: String,
    /// A sequence of so many frames: volumes come in through the acquisition port, the view follows its path.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_FRAMES as i64))]
    frames: Option<u32>,
    /// Turn of the eye about the vertical axis over all frames.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, requires = "frames")]
    turntable: Option<f64>,
    /// Phase of the first volume of a phantom that moves, in periods.
    #[arg(long, value_name = "PERIODS", allow_negative_numbers = true)]
    phase: Option<f64>,
    /// From each volume of a phantom that moves to the next; one period over all frames without it.
    #[arg(long, value_name = "PERIODS", allow_negative_numbers = true, requires = "frames")]
    phase_per_frame: Option<f64>,
    /// How volumes that come in share the memory modules with reads.
    #[arg(long, value_enum, requires = "frames")]
    acquisition: Option<AcquisitionArgument>,
    /// Voxel words that come in with a cycle.
    #[arg(long, value_name = "WORDS", requires = "frames")]
    words_per_cycle: Option<f64>,
    /// Whether rays share slots.
    #[arg(long, value_enum)]
    slots: Option<SlotsArgument>,
    /// What the samples at the ends of rays stand for: a whole step, as published, or their part of it.
    #[arg(long, value_enum)]
    ends: Option<EndsArgument>,
    /// Where discrete rays take their floor.
    #[arg(long, value_enum)]
    template: Option<TemplateArgument>,
    /// Which runs are made; "both" is timing and function side by side.
    #[arg(long, value_enum, default_value_t)]
    fidelity: FidelityArgument,
    /// What the picture is measured against: a method of `cube3 methods`, its options behind colons as in image-order:0.25, or none.
    #[arg(long, value_name = "NAME[:OPTION]", default_value = "image-order", value_parser = reference)]
    reference: Against,
    #[command(flatten)]
    kept: CacheArguments,
    /// Do not look for what limits the frame rate, which runs the machine again with one resource at a time out of the way.
    #[arg(long)]
    no_limits: bool,
    /// Run every unit, also those that cannot change the picture.
    #[arg(long)]
    no_plan: bool,
    /// Give voxels that are not finite the word 0, instead of refusing them.
    #[arg(long)]
    mask_non_finite: bool,
    /// Threads; all cores without it.
    #[arg(long)]
    threads: Option<usize>,
    /// Seed of everything random; written into the report.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Trace of the cycles --from to --to: .fst for waveform viewers, .kanata for Konata, .json for Perfetto.
    #[arg(long, value_name = "FILE", requires = "to", conflicts_with = "frames")]
    trace: Option<PathBuf>,
    /// First cycle of the trace.
    #[arg(long, value_name = "CYCLE", default_value_t = 0, requires = "trace")]
    from: u64,
    /// The cycle behind the last of the trace.
    #[arg(long, value_name = "CYCLE", requires = "trace")]
    to: Option<u64>,
    /// The machine as a drawing, with how busy each unit was: .svg or .dot.
    #[arg(long, value_name = "FILE")]
    topology: Option<PathBuf>,
    /// Save the clocked run at this cycle into the folder, as checkpoint.cube3, and go on.
    #[arg(long, value_name = "CYCLE", conflicts_with = "frames")]
    checkpoint_at: Option<u64>,
    /// Go on from a saved run, with the same scene, machine, volume and fidelity.
    #[arg(long, value_name = "FILE", conflicts_with = "frames")]
    resume: Option<PathBuf>,
    /// Folder for report and pictures.
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Print the default scene, commented, and stop.
    #[arg(long)]
    print_scene: bool,
    /// Print the default machine, commented, and stop.
    #[arg(long)]
    print_machine: bool,
    /// Print the JSON schema of report.json, and stop.
    #[arg(long)]
    print_schema: bool,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum FidelityArgument {
    #[default]
    Both,
    Timing,
    Function,
    Cycle,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SlotsArgument {
    Wrapped,
    Padded,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum EndsArgument {
    Published,
    Exact,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum TemplateArgument {
    SampleFloor,
    PlaneFloor,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum AcquisitionArgument {
    DualPort,
    CycleStealing,
    DoubleBuffer,
}

/// What a picture is measured against; nothing where none is asked for.
#[derive(Clone, Debug)]
struct Against(Option<Choice>);

fn reference(text: &str) -> Result<Against, MethodError> {
    if text == "none" { Ok(Against(None)) } else { text.parse().map(|choice| Against(Some(choice))) }
}

/// The run command on its own, to take its defaults from.
#[derive(Debug, Parser)]
struct Alone {
    #[command(flatten)]
    run: RunArguments,
}

impl RunArguments {
    /// The run that no arguments ask for.
    pub fn defaults() -> RunArguments {
        Alone::parse_from(["cube3"]).run
    }

    /// Runs the frame, prints the report and writes the files.
    ///
    /// # Errors
    /// What went wrong, in words.
    pub fn execute(self) -> Outcome<()> {
        if self.print_scene {
            return print(Scene::COMMENTED_DEFAULT);
        }
        if self.print_machine {
            return print(&MachineSpec::default().commented());
        }
        if self.print_schema {
            return print(JSON_SCHEMA);
        }
        keep_inputs(self.scene.file(), &self.machine, &self.out)?;
        let mut stops = self.stops()?;
        let drawing = self.topology.as_deref().map(drawing).transpose()?;
        let scene = self.scene()?;
        let machine = self.machine()?;
        let read = self.scene.read_options()?;
        let options = RunOptions {
            runs: match self.fidelity {
                FidelityArgument::Both => Runs::Both,
                FidelityArgument::Timing => Runs::Timing,
                FidelityArgument::Function => Runs::Function,
                FidelityArgument::Cycle => Runs::Cycle,
            },
            reference: self.reference.0.clone(),
            cache: self.kept.cache(),
            plan: !self.no_plan,
            limits: !self.no_limits,
            seed: self.seed,
        };
        self.check_memory(&scene, &machine, &read, &options)?;
        stops.resume = self.resume.as_deref().map(checkpoint::read).transpose()?;
        let bars = Bars::default();
        let watch = |what: &'static str, done, all| bars.set(what, done, all);
        let (mut result, mut files) = on_threads(self.threads, || {
            let started = |volume: &LoadedVolume| {
                let [nx, ny, nz] = volume.dims();
                print(&format!("{}: {nx} × {ny} × {nz}\n{}\n", volume.source, conversion(&scene, volume)))
            };
            let Some(frames) = self.frames.map(|frames| frames as usize) else {
                let waiting = Waiting::new("volume");
                let volume = inputs::load_volume(&scene, &machine, &read, self.mask_non_finite)?;
                drop(waiting);
                started(&volume)?;
                return Ok((run_frame(&scene, &machine, &volume, &options, &stops, &watch)?, None));
            };
            let mut series = Series::open(&scene, &machine, &read, self.mask_non_finite, frames)?;
            started(series.first())?;
            let mut files = SequenceFiles::new(&self.out, frames)?;
            let take = &mut |shown: Shown<'_>| {
                files.push(&shown).map_err(|problem| Error::Refused(problem.to_string().into()))
            };
            let result = run_sequence(&scene, &machine, &mut series, frames, &options, take, &watch)?;
            Ok((result, Some(files)))
        })?;
        result.report.command = command(std::env::args_os().skip(1));
        result.report.sources = self.sources();
        if let Some(sequence) = result.report.sequence.as_mut().filter(|_| result.pictures.image.is_some()) {
            sequence.animation = Some(ANIMATION.into());
        }
        print(&table(&result.report))?;
        for note in &result.notes {
            print(&format!("\nnote: {note}\n"))?;
        }
        if self.frames.is_none() && scene.path.is_some() {
            print("\nnote: this is the scene's own view; --frames N goes along its path\n")?;
        }
        let animation = files.as_mut().map(SequenceFiles::animation).transpose()?.flatten();
        let mut written = write_run(&self.out, &result, animation.as_deref(), &scene, &machine)?;
        if let (Some(path), Some(drawing), Some(counters)) = (&self.topology, drawing, &result.counters) {
            write_whole(path, drawing.draw(counters).as_bytes())?;
            written.push(path.display().to_string());
        }
        if let Some(files) = files {
            written.extend(files.finish()?);
        }
        print(&format!("wrote {}\n", written.join(" ")))
    }

    /// Refuses a run that does not fit into memory, before it takes any.
    fn check_memory(
        &self,
        scene: &Scene,
        machine: &MachineSpec,
        read: &ReadOptions,
        options: &RunOptions,
    ) -> Outcome<()> {
        let case = Case {
            scene,
            machine,
            grid: Grid::of_scene(&scene.volume, read)?,
            runs: options.runs,
            reference: options.reference.is_some(),
            mask: self.mask_non_finite,
            threads: threads(self.threads)?,
        };
        let mut need = match self.frames {
            None => case.frame(),
            Some(frames) => case.sequence(frames as usize, Series::moves(&scene.volume, read)?, KEPT_VOLUMES),
        };
        if let (Some(trace), Some(to)) = (&self.trace, self.to) {
            let format = TraceFormat::of(trace)?;
            need = case.trace(need, format, CycleWindow::new(self.from, to, format)?);
        }
        let resumed = self.resume.as_deref().and_then(|file| std::fs::metadata(file).ok()).map_or(0, |file| file.len());
        fits(&case.checkpoint(need, self.checkpoint_at.is_some(), resumed))
    }

    /// What is asked of the clocked run, but for the state that it goes on from.
    fn stops(&self) -> Outcome<Stops> {
        if matches!(self.fidelity, FidelityArgument::Function) && self.topology.is_some() {
            return Err(Problem::new(
                "--fidelity function has no units to draw; give --fidelity timing, both or cycle",
            ));
        }
        if let Some(folder) = self.topology.as_deref().and_then(std::path::Path::parent)
            && !folder.as_os_str().is_empty()
            && !folder.is_dir()
        {
            return Err(Problem::new(format!(
                "{}: there is no such folder; give a file in one that is there",
                folder.display()
            )));
        }
        let trace = match (&self.trace, self.to) {
            (Some(path), Some(to)) => {
                let format = TraceFormat::of(path)?;
                Some(TraceRequest { path: path.clone(), format, window: CycleWindow::new(self.from, to, format)? })
            }
            _ => None,
        };
        let checkpoint = self.checkpoint_at.map(|at| (at, self.out.join("checkpoint.cube3")));
        Ok(Stops { trace, checkpoint, resume: None })
    }

    fn scene(&self) -> Outcome<Scene> {
        let mut scene = self.scene.scene(|_| {})?;
        scene.volume.phase = self.phase.or(scene.volume.phase);
        scene.volume.phase_per_frame = self.phase_per_frame.or(scene.volume.phase_per_frame);
        scene.path = self.turntable.map(Path::turntable).or(scene.path);
        scene.validate()?;
        Ok(scene)
    }

    /// Where scene and machine come from.
    fn sources(&self) -> SourcesReport {
        let preset = PRESETS.iter().any(|(name, _)| *name == self.machine);
        SourcesReport {
            scene_file: self.scene.file().map(|file| file.display().to_string()),
            machine_file: (!preset).then(|| self.machine.clone()),
            machine_preset: preset.then(|| self.machine.clone()),
        }
    }

    fn machine(&self) -> Outcome<MachineSpec> {
        let mut machine = self.scene.machine(&self.machine)?;
        machine.acquisition.mode = match self.acquisition {
            Some(AcquisitionArgument::DualPort) => AcquisitionMode::DualPort,
            Some(AcquisitionArgument::CycleStealing) => AcquisitionMode::CycleStealing,
            Some(AcquisitionArgument::DoubleBuffer) => AcquisitionMode::DoubleBuffer,
            None => machine.acquisition.mode,
        };
        machine.acquisition.words_per_cycle = self.words_per_cycle.unwrap_or(machine.acquisition.words_per_cycle);
        match self.slots {
            Some(SlotsArgument::Wrapped) => machine.rays.slots = RaySlots::Wrapped,
            Some(SlotsArgument::Padded) => machine.rays.slots = RaySlots::Padded,
            None => {}
        }
        match self.ends {
            Some(EndsArgument::Published) => machine.rays.ends = RayEnds::Published,
            Some(EndsArgument::Exact) => machine.rays.ends = RayEnds::Exact,
            None => {}
        }
        match self.template {
            Some(TemplateArgument::SampleFloor) => machine.rays.template = TemplateRule::SampleFloor,
            Some(TemplateArgument::PlaneFloor) => machine.rays.template = TemplateRule::PlaneFloor,
            None => {}
        }
        machine.check(&self.machine)?;
        Ok(machine)
    }
}

/// The drawing that a file's extension asks for.
fn drawing(path: &std::path::Path) -> Outcome<Drawing> {
    Drawing::of(path).ok_or_else(|| Problem::new(format!("{}: the drawing is an .svg or .dot file", path.display())))
}

/// The command for the report: the program and its arguments, without the options that change nothing that is measured. So the same run gives
/// the same report on any number of threads and in any folder.
fn command(arguments: impl Iterator<Item = OsString>) -> Vec<String> {
    const ASIDE: [&str; 2] = ["--threads", "--out"];
    let mut words = vec!["cube3".to_owned()];
    let mut arguments = arguments.map(|argument| argument.to_string_lossy().into_owned());
    while let Some(argument) = arguments.next() {
        if ASIDE.contains(&argument.as_str()) {
            arguments.next();
        } else if !argument.split_once('=').is_some_and(|(option, _)| ASIDE.contains(&option)) {
            words.push(argument);
        }
    }
    words
}

/// The resolved scene and machine are written into the folder; they must not take the place of the files read.
pub(super) fn keep_inputs(scene: Option<&std::path::Path>, machine: &str, out: &std::path::Path) -> Outcome<()> {
    for (input, name) in [(scene, "scene.toml"), (Some(std::path::Path::new(machine)), "machine.toml")] {
        let Some(Ok(input)) = input.map(std::fs::canonicalize) else {
            continue;
        };
        if out.join(name).canonicalize().is_ok_and(|output| output == input) {
            let place = input.display();
            return Err(Problem::new(format!(
                "{place} is read, and would be written over; give another folder with --out"
            )));
        }
    }
    Ok(())
}

/// Prints to standard output; a reader that has gone away is no problem.
pub(super) fn print(text: &str) -> Outcome<()> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_is_told_without_threads_and_folder() {
        let told = |arguments: &[&str]| command(arguments.iter().map(OsString::from)).join(" ");
        assert_eq!(told(&[]), "cube3");
        assert_eq!(told(&["run", "--threads", "2", "--yaw", "-30", "--out", "a b"]), "cube3 run --yaw -30");
        assert_eq!(told(&["run", "--out=x", "--threads=1", "--yaw=5"]), "cube3 run --yaw=5");
        assert_eq!(told(&["run", "--outer", "--threads"]), "cube3 run --outer");
    }
}
