//! The machine as data: everything that an architect may change, with a unit and a source.

use crate::{RaySlots, TemplateRule};
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
    /// 2-D skewed buffers.
    pub dsb: Dsb,
    /// Sheared trilinear interpolation.
    pub trilin: Trilin,
    /// Gradient and shading.
    pub abc: Abc,
    /// Channels between the units.
    pub channel: Channels,
    /// How frames follow each other.
    pub frames: Frames,
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
}

/// The cubic frame buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Cfb {
    /// Skew (a, b, c): voxel (x, y, z) is in module (a·x + b·y + c·z) mod lanes.
    pub skew: [i64; 3],
}

/// The 2-D skewed buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Dsb {
    /// Buffers in the ring, each a plane of voxels: above, current, and the one being filled. One more
    /// holds the first plane where slots are shared along v.
    pub planes: usize,
}

/// The interpolation units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Trilin {
    /// Which intermediate results are kept for the neighbouring sample.
    pub reuse: Reuse,
}

/// Which intermediate lerps a TRILIN unit keeps; the values are the same, the multipliers differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
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
    pub const ALL: [Reuse; 4] = [Reuse::None, Reuse::Ray, Reuse::Plane, Reuse::Both];

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
}

/// Gradient estimators, by the samples that they read. Sections 4 of the paper and 3 of the design.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
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

impl GradientMethod {
    /// Every estimator with its name.
    pub const ALL: [(GradientMethod, &'static str); 7] = [
        (GradientMethod::Six, "6"),
        (GradientMethod::TwentySix, "26"),
        (GradientMethod::Ten, "10"),
        (GradientMethod::TenNormalised, "10n"),
        (GradientMethod::Twelve, "12"),
        (GradientMethod::SixSheared, "6d"),
        (GradientMethod::TwentySixSheared, "26d"),
    ];

    /// The name in machine files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(method, _)| *method == self).map_or("?", |(_, name)| name)
    }
}

/// How the ABC unit shades.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShadingUnit {
    /// Normalise, then Phong with integer multipliers.
    #[default]
    Phong,
    /// A reflectance table over the direction of the gradient.
    ReflectanceTable,
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
    /// Pixels from the cone to the host.
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
        Rays { slots: RaySlots::Wrapped, template: TemplateRule::SampleFloor, offset: 0.5 }
    }
}

impl Default for Cfb {
    fn default() -> Self {
        Cfb { skew: [1, 1, 1] }
    }
}

impl Default for Dsb {
    fn default() -> Self {
        Dsb { planes: 3 }
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
        }
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
            dsb: Dsb::default(),
            trilin: Trilin::default(),
            abc: Abc::default(),
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
        let skew = self.cfb.skew;
        check(
            skew.iter().all(|a| (-4096..=4096).contains(a)),
            "cfb.skew",
            format!("{skew:?}"),
            "outside −4096 to 4096",
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
        check(
            (4..=10).contains(&self.abc.root_bits),
            "abc.root_bits",
            self.abc.root_bits.to_string(),
            "outside 4 to 10",
        )?;
        let reflectance = self.abc.reflectance_bits;
        check((2..=8).contains(&reflectance), "abc.reflectance_bits", reflectance.to_string(), "outside 2 to 8")?;
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
        assert_eq!(error("[words]\nvoxel_bits = 40"), "m.toml: words.voxel_bits = 40 is outside 1 to 16");
        assert!(error("[abc]\ngradient = \"7\"").starts_with("m.toml:2: "));
    }
}
