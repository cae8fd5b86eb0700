//! Every parameter of a machine: a row for each key of its files.

use crate::{BurstOrder, MachineSpec, MemoryModel, TemplateRule};
use cube3_parameter::{Choice, Legal, Parameter, Unfit, Value, ValueKind, named, names, parameter};
use cube3_word::{Length, Rounding, Words};

/// The tables of a machine file in the order in which it is printed, each with what stands above it.
pub const SECTIONS: [(&str, &str); 14] = [
    ("", "A Cube-3 machine. Every key is optional; what is missing takes the value shown here."),
    ("words", "Word lengths and rounding."),
    ("rays", "Discrete rays, ray slots and the sample offset."),
    ("cfb", "Cubic frame buffer."),
    ("acquisition", "Port through which new voxels are written."),
    ("bus", "Fast bus: in a slice each channel carries a voxel word."),
    ("boards", "Boards of lanes in a ring."),
    ("dsb", "2-D skewed buffers."),
    ("trilin", "Sheared trilinear interpolation."),
    ("abc", "Gradient, classification and shading."),
    ("cone", "Ray projection cone."),
    ("host_link", "Link to the host."),
    (
        "channel",
        "Channels between the units: tokens that they hold, those on the way included, and cycles from push to pop, which is the depth of \
         the unit before. A full rate needs a capacity of latency + 1.",
    ),
    ("frames", "How frames follow each other."),
];

/// A row of a field; see [`parameter!`].
macro_rules! row {
    (
        $($key:ident).+, $unit:expr $(, $legal:expr)?; $about:expr; $source:expr
        $(; example $example:literal)? $(; because $because:literal)?
    ) => {
        Parameter {
            $(legal: $legal,)?
            $(example: $example,)?
            $(because: $because,)?
            ..parameter!(MachineSpec, $($key).+, $unit, $about, $source)
        }
    };
}

/// A row of a word's length, whose range is the word's.
macro_rules! word {
    ($key:ident, $length:ident; $about:literal; $source:literal) => {
        Parameter {
            legal: |machine| length(&Words::$length, machine),
            because: Words::$length.because,
            ..parameter!(MachineSpec, words.$key, "bits", $about, $source)
        }
    };
}

/// The row of a channel's capacity.
macro_rules! capacity {
    ($channel:ident, $about:literal) => {
        row!(channel.$channel.capacity, "tokens", |_| Legal::whole(1, 65536); $about; CAPACITY)
    };
}

/// The row of a channel's latency.
macro_rules! latency {
    ($channel:ident, $about:literal, $source:literal) => {
        row!(channel.$channel.latency, "cycles", |_| Legal::whole(1, 65536); $about; $source)
    };
}

const CAPACITY: &str = "ours: a full rate with one token to spare";

const MOST_HERTZ: f64 = 1e15;

fn length(length: &Length, machine: &MachineSpec) -> Legal {
    Legal::whole(length.low.into(), length.largest(&machine.words).into())
}

/// From a thousandth of the pipeline's clock: what one waits for the other is counted in cycles.
fn clock(machine: &MachineSpec) -> Legal {
    Legal::real((machine.clock_hz / 1000.0).max(1.0), MOST_HERTZ)
}

fn rate(_: &MachineSpec) -> Legal {
    Legal::real(1e-3, 1e9)
}

fn bits_up_to(low: u32, most: u32, limit: u32) -> Legal {
    Legal::whole(low.into(), most.min(limit).into())
}

/// The bursts of the memory that the machine has.
fn bursts(machine: &MachineSpec) -> Legal {
    let lengths = MemoryModel::of(machine.cfb.memory).burst_lengths;
    Legal::OneOf(lengths.iter().map(|&words| Value::Whole(words as i128)).collect())
}

/// The orders of bursts of the memory that the machine has: all, or none.
fn burst_orders(machine: &MachineSpec) -> Legal {
    let choice = MemoryModel::of(machine.cfb.memory).burst_order.is_some();
    Legal::names(names::<BurstOrder>().filter(|_| choice))
}

/// Those of machine files: labels, which take the nearest voxel, are the scene's.
fn templates(_: &MachineSpec) -> Legal {
    Legal::names([TemplateRule::SampleFloor, TemplateRule::PlaneFloor].map(Choice::name))
}

fn set_rounding(machine: &mut MachineSpec, value: &Value) -> Result<(), Unfit> {
    let unfit = || Unfit { value: value.clone(), kind: ValueKind::Choice, optional: false };
    machine.words.rounding = named(value).ok_or_else(unfit)?;
    Ok(())
}

/// A row for each key of a machine file, in the order in which they are checked: a row's range may read those before it.
pub const PARAMETERS: &[Parameter<MachineSpec>] = &[
    row!(schema, "", |_| Legal::whole(1, 1); "number of this file's form"; "ours"),
    row!(name, ""; "what the machine is called"; "ours"),
    row!(clock_hz, "hertz", |_| Legal::real(1.0, MOST_HERTZ);
        "pipeline clock, by default the 125 ns cycle of Cube-3's memory modules"; "Pfister et al. 1995, section 5"),
    row!(lanes, "", |_| Legal::whole(1, 4096);
        "memory modules, TRILIN units, ABC units and cone leaves; a beam of n voxels takes ceil(n / lanes) cycles";
        "Pfister et al. 1995, section 5: 512; the default is ours, a beam of it a cycle for 128 voxels"),
    word!(voxel_bits, VOXEL; "voxel word, unsigned"; "Pfister et al. 1995: 16"),
    word!(weight_bits, WEIGHT; "fraction of interpolation weights, which are 0 to 1 inclusive"; "ours"),
    word!(sample_fraction_bits, SAMPLE_FRACTION; "bits that a sample has below the voxel's"; "ours"),
    word!(gradient_bits, GRADIENT; "gradient component, signed"; "ours: a difference of samples, whole"),
    word!(normal_bits, NORMAL; "component of the normalised gradient, signed"; "ours"),
    word!(table_bits, TABLE; "index of the classification table"; "Pfister et al. 1999: 4096 entries"),
    word!(table_gradient_bits, TABLE_GRADIENT; "index over the gradient's magnitude, for two-dimensional tables"; "ours"),
    word!(colour_bits, COLOUR; "colour component"; "ours"),
    word!(opacity_bits, OPACITY; "opacity out of the table"; "Pfister et al. 1999: 12"),
    word!(accumulator_bits, ACCUMULATOR; "colour and opacity in the cone";
        "ours: accumulators of 12 bits that truncate lose 12/255 over 512 samples"),
    Parameter {
        key: "words.rounding",
        kind: ValueKind::Choice,
        unit: "",
        about: "what happens to the bits that a multiplication drops",
        source: "ours",
        optional: false,
        example: "",
        because: "",
        legal: |_| Legal::names(names::<Rounding>()),
        get: |machine| Value::Text(machine.words.rounding.name().to_owned()),
        set: set_rounding,
    },
    row!(rays.slots, ""; "whether rays u and u - n share a slot; padded takes up to four times the cycles"; "ours"),
    row!(rays.template, "", templates; "where discrete rays take their floor; at the plane, every offset is legal";
        "sample-floor: Pfister et al. 1995, equation (3); plane-floor: ours";
        because "labels, which take the nearest voxel, are the scene's: volume.labels = true"),
    row!(rays.offset, "voxels", |_| Legal::below(0.0, 1.0);
        "offset of the samples from the planes, lowered to what the template allows"; "Pfister et al. 1995, equation (3)"),
    row!(rays.grid, "depths of the volume", |_| Legal::real(0.1, 4.0);
        "in perspective, least distance from the eye to the plane of rays a voxel apart"; "ours"),
    row!(rays.ends, ""; "whether the first and last sample of a ray stand for a whole step or for their part of it";
        "published: Pfister et al. 1995; exact: ours"),
    row!(rays.section, "ray slots", |_| Legal::whole(1, 65536);
        "slots of a plane that are taken one behind another, and planes on the chip are so wide; all of them without it";
        "Osborne et al. 1997; Pfister et al. 1999"; example "32"),
    row!(cfb.skew, "", |_| Legal::whole(-4096, 4096);
        "voxel (x, y, z) is in module (a x + b y + c z) mod lanes"; "Pfister et al. 1995, section 3: 1, 1, 1"),
    row!(cfb.memory, ""; "type of the modules: row of the table of memories"; "data sheets, named in that table"),
    row!(cfb.memory_clock_hz, "hertz", clock; "clock of the modules; the type's own, or the pipeline's, without it";
        "data sheets"; example "100e6"; because "a thousandth of clock_hz is the least"),
    row!(cfb.layout, ""; "where a voxel lies in its module; mini-blocks of 2 x 2 x 2 are read whole";
        "mini-blocks: Osborne et al. 1997; Pfister et al. 1999"),
    row!(cfb.bank_hash, ""; "which bank of a module a row is in"; "Zhang, Zhu, Zhang 2000 (xor); ours (digit-sum)"),
    row!(cfb.burst_words, "words", bursts; "words that a read brings, of sdram 1, 2, 4 or 8, of hbm 16; the type's own without it"; "data sheets";
        example "4"; because "what cfb.memory has"),
    row!(cfb.burst_order, "", burst_orders; "order of a burst that starts at the word asked for; the type's own without it";
        "data sheets"; example "\"interleaved\""; because "only bursts of cfb.memory = \"sdram\" start at the word asked for"),
    row!(cfb.look_ahead, "", |_| Legal::whole(1, MemoryModel::MOST_AHEAD as i128);
        "words or bursts of a module that are asked for ahead; the type's own without it"; "ours"; example "8"),
    row!(cfb.look_ahead_unit, ""; "what the look-ahead counts"; "ours"),
    row!(cfb.look_ahead_freed, ""; "a place is free when the word is taken, or when the read of its column is issued"; "ours"),
    row!(cfb.controller, ""; "words in their order, or those of open rows first"; "fr-fcfs: Rixner et al. 2000"),
    row!(cfb.window, "", |machine| Legal::whole(1, MemoryModel::of_machine(&machine.cfb).look_ahead as i128);
        "words that fr-fcfs chooses from; the look-ahead without it"; "ours"; example "8"; because "cfb.look_ahead is the most"),
    row!(cfb.reorder_words, "voxel words", |_| Legal::whole(8, 1 << 36);
        "buffer behind modules that read mini-blocks; what the view needs without it"; "ours"; example "135000"),
    row!(acquisition.mode, ""; "how new volumes share the modules with reads"; "Pfister et al. 1995, section 3; ours"),
    row!(acquisition.words_per_cycle, "voxel words a cycle", rate; "new voxels that come in";
        "ours: 512 voxels a side in a thirtieth of a second at 8 MHz"),
    row!(bus.kind, ""; "any voxel to any lane, or whole beams turned, for parallel views alone"; "Pfister et al. 1995"),
    row!(bus.channels, "", |_| Legal::whole(1, 4096); "voxel words of a slice; one for each lane without it";
        "Pfister et al. 1995, section 5"; example "128"),
    row!(bus.clock_hz, "hertz", clock; "slices a second; the pipeline's clock without it"; "Pfister et al. 1995, section 5";
        example "8e6"; because "a thousandth of clock_hz is the least"),
    row!(boards.count, "", |machine| Legal::whole(1, machine.lanes as i128);
        "boards in a ring, which share the lanes evenly"; "Pfister et al. 1995, section 5: eight"; because "the lanes are the most"),
    row!(boards.link_words_per_cycle, "words a cycle", rate; "of a link in each direction; any number without it"; "ours";
        example "64.0"),
    row!(boards.link_capacity_words, "words", |_| Legal::whole(1, 1_000_000_000);
        "that wait at a link in each direction"; "ours: four of the beams of 512 lanes that send the most"),
    row!(boards.link_latency_cycles, "cycles", |_| Legal::whole(1, 65536); "from a board to its neighbour"; "ours"),
    row!(dsb.planes, "planes", |_| Legal::whole(1, 64); "buffers in the ring: above, current, and the one being filled";
        "Pfister et al. 1995, section 4"),
    row!(dsb.ports, "", |_| Legal::whole(1, 2); "2 write and read in the same cycle, 1 takes turns"; "ours"),
    row!(trilin.reuse, ""; "lerps kept for the neighbouring sample: 7, 5, 4 or 3 multipliers"; "ours"),
    row!(abc.gradient, ""; "gradient estimator, by the samples that it reads"; "Pfister et al. 1995, section 4"),
    row!(abc.shading, ""; "how the gradient becomes an intensity"; "reflectance-table: Pfister et al. 1999"),
    row!(abc.power_bits, "bits", |machine| bits_up_to(1, 11, machine.words.normal_bits.saturating_sub(1));
        "index of the specular power table"; "ours"; because "words.normal_bits - 1 is the most, and 11"),
    row!(abc.root_bits, "bits", |machine| bits_up_to(4, 10, 2 * machine.words.normal_bits.saturating_sub(1));
        "index of the normaliser's reciprocal root table"; "ours"; because "twice words.normal_bits - 1 is the most, and 10"),
    row!(abc.reflectance_bits, "bits", |_| Legal::whole(2, 8); "each coordinate on a face of the reflectance table"; "ours"),
    row!(abc.planes, "planes", |_| Legal::whole(1, 64); "of samples: above, current, below, and those that come in"; "ours"),
    row!(abc.reach, "rays", |_| Legal::whole(1, 64);
        "in perspective, most rays to a gradient's neighbours where an eye is near"; "ours"),
    row!(cone.kind, ""; "how the nodes that make a pixel are joined";
        "folded-tree: Pfister et al. 1995; chain: Kanus et al. 1997; the others ours"),
    row!(host_link.bytes_per_cycle, "bytes a cycle", rate; "of pixels to the host; any number without it"; "ours"; example "64.0"),
    capacity!(beams, "beams from the frame buffer to the bus"),
    latency!(beams, "memory access and skew network", "ours"),
    capacity!(aligned, "aligned beams from the bus to the skewed buffers"),
    latency!(aligned, "bus", "ours"),
    capacity!(rays, "pairs of discrete rays from the skewed buffers to TRILIN"),
    latency!(rays, "reading a buffer", "ours"),
    capacity!(samples, "rays of samples from TRILIN to ABC"),
    latency!(samples, "three lerps of two stages", "ours"),
    capacity!(shaded, "rays of coloured samples from ABC to the cone"),
    latency!(shaded, "gradient 4, normaliser 4, shading 6, weighting 2", "ours"),
    capacity!(pixels, "pixels from the cone to the host"),
    latency!(pixels, "a folded tree of log2(lanes) levels and the accumulator; other kinds add what differs", "ours"),
    row!(frames.overlap, ""; "the next frame enters behind this one's last beam, else when the last pixel has left"; "ours"),
];
