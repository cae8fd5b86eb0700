//! What an architect chooses among: each kind of unit, with its names in machine files.

use cube3_parameter::Choice;
use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

/// How written and read voxels share the memory modules.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum AcquisitionMode {
    /// A second port of every module: writing costs reading nothing, and a frame may show a volume that changes.
    #[default]
    DualPort,
    /// Writes take module cycles from reads; a frame may show a volume that changes.
    CycleStealing,
    /// Two frame buffers that change roles between frames: twice the memory, no frame shows two volumes.
    DoubleBuffer,
}

/// What a bus can do with a beam.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum BusKind {
    /// Any voxel to any lane: what perspective needs.
    #[default]
    Gather,
    /// A rotation of the whole beam: parallel projection only.
    Rotate,
}

/// How the nodes that make a pixel are joined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum ConeKind {
    /// A binary tree with cross-links, which starts at any leaf: the paper's.
    #[default]
    FoldedTree,
    /// A binary tree behind a shifter that turns the ray to leaf 0.
    ShiftedTree,
    /// A node for each lane, one behind another: front to back, pipelined.
    Chain,
    /// One node that takes a sample a cycle: front to back.
    Accumulator,
}

impl ConeKind {
    /// Every kind.
    pub const ALL: [ConeKind; ConeKind::VARIANTS.len()] = *ConeKind::VARIANTS.first_chunk().unwrap();

    /// The order in which its nodes combine the samples of a ray.
    pub fn order(self) -> ConeOrder {
        match self {
            ConeKind::FoldedTree | ConeKind::ShiftedTree => ConeOrder::Tree,
            ConeKind::Chain | ConeKind::Accumulator => ConeOrder::FrontToBack,
        }
    }
}

/// In which order the samples of a ray are combined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ConeOrder {
    /// Neighbours in pairs, level by level, in chunks of the leaves.
    #[default]
    Tree,
    /// One behind another from the eye on, however many leaves there are.
    FrontToBack,
}

/// How rays of a tilted view share the machine's ray slots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum RaySlots {
    /// Rays u and u − n, which together have n voxels, share one slot; planes v and v − n likewise.
    #[default]
    Wrapped,
    /// Each ray and each plane has its own slot: up to four times as many.
    Padded,
}

/// Where the discrete ray takes its floor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum TemplateRule {
    /// At the sample, `X(k) = ⌊(k+o)·du⌋`: the paper's. The offset is bounded by `1 − max(du, dv)`, equation (3).
    #[default]
    SampleFloor,
    /// At the plane, `X(k) = ⌊k·du⌋`: the ray is inside the cell at both planes, so every offset is legal.
    PlaneFloor,
    /// At the voxel nearest to the sample, `X(k) = ⌊k·du + ½⌋`, and no weights: the rule of label volumes, whose samples lie on planes of
    /// voxels. The scene asks for it, not a machine file.
    Nearest,
}

/// How much of a step the first and the last sample of a ray stand for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum RayEnds {
    /// A whole one, as every sample.
    #[default]
    Published,
    /// What there is of it between where the ray enters or leaves and half way to the next sample: the parts of a ray's samples are its
    /// length.
    Exact,
}

/// Rows of the table of memory modules; the numbers are in [`crate::MemoryModel`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum MemoryType {
    /// A word in every pipeline cycle, whatever its address.
    #[default]
    Ideal,
    /// Dual-ported video memory with a cycle of 125 ns.
    Vram,
    /// Fast-page DRAM.
    FastPage,
    /// SDRAM with banks, bursts, row misses and refresh.
    Sdram,
    /// A pseudo-channel of stacked memory.
    Hbm,
}

impl MemoryType {
    /// The name in machine files.
    pub fn key(self) -> &'static str {
        self.name()
    }
}

/// Where a voxel lies in its memory module.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Layout {
    /// Rows of voxels behind one another, along x, then y, then z.
    #[default]
    Rows,
    /// Blocks of up to 8 × 8 × 8 words of a module behind one another, so that a walk along any axis stays in a row of the memory
    /// for some words. Along x, a module has a word of every `lanes` voxels.
    Blocks,
    /// Mini-blocks of 2 × 2 × 2 voxels side by side in one module, which are read whole: mini-block (i, j, k) is in module
    /// (a·i + b·j + c·k) mod lanes, a without a factor in common with the lanes. Blocks of 2·lanes × 8 × 8 voxels are 128 words of each module.
    /// After Pfister et al. 1999 and Osborne et al. 1997.
    MiniBlocks,
}

impl Layout {
    /// Every layout, in the order of their numbers in vectors.
    pub const ALL: [Layout; Layout::VARIANTS.len()] = *Layout::VARIANTS.first_chunk().unwrap();

    /// Whether modules can hold a volume in this layout: with mini-blocks each run of `lanes` of them along x has to meet every module.
    pub fn takes(self, skew: [i64; 3], lanes: usize) -> bool {
        let lanes = lanes as i64;
        self != Layout::MiniBlocks || (1..lanes).all(|i| skew[0] * i % lanes != 0)
    }
}

/// Which intermediate lerps a TRILIN unit keeps; the values are the same, the multipliers differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Reuse {
    /// Nothing: 7 lerps a sample.
    None,
    /// The lerps along w of the ray before: 5.
    Ray,
    /// The lerps along u of the plane before: 4.
    Plane,
    /// Both: 3.
    #[default]
    Both,
}

impl Reuse {
    /// Every level.
    pub const ALL: [Reuse; Reuse::VARIANTS.len()] = *Reuse::VARIANTS.first_chunk().unwrap();

    /// Lerps, and so multipliers, for each sample.
    pub fn lerps(self) -> u32 {
        match self {
            Reuse::None => 7,
            Reuse::Ray => 5,
            Reuse::Plane => 4,
            Reuse::Both => 3,
        }
    }
}

/// Gradient estimators, by the samples that they read. Sections 4 of the paper and 3 of the design.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, VariantArray)]
pub enum GradientMethod {
    /// Neighbours in u, in v and along the ray, treated as if orthogonal.
    #[serde(rename = "6")]
    Six,
    /// 26 neighbours weighted by inverse Manhattan distance, ¼ for ⅓; treated as if orthogonal.
    #[serde(rename = "26")]
    TwentySix,
    /// Two along the ray, and on each side ray the foot of the perpendicular; raw differences.
    #[serde(rename = "10")]
    Ten,
    /// The same, each difference divided by the length it was taken over.
    #[serde(rename = "10n")]
    TenNormalised,
    /// u and v as in 6; w by bilinear interpolation of four samples on slice k ± 1.
    #[default]
    #[serde(rename = "12")]
    Twelve,
    /// 6, and Gw = Gr − du·Gu − dv·Gv.
    #[serde(rename = "6d")]
    SixSheared,
    /// 26, and Gw = Gr − du·Gu − dv·Gv.
    #[serde(rename = "26d")]
    TwentySixSheared,
}

/// How the ABC unit shades.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum ShadingUnit {
    /// Normalise, then Phong with integer multipliers.
    #[default]
    Phong,
    /// A reflectance table over the direction of the gradient.
    ReflectanceTable,
}
