//! What limits the machine, and what it is made of.

use cube3_machine::OperatorCounts;
use serde::{Deserialize, Serialize};

/// Which resource sets the frame rate, and what each would give if it were no limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LimitsReport {
    /// The resource that limits most: the frame rate gains most without it.
    pub critical: String,
    /// Sustained frames per second as the machine is.
    pub fps: f64,
    /// Sustained frames per second if the critical resource were infinitely fast; absent where nothing else limits.
    pub fps_without: Option<f64>,
    /// What limits then; absent where nothing else limits.
    pub next: Option<String>,
    /// The same in one sentence.
    pub sentence: String,
    /// Every resource that was taken out of the way, one at a time.
    pub without: Vec<LimitWithout>,
}

/// The machine with one resource out of the way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LimitWithout {
    /// The resource.
    pub resource: String,
    /// What it was replaced by.
    pub replaced_by: String,
    /// Sustained frames per second then.
    pub fps: f64,
}

/// What a machine is made of, counted from its configuration, and what flows between its units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResourcesReport {
    /// Arithmetic, unit by unit.
    pub operators: Vec<OperatorsReport>,
    /// Sum over all units.
    pub total: OperatorCounts,
    /// Memory, in bits.
    pub memory: Vec<MemoryBits>,
    /// Lines of buses, links and ports.
    pub lines: Vec<LinesReport>,
    /// Bytes through each interface.
    pub interfaces: Vec<InterfaceReport>,
    /// Sustained frames per second for each 10⁹ bytes per second that the memory modules can give.
    pub fps_per_memory_gb_per_s: f64,
    /// Sustained samples per second for each multiplier.
    pub samples_per_s_per_multiplier: f64,
}

/// Operators of one part of the machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct OperatorsReport {
    /// The part, such as `trilin` or `abc: normaliser`.
    pub part: String,
    /// How often it is there: once a lane, a node, a light of a lane.
    pub count: u64,
    /// Operators of each.
    pub each: OperatorCounts,
}

/// Bits of one kind of memory.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct MemoryBits {
    /// What is stored.
    pub what: String,
    /// How it is counted.
    pub counted: String,
    /// Bits in the whole machine.
    pub bits: u64,
}

/// Lines of one kind.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinesReport {
    /// Which lines.
    pub what: String,
    /// How they are counted.
    pub counted: String,
    /// Data lines, each a bit wide.
    pub lines: u64,
}

/// What a link between boards carried in a direction.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkReport {
    /// The link: b is between boards b − 1 and b.
    pub link: u64,
    /// `forwards`, or `backwards` to the board before.
    pub direction: String,
    /// Words of beams and rays.
    pub words: u64,
    /// Words that it could have carried; absent where it carries any number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slots: Option<u64>,
    /// Most words that were there at the end of a cycle.
    pub peak_words: u64,
}

/// What went through memory, bus, links and host's port over the run.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrafficReport {
    /// What the memory modules did; absent where they give any word in any cycle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory: Option<MemoryTraffic>,
    /// What went through the reorder buffer behind them; absent where they are read by beams.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reorder: Option<ReorderTraffic>,
    /// Voxel words that the bus carried.
    pub bus_words: u64,
    /// Voxel words that its channels could have carried.
    pub bus_slots: u64,
    /// Words of beams over the links between boards, both directions.
    pub link_words: u64,
    /// Most words of one beam over one link in one direction.
    pub link_peak_words: u64,
    /// Words of rays over the links: between interpolators, between shading units, in the cone.
    pub ray_words: [u64; 3],
    /// Each link between boards in each direction; none on one board.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<LinkReport>,
    /// Pixels to the host.
    pub host_pixels: u64,
    /// Bytes to the host.
    pub host_bytes: u64,
}

/// What the memory modules did, all together.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MemoryTraffic {
    /// Words read.
    pub words: u64,
    /// Read commands; the other words came with an earlier burst.
    pub reads: u64,
    /// Commands that found their row open.
    pub row_hits: u64,
    /// Commands that found their bank closed.
    pub row_misses: u64,
    /// Commands that found another row open.
    pub row_conflicts: u64,
    /// Refreshes.
    pub refreshes: u64,
}

/// What went through the reorder buffer of modules that read mini-blocks of 2 × 2 × 2 voxels.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReorderTraffic {
    /// Voxel words that it holds.
    pub words: u64,
    /// Most words that were in it, or on their way there.
    pub peak_words: u64,
    /// Rows of mini-blocks that were read.
    pub rows: u64,
    /// Mini-blocks that were read.
    pub mini_blocks: u64,
}

/// Bytes through one interface at the machine's clock.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InterfaceReport {
    /// From where to where.
    pub name: String,
    /// Most bytes per second that it can carry; absent where it is not limited.
    pub peak_bytes_per_s: Option<f64>,
    /// Bytes per second that it carried, over the run.
    pub mean_bytes_per_s: f64,
}
