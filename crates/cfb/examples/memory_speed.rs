//! Time that the memory modules take for the words of a frame, by type, layout and view:
//! `cargo run --release -p cube3-cfb --example memory_speed -- SIZE CLOCK_MHZ TYPE [LAYOUT_AND_VIEW]`, as in `512 66 sdram 'Rows z, y'`.

mod frame;

use cube3_machine::{Cfb, Layout, MachineSpec, MemoryModel};
use frame::{VIEWS, run};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [size, megahertz, kind, axes @ ..] = words.as_slice() else {
        return Err("give the voxels a side, the pipeline clock in MHz, the type, and which views".into());
    };
    let (size, megahertz): (usize, f64) = (size.parse()?, megahertz.parse()?);
    let model = MemoryModel::TABLE.iter().find(|model| format!("{:?}", model.kind).eq_ignore_ascii_case(kind));
    let memory = model.ok_or("no such type")?.kind;
    for layout in Layout::ALL {
        for (name, direction) in VIEWS {
            if axes.first().is_some_and(|axes| !format!("{layout:?} {name}").contains(axes)) {
                continue;
            }
            let cfb = Cfb { memory, layout, ..Cfb::default() };
            let machine = MachineSpec { lanes: size, clock_hz: 1e6 * megahertz, cfb, ..MachineSpec::default() };
            let start = Instant::now();
            let (cycles, _) = run(&machine, direction)?;
            println!("{layout:?} {name}: {cycles} cycles, {:.3} s", start.elapsed().as_secs_f64());
        }
    }
    Ok(())
}
