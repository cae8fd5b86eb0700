//! Frame rates of the presets over views from all around: `cargo run --release -p cube3 --example preset_views [-- VIEWS [PRESET …]]`.

use cube3::limits::frame_interval;
use cube3_host::{VolumeInfo, frame_setup};
use cube3_inputs::machine;
use cube3_machine::PRESETS;
use cube3_scene::{Scene, View};
use std::f64::consts::PI;

/// Voxels a side that a preset is made for.
fn size(name: &str) -> usize {
    match name {
        "cube3-512" | "cube3-board" => 512,
        "cube3-256" | "em-cube" | "volumepro-500" => 256,
        _ => 128,
    }
}

/// The i-th of so many directions, evenly over the sphere along a spiral of the golden angle.
fn direction(i: usize, views: usize) -> [f64; 3] {
    let z = 1.0 - (2 * i + 1) as f64 / views as f64;
    let (radius, turn) = ((1.0 - z * z).sqrt(), i as f64 * PI * (3.0 - 5.0_f64.sqrt()));
    [radius * turn.cos(), radius * turn.sin(), z]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let views: usize = words.next().map_or(Ok(50), |word| word.parse())?;
    let asked: Vec<String> = words.collect();
    println!("| preset | voxels | mean | least | most | the least from |\n| --- | --- | --- | --- | --- | --- |");
    for (name, _) in PRESETS {
        if !asked.is_empty() && !asked.iter().any(|word| word == name) {
            continue;
        }
        let preset = machine(name)?;
        let n = size(name);
        let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
        let mut rates = Vec::new();
        for i in 0..views {
            let scene = Scene { view: View::from_direction(direction(i, views), None), ..Scene::default() };
            let setup = frame_setup(&scene, &preset, &volume, true)?.setup;
            rates.push(preset.clock_hz / frame_interval(&preset, &[setup])? as f64);
        }
        let mean = rates.iter().sum::<f64>() / views as f64;
        let most = rates.iter().copied().fold(0.0, f64::max);
        let (worst, least) = rates
            .iter()
            .copied()
            .enumerate()
            .fold((0, f64::INFINITY), |least, rate| if rate.1 < least.1 { rate } else { least });
        let [x, y, z] = direction(worst, views);
        println!("| `{name}` | {n}³ | {mean:.2} | {least:.2} | {most:.2} | ({x:.2}, {y:.2}, {z:.2}) |");
    }
    Ok(())
}
