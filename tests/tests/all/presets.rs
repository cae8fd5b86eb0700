//! The machines to stand beside, each against the numbers that were published of it.

use cube3::limits::{frame_interval, limits};
use cube3_frame::FrameSetup;
use cube3_host::{VolumeInfo, frame_setup, picture_setup};
use cube3_inputs::machine;
use cube3_machine::{Cfb, MachineSpec, MemoryType, PRESETS, RaySlots};
use cube3_pipeline::Machine;
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

/// The rate along a direction.
fn fps_along(machine: &MachineSpec, n: usize, direction: [f64; 3]) -> f64 {
    let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
    let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let setup = frame_setup(&scene, machine, &volume, true).unwrap().setup;
    machine.clock_hz / frame_interval(machine, &[setup]).unwrap() as f64
}

/// 500 million samples a second are 29.8 frames of 256³: what four pipelines do with a memory that gives any voxel in any cycle.
#[test]
fn four_pipelines_at_125_mhz_render_256_cubed_at_about_30_frames_a_second() {
    for name in ["volumepro-500", "em-cube"] {
        let preset = machine(name).unwrap();
        let ideal = MachineSpec { cfb: Cfb::default(), ..preset };
        let rate = fps(&ideal, 256, [0.5, 0.25]);
        assert!((rate - 29.8).abs() < 0.01, "{name}: {rate}");
        assert!((rate * 256_f64.powi(3) / 500e6 - 1.0).abs() < 1e-9, "{name}: a sample in each pipeline and cycle");
    }
}

/// Outside: 1.016 ticks a word of mini-blocks of an SDRAM at 125 MHz, refreshes and all, are 29.3 frames a second, in whatever order. Rows of
/// mini-blocks that are read twice, and rows of a bank that follow each other, take up to half a frame.
#[test]
fn four_sdrams_give_mini_blocks_at_29_frames_a_second_from_any_direction() {
    let preset = machine("em-cube").unwrap();
    for direction in [[0.0, 0.0, 1.0], [0.3, -1.0, 0.1], [-1.0, 0.9, -0.8]] {
        let rate = fps_along(&preset, 256, direction);
        assert!((rate - 29.3).abs() < 0.5, "{direction:?}: {rate}");
    }
    let other = MachineSpec { words: preset.words, ..machine("volumepro-500").unwrap() };
    assert_eq!((preset.cfb, preset.lanes, preset.clock_hz), (other.cfb, other.lanes, other.clock_hz));
}

/// The same over fifty views of a sphere, in the turn of a spiral: mean, worst and which.
#[test]
#[ignore = "takes minutes"]
fn fifty_views_of_a_sphere_and_the_worst_of_them() {
    let preset = machine("em-cube").unwrap();
    let direction = |i: usize| {
        let (height, angle) = (1.0 - (2 * i + 1) as f64 / 50.0, i as f64 * 2.399_963_229_728_653);
        let radius = (1.0 - height * height).sqrt();
        [radius * angle.cos(), radius * angle.sin(), height]
    };
    let rates: Vec<(f64, [f64; 3])> =
        (0..50).map(direction).map(|along| (fps_along(&preset, 256, along), along)).collect();
    let mean = rates.iter().map(|(rate, _)| rate).sum::<f64>() / 50.0;
    let (worst, along) = rates.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    let best = rates.iter().map(|(rate, _)| *rate).fold(0.0, f64::max);
    println!("256³ on em-cube: mean {mean:.2}, worst {worst:.2} along {along:.3?}, best {best:.2} frames/s");
    assert!((worst - 29.3).abs() < 0.5 && (best - 29.3).abs() < 0.5, "{rates:?}");
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
    beams.cfb = Cfb { memory: MemoryType::Sdram, memory_clock_hz: Some(125e6), ..Cfb::default() };
    let passes = [setup(&beams, 64, [0.5, 0.25])];
    let found = limits(&beams, &passes, None).unwrap();
    assert_eq!((found.critical.as_str(), found.next.as_deref()), ("memory", Some("pipeline")), "{}", found.sentence);
}
