//! What `cube3 bench` measures: the runs beside the memory bandwidth of the machine that it runs on.

use crate::problem::Outcome;
use cube3_channel::{Channel, Pipe};
use cube3_function::{CanonicalVolume, render};
use cube3_host::{ParallelFrame, VolumeInfo, frame_setup};
use cube3_inputs::{self as inputs, LoadedVolume};
use cube3_machine::MachineSpec;
use cube3_pipeline::{Machine, RunError};
use cube3_scene::{Scene, VolumeSource};
use cube3_trace::{CycleWindow, Recorder, TraceFormat};
use cube3_volume::ReadOptions;
use rayon::prelude::*;
use std::time::Instant;

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// Voxels a side for function runs.
    pub size: usize,
    /// Voxels a side for timing runs.
    pub timing_size: usize,
    /// Times that everything is measured.
    pub repeats: usize,
}

/// A line of the result.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// What was measured.
    pub what: String,
    /// The median.
    pub value: String,
    /// Its unit.
    pub unit: &'static str,
    /// What it stands beside.
    pub note: String,
}

/// Cycles of the window that is traced.
const WINDOW_CYCLES: u64 = 1000;

/// Bytes that the bandwidth test copies from and to, each: several times any cache.
pub const COPY_BYTES: usize = 256 << 20;

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn seconds(repeats: usize, mut work: impl FnMut()) -> f64 {
    work();
    let times = (0..repeats).map(|_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    });
    median(times.collect())
}

/// Bytes a second that all cores read and write when they copy.
fn copy_bandwidth(repeats: usize) -> f64 {
    let from = vec![1_u64; COPY_BYTES / 8];
    let mut to = vec![0_u64; COPY_BYTES / 8];
    let chunk = (1 << 20) / 8;
    let time = seconds(repeats, || {
        to.par_chunks_mut(chunk).zip(from.par_chunks(chunk)).for_each(|(to, from)| to.copy_from_slice(from));
        std::hint::black_box(&to);
    });
    2.0 * COPY_BYTES as f64 / time
}

/// The pipe of five stages with 8-entry channels: unit-ticks a second.
fn pipe(repeats: usize) -> Outcome<f64> {
    const STAGES: usize = 5;
    const TOKENS: u32 = 1_000_000;
    let mut cycles = 0_u64;
    let mut failed = None;
    let time = seconds(repeats, || {
        let channels: Result<Vec<Channel<u32>>, _> = (0..=STAGES).map(|_| Channel::new("pipe", 8, 1)).collect();
        let Ok(mut channels) = channels.map_err(|error| failed = Some(error)) else {
            return;
        };
        let mut stages: Vec<_> = (0..STAGES).map(|_| Pipe::new(|v: u32| v.wrapping_mul(3).wrapping_add(1))).collect();
        let (mut sent, mut received) = (0, 0);
        cycles = 0;
        while received < TOKENS {
            if sent < TOKENS && channels[0].push(sent).is_ok() {
                sent += 1;
            }
            for (i, stage) in stages.iter_mut().enumerate() {
                let (before, after) = channels.split_at_mut(i + 1);
                stage.tick(&mut before[i], &mut after[0]);
            }
            if std::hint::black_box(channels[STAGES].pop()).is_some() {
                received += 1;
            }
            channels.iter_mut().for_each(Channel::commit);
            cycles += 1;
        }
    });
    match failed {
        Some(error) => Err(error.into()),
        None => Ok(cycles as f64 * STAGES as f64 / time),
    }
}

/// A function run of the head phantom, and what it takes to tell its speed.
struct FunctionCase {
    volume: LoadedVolume,
    frame: ParallelFrame,
    skip: bool,
}

impl FunctionCase {
    fn new(size: usize, shaded: bool, opaque: bool, skip: bool) -> Outcome<FunctionCase> {
        let mut scene = Scene { volume: VolumeSource::from_phantom("head", size), ..Scene::default() };
        scene.material.shaded = shaded;
        if opaque {
            scene.transfer.opacity = vec![[0.0, 0.05], [255.0, 0.05]];
        }
        let machine = MachineSpec { lanes: size, ..MachineSpec::default() };
        let volume = inputs::load_volume(&scene, &machine, &ReadOptions::default(), false)?;
        let frame = frame_setup(&scene, &machine, &volume.info(), skip)?;
        Ok(FunctionCase { volume, frame, skip })
    }

    /// Samples a second, and bytes a second that must come from memory at least: each voxel once, each pixel once.
    fn speed(&self, repeats: usize) -> (f64, f64) {
        let geometry = &self.frame.setup.geometry;
        let words = &self.volume.words;
        let turned = CanonicalVolume::new(&geometry.axes, words.dims, &words.words);
        let time = seconds(repeats, || {
            std::hint::black_box(render(&self.frame.setup, &turned, self.skip, &|_, _| {}));
        });
        let [width, height] = geometry.base_plane_size();
        let bytes = 2 * words.words.len() + 16 * width * height;
        (geometry.sample_count() as f64 / time, bytes as f64 / time)
    }
}

fn row(what: &str, value: f64, scale: f64, unit: &'static str, note: String) -> Measurement {
    Measurement { what: what.into(), value: format!("{:.2}", value / scale), unit, note }
}

/// Measures everything.
///
/// # Errors
/// A volume that cannot be made.
pub fn measure(sizes: &Sizes) -> Outcome<Vec<Measurement>> {
    let threads = rayon::current_num_threads();
    let mut rows = Vec::new();
    let bandwidth = copy_bandwidth(sizes.repeats);
    rows.push(row("memory, copying", bandwidth, 1e9, "GB/s", format!("{threads} threads, read and written")));
    let ticks = pipe(sizes.repeats)?;
    rows.push(row("channel, pipe of five stages", ticks, 1e6, "M unit-ticks/s", "1 thread".into()));
    let (cycles, time) = timing(sizes)?;
    let units = 8.0;
    rows.push(row("timing, a frame", time, 1.0, "s", format!("{} voxels a side, {cycles} cycles", sizes.timing_size)));
    let speed = cycles as f64 * units / time;
    rows.push(row("timing, units", speed, 1e6, "M unit-ticks/s", format!("{:.2} of the pipe's", speed / ticks)));
    for (what, format) in [
        ("timing, the whole frame recorded", None),
        ("timing, 1000 cycles traced as FST", Some(TraceFormat::Fst)),
        ("timing, 1000 cycles traced as Kanata", Some(TraceFormat::Kanata)),
        ("timing, 1000 cycles traced as JSON", Some(TraceFormat::Perfetto)),
    ] {
        let ratio = traced(sizes, format)?;
        rows.push(row(what, ratio, 1.0, "times as long", "as the frame without a trace".into()));
    }
    let cases = [
        ("function, head, shaded, planned", true, false, true),
        ("function, head, unshaded, planned", false, false, true),
        ("function, head, shaded, nothing left out", true, false, false),
        ("function, every sample visible, shaded", true, true, true),
    ];
    let mut first = None;
    for (what, shaded, opaque, skip) in cases {
        let case = FunctionCase::new(sizes.size, shaded, opaque, skip)?;
        let (samples, bytes) = case.speed(sizes.repeats);
        let first = *first.get_or_insert(samples);
        let note = format!("{:.2} of the first, {:.1} % of the bandwidth", samples / first, 100.0 * bytes / bandwidth);
        rows.push(row(what, samples, 1e6, "M samples/s", note));
    }
    Ok(rows)
}

/// The machine and the frame of timing runs: the default view.
fn timing_case(sizes: &Sizes) -> Outcome<(MachineSpec, ParallelFrame)> {
    let machine = inputs::machine("cube3-512")?;
    let volume = VolumeInfo { dims: [sizes.timing_size; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let frame = frame_setup(&Scene::default(), &machine, &volume, true)?;
    Ok((machine, frame))
}

/// How much longer a timing run takes with a recording: of the whole frame and kept in memory, or of a window in its middle and
/// made into a file of a format. Runs with and without are measured in turn.
fn traced(sizes: &Sizes, format: Option<TraceFormat>) -> Outcome<f64> {
    let (machine, frame) = timing_case(sizes)?;
    let frames = || vec![frame.setup.clone()];
    let mut plain = Machine::timing(&machine, frames())?;
    plain.run(&|_, _| {})?;
    let cycles = plain.counters().cycles;
    let window = match format {
        None => CycleWindow { from: 0, to: cycles },
        Some(_) => CycleWindow { from: cycles / 2, to: cycles / 2 + WINDOW_CYCLES },
    };
    let mut ratios = Vec::new();
    for _ in 0..=sizes.repeats {
        let mut plain = Machine::timing(&machine, frames())?;
        let start = Instant::now();
        plain.run(&|_, _| {})?;
        let without = start.elapsed().as_secs_f64();
        let mut run = Machine::timing(&machine, frames())?;
        let start = Instant::now();
        run.run_until(window.from, &|_, _| {})?;
        let mut recorder = Recorder::new(&run, window, machine.clock_hz);
        recorder.run(&mut run, window.to, &|_, _| {})?;
        run.run(&|_, _| {})?;
        let recording = recorder.finish();
        if let Some(format) = format {
            std::hint::black_box(recording.write(format)?);
        }
        std::hint::black_box(&recording);
        ratios.push(start.elapsed().as_secs_f64() / without);
    }
    Ok(median(ratios))
}

/// Cycles and seconds of a timing run of the default view.
fn timing(sizes: &Sizes) -> Outcome<(u64, f64)> {
    let (machine, frame) = timing_case(sizes)?;
    let mut cycles = 0;
    let mut failed = None;
    let time = seconds(sizes.repeats, || match Machine::timing(&machine, vec![frame.setup.clone()]) {
        Ok(mut machine) => {
            failed = machine.run(&|_, _| {}).err().map(RunError::from);
            cycles = machine.counters().cycles;
        }
        Err(error) => failed = Some(error),
    });
    match failed {
        Some(error) => Err(error.into()),
        None => Ok((cycles, time)),
    }
}
