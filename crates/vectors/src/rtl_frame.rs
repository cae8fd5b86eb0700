//! A frame as text files for the pipeline in SystemVerilog: `tests/rtl/cube3_pipeline.sv` and its test bench.
//!
//! The files are for `$readmemh`: one hexadecimal word a line, `//` before a comment.
//!
//! - `registers.hex`: one 32-bit register a line, in the order of their numbers, each with its name in a comment. Signed ones are in
//!   two's complement. With N the side of the volume:
//!
//!   | number | register |
//!   | --- | --- |
//!   | 0, 1, 2 | ray slots of a plane, planes, whether slots are shared |
//!   | 3 | sample offset o |
//!   | 4 to 6, 7 | voxel axis of u, v, w (0 is x); reversed axes, bit 0 for u |
//!   | 8, 9, 10 | whether there is a gradient, its weights along u and v |
//!   | 11 to 13, 14 | factors of its components, 65536 is 1; the word beyond the border |
//!   | 15, 16 | threshold: the lowest and the highest sample that is shown |
//!   | 17, 18, 19 | whether colours are lit, ambient light, whether from both sides |
//!   | 20, 21 | mode of the cone (0 composite, 1 first-opaque, 2 last-opaque, 3 maximum, 4 minimum, 5 weighted-sum), opaque from |
//!   | 22, 23 | weight of the weighted sum, low and high word |
//!   | 24 to 35, 36 to 47 | a light each: direction, halfway, diffuse, specular, of three words |
//!   | 48 on | X(k), k = 0 to N; the N weights along u; Y(k), k = 0 to N; the N weights along v |
//!
//! - `voxels.hex`: the words of module 0 in the order of their addresses, then those of module 1, and so on: N² each.
//! - `opacity.hex`, `colour.hex`, `root.hex`, `power.hex`: the tables of a lane. A colour has red in its low bits. A table that the
//!   frame does not use is filled with zeros.
//!
//! [`RtlFrame::parameters`] are the parameters that the design must be elaborated with; the same design takes any frame of the same
//! parameters. The pipeline is that of the default machine for a cubic volume with a lane for each voxel of a side; what it cannot do
//! is refused.

use cube3_cfb::golden::{Placement, Skew};
use cube3_file::write_whole;
use cube3_frame::{FrameSetup, LinearFactor, Phong, Shading};
use cube3_machine::{Cfb, ConeKind, Dsb, HostLink, MachineSpec, MemoryType, RaySlots};
use cube3_word::Rounding;
use std::fmt::{Display, Write as _};
use std::io;
use std::path::Path;

/// Lights of the pipeline.
pub const LIGHTS: usize = 2;

/// Shortest and longest side of a volume that the pipeline is written for.
pub const SIDES: [usize; 2] = [4, 256];

/// The files and the parameters of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RtlFrame {
    /// Parameters of `cube3_pipeline` and of its test bench, by name.
    pub parameters: Vec<(&'static str, u32)>,
    /// Names and contents of the files.
    pub files: Vec<(&'static str, String)>,
}

/// What the pipeline in SystemVerilog cannot do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RtlFrameError {
    /// Something in the machine or the frame.
    #[error("the RTL pipeline has no {what}: {remedy}")]
    Unsupported {
        /// What it lacks.
        what: &'static str,
        /// What to change.
        remedy: &'static str,
    },
    /// A volume that is no cube with a side of a power of two.
    #[error(
        "the RTL pipeline renders cubes whose side is a power of two from {} to {} voxels, a lane for each; the volume is {} x {} x {}: \
         give a volume of {remedy} voxels a side",
        SIDES[0], SIDES[1], size[0], size[1], size[2]
    )]
    Size {
        /// Voxels along u, v, w.
        size: [usize; 3],
        /// The nearest side that it renders.
        remedy: usize,
    },
    /// A cube of another side than there are lanes.
    #[error(
        "the RTL pipeline has a lane for each voxel of a side; the volume has {side} and the machine {lanes} lanes: \
         set lanes in the machine file to the volume's side"
    )]
    Lanes {
        /// Voxels of a side.
        side: usize,
        /// Lanes.
        lanes: usize,
    },
    /// More lights than there are.
    #[error("the RTL pipeline has {LIGHTS} lights and the scene {lights}: leave some out of the scene")]
    Lights {
        /// Lights of the frame.
        lights: usize,
    },
    /// Another number of voxels than the geometry has.
    #[error(
        "the volume has {found} voxels and the frame is for {expected}: export the frame with the volume it was set up for"
    )]
    Voxels {
        /// Voxels given.
        found: usize,
        /// Voxels of the frame.
        expected: usize,
    },
}

impl RtlFrame {
    /// Writes the files into a folder, which is made where it is not there.
    ///
    /// # Errors
    /// A folder or file that cannot be written.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        std::fs::create_dir_all(folder)?;
        self.files.iter().try_for_each(|(name, text)| write_whole(&folder.join(name), text.as_bytes()))
    }
}

/// The files of a frame: `machine` and `setup` as [`cube3_pipeline::Machine::cycle`] takes them, with the voxel words, x fastest.
///
/// # Errors
/// A machine, a frame or a volume that the pipeline is not made for.
pub fn export(machine: &MachineSpec, setup: &FrameSetup, voxels: &[u16]) -> Result<RtlFrame, RtlFrameError> {
    check_machine(machine)?;
    check_frame(machine, setup)?;
    let expected = setup.geometry.dims().iter().product();
    if voxels.len() != expected {
        return Err(RtlFrameError::Voxels { found: voxels.len(), expected });
    }
    let files = vec![
        ("registers.hex", registers(setup)),
        ("voxels.hex", modules(machine, setup, voxels)),
        ("opacity.hex", table("opacity over the sample", setup.classification.opacity.iter().copied())),
        ("colour.hex", table("colour over the sample, red in the low bits", colours(setup))),
        ("root.hex", table("reciprocal roots of the normaliser", roots(machine, setup))),
        ("power.hex", table("x to the power of the shininess", powers(machine, setup))),
    ];
    Ok(RtlFrame { parameters: parameters(machine, setup), files })
}

fn unsupported(lacks: bool, what: &'static str, remedy: &'static str) -> Result<(), RtlFrameError> {
    if lacks { Err(RtlFrameError::Unsupported { what, remedy }) } else { Ok(()) }
}

/// The parts of a machine that the pipeline is written for.
fn check_machine(machine: &MachineSpec) -> Result<(), RtlFrameError> {
    let default = MachineSpec::default();
    unsupported(
        machine.cfb.memory != MemoryType::Ideal || machine.memory_clock_hz() != machine.clock_hz,
        "memory that takes its time",
        "set cfb.memory = \"ideal\" without a memory_clock_hz in the machine file",
    )?;
    let Cfb { skew, layout, .. } = Cfb::default();
    unsupported(
        machine.cfb.skew != skew || machine.cfb.layout != layout,
        "skew but (1, 1, 1) and no layout but rows",
        "set cfb.skew = [1, 1, 1] and cfb.layout = \"rows\" in the machine file",
    )?;
    let slow_bus = machine.bus.channels.is_some_and(|channels| channels < machine.lanes)
        || machine.bus.clock_hz.is_some_and(|clock| clock < machine.clock_hz);
    unsupported(
        slow_bus,
        "bus with fewer words than lanes",
        "leave bus.channels and bus.clock_hz out of the machine file",
    )?;
    unsupported(machine.rays.section.is_some(), "sections", "leave rays.section out of the machine file")?;
    unsupported(machine.boards.count != 1, "links between boards", "set boards.count = 1 in the machine file")?;
    unsupported(
        machine.dsb != Dsb::default() || machine.abc.planes != default.abc.planes,
        "other buffers than the default machine's",
        "leave dsb.planes, dsb.ports and abc.planes out of the machine file",
    )?;
    unsupported(
        machine.cone.kind != ConeKind::FoldedTree,
        "cone but the folded tree",
        "set cone.kind = \"folded-tree\" in the machine file",
    )?;
    unsupported(
        machine.host_link != HostLink::default(),
        "host link with a rate",
        "leave host_link.bytes_per_cycle out of the machine file",
    )?;
    unsupported(
        machine.channel != default.channel,
        "other channels than the default machine's",
        "leave [channel] out of the machine file",
    )
}

/// The parts of a frame that the pipeline is written for.
fn check_frame(machine: &MachineSpec, setup: &FrameSetup) -> Result<(), RtlFrameError> {
    let geometry = &setup.geometry;
    unsupported(
        geometry.perspective.is_some() || setup.rays.is_some(),
        "perspective",
        "give the scene a view with parallel rays",
    )?;
    let (size, lanes) = (geometry.size, machine.lanes);
    let side = size[0];
    if size != [side; 3] || !side.is_power_of_two() || !(SIDES[0]..=SIDES[1]).contains(&side) {
        return Err(RtlFrameError::Size { size, remedy: nearest_side(size) });
    }
    if side != lanes || setup.cone.leaves != lanes {
        return Err(RtlFrameError::Lanes { side, lanes });
    }
    unsupported(
        setup.ends.is_some(),
        "parts of a step for the ends of rays",
        "set rays.ends = \"published\" in the machine file",
    )?;
    unsupported(!setup.clips.is_empty(), "cut planes and no crop box", "leave cuts and crop out of the scene")?;
    let neutral = |cue: &LinearFactor| {
        let factor = cue.factor;
        [factor.u, factor.v, factor.k, factor.constant - (1 << LinearFactor::FRACTION_BITS)] == [0; 4]
    };
    unsupported(
        setup.depth_cue.as_ref().is_some_and(|cue| !neutral(cue)),
        "depth cue",
        "leave depth_cue out of the scene",
    )?;
    unsupported(
        setup.classification.gradient_rows.is_some(),
        "opacity table over the gradient",
        "give the scene one opacity curve without layers",
    )?;
    match &setup.shading {
        Some(Shading::Table(_)) => {
            unsupported(true, "reflectance table", "set abc.shading = \"phong\" in the machine file")
        }
        Some(Shading::Phong(phong)) if phong.lights.len() > LIGHTS => {
            Err(RtlFrameError::Lights { lights: phong.lights.len() })
        }
        _ => Ok(()),
    }
}

/// The side of the cube nearest to a volume: of the lower and the higher power of two the nearer to its longest side.
fn nearest_side(size: [usize; 3]) -> usize {
    let longest = size.into_iter().max().unwrap_or(SIDES[0]).clamp(SIDES[0], SIDES[1]);
    let higher = longest.next_power_of_two();
    if higher - longest <= longest - higher / 2 { higher } else { higher / 2 }
}

fn parameters(machine: &MachineSpec, setup: &FrameSetup) -> Vec<(&'static str, u32)> {
    let words = &setup.words;
    let gradient = setup.gradient.map_or(machine.abc.gradient, |registers| registers.method);
    let kept = setup.gradient.and_then(|registers| registers.scale).map_or(0, |scale| scale.kept_bits);
    vec![
        ("N", machine.lanes as u32),
        ("PADDED", u32::from(setup.geometry.slots == RaySlots::Padded)),
        ("METHOD", gradient.row().rtl),
        ("VOXEL_BITS", words.voxel_bits),
        ("WEIGHT_BITS", words.weight_bits),
        ("SAMPLE_FRACTION_BITS", words.sample_fraction_bits),
        ("GRADIENT_BITS", words.gradient_bits),
        ("NORMAL_BITS", words.normal_bits),
        ("TABLE_BITS", words.table_bits),
        ("COLOUR_BITS", words.colour_bits),
        ("OPACITY_BITS", words.opacity_bits),
        ("ACCUMULATOR_BITS", words.accumulator_bits),
        ("NEAREST", u32::from(words.rounding == Rounding::Nearest)),
        ("KEPT_BITS", kept),
        ("ROOT_BITS", setup.normaliser.as_ref().map_or(machine.abc.root_bits, |table| table.root_bits)),
        ("POWER_BITS", phong(setup).map_or(machine.abc.power_bits, |phong| phong.power_bits)),
    ]
}

fn phong(setup: &FrameSetup) -> Option<&Phong> {
    match &setup.shading {
        Some(Shading::Phong(phong)) => Some(phong),
        _ => None,
    }
}

/// Registers as they are listed: a word and its name a line.
#[derive(Default)]
struct Listing {
    text: String,
}

impl Listing {
    fn word(&mut self, word: u32, name: impl Display) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{word:08x} // {name}");
    }

    fn three(&mut self, words: [u32; 3], name: &str, of: [&str; 3]) {
        for (word, of) in words.into_iter().zip(of) {
            self.word(word, format_args!("{name} {of}"));
        }
    }
}

fn registers(setup: &FrameSetup) -> String {
    let geometry = &setup.geometry;
    let [slots, planes] = geometry.slot_counts();
    let (uvw, rgb) = (["u", "v", "w"], ["red", "green", "blue"]);
    let mut list = Listing::default();
    list.word(slots as u32, "ray slots of a plane");
    list.word(planes as u32, "planes");
    list.word(u32::from(geometry.slots == RaySlots::Wrapped), "slots are shared");
    list.word(geometry.offset, "sample offset");
    list.three(geometry.axes.axis.map(|axis| axis as u32), "voxel axis of", uvw);
    let reversed = geometry.axes.reversed.iter().enumerate().map(|(i, &reversed)| u32::from(reversed) << i).sum();
    list.word(reversed, "reversed axes");
    let gradient = setup.gradient.as_ref();
    list.word(u32::from(gradient.is_some()), "gradient");
    let weights = gradient.map_or([0; 2], |registers| registers.weights);
    list.word(weights[0], "gradient weight along u");
    list.word(weights[1], "gradient weight along v");
    let factors = gradient.and_then(|registers| registers.scale).map_or([1 << 16; 3], |scale| scale.factors);
    list.three(factors, "gradient factor", uvw);
    list.word(gradient.map_or(0, |registers| registers.border as u32), "border");
    list.word(setup.classification.threshold[0], "lowest sample shown");
    list.word(setup.classification.threshold[1], "highest sample shown");
    let phong = phong(setup);
    list.word(u32::from(phong.is_some()), "colours are lit");
    list.word(phong.map_or(0, |phong| phong.ambient), "ambient light");
    list.word(phong.map_or(0, |phong| u32::from(phong.two_sided)), "lit from both sides");
    list.word(setup.cone.mode.code(), "mode of the cone");
    list.word(setup.cone.opaque, "opaque from");
    list.word(setup.cone.sum_weight as u32, "weight of the sum, low word");
    list.word((setup.cone.sum_weight >> 32) as u32, "weight of the sum, high word");
    for light in 0..LIGHTS {
        // A light that is not there has no intensity, which adds nothing.
        let source = phong.and_then(|phong| phong.lights.get(light));
        let signed = |words: [i32; 3]| words.map(|word| word as u32);
        list.three(source.map_or([0; 3], |source| signed(source.direction)), &format!("light {light} direction"), uvw);
        list.three(source.map_or([0; 3], |source| signed(source.halfway)), &format!("light {light} halfway"), uvw);
        list.three(source.map_or([0; 3], |source| source.diffuse), &format!("light {light} diffuse"), rgb);
        list.three(source.map_or([0; 3], |source| source.specular), &format!("light {light} specular"), rgb);
    }
    for (template, column, axis) in [(&geometry.u, "X", "u"), (&geometry.v, "Y", "v")] {
        for (k, &word) in template.columns.iter().enumerate() {
            list.word(word, format_args!("{column}({k})"));
        }
        for (k, &word) in template.weights.iter().enumerate() {
            list.word(word, format_args!("weight along {axis} of sample {k}"));
        }
    }
    list.text
}

/// The voxels by module and address.
fn modules(machine: &MachineSpec, setup: &FrameSetup, voxels: &[u16]) -> String {
    let dims = setup.geometry.dims();
    let skew = Skew { coefficients: machine.cfb.skew, lanes: machine.lanes };
    let placement = Placement { skew, layout: machine.cfb.layout, dims };
    let words = placement.words();
    let mut memory = vec![0; words * machine.lanes];
    for (i, &voxel) in voxels.iter().enumerate() {
        let xyz = [i % dims[0], i / dims[0] % dims[1], i / (dims[0] * dims[1])];
        memory[placement.module(xyz) * words + placement.address(xyz)] = voxel;
    }
    let mut text = String::new();
    for (module, words) in memory.chunks(words).enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "// module {module}");
        for word in words {
            let _ = writeln!(text, "{word:04x}");
        }
    }
    text
}

fn table(name: &str, words: impl Iterator<Item = impl std::fmt::LowerHex>) -> String {
    let mut text = format!("// {name}\n");
    for word in words {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{word:x}");
    }
    text
}

fn colours(setup: &FrameSetup) -> impl Iterator<Item = u64> {
    let bits = setup.words.colour_bits;
    setup.classification.colour.iter().map(move |rgb| (0..3).map(|i| u64::from(rgb[i]) << (i as u32 * bits)).sum())
}

fn roots(machine: &MachineSpec, setup: &FrameSetup) -> impl Iterator<Item = u32> {
    let none = vec![0; 11 << machine.abc.root_bits];
    setup.normaliser.as_ref().map_or(none, |table| table.root.clone()).into_iter()
}

fn powers(machine: &MachineSpec, setup: &FrameSetup) -> impl Iterator<Item = u32> {
    let none = vec![0; (1 << machine.abc.power_bits) + 1];
    phong(setup).map_or(none, |phong| phong.power.clone()).into_iter()
}
