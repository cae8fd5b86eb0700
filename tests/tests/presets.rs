//! The machines to stand beside, each against the numbers that were published of it.

use cube3::inputs::{PRESETS, machine};
use cube3::limits::{frame_interval, limits};
use cube3::machine::Machine;
use cube3_host::{FrameSetup, MachineSpec, RaySlots, VolumeInfo, frame_setup, picture_setup};
use cube3_scene::{Perspective, Scene, View};

fn setup(machine: &MachineSpec, n: usize, [du, dv]: [f64; 2]) -> FrameSetup {
    let scene = Scene { view: View::from_direction([du, dv, 1.0], None), ..Scene::default() };
    let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    frame_setup(&scene, machine, &volume, true).unwrap().setup
}

fn slope(degrees: f64) -> f64 {
    degrees.to_radians().tan()
}

fn fps(machine: &MachineSpec, n: usize, slopes: [f64; 2]) -> f64 {
    machine.clock_hz / frame_interval(machine, &[setup(machine, n, slopes)]).unwrap() as f64
}

#[test]
fn every_preset_is_a_machine_of_its_own_name() {
    for (name, text) in PRESETS {
        assert_eq!(machine(name).unwrap().name, name);
        assert_eq!(MachineSpec::from_toml(text, name).unwrap().name, name);
    }
}

/// Up to 30 frames a second, section 5: 512³ voxels at a memory cycle of 125 ns, the next frame behind this one. What padding costs.
#[test]
fn eight_boards_of_cube3_reach_the_papers_rate() {
    let wrapped = machine("cube3-512").unwrap();
    let mut padded = wrapped.clone();
    padded.rays.slots = RaySlots::Padded;
    let close = |got: f64, expected: f64| assert!((got - expected).abs() < 0.05, "{got}, not {expected}");
    close(fps(&wrapped, 512, [1.0, slope(20.0)]), 30.5);
    close(fps(&padded, 512, [1.0, 0.0]), 15.3);
    close(fps(&padded, 512, [1.0, slope(20.0)]), 11.2);
    close(fps(&padded, 512, [1.0, 1.0]), 7.6);
}

#[test]
fn one_board_of_eight_has_an_eighth_of_the_rate() {
    let (all, one) = (machine("cube3-512").unwrap(), machine("cube3-board").unwrap());
    let interval = |machine: &MachineSpec| frame_interval(machine, &[setup(machine, 512, [0.5, 0.25])]).unwrap();
    assert_eq!(interval(&one), 8 * interval(&all));
    assert_eq!(one.lanes * all.boards.count, all.lanes);
}

/// 500 million samples a second are 29.8 frames of 256³.
#[test]
fn four_pipelines_at_125_mhz_render_256_cubed_at_about_30_frames_a_second() {
    for name in ["volumepro-500", "em-cube"] {
        let preset = machine(name).unwrap();
        let rate = fps(&preset, 256, [0.5, 0.25]);
        assert!((rate - 29.8).abs() < 0.01, "{name}: {rate}");
        assert!((rate * 256_f64.powi(3) / 500e6 - 1.0).abs() < 1e-9, "{name}: a sample in each pipeline and cycle");
    }
}

/// The bus of both turns whole beams, so there is no perspective.
#[test]
fn machines_for_parallel_projection_refuse_an_eye() {
    let view = View { perspective: Some(Perspective::new(40.0)), ..View::default() };
    let scene = Scene { view, ..Scene::default() };
    let volume = VolumeInfo { dims: [16; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    for name in ["volumepro-500", "em-cube"] {
        assert!(picture_setup(&scene, &machine(name).unwrap(), &volume, true).is_err());
    }
    assert!(picture_setup(&scene, &machine("cube3-512").unwrap(), &volume, true).is_ok());
}

/// 128³ voxels in 0.65 s at 0.96 MHz: 3.36 samples a cycle. Four pipelines on padded rays need that at a yaw of 9.5°.
#[test]
fn cube4_on_teramac() {
    let teramac = machine("cube4-teramac").unwrap();
    let seconds = |slopes| {
        let mut run = Machine::timing(&teramac, vec![setup(&teramac, 128, slopes)]).unwrap();
        run.run(&|_, _| {}).unwrap();
        run.counters().cycles as f64 / teramac.clock_hz
    };
    assert!((seconds([0.0, 0.0]) - 0.559).abs() < 1e-3);
    let tilted = seconds([slope(9.5), 0.0]);
    assert!((tilted - 0.65).abs() < 1e-3, "{tilted}");
    assert!((128_f64.powi(3) / (tilted * teramac.clock_hz) - 3.36).abs() < 0.01);
}

/// SDRAM read by beams, not by blocks, would limit EM-Cube.
#[test]
fn read_by_beams_the_sdram_of_em_cube_would_be_critical() {
    let mut beams = machine("em-cube").unwrap();
    beams.cfb.memory = cube3_host::MemoryType::Sdram;
    beams.cfb.memory_clock_hz = Some(125e6);
    let passes = [setup(&beams, 64, [0.5, 0.25])];
    let found = limits(&beams, &passes, None).unwrap();
    assert_eq!((found.critical.as_str(), found.next.as_deref()), ("memory", Some("pipeline")), "{}", found.sentence);
}
