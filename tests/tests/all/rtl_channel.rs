//! The RTL channel is the model's channel, cycle by cycle, under random stalls on both sides.

use cube3_channel::Channel;
use cube3_tests::rtl;
use cube3_tests::thorough::thorough;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use rayon::prelude::*;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// What is wished for in a cycle.
#[derive(Clone, Copy, Debug)]
struct Cycle {
    push: bool,
    data: u16,
    pop: bool,
}

/// Cycles with each pair of densities.
const CYCLES: usize = 3000;
/// How often of 100 cycles a push and a pop are wished for: rarely, often, and all the time, on either side.
const DENSITIES: [[u32; 2]; 6] = [[50, 50], [100, 100], [90, 20], [20, 90], [100, 30], [10, 10]];

/// Capacity and latency: the smallest, a full rate, too few credits for one, and no power of two.
const SIZES: [(usize, u64); 4] = [(1, 1), (3, 2), (4, 6), (7, 5)];

fn wishes(seed: u64) -> Vec<Cycle> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut wish = |density: u32| random.next_u32() % 100 < density;
    let mut cycles: Vec<Cycle> = DENSITIES
        .iter()
        .flat_map(|&[push, pop]| (0..CYCLES).map(move |_| [push, pop]))
        .map(|[push, pop]| Cycle { push: wish(push), data: 0, pop: wish(pop) })
        .collect();
    // Neighbouring tokens differ.
    cycles.iter_mut().zip(1_u16..).for_each(|(cycle, number)| cycle.data = number.wrapping_mul(0x9e37));
    cycles
}

/// What the model shows before each clock edge, in the test bench's form: can_push valid front occupancy.
fn model(capacity: usize, latency: u64, cycles: &[Cycle]) -> Vec<String> {
    let mut channel = Channel::new("model", capacity, latency).unwrap();
    let mut step = |cycle: &Cycle| {
        let (can_push, front) = (channel.can_push(), channel.front().copied());
        let shown = format!(
            "{} {} {:04x} {:02x}",
            u8::from(can_push),
            u8::from(front.is_some()),
            front.unwrap_or(0),
            channel.occupancy()
        );
        if cycle.pop {
            channel.pop();
        }
        if cycle.push {
            assert_eq!(channel.push(cycle.data).is_ok(), can_push);
        }
        channel.commit();
        shown
    };
    cycles.iter().map(&mut step).collect()
}

fn write_stimulus(file: &Path, cycles: &[Cycle]) {
    let mut text = String::new();
    for Cycle { push, data, pop } in cycles {
        writeln!(text, "{} {data:x} {}", u8::from(*push), u8::from(*pop)).unwrap();
    }
    std::fs::write(file, text).unwrap();
}

/// Compares what a simulator wrote, line by line.
fn assert_same(simulator: &str, capacity: usize, latency: u64, written: &str, cycles: &[Cycle]) {
    let form =
        |line: &&str| line.split(' ').count() == 4 && line.chars().all(|c| c == ' ' || c.is_ascii_alphanumeric());
    let shown: Vec<&str> = written.lines().filter(form).collect();
    let expected = model(capacity, latency, cycles);
    let place = format!("{simulator}, capacity {capacity}, latency {latency}");
    let first = shown.iter().zip(&expected).position(|(shown, expected)| shown != expected);
    if let Some(cycle) = first {
        panic!("{place}: cycle {cycle} shows {}, not {}", shown[cycle], expected[cycle]);
    }
    assert_eq!(shown.len(), expected.len(), "{place}: {written}");
}

#[test]
fn the_channel_in_icarus_is_the_models() {
    let (Some(iverilog), Some(vvp)) = (rtl::require("iverilog"), rtl::require("vvp")) else { return };
    let folder = tempfile::tempdir().unwrap();
    let sizes = match thorough("sizes of the channel in Icarus but four") {
        true => (1..=8).flat_map(|capacity| (1..=6).map(move |latency| (capacity, latency))).collect(),
        false => SIZES.to_vec(),
    };
    sizes.par_iter().for_each(|&(capacity, latency)| {
        let cycles = wishes(8 * latency + capacity as u64);
        let [bench, stimulus] =
            ["bench", "stimulus"].map(|kind| folder.path().join(format!("{kind}.{capacity}.{latency}")));
        write_stimulus(&stimulus, &cycles);
        let mut compile = Command::new(&iverilog);
        compile.current_dir(rtl::folder()).args(["-g2012", "-Wall", "-y.", "-Y.sv", "-o"]).arg(&bench);
        for (name, value) in [("CAPACITY", capacity), ("LATENCY", latency as usize), ("CYCLES", cycles.len())] {
            compile.arg(format!("-Pchannel_tb.{name}={value}"));
        }
        assert_eq!(rtl::run(compile.arg("tb/channel_tb.sv")).unwrap(), "");
        let written = rtl::run(Command::new(&vvp).arg(&bench).arg(format!("+in={}", stimulus.display()))).unwrap();
        assert_same("Icarus", capacity, latency, &written, &cycles);
    });
}

/// A compiled bench takes seconds for each size.
#[test]
fn the_channel_in_verilator_is_the_models() {
    let Some(verilator) = rtl::require("verilator") else { return };
    if !thorough("the channel in Verilator") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (capacity, latency) in SIZES {
        let cycles = wishes(100 + capacity as u64);
        let built = folder.path().join(format!("{capacity}.{latency}"));
        let stimulus = folder.path().join("stimulus");
        write_stimulus(&stimulus, &cycles);
        let mut compile = rtl::verilator_program(&verilator);
        compile.current_dir(rtl::folder()).args(rtl::MADE_SOON);
        compile.args(["-Wno-fatal", "-y", ".", "--top-module", "channel_tb"]);
        for (name, value) in [("CAPACITY", capacity), ("LATENCY", latency as usize), ("CYCLES", cycles.len())] {
            compile.arg(format!("-G{name}={value}"));
        }
        rtl::run(compile.arg("--Mdir").arg(&built).arg("tb/channel_tb.sv")).unwrap();
        let bench = built.join("Vchannel_tb");
        let written = rtl::run(Command::new(&bench).arg(format!("+in={}", stimulus.display()))).unwrap();
        assert_same("Verilator", capacity, latency, &written, &cycles);
    }
}

/// A channel of another size shows something else: the comparison can fail.
#[test]
fn channels_of_two_sizes_differ() {
    let cycles = wishes(1);
    assert_ne!(model(4, 2, &cycles), model(4, 3, &cycles));
    assert_ne!(model(4, 2, &cycles), model(5, 2, &cycles));
}
