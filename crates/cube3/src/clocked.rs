//! A clocked run with stops on its way: a window is traced, the state saved, an earlier state taken up.

use crate::{Error, Outcome, write_waveform};
use cube3_file::write_whole;
use cube3_pipeline::checkpoint::{self, CheckpointError, RunIdentity};
use cube3_pipeline::{Fidelity, Machine, RunError};
use cube3_trace::{CycleWindow, Recorder, Recording, TraceError, TraceFormat};
use std::path::PathBuf;

/// A trace that is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TraceRequest {
    /// The file.
    pub path: PathBuf,
    /// How it is written.
    pub format: TraceFormat,
    /// Its cycles.
    pub window: CycleWindow,
}

/// What is asked of a clocked run beside its counters.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stops {
    /// A trace of a window of cycles. It is written also when the machine cannot move on.
    pub trace: Option<TraceRequest>,
    /// The cycle at which the state is saved, and the file.
    pub checkpoint: Option<(u64, PathBuf)>,
    /// The bytes of a checkpoint that the run goes on from.
    pub resume: Option<Vec<u8>>,
}

impl Stops {
    /// Whether nothing is asked.
    pub fn is_empty(&self) -> bool {
        *self == Stops::default()
    }
}

/// Runs a machine that has just been built, to the last pixel. `identity` is made where the state is saved or taken up. What was
/// written, and what else a person should know.
///
/// # Errors
/// A machine that cannot move, a checkpoint that does not fit, a window or cycle outside of the run, a file that cannot be written.
pub fn run_clocked<F: Fidelity>(
    machine: &mut Machine<F>,
    stops: &Stops,
    clock_hz: f64,
    identity: impl Fn() -> RunIdentity,
    progress: &dyn Fn(u64, u64),
) -> Outcome<Vec<String>> {
    let mut told = Vec::new();
    if let Some(bytes) = &stops.resume {
        checkpoint::restore(bytes, machine, &identity())?;
        told.push(format!("the run was resumed at cycle {}", machine.now()));
    }
    let (start, window) = (machine.now(), stops.trace.as_ref().map(|trace| trace.window));
    if let Some(CycleWindow { from, .. }) = window.filter(|window| window.from < start) {
        return Err(TraceError::Before { cycle: start, from }.into());
    }
    if let Some((at, _)) = stops.checkpoint.as_ref().filter(|(at, _)| *at < start) {
        return Err(CheckpointError::Before { cycle: start, at: *at }.into());
    }
    let mut cycles: Vec<u64> = window.into_iter().flat_map(|window| [window.from, window.to]).collect();
    cycles.extend(stops.checkpoint.as_ref().map(|(at, _)| *at));
    cycles.push(u64::MAX);
    cycles.sort_unstable();
    let (mut recorder, mut recording): (Option<Recorder>, Option<Recording>) = (None, None);
    let mut saved = false;
    for stop in cycles {
        let done = match &mut recorder {
            Some(recorder) => recorder.run(machine, stop, progress),
            None => machine.run_until(stop, progress),
        };
        match done {
            Ok(true) => break,
            Ok(false) => {}
            Err(deadlock) => {
                recording = recording.or(recorder.map(Recorder::finish));
                write_trace(stops, recording.as_ref())?;
                return Err(RunError::from(deadlock).into());
            }
        }
        if let Some((at, path)) = &stops.checkpoint
            && *at == stop
            && !saved
        {
            let bytes = checkpoint::save(machine, &identity())?;
            if let Some(folder) = path.parent() {
                std::fs::create_dir_all(folder).map_err(|error| Error::file(folder, error))?;
            }
            write_whole(path, &bytes).map_err(|error| Error::file(path, error))?;
            told.push(format!("the state at cycle {stop} is in {}", path.display()));
            saved = true;
        }
        if let Some(window) = window {
            if window.from == stop && recorder.is_none() && recording.is_none() {
                recorder = Some(Recorder::new(machine, window, clock_hz));
            } else if window.to == stop {
                recording = recording.or(recorder.take().map(Recorder::finish));
            }
        }
    }
    let cycles = machine.now();
    if let Some((at, _)) = stops.checkpoint.as_ref().filter(|_| !saved) {
        return Err(CheckpointError::Beyond { cycles, at: *at }.into());
    }
    recording = recording.or(recorder.map(Recorder::finish));
    match (&recording, window) {
        (None, Some(CycleWindow { from, .. })) => return Err(TraceError::Beyond { cycles, from }.into()),
        (Some(recording), Some(window)) if recording.to() < window.to => {
            told.push(format!("the trace ends with the run, at cycle {cycles}, before --to {}", window.to));
        }
        _ => {}
    }
    told.extend(write_trace(stops, recording.as_ref())?);
    Ok(told)
}

fn write_trace(stops: &Stops, recording: Option<&Recording>) -> Outcome<Option<String>> {
    let (Some(TraceRequest { path, format, .. }), Some(recording)) = (&stops.trace, recording) else {
        return Ok(None);
    };
    let told = format!("the trace of cycles {} to {} is in {}", recording.from(), recording.to(), path.display());
    if *format == TraceFormat::Fst {
        write_waveform(path, &recording.waveform()?)?;
        let [gtkwave, surfer] = ["gtkw", "sucl"].map(|extension| path.with_extension(extension).display().to_string());
        return Ok(Some(format!(
            "{told}; open it with `gtkwave {gtkwave}` or `surfer -c {surfer} {}`",
            path.display()
        )));
    }
    write_whole(path, &recording.write(*format)?).map_err(|error| Error::file(path, error))?;
    Ok(Some(told))
}
