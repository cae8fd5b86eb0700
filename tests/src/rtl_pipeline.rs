//! The pipeline in SystemVerilog in an event-driven and in a compiled simulator, beside `Machine::cycle`.

use crate::{SmallVolume, rtl};
use cube3_frame::Overflows;
use cube3_frame::{BasePlane, DiscreteRay, FrameSetup};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_inputs as inputs;
use cube3_machine::{Abc, GradientMethod, MachineSpec};
use cube3_pipeline::Cycle;
use cube3_pipeline::{Machine, RunCounters};
use cube3_scene::{Light, Material, Mode, Scene, View, VolumeSource};
use cube3_vectors::rtl_frame;
use cube3_volume::ReadOptions;
use cube3_word::{Rounding, Words};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use std::path::{Path, PathBuf};
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
    /// Where its runs write.
    folder: PathBuf,
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

/// What a run leaves in its files: the test bench says what is in them.
struct Written {
    out: String,
    activity: String,
}

impl Written {
    /// The run, and the activities of its cycles.
    fn read(&self) -> Result<(RtlRun, Vec<u16>), String> {
        let word = |line: &str| u16::from_str_radix(line, 16).map_err(|_| format!("an activity of {line}"));
        Ok((RtlRun::read(&self.out)?, self.activity.lines().map(word).collect::<Result<_, _>>()?))
    }
}

impl Design {
    /// Compiles the pipeline and its test bench into a folder.
    ///
    /// # Panics
    /// If the simulator does not take it.
    pub fn compile(simulator: Simulator, parameters: &[(&'static str, u32)], effort: Effort, folder: &Path) -> Design {
        Design::of(&rtl::folder(), simulator, parameters, effort, folder).unwrap_or_else(|problem| panic!("{problem}"))
    }

    /// Compiles the pipeline of a folder of modules and its test bench into another.
    ///
    /// # Errors
    /// What the simulator does not take.
    pub fn of(
        modules: &Path,
        simulator: Simulator,
        parameters: &[(&'static str, u32)],
        effort: Effort,
        folder: &Path,
    ) -> Result<Design, String> {
        let bench = rtl::folder().join("tb/cube3_pipeline_tb.sv");
        std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        let mut command = match simulator {
            Simulator::Icarus => Command::new("iverilog"),
            Simulator::Verilator => rtl::verilator_program(Path::new("verilator")),
        };
        let program = match simulator {
            Simulator::Icarus => {
                let program = folder.join("pipeline.vvp");
                command.args(["-g2012", "-s", "cube3_pipeline_tb", "-Y", ".sv", "-y"]).arg(modules);
                command.args(parameters.iter().map(|(name, value)| format!("-Pcube3_pipeline_tb.{name}={value}")));
                command.arg("-o").arg(&program).arg(bench);
                vec!["vvp".into(), "-n".into(), program.display().to_string()]
            }
            Simulator::Verilator => {
                command.args(["--top-module", "cube3_pipeline_tb", "-j", "2", "-Wno-WIDTH", "-y"]);
                command.arg(modules).args(parameters.iter().map(|(name, value)| format!("-G{name}={value}")));
                match effort {
                    Effort::Quick => command.args(rtl::MADE_SOON),
                    Effort::Fast => command.args(FAST),
                };
                command.args(["-o", "pipeline", "--Mdir"]).arg(folder).arg(bench);
                vec![folder.join("pipeline").display().to_string()]
            }
        };
        rtl::run(&mut command)?;
        Ok(Design { program, folder: folder.to_owned() })
    }

    /// Runs a frame so many times in one process, and gives what the last run wrote; `limit` is the most cycles that a frame may take.
    fn written(&self, frame: &Path, repeat: u64, limit: Option<u64>, trace: bool) -> Result<Written, String> {
        let (out, activity) = (self.folder.join("out.txt"), self.folder.join("activity.hex"));
        let mut command = Command::new(&self.program[0]);
        command.args(&self.program[1..]).arg(format!("+frame={}", frame.display()));
        command.arg(format!("+out={}", out.display())).arg(format!("+repeat={repeat}"));
        command.args(limit.map(|limit| format!("+limit={limit}")));
        if trace {
            command.arg(format!("+activity={}", activity.display()));
        }
        rtl::run(&mut command)?;
        let text = |path: &Path| std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()));
        Ok(Written { out: text(&out)?, activity: if trace { text(&activity)? } else { String::new() } })
    }

    /// Runs the frame of a folder so many times in one process, and reads what the last run wrote.
    ///
    /// # Panics
    /// If the run fails or writes something else.
    pub fn run(&self, frame: &Path, repeat: u64) -> RtlRun {
        let run = self.written(frame, repeat, None, false).and_then(|written| written.read());
        run.unwrap_or_else(|problem| panic!("{problem}")).0
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
    /// Reads what the test bench wrote; a number that is unknown is none.
    fn read(text: &str) -> Result<RtlRun, String> {
        let mut run =
            RtlRun { pixels: Vec::new(), cycles: 0, accounts: Vec::new(), occupancies: Vec::new(), overflows: [0; 2] };
        for line in text.lines() {
            let fields: Vec<&str> = line.split_whitespace().collect();
            let not = || format!("the line \"{line}\"");
            let [kind, numbers @ ..] = fields.as_slice() else { return Err(not()) };
            let decimal = |i: usize| numbers.get(i).and_then(|text| text.parse::<i64>().ok()).ok_or_else(not);
            let count = |i: usize| decimal(i).and_then(|number| u64::try_from(number).map_err(|_| not()));
            let word = |i: usize| numbers.get(i).and_then(|text| u32::from_str_radix(text, 16).ok()).ok_or_else(not);
            match *kind {
                "pixel" => {
                    let ray = DiscreteRay { u: decimal(0)?, v: decimal(1)? };
                    run.pixels.push((ray, [word(2)?, word(3)?, word(4)?, word(5)?]));
                }
                "cycles" => run.cycles = count(0)?,
                "account" => run.accounts.push([count(0)?, count(1)?, count(2)?]),
                "occupancy" => run.occupancies.push(count(0)?),
                "overflows" => run.overflows = [count(0)?, count(1)?],
                _ => return Err(not()),
            }
        }
        Ok(run)
    }

    /// The base plane of the pixels.
    ///
    /// # Errors
    /// A ray that has two pixels, or one outside of the base plane.
    fn base_plane(&self, setup: &FrameSetup) -> Result<BasePlane, String> {
        let mut base = BasePlane::empty(&setup.geometry, setup.words.accumulator_bits);
        let mut seen = vec![false; base.pixels.len()];
        for (ray, rgba) in &self.pixels {
            let [column, row] = setup.geometry.pixel(*ray);
            if column >= base.width || row >= base.height {
                return Err(format!("a pixel of ray {ray:?}, outside of the base plane"));
            }
            let place = row * base.width + column;
            if std::mem::replace(&mut seen[place], true) {
                return Err(format!("two pixels of ray {ray:?}"));
            }
            base.pixels[place] = *rgba;
        }
        Ok(base)
    }

    /// The first number or pixel of the run that differs from those of `Machine::cycle`, if there is one.
    pub fn difference(&self, ours: &OurRun, setup: &FrameSetup) -> Option<String> {
        let base = match self.base_plane(setup) {
            Ok(base) => base,
            Err(problem) => return Some(problem),
        };
        let (counters, overflows) = (&ours.counters, ours.overflows);
        let accounts: Vec<[u64; 3]> =
            counters.units.iter().map(|(_, account)| [account.busy, account.starved, account.blocked]).collect();
        let occupancies: Vec<u64> = counters.channels.iter().map(|channel| channel.counters.occupancy_cycles).collect();
        let pair = |what: &str, rtl: &dyn std::fmt::Debug, ours: &dyn std::fmt::Debug| {
            let (rtl, ours) = (format!("{rtl:?}"), format!("{ours:?}"));
            (rtl != ours).then(|| format!("{what}: {rtl}, and by Machine::cycle {ours}"))
        };
        let pixel = || {
            let place = (0..base.pixels.len()).find(|&i| base.pixels[i] != ours.base.pixels[i])?;
            let ([column, row], rtl) = ([place % base.width, place / base.width], base.pixels[place]);
            pair(&format!("pixel {column}, {row} of the base plane"), &rtl, &ours.base.pixels[place])
        };
        pixel()
            .or_else(|| pair("pixels", &(self.pixels.len() as u64), &counters.host.pixels))
            .or_else(|| pair("cycles", &self.cycles, &counters.cycles))
            .or_else(|| pair("busy, starved and blocked cycles of the units", &self.accounts, &accounts))
            .or_else(|| pair("tokens held in the channels", &self.occupancies, &occupancies))
            .or_else(|| pair("saturated words", &self.overflows, &[overflows.shading, overflows.pixel]))
    }
}

/// What our simulator does in a frame.
#[derive(Clone, Debug)]
pub struct OurRun {
    /// Counters of units, channels and host.
    pub counters: RunCounters,
    /// Words saturated.
    pub overflows: Overflows,
    /// The picture.
    pub base: BasePlane,
}

impl OurRun {
    /// Runs a machine of one frame to its end.
    ///
    /// # Panics
    /// If it cannot.
    pub fn new(mut machine: Machine<Cycle>) -> OurRun {
        machine.run(&|_, _| {}).unwrap_or_else(|error| panic!("{error}"));
        let (counters, overflows) = (machine.counters(), machine.overflows());
        OurRun { counters, overflows, base: machine.into_base_planes().remove(0) }
    }
}

/// A frame on one machine, as our simulator and a compiled design run it.
#[derive(Clone, Debug)]
pub struct Case<'a> {
    /// Mode and view.
    pub name: String,
    machine: &'a MachineSpec,
    setup: FrameSetup,
    volume: &'a SmallVolume,
}

impl<'a> Case<'a> {
    /// A scene's frame, with a plan or without one.
    ///
    /// # Panics
    /// Where the machine does not render the scene.
    pub fn new(
        scene: &Scene,
        machine: &'a MachineSpec,
        volume: &'a SmallVolume,
        info: &VolumeInfo,
        plan: bool,
    ) -> Case<'a> {
        let setup = frame_setup(scene, machine, info, plan).unwrap_or_else(|error| panic!("{error}")).setup;
        Case { name: format!("{:?} {:?}", scene.mode, scene.view.direction), machine, setup, volume }
    }

    fn machine(&self) -> Machine<Cycle> {
        Machine::cycle(self.machine, vec![self.setup.clone()], self.volume.dims, &self.volume.words)
            .unwrap_or_else(|error| panic!("{error}"))
    }

    /// What each unit does in each cycle, two bits a unit, the first in the low ones: 0 busy, 1 starved, 2 blocked.
    fn activities(&self) -> Vec<u16> {
        let mut run = self.machine();
        let mut activities = Vec::new();
        let mut done = false;
        while !done {
            let before = run.accounts().map(|account| *account);
            done = run.run_until(run.now() + 1, &|_, _| {}).unwrap_or_else(|error| panic!("{error}"));
            let codes = run.accounts().into_iter().zip(before).map(|(account, before)| account.since(&before).code());
            activities.push(codes.enumerate().map(|(i, code)| u16::from(code) << (2 * i)).sum());
            if run.now() < activities.len() as u64 {
                activities.pop();
            }
        }
        activities
    }

    /// Writes the frame into a folder, and lets our simulator run it.
    ///
    /// # Panics
    /// Where it cannot, and where the picture is empty: that would prove nothing.
    pub fn prepare(&self, folder: &Path) -> PreparedFrame {
        let frame = rtl_frame::export(self.machine, &self.setup, &self.volume.words)
            .unwrap_or_else(|error| panic!("{}: {error}", self.name));
        frame.write(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        let ours = OurRun::new(self.machine());
        assert!(ours.base.pixels.iter().any(|pixel| pixel[3] > 0), "{}: an empty picture proves nothing", self.name);
        PreparedFrame {
            name: self.name.clone(),
            parameters: frame.parameters,
            folder: folder.to_owned(),
            setup: self.setup.clone(),
            ours,
            activities: self.activities(),
        }
    }
}

/// A frame as files, and what our simulator does in it.
#[derive(Clone, Debug)]
pub struct PreparedFrame {
    /// Mode and view.
    pub name: String,
    /// Parameters of the design that runs it.
    pub parameters: Vec<(&'static str, u32)>,
    folder: PathBuf,
    setup: FrameSetup,
    ours: OurRun,
    activities: Vec<u16>,
}

/// Cycles that a frame may take longer than ours before it is given up.
const PATIENCE: u64 = 16;

impl PreparedFrame {
    /// Cycles of the frame.
    pub fn cycles(&self) -> u64 {
        self.ours.counters.cycles
    }

    /// Runs a compiled design: the first thing that it does otherwise than our simulator, if there is one, in pixels, counters, or what
    /// each unit does in each cycle.
    ///
    /// # Errors
    /// A simulation that cannot be run.
    pub fn difference(&self, design: &Design) -> Result<Option<String>, String> {
        let written = design.written(&self.folder, 1, Some(self.cycles() + PATIENCE), true)?;
        let (run, activities) = match written.read() {
            Ok(read) => read,
            Err(problem) => return Ok(Some(problem)),
        };
        let activity = || {
            let cycle = (0..activities.len().max(self.activities.len()))
                .find(|&cycle| activities.get(cycle) != self.activities.get(cycle))?;
            let [rtl, ours] = [&activities, &self.activities].map(|of| of.get(cycle).map(|code| format!("{code:04x}")));
            Some(format!("cycle {cycle}: the units do {rtl:?}, and by Machine::cycle {ours:?}"))
        };
        Ok(run.difference(&self.ours, &self.setup).or_else(activity))
    }
}

/// Words that lose bits everywhere, truncated.
pub fn narrow() -> Words {
    Words {
        voxel_bits: 8,
        weight_bits: 4,
        sample_fraction_bits: 2,
        gradient_bits: 7,
        normal_bits: 8,
        table_bits: 6,
        table_gradient_bits: 4,
        colour_bits: 6,
        opacity_bits: 5,
        accumulator_bits: 9,
        rounding: Rounding::Truncate,
    }
}

/// The default machine with so many lanes, in some words.
pub fn machine(n: usize, gradient: GradientMethod, words: Words) -> MachineSpec {
    let power_bits = 10.min(words.normal_bits - 1);
    MachineSpec { lanes: n, words, abc: Abc { gradient, power_bits, ..Abc::default() }, ..MachineSpec::default() }
}

/// A cube of random words.
pub fn noise(n: usize, words: &Words) -> SmallVolume {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let words = (0..n * n * n).map(|_| (random.next_u32() >> (32 - words.voxel_bits)) as u16).collect();
    SmallVolume { dims: [n; 3], spacing: [1.0; 3], words }
}

/// The default phantom as a cube.
///
/// # Panics
/// Where it cannot be made.
pub fn phantom(n: usize, machine: &MachineSpec) -> (SmallVolume, VolumeInfo) {
    let volume = VolumeSource { size_voxels: Some(n), ..Scene::default().volume };
    let scene = Scene { volume, ..Scene::default() };
    let loaded =
        inputs::load_volume(&scene, machine, &ReadOptions::default(), false).unwrap_or_else(|error| panic!("{error}"));
    let info = loaded.info();
    (SmallVolume { dims: info.dims, spacing: info.spacing, words: loaded.words.words }, info)
}

/// The default scene from a direction.
pub fn scene(direction: [f64; 3], mode: Mode) -> Scene {
    Scene { mode, view: View::from_direction(direction, None), ..Scene::default() }
}

/// A scene with two lights, one of them from the side, on a one-sided shiny surface, half transparent.
pub fn lit(direction: [f64; 3], mode: Mode) -> Scene {
    let lights = vec![
        Light { direction: None, colour: [0.5, 0.9, 0.2] },
        Light { direction: Some([0.7, -0.2, 0.4]), colour: [1.0, 0.4, 0.8] },
    ];
    let material =
        Material { shaded: true, ambient: 0.3, diffuse: 0.9, specular: 1.2, shininess: 7.0, two_sided: false };
    let mut scene = Scene { lights, material, ..scene(direction, mode) };
    scene.transfer.opacity = vec![[0.0, 0.0], [40.0, 0.1], [200.0, 0.6]];
    scene
}
