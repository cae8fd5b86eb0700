//! A throughput report: what a machine does with its cycles, and what limits it: `cargo run --release -p cube3 --example throughput`.

use cube3::{Machine, RunOptions, Runs, Scene, load, run};
use cube3_scene::{View, VolumeSource};
use std::error::Error;

/// Prints the report of one frame for three machines that differ in a row of the machine file.
pub fn main() -> Result<(), Box<dyn Error>> {
    let scene = Scene {
        volume: VolumeSource::from_phantom("head", 48),
        view: View { yaw_deg: 30.0, tilt_deg: 10.0, ..View::default() },
        ..Scene::default()
    };
    let options = RunOptions { runs: Runs::Timing, reference: None, ..RunOptions::default() };
    for text in ["lanes = 48", "lanes = 24", "lanes = 48\ncfb.memory = \"sdram\"\ncfb.memory_clock_hz = 66e6"] {
        let machine = Machine::from_toml(text, "machine.toml")?;
        let volume = load(&scene, &machine)?;
        let report = run(&scene, &machine, &volume, &options)?.report;
        let timing = report.timing.ok_or("a timing run counts cycles")?;
        println!("{}", text.replace('\n', ", "));
        println!("  {} cycles, {:.0} frames a second", timing.cycles, timing.fps);
        for unit in &report.units {
            let parts = [unit.busy, unit.starved, unit.blocked].map(|cycles| 100 * cycles / timing.cycles);
            println!(
                "  {:<10} busy {:>3} %, starved {:>3} %, blocked {:>3} %",
                unit.name, parts[0], parts[1], parts[2]
            );
        }
        if let Some(limits) = report.limits {
            println!("  {}", limits.sentence);
        }
    }
    Ok(())
}
