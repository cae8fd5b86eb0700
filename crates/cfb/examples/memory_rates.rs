//! Frame rates that each type of memory module allows, and how often a word needs a new row, by the axes of beam and depth:
//! `cargo run --release -p cube3-cfb --example memory_rates -- SIZE CLOCK_MHZ [KEY = VALUE]...`, with keys of `cfb` of a machine file.

use cube3_cfb::memory::{MemoryCounters, Supply};
use cube3_cfb::{Beam, CfbSpec, CfbUnit, NoVoxels};
use cube3_channel::Channel;
use cube3_host::{Cfb, Layout, MachineSpec, MemoryModel, MemoryType, VolumeInfo, frame_setup};
use cube3_scene::{Scene, View};

const VIEWS: [(&str, [f64; 3]); 6] = [
    ("x, y", [0.3, 1.0, 0.1]),
    ("x, z", [0.3, 0.1, 1.0]),
    ("y, x", [1.0, 0.3, 0.1]),
    ("y, z", [0.1, 0.3, 1.0]),
    ("z, x", [1.0, 0.1, 0.3]),
    ("z, y", [0.1, 1.0, 0.3]),
];

/// Cycles of a frame against a bus that takes every beam, and the rows opened for a word.
fn frame(machine: &MachineSpec, direction: [f64; 3]) -> Result<(u64, f64), Box<dyn std::error::Error>> {
    let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
    let volume = VolumeInfo { dims: [machine.lanes; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let setups = [frame_setup(&scene, machine, &volume, true)?.setup];
    let spec = CfbSpec::new(machine, &setups[0].geometry);
    let mut cfb = CfbUnit::new(vec![spec], NoVoxels).with_modules(Supply::new(machine, &setups)?);
    let mut beams = Channel::<Beam<()>>::new("beams", 4, 2)?;
    let mut cycles = 0;
    while !cfb.done() {
        beams.pop_slot();
        cfb.tick(&setups, 1, &mut beams);
        beams.commit();
        cycles += 1;
    }
    let MemoryCounters { words, row_misses, row_conflicts, .. } =
        cfb.memory_counters().first().copied().unwrap_or_default();
    Ok((cycles, (row_misses + row_conflicts) as f64 / words.max(1) as f64))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [size, megahertz, keys @ ..] = words.as_slice() else {
        return Err("give the voxels a side and the pipeline clock in MHz".into());
    };
    let (size, megahertz): (f64, f64) = (size.parse()?, megahertz.parse()?);
    println!("| memory | layout | {} |", VIEWS.map(|(axes, _)| axes).join(" | "));
    for model in MemoryModel::TABLE {
        for layout in [Layout::Rows, Layout::Blocks] {
            let file = format!("[cfb]\nmemory = \"{}\"\n{}", model.kind.key(), keys.join("\n"));
            let Ok(machine) = MachineSpec::from_toml(&file, "the command line") else { continue };
            let cfb = Cfb { layout, ..machine.cfb };
            let machine = MachineSpec { lanes: size as usize, clock_hz: 1e6 * megahertz, cfb, ..machine };
            if layout == Layout::Blocks && matches!(model.kind, MemoryType::Ideal | MemoryType::Vram) {
                continue;
            }
            print!("| {:?} | {layout:?} |", model.kind);
            for (_, direction) in VIEWS {
                let (cycles, rows) = frame(&machine, direction)?;
                print!(" {:.1} ({:.1} %) |", machine.clock_hz / cycles as f64, 100.0 * rows);
            }
            println!();
        }
    }
    Ok(())
}
