//! The machine as data: everything that an architect may change, with a unit and a source.

use crate::{
    AcquisitionMode, BankHash, BurstOrder, BusKind, ConeKind, ControllerKind, GradientMethod, Layout, LookAheadFreed,
    LookAheadUnit, MemoryModel, MemoryType, RayEnds, RaySlots, Reuse, ShadingUnit, TemplateRule,
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

/// What is wrong with a machine file.
#[derive(Debug, thiserror::Error)]
pub enum MachineError {
    /// Not TOML, or a key or value that is not known.
    #[error("{place}: {reason}")]
    Syntax {
        /// File and line.
        place: String,
        /// What the parser says.
        reason: String,
    },
    /// A word length out of range.
    #[error("{place}: {source}")]
    Word {
        /// File.
        place: String,
        /// Which word.
        source: cube3_word::WordError,
    },
    /// Another value out of range.
    #[error("{place}: {key} = {value} is {reason}")]
    Value {
        /// File.
        place: String,
        /// The key.
        key: &'static str,
        /// The value given.
        value: String,
        /// What would be right.
        reason: &'static str,
    },
}

impl MachineSpec {
    /// The default machine as a commented file, ready to edit.
    pub const COMMENTED_DEFAULT: &'static str = include_str!("default-machine.toml");

    /// Reads a machine file's text; `place` names it in errors.
    ///
    /// # Errors
    /// Syntax, unknown keys, and values out of range, each with its place.
    pub fn from_toml(text: &str, place: &str) -> Result<MachineSpec, MachineError> {
        let machine: MachineSpec = toml::from_str(text).map_err(|error| {
            let line = error.span().map_or(0, |span| text[..span.start.min(text.len())].matches('\n').count() + 1);
            let place = if line > 0 { format!("{place}:{line}") } else { place.to_owned() };
            MachineError::Syntax { place, reason: error.message().to_owned() }
        })?;
        machine.check(place)?;
        Ok(machine)
    }

    /// The machine as a file.
    pub fn to_toml(&self) -> String {
        toml::to_string_pretty(self).unwrap_or_default()
    }

    /// The machine with other words; its tables get no more index bits than a normal has.
    pub fn with_words(mut self, words: Words) -> MachineSpec {
        self.words = words;
        self.abc.power_bits = self.abc.power_bits.min(words.normal_bits - 1);
        self.abc.root_bits = self.abc.root_bits.min(2 * (words.normal_bits - 1));
        self
    }

    /// Checks every range; `place` names the machine in errors.
    ///
    /// # Errors
    /// The first value out of range.
    pub fn check(&self, place: &str) -> Result<(), MachineError> {
        let check = |good: bool, key, value: String, reason| {
            if good { Ok(()) } else { Err(MachineError::Value { place: place.to_owned(), key, value, reason }) }
        };
        check(self.schema == 1, "schema", self.schema.to_string(), "not a form that this program reads; it reads 1")?;
        check(
            (1.0..=1e15).contains(&self.clock_hz),
            "clock_hz",
            self.clock_hz.to_string(),
            "outside 1 to 10^15 hertz",
        )?;
        check((1..=4096).contains(&self.lanes), "lanes", self.lanes.to_string(), "outside 1 to 4096")?;
        self.words.check().map_err(|source| MachineError::Word { place: place.to_owned(), source })?;
        check(
            (0.0..1.0).contains(&self.rays.offset),
            "rays.offset",
            self.rays.offset.to_string(),
            "outside 0 to below 1",
        )?;
        check(
            self.rays.template != TemplateRule::Nearest,
            "rays.template",
            "\"nearest\"".into(),
            "for label volumes, which say so in the scene: volume.labels = true",
        )?;
        check((0.1..=4.0).contains(&self.rays.grid), "rays.grid", self.rays.grid.to_string(), "outside 0.1 to 4")?;
        let skew = self.cfb.skew;
        check(
            skew.iter().all(|a| (-4096..=4096).contains(a)),
            "cfb.skew",
            format!("{skew:?}"),
            "outside −4096 to 4096",
        )?;
        check(
            self.cfb.layout.takes(skew, self.lanes),
            "cfb.skew",
            format!("{skew:?}"),
            "not for cfb.layout = \"mini-blocks\": its first coefficient shares a factor with the lanes; choose another skew or layout",
        )?;
        check(
            self.cfb.layout != Layout::MiniBlocks || self.cfb.controller == ControllerKind::InOrder,
            "cfb.controller",
            "\"fr-fcfs\"".into(),
            "not for cfb.layout = \"mini-blocks\": their rows are read in order; leave it \"in-order\", or choose another layout",
        )?;
        let reorder = self.cfb.reorder_words;
        check(
            reorder.is_none_or(|words| (8..=1 << 36).contains(&words)),
            "cfb.reorder_words",
            reorder.unwrap_or_default().to_string(),
            "outside 8 to 2^36",
        )?;
        check(
            reorder.is_none() || self.cfb.layout == Layout::MiniBlocks,
            "cfb.reorder_words",
            reorder.unwrap_or_default().to_string(),
            "only for cfb.layout = \"mini-blocks\": other layouts are read in the order of the beams; leave it out",
        )?;
        check((1..=64).contains(&self.dsb.planes), "dsb.planes", self.dsb.planes.to_string(), "outside 1 to 64")?;
        let power_top = 11.min(self.words.normal_bits - 1);
        let power = self.abc.power_bits;
        check(
            (1..=power_top).contains(&power),
            "abc.power_bits",
            power.to_string(),
            "outside 1 to 11, or above words.normal_bits − 1",
        )?;
        let root_top = 10.min(2 * (self.words.normal_bits - 1));
        check(
            (4..=root_top).contains(&self.abc.root_bits),
            "abc.root_bits",
            self.abc.root_bits.to_string(),
            "outside 4 to 10, or above 2·(words.normal_bits − 1)",
        )?;
        let reflectance = self.abc.reflectance_bits;
        check((2..=8).contains(&reflectance), "abc.reflectance_bits", reflectance.to_string(), "outside 2 to 8")?;
        self.check_resources(place)?;
        for (key, size) in self.channel.named() {
            check(
                (1..=65536).contains(&size.capacity),
                key,
                format!("capacity {}", size.capacity),
                "outside 1 to 65536",
            )?;
            check(
                (1..=65536).contains(&size.latency),
                key,
                format!("latency {}", size.latency),
                "outside 1 to 65536 cycles",
            )?;
        }
        Ok(())
    }
}

impl MachineSpec {
    /// Clock of the memory modules in hertz.
    pub fn memory_clock_hz(&self) -> f64 {
        self.cfb.memory_clock_hz.or(MemoryModel::of(self.cfb.memory).clock_hz).unwrap_or(self.clock_hz)
    }

    /// Ranges of memory, bus, boards, buffers and links.
    fn check_resources(&self, place: &str) -> Result<(), MachineError> {
        let check = |good: bool, key, value: String, reason| {
            if good { Ok(()) } else { Err(MachineError::Value { place: place.to_owned(), key, value, reason }) }
        };
        let count = |key, value: Option<usize>, most: usize, reason| {
            let good = value.is_none_or(|value| (1..=most).contains(&value));
            check(good, key, value.unwrap_or_default().to_string(), reason)
        };
        let clock = |key, value: Option<f64>| {
            let good = value.is_none_or(|value| (1.0..=1e15).contains(&value) && value >= self.clock_hz / 1000.0);
            let reason = "outside 1 to 10^15 hertz, or below a thousandth of clock_hz";
            check(good, key, value.unwrap_or_default().to_string(), reason)
        };
        let rate = |key, value: Option<f64>| {
            let good = value.is_none_or(|value| (1e-3..=1e9).contains(&value));
            check(good, key, value.unwrap_or_default().to_string(), "outside 0.001 to 10^9 in a cycle")
        };
        clock("cfb.memory_clock_hz", self.cfb.memory_clock_hz)?;
        let kind = MemoryModel::of(self.cfb.memory);
        count("cfb.look_ahead", self.cfb.look_ahead, MemoryModel::MOST_AHEAD, "outside 1 to 64")?;
        check(
            self.cfb.burst_words.is_none_or(|words| kind.burst_lengths.contains(&words)),
            "cfb.burst_words",
            self.cfb.burst_words.unwrap_or_default().to_string(),
            "not a burst of cfb.memory: sdram has bursts of 1, 2, 4 and 8 words, hbm of 16, the others of 1",
        )?;
        check(
            self.cfb.burst_order.is_none() || kind.burst_order.is_some(),
            "cfb.burst_order",
            format!("{:?}", self.cfb.burst_order.map_or("", BurstOrder::name)),
            "no choice of cfb.memory: only bursts of sdram start at the word asked for; leave it out",
        )?;
        let (model, memory_clock) = (MemoryModel::of_machine(&self.cfb), self.memory_clock_hz());
        count("cfb.window", self.cfb.window, model.look_ahead, "outside 1 to cfb.look_ahead")?;
        check(
            model.refreshes_in_time(memory_clock),
            "cfb.memory_clock_hz",
            memory_clock.to_string(),
            "too slow: refreshing would take more than a quarter of the time",
        )?;
        check(
            memory_clock / self.clock_hz <= MemoryModel::MOST_TICKS,
            "cfb.memory_clock_hz",
            memory_clock.to_string(),
            "above 65536 ticks in a cycle of clock_hz",
        )?;
        count("rays.section", self.rays.section, 65536, "outside 1 to 65536 ray slots")?;
        rate("acquisition.words_per_cycle", Some(self.acquisition.words_per_cycle))?;
        count("bus.channels", self.bus.channels, 4096, "outside 1 to 4096")?;
        clock("bus.clock_hz", self.bus.clock_hz)?;
        count("boards.count", Some(self.boards.count), self.lanes, "outside 1 to the lanes")?;
        rate("boards.link_words_per_cycle", self.boards.link_words_per_cycle)?;
        let capacity = self.boards.link_capacity_words;
        count("boards.link_capacity_words", Some(capacity), 1_000_000_000, "outside 1 to 10^9 words")?;
        let latency = self.boards.link_latency_cycles;
        check((1..=65536).contains(&latency), "boards.link_latency_cycles", latency.to_string(), "outside 1 to 65536")?;
        count("dsb.ports", Some(self.dsb.ports), 2, "outside 1 to 2")?;
        check((1..=64).contains(&self.abc.planes), "abc.planes", self.abc.planes.to_string(), "outside 1 to 64")?;
        check((1..=64).contains(&self.abc.reach), "abc.reach", self.abc.reach.to_string(), "outside 1 to 64")?;
        rate("host_link.bytes_per_cycle", self.host_link.bytes_per_cycle)
    }
}

impl Channels {
    /// Each channel with its key, in pipeline order.
    pub fn named(&self) -> [(&'static str, ChannelSize); 6] {
        [
            ("channel.beams", self.beams),
            ("channel.aligned", self.aligned),
            ("channel.rays", self.rays),
            ("channel.samples", self.samples),
            ("channel.shaded", self.shaded),
            ("channel.pixels", self.pixels),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_commented_file_is_the_default_machine() {
        let read = MachineSpec::from_toml(MachineSpec::COMMENTED_DEFAULT, "default").unwrap();
        assert_eq!(read, MachineSpec::default());
        assert_eq!(MachineSpec::from_toml(&read.to_toml(), "resolved").unwrap(), read);
    }

    #[test]
    fn mistakes_are_named_with_their_place() {
        let error = |text: &str| MachineSpec::from_toml(text, "m.toml").unwrap_err().to_string();
        assert!(error("lanse = 3").starts_with("m.toml:1: unknown field `lanse`"), "{}", error("lanse = 3"));
        assert_eq!(error("lanes = 0"), "m.toml: lanes = 0 is outside 1 to 4096");
        assert_eq!(
            error("[cfb]\nmemory = \"sdram\"\nmemory_clock_hz = 1e6"),
            "m.toml: cfb.memory_clock_hz = 1000000 is too slow: refreshing would take more than a quarter of the time"
        );
        assert_eq!(
            error("clock_hz = 1.0\n[cfb]\nmemory = \"sdram\""),
            "m.toml: cfb.memory_clock_hz = 133000000 is above 65536 ticks in a cycle of clock_hz"
        );
        let cfb = |text: &str| error(&format!("[cfb]\n{text}"));
        assert_eq!(cfb("look_ahead = 65"), "m.toml: cfb.look_ahead = 65 is outside 1 to 64");
        assert_eq!(cfb("look_ahead = 0"), "m.toml: cfb.look_ahead = 0 is outside 1 to 64");
        assert_eq!(cfb("memory = \"sdram\"\nwindow = 9"), "m.toml: cfb.window = 9 is outside 1 to cfb.look_ahead");
        assert!(
            cfb("memory = \"sdram\"\nburst_words = 3").starts_with("m.toml: cfb.burst_words = 3 is not a burst of ")
        );
        assert!(cfb("memory = \"hbm\"\nburst_words = 4").starts_with("m.toml: cfb.burst_words = 4 is not a burst of "));
        assert!(
            cfb("memory = \"hbm\"\nburst_order = \"sequential\"")
                .starts_with("m.toml: cfb.burst_order = \"sequential\" is no choice of cfb.memory: ")
        );
        assert!(cfb("bank_hash = \"sum\"").starts_with("m.toml:2: "));
        assert_eq!(
            error("[words]\nnormal_bits = 4\n[abc]\npower_bits = 3"),
            "m.toml: abc.root_bits = 8 is outside 4 to 10, or above 2·(words.normal_bits − 1)"
        );
        assert_eq!(error("[words]\nvoxel_bits = 40"), "m.toml: words.voxel_bits = 40 is outside 1 to 16");
        let mini = "lanes = 6\n[cfb]\nlayout = \"mini-blocks\"\n";
        assert!(MachineSpec::from_toml(&format!("{mini}skew = [-5, 3, 2]\nreorder_words = 8"), "m.toml").is_ok());
        assert_eq!(
            error(&format!("{mini}skew = [3, 1, 1]")),
            "m.toml: cfb.skew = [3, 1, 1] is not for cfb.layout = \"mini-blocks\": its first coefficient shares a factor with the lanes; \
             choose another skew or layout"
        );
        assert_eq!(
            error(&format!("{mini}memory = \"sdram\"\ncontroller = \"fr-fcfs\"")),
            "m.toml: cfb.controller = \"fr-fcfs\" is not for cfb.layout = \"mini-blocks\": their rows are read in order; leave it \"in-order\", \
             or choose another layout"
        );
        assert_eq!(error(&format!("{mini}reorder_words = 7")), "m.toml: cfb.reorder_words = 7 is outside 8 to 2^36");
        assert_eq!(
            error("[cfb]\nreorder_words = 4096"),
            "m.toml: cfb.reorder_words = 4096 is only for cfb.layout = \"mini-blocks\": other layouts are read in the order of the beams; \
             leave it out"
        );
        assert!(error("[abc]\ngradient = \"7\"").starts_with("m.toml:2: "));
        assert_eq!(error("[rays]\nsection = 0"), "m.toml: rays.section = 0 is outside 1 to 65536 ray slots");
        assert_eq!(error("[rays]\nsection = 65537"), "m.toml: rays.section = 65537 is outside 1 to 65536 ray slots");
        assert!(MachineSpec::from_toml("[rays]\nsection = 32", "m.toml").is_ok());
    }
}
