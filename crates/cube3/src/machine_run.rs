//! The machine's runs of a picture: with a clock, without, or both at once.

use crate::clocked::{Stops, run_clocked};
use crate::options::Runs;
use crate::{Error, Outcome, RunOptions};
use cube3_frame::{BasePlane, FrameSetup, Overflows};
use cube3_function::{CanonicalVolume, FunctionRun, render};
use cube3_host::PictureFrames;
use cube3_inputs::LoadedVolume;
use cube3_machine::MachineSpec;
use cube3_picture::Watch;
use cube3_pipeline::checkpoint::RunIdentity;
use cube3_pipeline::{Fidelity, Machine, RunCounters, Timing};
use cube3_report::WallReport;
use std::sync::Arc;
use std::time::Instant;

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

/// Makes the runs of a picture's frames.
pub(crate) fn run_machine(
    frames: &PictureFrames,
    machine: &MachineSpec,
    volume: &LoadedVolume,
    options: &RunOptions,
    stops: &Stops,
    watch: Watch<'_>,
) -> Outcome<MachineRun> {
    if options.runs == Runs::Function && !stops.is_empty() {
        return Err(Error::NoCycles);
    }
    let mut run = MachineRun::default();
    let (setups, words) = (frames.setups.as_slice(), &volume.words);
    if setups.is_empty() {
        run.bases = (options.runs != Runs::Timing).then(Vec::new);
        return Ok(run);
    }
    let function = || function(setups, words.dims, &words.words, options.plan, watch);
    match options.runs {
        Runs::Both => {
            let (timing, function) = std::thread::scope(|scope| {
                let timing = scope.spawn(|| timing(setups, machine, volume, stops, watch));
                let function = function();
                (timing.join(), function)
            });
            run.take_timing(timing.map_err(|_| Error::Stopped("timing"))??);
            run.take_function(function);
        }
        Runs::Timing => run.take_timing(timing(setups, machine, volume, stops, watch)?),
        Runs::Function => run.take_function(function()),
        Runs::Cycle => {
            let start = Instant::now();
            let mut cycle = Machine::cycle(machine, setups.to_vec(), words.dims, &words.words)?;
            run.told = clocked(&mut cycle, Runs::Cycle, setups, machine, volume, stops, &|done, all| {
                watch("cycle", done, all);
            })?;
            run.cycle_s = Some(start.elapsed().as_secs_f64());
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

fn timing(
    setups: &[Arc<FrameSetup>],
    machine: &MachineSpec,
    volume: &LoadedVolume,
    stops: &Stops,
    watch: Watch<'_>,
) -> Outcome<TimingRun> {
    let start = Instant::now();
    let mut timing: Machine<Timing> = Machine::timing(machine, setups.to_vec())?;
    let told =
        clocked(&mut timing, Runs::Timing, setups, machine, volume, stops, &|done, all| watch("timing", done, all))?;
    Ok((timing.counters(), start.elapsed().as_secs_f64(), told))
}

fn clocked<F: Fidelity>(
    run: &mut Machine<F>,
    runs: Runs,
    setups: &[Arc<FrameSetup>],
    machine: &MachineSpec,
    volume: &LoadedVolume,
    stops: &Stops,
    progress: &dyn Fn(u64, u64),
) -> Outcome<Vec<String>> {
    let words = &volume.words;
    let identity = || RunIdentity::new(runs.name(), machine, setups, words.dims, &words.words);
    run_clocked(run, stops, machine.clock_hz, identity, progress)
}

/// Renders frames of a volume of voxel words, x fastest; also the seconds.
pub(crate) fn function(
    setups: &[Arc<FrameSetup>],
    dims: [usize; 3],
    words: &[u16],
    skip: bool,
    watch: Watch<'_>,
) -> (Vec<FunctionRun>, f64) {
    let start = Instant::now();
    let pass = |setup: &Arc<FrameSetup>| {
        let turned = CanonicalVolume::new(&setup.geometry.axes, dims, words);
        render(setup, &turned, skip, &|done, all| watch("function", done, all))
    };
    let runs = setups.iter().map(pass).collect();
    (runs, start.elapsed().as_secs_f64())
}
