//! The pipeline in SystemVerilog has the bits and the cycles of `Machine::cycle`, in two simulators.

use cube3::inputs;
use cube3::machine::Machine;
use cube3::rtl_frame::{self, RtlFrameError};
use cube3_host::{
    Abc, Boards, ChannelSize, Channels, Cone, ConeKind, FrameSetup, GradientMethod, MachineSpec, RaySlots, Rays,
    ShadingUnit, VolumeInfo, frame_setup,
};
use cube3_scene::{Crop, DepthCue, Light, Material, Mode, Perspective, Scene, View, VolumeSource};
use cube3_tests::SmallVolume;
use cube3_tests::rtl_pipeline::{Design, Effort, Simulator};
use cube3_volume::ReadOptions;
use cube3_word::{Rounding, Words};
use std::path::Path;

/// Along an axis, tilted in u alone, in both, at 45° in both, and along other axes against their direction.
const DIRECTIONS: [[f64; 3]; 7] = [
    [0.0, 0.0, 1.0],
    [0.4, 0.0, 1.0],
    [0.55, 0.3, 1.0],
    [1.0, 1.0, 1.0],
    [-0.9, 0.35, -0.6],
    [0.2, -1.0, 0.7],
    [-1.0, 0.0, 0.0],
];

const MODES: [Mode; 3] = [Mode::Composite, Mode::Maximum, Mode::FirstOpaque];
const OTHER_MODES: [Mode; 3] = [Mode::Minimum, Mode::LastOpaque, Mode::WeightedSum];

/// Words that lose bits everywhere, truncated.
fn narrow() -> Words {
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

fn machine(n: usize, gradient: GradientMethod, words: Words) -> MachineSpec {
    let power_bits = 10.min(words.normal_bits - 1);
    MachineSpec { lanes: n, words, abc: Abc { gradient, power_bits, ..Abc::default() }, ..MachineSpec::default() }
}

/// Random words.
fn noise(n: usize, words: &Words) -> SmallVolume {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 48) as u16 >> (16 - words.voxel_bits)
    };
    SmallVolume { dims: [n; 3], spacing: [1.0; 3], words: (0..n * n * n).map(|_| next()).collect() }
}

fn phantom(n: usize, machine: &MachineSpec) -> (SmallVolume, VolumeInfo) {
    let volume = VolumeSource { size_voxels: Some(n), ..Scene::default().volume };
    let scene = Scene { volume, ..Scene::default() };
    let loaded = inputs::volume(&scene, machine, &ReadOptions::default(), false).unwrap();
    let info = loaded.info();
    (SmallVolume { dims: info.dims, spacing: info.spacing, words: loaded.words.words }, info)
}

fn scene(direction: [f64; 3], mode: Mode) -> Scene {
    Scene { mode, view: View::from_direction(direction, None), ..Scene::default() }
}

/// A scene with two lights, one of them from the side, on a one-sided shiny surface, half transparent.
fn lit(direction: [f64; 3], mode: Mode) -> Scene {
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

/// A frame on one machine, as our simulator and a compiled design run it.
struct Case<'a> {
    name: String,
    machine: &'a MachineSpec,
    setup: FrameSetup,
    volume: &'a SmallVolume,
}

impl<'a> Case<'a> {
    fn new(
        scene: &Scene,
        machine: &'a MachineSpec,
        volume: &'a SmallVolume,
        info: &VolumeInfo,
        plan: bool,
    ) -> Case<'a> {
        let setup = frame_setup(scene, machine, info, plan).unwrap().setup;
        Case { name: format!("{:?} {:?}", scene.mode, scene.view.direction), machine, setup, volume }
    }

    fn run(&self) -> Machine<cube3::fidelity::Cycle> {
        Machine::cycle(self.machine, vec![self.setup.clone()], self.volume.dims, &self.volume.words).unwrap()
    }

    /// What each unit does in each cycle, two bits a unit.
    fn activities(&self) -> Vec<u16> {
        let mut run = self.run();
        let mut activities = Vec::new();
        let mut done = false;
        while !done {
            let before = run.accounts().map(|account| *account);
            done = run.run_until(run.now() + 1, &|_, _| {}).unwrap();
            let codes = run.accounts().into_iter().zip(before).map(|(account, before)| account.since(&before).code());
            activities.push(codes.enumerate().map(|(i, code)| u16::from(code) << (2 * i)).sum());
            if run.now() < activities.len() as u64 {
                activities.pop();
            }
        }
        activities
    }

    fn check(&self, simulator: Simulator, design: &Design, folder: &Path) {
        let frame = rtl_frame::export(self.machine, &self.setup, &self.volume.words).unwrap();
        frame.write(folder).unwrap();
        let mut run = self.run();
        run.run(&|_, _| {}).unwrap();
        let (counters, overflows) = (run.counters(), run.overflows());
        let base = run.into_base_planes().remove(0);
        let (rtl, activities) = design.run(folder, 1, true);
        println!("{simulator:?}: {}: {} cycles, {} pixels", self.name, rtl.cycles, rtl.pixels.len());
        rtl.assert_equals(&counters, overflows, &base, &self.setup);
        assert_eq!(activities, self.activities(), "{}", self.name);
    }
}

/// Runs cases of the same parameters in one compiled design.
fn check(simulator: Simulator, cases: &[Case<'_>]) {
    if !simulator.is_there() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let parameters =
        |case: &Case<'_>| rtl_frame::export(case.machine, &case.setup, &case.volume.words).unwrap().parameters;
    let first = parameters(&cases[0]);
    let design = Design::compile(simulator, &first, Effort::Quick, &folder.path().join("design"));
    for (i, case) in cases.iter().enumerate() {
        assert_eq!(parameters(case), first, "{}", case.name);
        case.check(simulator, &design, &folder.path().join(format!("frame{i}")));
    }
}

/// Views and modes on noise and a phantom: every view in one mode, every mode in one view at least.
fn frames<'a>(
    machine: &'a MachineSpec,
    noise: &'a SmallVolume,
    phantom: &'a (SmallVolume, VolumeInfo),
    thorough: bool,
) -> Vec<Case<'a>> {
    let mut cases = Vec::new();
    for (i, &direction) in DIRECTIONS.iter().enumerate() {
        let (phantom, info) = phantom;
        for (j, &mode) in MODES.iter().enumerate() {
            if thorough || i % MODES.len() == j {
                cases.push(Case::new(&scene(direction, mode), machine, phantom, info, true));
                cases.push(Case::new(&lit(direction, mode), machine, noise, &noise.info(), false));
            }
        }
        let other = OTHER_MODES[i % OTHER_MODES.len()];
        cases.push(Case::new(&lit(direction, other), machine, noise, &noise.info(), i % 2 == 0));
    }
    cases
}

fn compare(simulator: Simulator, n: usize, gradient: GradientMethod, words: Words, thorough: bool) {
    let machine = machine(n, gradient, words);
    let (noise, phantom) = (noise(n, &words), phantom(n, &machine));
    check(simulator, &frames(&machine, &noise, &phantom, thorough));
}

#[test]
fn eight_lanes_in_icarus() {
    compare(Simulator::Icarus, 8, GradientMethod::Twelve, Words::default(), false);
    compare(Simulator::Icarus, 8, GradientMethod::Six, narrow(), false);
}

#[test]
fn eight_lanes_in_verilator() {
    compare(Simulator::Verilator, 8, GradientMethod::Twelve, Words::default(), true);
}
