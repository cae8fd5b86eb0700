//! The pipeline in SystemVerilog in an event-driven and in a compiled simulator, beside `Machine::cycle`.

use crate::rtl;
use cube3::machine::{Overflows, RunCounters};
use cube3_host::{BasePlane, DiscreteRay, FrameSetup};
use std::path::Path;
use std::process::Command;

/// A Verilog simulator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Simulator {
    /// Icarus Verilog.
    Icarus,
    /// Verilator.
    Verilator,
}

impl Simulator {
    /// The commands that compile and run a design.
    fn commands(self) -> &'static [&'static str] {
        match self {
            Simulator::Icarus => &["iverilog", "vvp"],
            Simulator::Verilator => &["verilator"],
        }
    }

    /// Whether the simulator is there: see [`rtl::require`].
    pub fn is_there(self) -> bool {
        self.commands().iter().all(|command| rtl::require(command).is_some())
    }
}

/// How a design is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// To start soon.
    Quick,
    /// To run fast.
    Fast,
}

/// The pipeline compiled for some parameters.
#[derive(Clone, Debug)]
pub struct Design {
    program: Vec<String>,
}

/// What a run of the pipeline wrote.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RtlRun {
    /// Pixels in the order in which they came: ray, and red, green, blue, opacity.
    pub pixels: Vec<(DiscreteRay, [u32; 4])>,
    /// Cycles of the frame.
    pub cycles: u64,
    /// Of each unit, cycles that it was busy, starved and blocked.
    pub accounts: Vec<[u64; 3]>,
    /// Of each channel, tokens held, summed over the cycles.
    pub occupancies: Vec<u64>,
    /// Words saturated in shading and in pixels.
    pub overflows: [u64; 2],
}

fn succeeded(command: &mut Command) {
    rtl::run(command).unwrap_or_else(|problem| panic!("{problem}"));
}

impl Design {
    /// Compiles the pipeline and its test bench into a folder.
    ///
    /// # Panics
    /// If the simulator does not take it.
    pub fn compile(simulator: Simulator, parameters: &[(&'static str, u32)], effort: Effort, folder: &Path) -> Design {
        let rtl = rtl::folder();
        let bench = rtl.join("tb/cube3_pipeline_tb.sv");
        std::fs::create_dir_all(folder).unwrap();
        let mut command = Command::new(simulator.commands()[0]);
        match simulator {
            Simulator::Icarus => {
                let program = folder.join("pipeline.vvp");
                command.args(["-g2012", "-s", "cube3_pipeline_tb", "-Y", ".sv", "-y"]).arg(&rtl);
                command.args(parameters.iter().map(|(name, value)| format!("-Pcube3_pipeline_tb.{name}={value}")));
                succeeded(command.arg("-o").arg(&program).arg(bench));
                Design { program: vec!["vvp".into(), "-n".into(), program.display().to_string()] }
            }
            Simulator::Verilator => {
                command.args([
                    "--binary",
                    "--timing",
                    "--top-module",
                    "cube3_pipeline_tb",
                    "-j",
                    "2",
                    "-Wno-WIDTH",
                    "-y",
                ]);
                command.arg(&rtl).args(parameters.iter().map(|(name, value)| format!("-G{name}={value}")));
                match effort {
                    Effort::Quick => {
                        command.args(["-CFLAGS", "-O0", "-MAKEFLAGS", "OPT_FAST=-O1 OPT_SLOW=-O0 OPT_GLOBAL=-O0"])
                    }
                    Effort::Fast => command.args(FAST),
                };
                succeeded(command.args(["-o", "pipeline", "--Mdir"]).arg(folder).arg(bench));
                Design { program: vec![folder.join("pipeline").display().to_string()] }
            }
        }
    }

    /// Runs the frame in a folder so many times in one process, and reads what the last run wrote; with `trace`, also each cycle's
    /// activity of the units: two bits each, the first unit in the low ones, 0 busy, 1 starved, 2 blocked.
    ///
    /// # Panics
    /// If the run fails or writes something else.
    pub fn run(&self, frame: &Path, repeat: u64, trace: bool) -> (RtlRun, Vec<u16>) {
        let (out, activity) = (frame.join("out.txt"), frame.join("activity.hex"));
        let mut command = Command::new(&self.program[0]);
        command.args(&self.program[1..]).arg(format!("+frame={}", frame.display()));
        command.arg(format!("+out={}", out.display())).arg(format!("+repeat={repeat}"));
        if trace {
            command.arg(format!("+activity={}", activity.display()));
        }
        succeeded(&mut command);
        let word = |line: &str| u16::from_str_radix(line, 16).unwrap();
        let activities =
            if trace { std::fs::read_to_string(activity).unwrap().lines().map(word).collect() } else { Vec::new() };
        (RtlRun::read(&std::fs::read_to_string(out).unwrap()), activities)
    }
}

/// The settings of Verilator for speed.
pub const FAST: [&str; 10] = [
    "-O3",
    "--x-assign",
    "fast",
    "--x-initial",
    "fast",
    "--noassert",
    "-CFLAGS",
    "-O3 -march=native",
    "-MAKEFLAGS",
    "OPT_FAST=-O3",
];

impl RtlRun {
    fn read(text: &str) -> RtlRun {
        let mut run =
            RtlRun { pixels: Vec::new(), cycles: 0, accounts: Vec::new(), occupancies: Vec::new(), overflows: [0; 2] };
        for line in text.lines() {
            let fields: Vec<&str> = line.split_whitespace().collect();
            let number = |i: usize| fields[i].parse::<u64>().unwrap_or_else(|_| panic!("{line}"));
            match fields[0] {
                "pixel" => {
                    let [u, v] = [1, 2].map(|i| fields[i].parse().unwrap_or_else(|_| panic!("{line}")));
                    let rgba =
                        [3, 4, 5, 6].map(|i| u32::from_str_radix(fields[i], 16).unwrap_or_else(|_| panic!("{line}")));
                    run.pixels.push((DiscreteRay { u, v }, rgba));
                }
                "cycles" => run.cycles = number(1),
                "account" => run.accounts.push([1, 2, 3].map(number)),
                "occupancy" => run.occupancies.push(number(1)),
                "overflows" => run.overflows = [number(1), number(2)],
                _ => panic!("{line}"),
            }
        }
        run
    }

    /// The base plane of the pixels.
    ///
    /// # Panics
    /// If a ray has two pixels, or one outside of the base plane.
    pub fn base_plane(&self, setup: &FrameSetup) -> BasePlane {
        let mut base = BasePlane::empty(&setup.geometry, setup.words.accumulator_bits);
        let mut seen = vec![false; base.pixels.len()];
        for (ray, rgba) in &self.pixels {
            let [column, row] = setup.geometry.pixel(*ray);
            assert!(column < base.width && row < base.height, "a pixel of ray {ray:?}, outside of the base plane");
            let place = row * base.width + column;
            assert!(!std::mem::replace(&mut seen[place], true), "two pixels of ray {ray:?}");
            base.pixels[place] = *rgba;
        }
        base
    }

    /// Every number and pixel of the run against those of `Machine::cycle`.
    ///
    /// # Panics
    /// At the first difference.
    pub fn assert_equals(&self, counters: &RunCounters, overflows: Overflows, base: &BasePlane, setup: &FrameSetup) {
        assert_eq!(self.base_plane(setup), *base, "base plane");
        assert_eq!(self.pixels.len() as u64, counters.host.pixels, "pixels");
        assert_eq!(self.cycles, counters.cycles, "cycles");
        let accounts: Vec<[u64; 3]> =
            counters.units.iter().map(|(_, account)| [account.busy, account.starved, account.blocked]).collect();
        assert_eq!(self.accounts, accounts, "busy, starved and blocked cycles of the units");
        let occupancies: Vec<u64> = counters.channels.iter().map(|channel| channel.counters.occupancy_cycles).collect();
        assert_eq!(self.occupancies, occupancies, "tokens held in the channels");
        assert_eq!(self.overflows, [overflows.shading, overflows.pixel], "saturated words");
    }
}
