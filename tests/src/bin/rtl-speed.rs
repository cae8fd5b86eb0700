//! The pipeline in SystemVerilog, compiled by Verilator for speed, and `Machine::cycle` on the same frame: cycles a second of each.
//!
//! `cargo run --release -p cube3-tests --bin rtl-speed [SIDE [SECONDS]]`, 16 voxels a side and half a second each in every round where they are
//! not given. Seconds are those of the processor. The two run in turns: what else the computer does slows now one and now the other, so the
//! best round of each is what is compared; the ratios of the rounds show how far that may be trusted.

use cube3_host::frame_setup;
use cube3_inputs as inputs;
use cube3_machine::MachineSpec;
use cube3_pipeline::Cycle;
use cube3_pipeline::Machine;
use cube3_scene::{Scene, View, VolumeSource};
use cube3_tests::rtl_pipeline::{Design, Effort, OurRun, RtlRun, Simulator};
use cube3_vectors::rtl_frame;
use cube3_volume::ReadOptions;
use std::path::Path;
use std::time::Duration;

/// Frames of our simulator between two looks at the clock.
const BATCH: u64 = 200;

/// Turns of the two.
const ROUNDS: usize = 9;

fn main() {
    let arguments: Vec<f64> = std::env::args().skip(1).filter_map(|text| text.parse().ok()).collect();
    let n = arguments.first().map_or(16, |side| *side as usize);
    let time = Duration::from_secs_f64(arguments.get(1).map_or(0.5, |seconds| seconds.clamp(0.1, 1e3)));
    if !Simulator::Verilator.is_there() {
        return;
    }
    let machine = MachineSpec { lanes: n, ..MachineSpec::default() };
    let volume = VolumeSource { size_voxels: Some(n), ..Scene::default().volume };
    let scene = Scene { volume, view: View::from_direction([0.55, 0.3, 1.0], None), ..Scene::default() };
    let loaded =
        inputs::load_volume(&scene, &machine, &ReadOptions::default(), false).unwrap_or_else(|error| panic!("{error}"));
    let words = &loaded.words.words;
    let setup = frame_setup(&scene, &machine, &loaded.info(), true).unwrap_or_else(|error| panic!("{error}")).setup;
    let frame = rtl_frame::export(&machine, &setup, words).unwrap_or_else(|error| panic!("{error}"));
    let folder = std::env::temp_dir().join(format!("cube3-rtl-speed-{}", std::process::id()));
    frame.write(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let design = Design::compile(Simulator::Verilator, &frame.parameters, Effort::Fast, &folder.join("design"));
    let build = || -> Machine<Cycle> {
        Machine::cycle(&machine, vec![setup.clone()], [n; 3], words).unwrap_or_else(|error| panic!("{error}"))
    };
    let rtl = design.run(&folder, 2);
    assert_eq!(rtl.difference(&OurRun::new(build()), &setup), None);
    println!("{n} voxels a side, {} cycles a frame; bits, cycles and counters are equal", rtl.cycles);
    let repeat = frames_in(&design, &folder, time);
    let mut rounds = Vec::new();
    for _ in 0..ROUNDS {
        let [alone, whole] = time_ours(build, time);
        rounds.push([time_rtl(&design, &folder, repeat), alone, whole]);
    }
    let best = [0, 1, 2].map(|which| rounds.iter().map(|round| round[which]).fold(0.0, f64::max));
    let mut ratios: Vec<f64> = rounds.iter().map(|[rtl, alone, _]| alone / rtl).collect();
    ratios.sort_by(f64::total_cmp);
    println!("Verilator:              {:>12.0} cycles/s", best[0]);
    println!("cube3, run alone:       {:>12.0} cycles/s, {:.1} times as fast", best[1], best[1] / best[0]);
    println!("cube3, with its set-up: {:>12.0} cycles/s, {:.1} times as fast", best[2], best[2] / best[0]);
    println!(
        "best of {ROUNDS} rounds; in one round run alone {:.1} to {:.1} times as fast, half of them {:.1} at least",
        ratios[0],
        ratios[ROUNDS - 1],
        ratios[ROUNDS / 2]
    );
    let _ = std::fs::remove_dir_all(&folder);
}

/// Processor time of this process and of those that it has waited for, which others on the machine do not change.
fn processor_time() -> Duration {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_else(|error| panic!("/proc/self/stat: {error}"));
    // Behind the name in brackets: state, 10 numbers, then user and system time of the process and of its children, in 1/100 s.
    let fields = text.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11).take(4);
    Duration::from_millis(10 * fields.filter_map(|field| field.parse::<u64>().ok()).sum::<u64>())
}

/// How often Verilator's design renders the frame in so long.
fn frames_in(design: &Design, folder: &Path, time: Duration) -> u64 {
    let mut repeat = 100;
    loop {
        let start = processor_time();
        design.run(folder, repeat);
        let running = (processor_time() - start).as_secs_f64();
        if running >= time.as_secs_f64() {
            return repeat;
        }
        repeat = (time.as_secs_f64() * 1.2 / running.max(1e-3) * repeat as f64) as u64 + 1;
    }
}

/// Cycles a second of Verilator's design, without the start of its process.
fn time_rtl(design: &Design, folder: &Path, repeat: u64) -> f64 {
    let timed = |repeat: u64| {
        let start = processor_time();
        let run: RtlRun = design.run(folder, repeat);
        (run.cycles, processor_time() - start)
    };
    let (_, start) = timed(1);
    let (cycles, all) = timed(repeat);
    (cycles * (repeat - 1)) as f64 / all.saturating_sub(start).as_secs_f64()
}

/// Cycles a second of our simulator: of its runs alone, and with the building of each machine.
fn time_ours(build: impl Fn() -> Machine<Cycle>, time: Duration) -> [f64; 2] {
    let batch = |runs: bool| {
        let (mut cycles, start) = (0, processor_time());
        for _ in 0..BATCH {
            let mut machine = build();
            if runs {
                machine.run(&|_, _| {}).unwrap_or_else(|error| panic!("{error}"));
            }
            cycles += machine.now();
        }
        (cycles, processor_time() - start)
    };
    let (mut cycles, mut whole, mut building) = (0, Duration::ZERO, Duration::ZERO);
    while whole < time {
        let (ran, spent) = batch(true);
        cycles += ran;
        whole += spent;
        building += batch(false).1;
    }
    [whole - building, whole].map(|elapsed| cycles as f64 / elapsed.as_secs_f64())
}
