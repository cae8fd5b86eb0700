//! Frame rates that each type of memory module allows, and how often a word needs a new row, by the axes of beam and depth:
//! `cargo run --release -p cube3-cfb --example memory_rates -- SIZE CLOCK_MHZ [KEY = VALUE]...`, with keys of `cfb` of a machine file.

mod frame;

use cube3_machine::{Cfb, Layout, MachineSpec, MemoryModel, MemoryType};
use frame::{VIEWS, run};

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
                let (cycles, counters) = run(&machine, direction)?;
                let rows = (counters.row_misses + counters.row_conflicts) as f64 / counters.words.max(1) as f64;
                print!(" {:.1} ({:.1} %) |", machine.clock_hz / cycles as f64, 100.0 * rows);
            }
            println!();
        }
    }
    Ok(())
}
