//! Time that the memory modules take for the words of a frame, by type, layout and view:
//! `cargo run --release -p cube3-cfb --example memory_speed -- SIZE CLOCK_MHZ TYPE [VIEW]`.

use cube3_cfb::memory::Supply;
use cube3_cfb::{Beam, CfbSpec, CfbUnit, NoVoxels};
use cube3_channel::Channel;
use cube3_host::{Cfb, Layout, MachineSpec, MemoryModel, VolumeInfo, frame_setup};
use cube3_scene::{Scene, View};
use std::time::Instant;

const VIEWS: [(&str, [f64; 3]); 6] = [
    ("x, y", [0.3, 1.0, 0.1]),
    ("x, z", [0.3, 0.1, 1.0]),
    ("y, x", [1.0, 0.3, 0.1]),
    ("y, z", [0.1, 0.3, 1.0]),
    ("z, x", [1.0, 0.1, 0.3]),
    ("z, y", [0.1, 1.0, 0.3]),
];

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
            let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
            let volume = VolumeInfo { dims: [size; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
            let setups = [frame_setup(&scene, &machine, &volume, true)?.setup];
            let spec = CfbSpec::new(&machine, &setups[0].geometry);
            let mut unit = CfbUnit::new(vec![spec], NoVoxels).with_modules(Supply::new(&machine, &setups)?);
            let mut beams = Channel::<Beam<()>>::new("beams", 4, 2)?;
            let (start, mut cycles) = (Instant::now(), 0);
            while !unit.done() {
                beams.pop_slot();
                unit.tick(&setups, 1, &mut beams);
                beams.commit();
                cycles += 1;
            }
            println!("{layout:?} {name}: {cycles} cycles, {:.3} s", start.elapsed().as_secs_f64());
        }
    }
    Ok(())
}
