//! `FrameSetup`: what a driver writes into the machine's registers and tables. Nothing else enters the machine.

use crate::{EndRegisters, Geometry, HalfSpace, LinearFactor, Schedule, ShadingOrder};
use cube3_machine::{ConeOrder, GradientMethod, Reuse};
use cube3_scene::Mode;
use cube3_word::Words;
use serde::{Deserialize, Serialize};

/// The registers and tables of one frame.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameSetup {
    /// Version of this form: 1.
    pub schema: u32,
    /// Word lengths that the tables below are made for.
    pub words: Words,
    /// Templates and slots.
    pub geometry: Geometry,
    /// Interpolation results that are kept.
    pub reuse: Reuse,
    /// Half-spaces that samples must lie in: cut planes and the crop box, none to twelve.
    pub clips: Vec<HalfSpace>,
    /// Sample to colour and opacity.
    pub classification: Classification,
    /// Gradient, absent where nothing reads it.
    pub gradient: Option<GradientRegisters>,
    /// Length and direction of the gradient, absent where nothing reads them.
    pub normaliser: Option<Normaliser>,
    /// Shading, absent where colours are used as they are.
    pub shading: Option<Shading>,
    /// Depth cueing, absent where there is none.
    pub depth_cue: Option<LinearFactor>,
    /// The cone's mode.
    pub cone: ConeRegisters,
    /// What differs from ray to ray in perspective.
    pub rays: Option<RayRegisters>,
    /// The parts of a step that the ends of rays stand for; absent where each sample stands for a whole step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ends: Option<EndRegisters>,
}

impl FrameSetup {
    /// How many rays away, along u and along v, the neighbours of the samples at a depth are.
    #[inline]
    pub fn reach(&self, k: usize) -> i64 {
        let reach = self.rays.as_ref().and_then(|rays| rays.reach.as_ref());
        reach.map_or(1, |reach| i64::from(reach[k]))
    }

    /// Planes of the ring on a machine of so many: two more for each ray and plane by which neighbours are farther than the next.
    pub fn ring(&self, planes: usize) -> usize {
        planes + 2 * (self.most_reach() - 1)
    }

    /// The order in which rays are shaded on a machine where the frame has this schedule: those of a frame with a gradient wait for their
    /// neighbours.
    pub fn shading_order(&self, schedule: &Schedule) -> ShadingOrder {
        schedule.shading_order(self.most_reach(), self.gradient.is_some())
    }

    /// The farthest of them in rays, at any depth.
    pub fn most_reach(&self) -> usize {
        let reach = self.rays.as_ref().and_then(|rays| rays.reach.as_ref());
        reach.and_then(|reach| reach.iter().max()).map_or(1, |&most| most as usize)
    }
}

/// What differs from ray to ray and from depth to depth of a perspective frame, each a table over one axis; rays are in the
/// order of their slots.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RayRegisters {
    /// Along u: the view vector of ray (i, j), against which light is measured, is `[view_u[i], view_v[j], view_w]` in world
    /// lengths, of any length. It points away from the eye, as the gradient does from a surface's normal.
    pub view_u: Vec<i32>,
    /// Along v.
    pub view_v: Vec<i32>,
    /// Along w.
    pub view_w: i32,
    /// Whether a light of the shading unit stands at the eye: then its two directions are the view vector.
    pub at_eye: Vec<bool>,
    /// Along u: part of the squared length of a step.
    pub length_u: Vec<u32>,
    /// Along v.
    pub length_v: Vec<u32>,
    /// Tables of opacity, one for each class of step lengths: class = (length_u(i) + length_v(j)) >> `CLASS_SHIFT`.
    pub length_classes: u32,
    /// Size of the slope along u, a fraction of [`RayRegisters::SLOPE_BITS`].
    pub slope_u: Vec<u32>,
    /// Along v.
    pub slope_v: Vec<u32>,
    /// By depth, 1 / max(j·m, 1) for neighbours j rays away: what makes a slope a shear in units of their distance. A fraction of [`RayRegisters::SLOPE_BITS`].
    pub closeness: Vec<u32>,
    /// By depth: factors of the gradient's components, fractions of [`GradientScale::FACTOR_BITS`].
    pub factors: Vec<[u32; 3]>,
    /// By depth, how many rays away along u and v the neighbours are that a gradient reads: where rays are closer than a voxel, as
    /// many as make about one. Absent where they are nowhere closer, and neighbours are the next rays.
    pub reach: Option<Vec<u32>>,
    /// By depth, min(j·m, 1), a fraction of [`GradientScale::FACTOR_BITS`]: what the difference along the ray is multiplied with.
    /// Absent where m is never below 1.
    pub nearness: Option<Vec<u32>>,
}

impl RayRegisters {
    /// Fraction bits of slopes and closeness.
    pub const SLOPE_BITS: u32 = 15;
    /// Right shift from a squared length to its class.
    pub const CLASS_SHIFT: u32 = 12;
    /// Most classes of step lengths.
    pub const MOST_CLASSES: u32 = 16;
}

/// The classification tables.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Classification {
    /// Samples outside of these words, inclusive, are transparent.
    pub threshold: [u32; 2],
    /// Right shift from a sample to the table's index.
    pub index_shift: u32,
    /// Opacity over the index, unit words of `opacity_bits`; for a two-dimensional table the rows of the
    /// gradient's index follow each other, each of `colour.len()` entries. In perspective there is such a table for each
    /// class of step lengths; and one for each length that the ends of rays may stand for, where they have parts of their own.
    pub opacity: Vec<u32>,
    /// Colour over the index, unit words of `colour_bits`.
    pub colour: Vec<[u32; 3]>,
    /// For a two-dimensional table: how the gradient's magnitude becomes a row.
    pub gradient_rows: Option<GradientRows>,
}

/// Rows of a two-dimensional opacity table: row = min(magnitude >> shift, rows − 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GradientRows {
    /// Right shift of the magnitude.
    pub shift: u32,
    /// How many rows.
    pub rows: u32,
}

/// Registers of the gradient unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GradientRegisters {
    /// Which samples are read.
    pub method: GradientMethod,
    /// Along u and v, fractions of the weight bits: du and dv for 12, 6d and 26d; the foot of the perpendicular
    /// for 10. Closed range [0, 1].
    pub weights: [u32; 2],
    /// Factors of the three components, absent where all are 1.
    pub scale: Option<GradientScale>,
    /// The value of samples beyond the volume's border.
    pub border: i32,
}

/// Factors of the gradient's components: voxels that are not cubes, and estimators whose differences are taken over
/// different lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GradientScale {
    /// Fractions of [`GradientScale::FACTOR_BITS`], 0 to 1.
    pub factors: [u32; 3],
    /// Bits of the products that the components keep below the gradient's word, so that a small factor does not lose them:
    /// at most [`GradientScale::FACTOR_BITS`], and what [`GradientScale::room`] leaves.
    pub kept_bits: u32,
}

impl GradientScale {
    /// Fraction bits of a factor.
    pub const FACTOR_BITS: u32 = 16;

    /// Bits that a difference of a method leaves of 31.
    pub fn room(method: GradientMethod, words: &Words) -> u32 {
        30 - (words.sample_bits() + method.row().difference_bits())
    }
}

/// The normaliser's table of reciprocal roots.
///
/// A block-normalised gradient of `normal_bits` B has a squared length of `2^(2B−2)` to below `3·2^(2B)`; entry i is
/// `2^(2B−1) / √m²` at the middle of the i-th bin of `2^(2B−2−root_bits)`, at most `2^B`.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Normaliser {
    /// `11·2^root_bits` entries.
    pub root: Vec<u32>,
    /// Index bits of the table.
    pub root_bits: u32,
}

impl Normaliser {
    /// Entries of a table with so many index bits.
    pub fn entries(root_bits: u32) -> u64 {
        11 << root_bits
    }

    /// The table for components of `normal_bits`.
    pub fn new(normal_bits: u32, root_bits: u32) -> Normaliser {
        let bin = f64::from(1_u32 << (2 * normal_bits - 2 - root_bits));
        let top = f64::from(1_u32 << (2 * normal_bits - 1));
        let root = (1_u32 << root_bits..12 << root_bits)
            .map(|index| (top / ((f64::from(index) + 0.5) * bin).sqrt()).round() as u32)
            .map(|root| root.min(1 << normal_bits))
            .collect();
        Normaliser { root, root_bits }
    }
}

/// Registers and tables of the shading unit.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Shading {
    /// Normalised gradient and Phong's formula.
    Phong(Phong),
    /// A table over the gradient's direction.
    Table(ReflectanceTable),
}

/// Integer Phong. Intensities are fractions of `colour_bits` (1 is `2^colour_bits`, below 16); directions are
/// fractions of `normal_bits − 1`, against the gradient, in its frame.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Phong {
    /// Ambient intensity.
    pub ambient: u32,
    /// Lit from both sides.
    pub two_sided: bool,
    /// The lights.
    pub lights: Vec<PhongLight>,
    /// x^shininess over the unit interval, `2^power_bits + 1` entries, fractions of `colour_bits`.
    pub power: Vec<u32>,
    /// Index bits of the power table.
    pub power_bits: u32,
}

impl Phong {
    /// Largest intensity.
    pub const MOST_INTENSITY: u32 = 15;

    /// The table of powers for an exponent.
    pub fn powers(shininess: f64, power_bits: u32, colour_bits: u32) -> Vec<u32> {
        let steps = f64::from(1_u32 << power_bits);
        let one = f64::from(1_u32 << colour_bits);
        (0..=1_u32 << power_bits).map(|i| (libm::pow(f64::from(i) / steps, shininess) * one).round() as u32).collect()
    }
}

/// One light of the Phong unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PhongLight {
    /// Towards the light, negated (the surface's normal is against the gradient).
    pub direction: [i32; 3],
    /// Halfway between light and eye, likewise.
    pub halfway: [i32; 3],
    /// Diffuse intensity of red, green, blue.
    pub diffuse: [u32; 3],
    /// Specular intensity, on the scale of a unit colour word.
    pub specular: [u32; 3],
}

/// A reflectance table: six faces of a cube, each `2^bits` squared.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReflectanceTable {
    /// Bits of each coordinate on a face.
    pub bits: u32,
    /// Ambient and diffuse intensity that multiplies the colour, fractions of `colour_bits`, over the direction.
    pub diffuse: Vec<[u32; 3]>,
    /// Specular intensity that is added, on the scale of a unit colour word.
    pub specular: Vec<[u32; 3]>,
    /// Intensity of a sample without a gradient.
    pub flat: u32,
}

/// Registers of the cone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConeRegisters {
    /// What the nodes do.
    pub mode: Mode,
    /// In which order.
    pub order: ConeOrder,
    /// Leaves: a ray of more samples is reduced in chunks of this many, and the chunks in order.
    pub leaves: usize,
    /// Opacity, unit word of `opacity_bits` above 0, from which a sample is opaque.
    pub opaque: u32,
    /// Weight of the weighted sum, a fraction of [`ConeRegisters::WEIGHT_BITS`], at most 1.
    pub sum_weight: u64,
}

impl ConeRegisters {
    /// Fraction bits of the weighted sum's weight.
    pub const WEIGHT_BITS: u32 = 32;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entry i of a table without a gap between its bins is that of the squared length i itself.
    #[test]
    fn the_shortest_normals_have_a_table_as_fine_as_their_squares() {
        let table = Normaliser::new(4, 6);
        assert_eq!((table.root_bits, table.root.len()), (6, 11 << 6));
        let entry = |square: usize| (128.0 / (square as f64 + 0.5).sqrt()).round() as u32;
        assert!(table.root.iter().enumerate().all(|(i, &root)| root == entry(i + 64).min(16)));
    }
}
