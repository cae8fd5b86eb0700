//! The machine as data: everything that an architect may change, with a unit and a source.

use crate::{
    AcquisitionMode, BankHash, BurstOrder, BusKind, ConeKind, ControllerKind, GradientMethod, Layout, LookAheadFreed,
    LookAheadUnit, MemoryType, RayEnds, RaySlots, Reuse, ShadingUnit, TemplateRule,
};
use cube3_word::Words;
use serde::{Deserialize, Serialize};

/// A machine file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MachineSpec {
    /// Version of this file's form: 1.
    pub schema: u32,
    /// What the machine is called.
    pub name: String,
    /// Pipeline clock in hertz.
    pub clock_hz: f64,
    /// Memory modules, TRILIN units, ABC units and cone leaves: 1 to 4096. A beam of n voxels takes ⌈n/lanes⌉ cycles.
    pub lanes: usize,
    /// Word lengths and rounding.
    pub words: Words,
    /// Discrete rays, ray slots and the sample offset.
    pub rays: Rays,
    /// Cubic frame buffer.
    pub cfb: Cfb,
    /// Port through which new voxels are written.
    pub acquisition: Acquisition,
    /// Fast bus.
    pub bus: Bus,
    /// Boards and the links between them.
    pub boards: Boards,
    /// 2-D skewed buffers.
    pub dsb: Dsb,
    /// Sheared trilinear interpolation.
    pub trilin: Trilin,
    /// Gradient and shading.
    pub abc: Abc,
    /// Ray projection cone.
    pub cone: Cone,
    /// Link to the host.
    pub host_link: HostLink,
    /// Channels between the units.
    pub channel: Channels,
    /// How frames follow each other.
    pub frames: Frames,
}

/// Port through which new voxels are written into the frame buffer while it is read.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Acquisition {
    /// How written and read voxels share the modules.
    pub mode: AcquisitionMode,
    /// Voxel words that come in for each pipeline cycle, above 0.
    pub words_per_cycle: f64,
}

/// The fast bus: in a slice each channel carries one voxel word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Bus {
    /// What the bus can do with a beam.
    pub kind: BusKind,
    /// Channels, each a voxel word wide: 1 to 4096. One for each lane where it is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channels: Option<usize>,
    /// Slice clock in hertz; the pipeline's where it is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clock_hz: Option<f64>,
}

/// Boards of lanes in a ring, and the links between neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Boards {
    /// Boards, which share the lanes evenly: 1 to the lanes.
    pub count: usize,
    /// Words that a link carries in each direction in a pipeline cycle, above 0; any number where it is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub link_words_per_cycle: Option<f64>,
    /// Words at a link, in each direction, that a cycle does not carry, with which it has no room for another token's: 1 to 10⁹. The default is four of
    /// the beams of 512 lanes that send the most, 256 words, so that a link need not rest between beams; ours.
    pub link_capacity_words: usize,
    /// Pipeline cycles from a board to its neighbour.
    pub link_latency_cycles: u64,
}

/// The ray projection cone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Cone {
    /// How the nodes are joined.
    pub kind: ConeKind,
}

/// The link to the host.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct HostLink {
    /// Bytes in a pipeline cycle, above 0; any number where it is not given. A pixel has four components of
    /// ⌈accumulator_bits / 8⌉ bytes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes_per_cycle: Option<f64>,
}

/// How frames follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Frames {
    /// The next frame enters behind this one's last beam. Registers, and the buffers of first planes, are then there twice. Without
    /// it, the next frame enters when the last pixel has left.
    pub overlap: bool,
}

/// How rays are made and placed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Rays {
    /// Whether rays share slots.
    pub slots: RaySlots,
    /// Where discrete rays take their floor.
    pub template: TemplateRule,
    /// The sample offset wanted, 0 to below 1; lowered to what the rule allows.
    pub offset: f64,
    /// In perspective: least distance from the eye to the plane on which rays are a voxel apart, in depths of the volume, 0.1 to 4. Rays
    /// are at most 1 + 1/grid voxels apart.
    pub grid: f64,
    /// How much of a step the first and the last sample of a ray stand for.
    pub ends: RayEnds,
    /// Ray slots of a section: 1 to 65536. Planes on the chip are so wide, and what neighbours need across the edge of a section is kept
    /// beside it; parallel frames only. Whole planes where it is not given. Osborne et al. 1997; Pfister et al. 1999.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub section: Option<usize>,
}

/// The cubic frame buffer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Cfb {
    /// Skew (a, b, c): voxel (x, y, z) is in module (a·x + b·y + c·z) mod lanes.
    pub skew: [i64; 3],
    /// Row of the table of memory modules.
    pub memory: MemoryType,
    /// Clock of the modules in hertz; that of the table where it is not given, and the pipeline's where that has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub memory_clock_hz: Option<f64>,
    /// Where a voxel lies in its module.
    pub layout: Layout,
    /// In which bank a row of a module lies.
    pub bank_hash: BankHash,
    /// Words that a read brings: a length that the memory has, and that of the table where it is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub burst_words: Option<usize>,
    /// The order of a burst that starts at the word asked for; for memories that have a choice, and that of the table where it is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub burst_order: Option<BurstOrder>,
    /// Words or bursts of a module that are asked for ahead, the one that the scan waits for included: 1 to 64; as many as in the table
    /// where it is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look_ahead: Option<usize>,
    /// What the look-ahead counts.
    pub look_ahead_unit: LookAheadUnit,
    /// When a place of the look-ahead is free again.
    pub look_ahead_freed: LookAheadFreed,
    /// In which order a module serves the words that it is asked for.
    pub controller: ControllerKind,
    /// Words among which a controller that reorders chooses: 1 to the look-ahead, and the look-ahead where it is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window: Option<usize>,
    /// Voxel words of the reorder buffer behind modules that read mini-blocks: 8 to 2^36. As many as the view needs where it is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reorder_words: Option<u64>,
}

/// The 2-D skewed buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Dsb {
    /// Buffers in the ring, each a plane of voxels: above, current, and the one being filled. One more
    /// holds the first plane where slots are shared along v.
    pub planes: usize,
    /// Ports of a buffer's modules: 2 write and read in the same cycle, 1 takes turns.
    pub ports: usize,
}

/// The interpolation units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Trilin {
    /// Which intermediate results are kept for the neighbouring sample.
    pub reuse: Reuse,
}

/// The ABC units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Abc {
    /// Gradient estimator.
    pub gradient: GradientMethod,
    /// How the gradient becomes an intensity.
    pub shading: ShadingUnit,
    /// Bits of the specular power table's index: 1 to 11, no more than the normal's fraction.
    pub power_bits: u32,
    /// Bits of the normaliser's reciprocal-root table index: 4 to 10.
    pub root_bits: u32,
    /// Bits of each of the two coordinates on a face of the reflectance table: 2 to 8.
    pub reflectance_bits: u32,
    /// Planes of samples in the ring: above, current, below, and those that come in.
    pub planes: usize,
    /// Most rays from a sample to the neighbours along u and v that its gradient reads: where an eye is near, as many as make a voxel,
    /// but no more than these. The ring then has two planes more for each beyond the first.
    pub reach: u32,
}

/// The channels of the pipeline, in its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Channels {
    /// Beams from the frame buffer to the bus.
    pub beams: ChannelSize,
    /// Aligned beams from the bus to the skewed buffers.
    pub aligned: ChannelSize,
    /// Pairs of discrete rays from the skewed buffers to TRILIN.
    pub rays: ChannelSize,
    /// Rays of samples from TRILIN to ABC.
    pub samples: ChannelSize,
    /// Rays of coloured samples from ABC to the cone.
    pub shaded: ChannelSize,
    /// Pixels from the cone to the host: the latency is that of a folded tree, and other kinds add what differs.
    pub pixels: ChannelSize,
}

/// Size of one channel. A full rate needs a capacity of latency + 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelSize {
    /// Tokens that it holds, those on the way included.
    pub capacity: usize,
    /// Cycles from push to pop, at least 1: the pipeline depth of the unit before it.
    pub latency: u64,
}

impl ChannelSize {
    /// A channel that runs at full rate with one token to spare.
    pub const fn pipelined(latency: u64) -> ChannelSize {
        ChannelSize { capacity: latency as usize + 2, latency }
    }
}

impl Default for Frames {
    fn default() -> Self {
        Frames { overlap: true }
    }
}

impl Default for Rays {
    fn default() -> Self {
        Rays {
            slots: RaySlots::Wrapped,
            template: TemplateRule::SampleFloor,
            offset: 0.5,
            grid: 0.5,
            ends: RayEnds::Published,
            section: None,
        }
    }
}

impl Default for Cfb {
    fn default() -> Self {
        Cfb {
            skew: [1, 1, 1],
            memory: MemoryType::Ideal,
            memory_clock_hz: None,
            layout: Layout::Rows,
            bank_hash: BankHash::default(),
            burst_words: None,
            burst_order: None,
            look_ahead: None,
            look_ahead_unit: LookAheadUnit::default(),
            look_ahead_freed: LookAheadFreed::default(),
            controller: ControllerKind::default(),
            window: None,
            reorder_words: None,
        }
    }
}

impl Default for Dsb {
    fn default() -> Self {
        Dsb { planes: 3, ports: 2 }
    }
}

impl Default for Trilin {
    fn default() -> Self {
        Trilin { reuse: Reuse::Both }
    }
}

impl Default for Abc {
    fn default() -> Self {
        Abc {
            gradient: GradientMethod::Twelve,
            shading: ShadingUnit::Phong,
            power_bits: 10,
            root_bits: 8,
            reflectance_bits: 6,
            planes: 4,
            reach: 8,
        }
    }
}

impl Default for Acquisition {
    /// A volume of 512³ in a thirtieth of a second at 8 MHz.
    fn default() -> Self {
        Acquisition { mode: AcquisitionMode::DualPort, words_per_cycle: 512.0 }
    }
}

impl Default for Boards {
    fn default() -> Self {
        Boards { count: 1, link_words_per_cycle: None, link_capacity_words: 1024, link_latency_cycles: 1 }
    }
}

impl Default for Channels {
    /// Latencies: memory access and skew network 2; bus 2; buffer read 2; three lerps of two stages 6; gradient 4, normaliser 4,
    /// shading 6, weighting 2: 16; cone: log₂ of the lanes (7 for 128) and the accumulator.
    fn default() -> Self {
        Channels {
            beams: ChannelSize::pipelined(2),
            aligned: ChannelSize::pipelined(2),
            rays: ChannelSize::pipelined(2),
            samples: ChannelSize::pipelined(6),
            shaded: ChannelSize::pipelined(16),
            pixels: ChannelSize::pipelined(8),
        }
    }
}

impl Default for MachineSpec {
    /// 128 lanes at the cycle of Cube-3's memory, 125 ns.
    fn default() -> Self {
        MachineSpec {
            schema: 1,
            name: "cube3-128".into(),
            clock_hz: 8.0e6,
            lanes: 128,
            words: Words::default(),
            rays: Rays::default(),
            cfb: Cfb::default(),
            acquisition: Acquisition::default(),
            bus: Bus::default(),
            boards: Boards::default(),
            dsb: Dsb::default(),
            trilin: Trilin::default(),
            abc: Abc::default(),
            cone: Cone::default(),
            host_link: HostLink::default(),
            channel: Channels::default(),
            frames: Frames::default(),
        }
    }
}

impl MachineSpec {
    /// The machine with other words; its tables get no more index bits than a normal has.
    pub fn with_words(mut self, words: Words) -> MachineSpec {
        self.words = words;
        self.abc.power_bits = self.abc.power_bits.min(words.normal_bits - 1);
        self.abc.root_bits = self.abc.root_bits.min(2 * (words.normal_bits - 1));
        self
    }
}
