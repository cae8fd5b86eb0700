//! Frame rates of four SDRAMs of 125 MHz behind four pipelines of the same clock, by view and layout, as a table:
//! `cargo run --release -p cube3-cfb --example layout_rates -- SIZE [REORDER_PART]`.
//!
//! With a part, the reorder buffer has the least words that would do and that part of what the view needs above them.

use cube3_cfb::memory::{ReorderNeed, Supply};
use cube3_cfb::{Beam, CfbSpec, CfbUnit, NoVoxels};
use cube3_channel::Channel;
use cube3_frame::Schedule;
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::{Cfb, Layout, LookAheadUnit, MachineSpec, MemoryType};
use cube3_scene::{Scene, View};
use std::sync::Arc;

const YAWS: [f64; 5] = [0.0, 30.0, 45.0, 60.0, 90.0];
const TILTS: [f64; 4] = [0.0, 20.0, 45.0, 80.0];

fn machine(layout: Layout) -> MachineSpec {
    let mut cfb = Cfb { memory: MemoryType::Sdram, memory_clock_hz: Some(125e6), layout, ..Cfb::default() };
    if layout == Layout::MiniBlocks {
        (cfb.burst_words, cfb.look_ahead, cfb.look_ahead_unit) = (Some(8), Some(16), LookAheadUnit::Bursts);
    }
    MachineSpec { lanes: 4, clock_hz: 125e6, cfb, ..MachineSpec::default() }
}

/// Frames a second, the second frame behind the first, against a bus that takes every beam; and words of the reorder buffer.
fn rate(
    machine: &MachineSpec,
    view: View,
    size: usize,
    part: Option<f64>,
) -> Result<(f64, u64), Box<dyn std::error::Error>> {
    let scene = Scene { view, ..Scene::default() };
    let volume = VolumeInfo { dims: [size; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let setup = frame_setup(&scene, machine, &volume, true)?.setup;
    let mut machine = machine.clone();
    if let Some(part) = part {
        let ReorderNeed { least, steady, .. } = ReorderNeed::new(&machine, &setup.geometry);
        machine.cfb.reorder_words = Some(least + (part * (steady - least) as f64) as u64);
    }
    let setup = Arc::new(setup);
    let setups = [Arc::clone(&setup), setup];
    let specs: Vec<CfbSpec> = setups
        .iter()
        .map(|setup| CfbSpec::new(&machine, &setup.geometry, Schedule::new(&machine, &setup.geometry)))
        .collect();
    let mut cfb = CfbUnit::new(specs, NoVoxels).with_modules(Supply::new(&machine, &setups)?);
    let mut beams = Channel::<Beam<()>>::new("beams", 4, 2)?;
    let (mut cycles, mut first) = (0, 0);
    while !cfb.done() {
        beams.pop_slot();
        cfb.tick(&setups, 2, &mut beams);
        beams.commit();
        cycles += 1;
        if cfb.fetched() <= (size * size) as u64 {
            first = cycles;
        }
    }
    let words = cfb.reorder_counters().map_or(0, |buffer| buffer.words);
    Ok((machine.clock_hz / (cycles - first) as f64, words))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let numbers: Vec<f64> = std::env::args().skip(1).map(|word| word.parse()).collect::<Result<_, _>>()?;
    let [size, part @ ..] = numbers.as_slice() else {
        return Err("give the voxels a side".into());
    };
    let part = part.first().copied();
    println!("| tilt, layout | {} |", YAWS.map(|yaw| format!("yaw {yaw}°")).join(" | "));
    println!("| --- {}|", "| --- ".repeat(YAWS.len()));
    for tilt in TILTS {
        for layout in Layout::ALL {
            if part.is_some() && layout != Layout::MiniBlocks {
                continue;
            }
            let mut line = format!("| {tilt}°, {layout:?} |");
            for yaw in YAWS {
                let (fps, words) = rate(&machine(layout), View::from_angles(yaw, tilt), *size as usize, part)?;
                line += &if part.is_some() { format!(" {fps:.1} ({words}) |") } else { format!(" {fps:.1} |") };
            }
            println!("{line}");
        }
    }
    Ok(())
}
