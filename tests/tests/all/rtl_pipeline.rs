//! The pipeline in SystemVerilog has the bits and the cycles of `Machine::cycle`, in two simulators.

use cube3_host::{VolumeInfo, frame_setup, picture_setup};
use cube3_machine::{
    Abc, Boards, ChannelSize, Channels, Cone, ConeKind, GradientMethod, MachineSpec, RaySlots, Rays, ShadingUnit,
};
use cube3_scene::{Crop, DepthCue, Layer, Light, Mode, Perspective, Scene, Threshold, View};
use cube3_tests::SmallVolume;
use cube3_tests::rtl::{self, Parameters};
use cube3_tests::rtl_pipeline::{
    Case, Design, Effort, PreparedFrame, Simulator, lit, machine, narrow, noise, phantom, scene,
};
use cube3_tests::thorough::thorough;
use cube3_vectors::rtl_frame::{self, RtlFrameError};
use cube3_word::Words;
use std::process::Command;

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
/// What a quick run leaves out.
const OTHERS: &str = "RTL pipelines but one in Icarus and one in Verilator";

const OTHER_MODES: [Mode; 3] = [Mode::Minimum, Mode::LastOpaque, Mode::WeightedSum];

/// Runs cases of the same parameters in one compiled design.
fn check(simulator: Simulator, cases: &[Case<'_>]) {
    if !simulator.is_there() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let prepare = |(i, case): (usize, &Case<'_>)| case.prepare(&folder.path().join(format!("frame{i}")));
    let frames: Vec<PreparedFrame> = cases.iter().enumerate().map(prepare).collect();
    let first = &frames[0].parameters;
    let design = Design::compile(simulator, first, Effort::Quick, &folder.path().join("design"));
    for frame in &frames {
        assert_eq!(frame.parameters, *first, "{}", frame.name);
        println!("{simulator:?}: {}: {} cycles", frame.name, frame.cycles());
        assert_eq!(frame.difference(&design), Ok(None), "{}", frame.name);
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
    compare(Simulator::Icarus, 8, GradientMethod::Six, narrow(), false);
    if thorough(OTHERS) {
        compare(Simulator::Icarus, 8, GradientMethod::Twelve, Words::default(), false);
    }
}

#[test]
fn sixteen_lanes_in_icarus() {
    if !thorough(OTHERS) {
        return;
    }
    let machine = machine(16, GradientMethod::Twelve, Words::default());
    let (phantom, info) = phantom(16, &machine);
    check(Simulator::Icarus, &[Case::new(&lit([0.55, 0.3, 1.0], Mode::Composite), &machine, &phantom, &info, true)]);
}

#[test]
fn eight_lanes_in_verilator() {
    if !thorough(OTHERS) {
        return;
    }
    compare(Simulator::Verilator, 8, GradientMethod::Twelve, Words::default(), true);
}

#[test]
fn eight_lanes_of_narrow_words_in_verilator() {
    if !thorough(OTHERS) {
        return;
    }
    compare(Simulator::Verilator, 8, GradientMethod::Six, narrow(), true);
}

#[test]
fn other_gradients_in_verilator() {
    if !thorough(OTHERS) {
        return;
    }
    compare(Simulator::Verilator, 8, GradientMethod::TwentySixSheared, Words::default(), false);
    compare(Simulator::Verilator, 4, GradientMethod::Ten, narrow(), false);
}

#[test]
fn sixteen_lanes_in_verilator() {
    compare(
        Simulator::Verilator,
        16,
        GradientMethod::Twelve,
        Words::default(),
        thorough("views in other modes in Verilator"),
    );
}

#[test]
fn sixteen_lanes_of_narrow_words_in_verilator() {
    if !thorough(OTHERS) {
        return;
    }
    compare(Simulator::Verilator, 16, GradientMethod::Six, narrow(), false);
}

#[test]
fn slots_that_are_not_shared_in_verilator() {
    if !thorough(OTHERS) {
        return;
    }
    let rays = Rays { slots: RaySlots::Padded, ..Rays::default() };
    let machine = MachineSpec { rays, ..machine(8, GradientMethod::Twelve, Words::default()) };
    let (noise, phantom) = (noise(8, &machine.words), phantom(8, &machine));
    check(Simulator::Verilator, &frames(&machine, &noise, &phantom, false));
}

/// Labels are other registers, and nothing else.
#[test]
fn labels_in_both_simulators() {
    if !thorough(OTHERS) {
        return;
    }
    for (simulator, words) in [(Simulator::Icarus, Words::default()), (Simulator::Verilator, narrow())] {
        let machine = machine(8, GradientMethod::Twelve, words);
        let noise = noise(8, &words);
        let modes = MODES.iter().chain(&OTHER_MODES).cycle();
        let cases: Vec<Case<'_>> = DIRECTIONS
            .iter()
            .zip(modes)
            .map(|(&direction, &mode)| {
                let mut scene = lit(direction, mode);
                scene.volume.labels = true;
                Case::new(&scene, &machine, &noise, &noise.info(), true)
            })
            .collect();
        check(simulator, &cases);
    }
}

#[test]
fn voxels_that_are_not_cubes_and_thresholds_in_verilator() {
    if !thorough(OTHERS) {
        return;
    }
    let machine = machine(8, GradientMethod::Twelve, Words::default());
    let volume = SmallVolume { spacing: [1.0, 1.7, 0.8], ..noise(8, &machine.words) };
    let frames: Vec<Case<'_>> = DIRECTIONS
        .iter()
        .map(|&direction| {
            let threshold = Some(Threshold { low: Some(30.0), high: Some(220.0) });
            Case::new(&Scene { threshold, ..lit(direction, Mode::Composite) }, &machine, &volume, &volume.info(), true)
        })
        .collect();
    check(Simulator::Verilator, &frames);
}

/// Parameters of the pipeline as a whole: sides, slots, methods and words.
fn parameter_sets() -> Vec<Parameters> {
    let words = [
        ("VOXEL_BITS", 8),
        ("WEIGHT_BITS", 4),
        ("SAMPLE_FRACTION_BITS", 2),
        ("GRADIENT_BITS", 7),
        ("TABLE_BITS", 6),
        ("NEAREST", 0),
    ];
    let sets = [[4, 0, 6], [8, 0, 12], [8, 1, 12], [16, 0, 61], [16, 1, 10], [8, 0, 26]];
    let set = |[n, padded, method]: [i64; 3]| vec![("N", n), ("PADDED", padded), ("METHOD", method)];
    let narrow = [set([8, 0, 12]), words.to_vec()].concat();
    sets.map(set).into_iter().chain([narrow]).collect()
}

#[test]
fn verilator_and_icarus_have_nothing_to_say() {
    let folder = tempfile::tempdir().unwrap();
    for set in parameter_sets() {
        if let Some(verilator) = rtl::require("verilator") {
            rtl::verilator_lint(&verilator, "cube3_pipeline", &set).unwrap();
        }
        if let Some(iverilog) = rtl::require("iverilog") {
            rtl::icarus_lint(&iverilog, "cube3_pipeline", &set, &folder.path().join("pipeline")).unwrap();
        }
    }
}

#[test]
fn yosys_takes_the_pipeline_and_finds_no_latch() {
    let Some(yosys) = rtl::require("yosys") else { return };
    let script = "read_verilog -sv cube3_*.sv; hierarchy -check -top cube3_pipeline; proc; check -assert; \
                  select -assert-none t:$dlatch";
    rtl::run(Command::new(yosys).current_dir(rtl::folder()).args(["-q", "-p", script])).unwrap();
}

#[test]
fn what_the_pipeline_lacks_is_refused_with_the_way_out() {
    let default = machine(8, GradientMethod::Twelve, Words::default());
    let volume = noise(8, &default.words);
    let refused = |machine: &MachineSpec, scene: &Scene| -> String {
        let setup = frame_setup(scene, machine, &volume.info(), true).unwrap().setup;
        rtl_frame::export(machine, &setup, &volume.words).unwrap_err().to_string()
    };
    let plain = lit([0.5, 0.2, 1.0], Mode::Composite);
    let crop = Some(Crop { min_voxel: [1.0; 3], max_voxel: [6.0; 3] });
    let cue = Some(DepthCue { front: 1.0, back: 0.5 });
    let layer = |gradient, opacity| Layer { gradient, opacity: vec![[0.0, 0.0], [255.0, opacity]] };
    let mut layered = plain.clone();
    layered.transfer.opacity = Vec::new();
    layered.transfer.layers = vec![layer(0.0, 0.2), layer(50.0, 0.9)];
    let scenes = [
        (
            Scene { crop, ..plain.clone() },
            "the RTL pipeline has no cut planes and no crop box: leave cuts and crop out of the scene",
        ),
        (
            Scene { depth_cue: cue, ..plain.clone() },
            "the RTL pipeline has no depth cue: leave depth_cue out of the scene",
        ),
        (
            layered,
            "the RTL pipeline has no opacity table over the gradient: give the scene one opacity curve without layers",
        ),
        (
            Scene { lights: vec![Light { direction: None, colour: [1.0; 3] }; 3], ..plain.clone() },
            "the RTL pipeline has 2 lights and the scene 3: leave some out of the scene",
        ),
    ];
    for (scene, text) in scenes {
        assert_eq!(refused(&default, &scene), text);
    }
    let machines = [
        (MachineSpec { lanes: 4, ..default.clone() }, "set lanes in the machine file to the volume's side"),
        (MachineSpec { cone: Cone { kind: ConeKind::Chain }, ..default.clone() }, "set cone.kind = \"folded-tree\""),
        (MachineSpec { boards: Boards { count: 2, ..default.boards }, ..default.clone() }, "set boards.count = 1"),
        (
            MachineSpec { abc: Abc { shading: ShadingUnit::ReflectanceTable, ..default.abc }, ..default.clone() },
            "set abc.shading = \"phong\"",
        ),
        (
            MachineSpec {
                channel: Channels { rays: ChannelSize { capacity: 5, latency: 2 }, ..default.channel },
                ..default.clone()
            },
            "leave [channel] out",
        ),
    ];
    for (machine, text) in machines {
        let said = refused(&machine, &plain);
        assert!(said.contains(text), "{said}");
    }
    let setup = frame_setup(&plain, &default, &volume.info(), true).unwrap().setup;
    let error = rtl_frame::export(&default, &setup, &volume.words[1..]).unwrap_err();
    assert_eq!(error, RtlFrameError::Voxels { found: 511, expected: 512 });
    let eye = Scene { view: View { perspective: Some(Perspective::new(40.0)), ..plain.view.clone() }, ..plain };
    let frames = picture_setup(&eye, &default, &volume.info(), true).unwrap();
    let error = rtl_frame::export(&default, &frames.setups[0], &volume.words).unwrap_err();
    assert_eq!(error.to_string(), "the RTL pipeline has no perspective: give the scene a view with parallel rays");
}
