//! What a frame derives from its registers: columns and weights, places, half-spaces, factors, classes. Exact integers; the definition.

pub(crate) mod template;

pub use template::largest_offset;

use crate::bits::PLACE_BITS;
use crate::fan::FanShape;
use crate::{Geometry, GradientScale, HalfSpace, Linear, LinearFactor, RayRegisters, SLOPE_FRACTION_BITS};
use cube3_machine::{RaySlots, TemplateRule};
use cube3_word::{Probe, quantise_fraction};

impl FanShape {
    /// The position of a sample, a fraction of slope and weight bits.
    pub(crate) fn position(&self, start: i64, slope: i64, k: usize) -> i64 {
        let steps = ((k as i64 - self.first_depth as i64) << self.weight_bits) + i64::from(self.offset);
        (start << self.weight_bits) + steps * slope
    }

    /// The position of a ray at a plane, a fraction of slope bits.
    pub(crate) fn at_plane(&self, start: i64, slope: i64, k: usize) -> i64 {
        start + (k as i64 - self.first_depth as i64) * slope
    }

    /// The column of a ray at a depth from the first on: its floor at the sample or at the plane, or the nearest.
    pub(crate) fn column(&self, start: i64, slope: i64, k: usize) -> i32 {
        let column = match self.rule {
            TemplateRule::SampleFloor => self.position(start, slope, k) >> (SLOPE_FRACTION_BITS + self.weight_bits),
            TemplateRule::PlaneFloor => self.at_plane(start, slope, k) >> SLOPE_FRACTION_BITS,
            TemplateRule::Nearest => {
                (self.at_plane(start, slope, k) + (1 << (SLOPE_FRACTION_BITS - 1))) >> SLOPE_FRACTION_BITS
            }
        };
        column as i32
    }

    /// `lerp(near, far, o)`, a fraction of the weight bits.
    pub(crate) fn between(&self, near: i32, far: i32) -> i64 {
        (i64::from(near) << self.weight_bits) + i64::from(far - near) * i64::from(self.offset)
    }

    /// The weight of a position between a left and a right edge, rounded to nearest; none where the left one is the nearest voxel.
    pub(crate) fn weight(&self, position: i64, left: i64, right: i64) -> u32 {
        if self.rule == TemplateRule::Nearest {
            return 0;
        }
        let part = position - (left << SLOPE_FRACTION_BITS);
        let whole = right - left;
        ((part << self.weight_bits) + (whole << (SLOPE_FRACTION_BITS - 1))).div_euclid(whole << SLOPE_FRACTION_BITS)
            as u32
    }
}

impl Geometry {
    /// The ray whose voxel is in a slot, along one axis: the slots of a plane are its rays, shifted by the column and, where they are shared, round the volume.
    pub(crate) fn ray_in(&self, slot: usize, n: usize, column: u32, shear: usize) -> i64 {
        match self.slots {
            RaySlots::Wrapped => slot as i64 - ((slot + column as usize) / n * n) as i64,
            RaySlots::Padded => slot as i64 - shear as i64,
        }
    }
}

impl Linear {
    /// The value at a sample.
    #[inline(always)]
    pub fn at(&self, u: i64, v: i64, k: i64) -> i64 {
        self.at_wires(u, v, k, &mut ())
    }

    /// [`Linear::at`], and what its wires carry.
    #[inline(always)]
    pub fn at_wires(&self, u: i64, v: i64, k: i64, probe: &mut impl Probe) -> i64 {
        let products = [self.u * u, self.v * v, self.k * k];
        let value = products[0] + products[1] + products[2] + self.constant;
        for (i, product) in products.into_iter().enumerate() {
            probe.wire("product", i, product.into());
        }
        probe.wire("value", 0, value.into());
        value
    }

    /// The value at a place of a perspective frame, whose coordinates are fractions of [`PLACE_BITS`].
    #[inline(always)]
    pub fn at_place(&self, [u, v, w]: [i64; 3]) -> i64 {
        ((self.u * u + self.v * v + self.k * w) >> PLACE_BITS) + self.constant
    }
}

impl HalfSpace {
    /// Of the rays `from` to `to`, the end not included, those whose sample `k` in plane `v` of a parallel frame is inside: the whole
    /// row at once. Where there are none, the end is not above the start.
    pub fn interval(&self, v: i64, k: i64, [from, to]: [i64; 2]) -> [i64; 2] {
        let step = self.distance.u;
        let at_zero = self.distance.at(0, v, k);
        match step.signum() {
            1 => [from.max(-at_zero.div_euclid(step)), to],
            -1 => [from, to.min(at_zero.div_euclid(-step) + 1)],
            _ if at_zero < 0 => [from, from],
            _ => [from, to],
        }
    }
}

impl LinearFactor {
    /// The factor word at a sample, for the value of the linear function: 0 to `2^WORD_BITS`.
    #[inline(always)]
    pub fn word(value: i64) -> u32 {
        let clamped = value.clamp(0, 1 << Self::FRACTION_BITS);
        (clamped >> (Self::FRACTION_BITS - Self::WORD_BITS)) as u32
    }
}

impl RayRegisters {
    /// The register for a ray's slope, which is a fraction of [`SLOPE_FRACTION_BITS`]: its size, at most 2.
    pub fn slope_register(slope: i64) -> u32 {
        let twice = slope.unsigned_abs() >> (SLOPE_FRACTION_BITS - Self::SLOPE_BITS - 1);
        twice.div_ceil(2).min(2 << Self::SLOPE_BITS) as u32
    }

    /// The registers for closeness and nearness where neighbours along u and v are so far from each other, in voxels.
    pub fn closeness_registers(spacing: f64) -> [u32; 2] {
        let closeness = quantise_fraction(1.0 / spacing.max(1.0), Self::SLOPE_BITS);
        [closeness, quantise_fraction(spacing, GradientScale::FACTOR_BITS)]
    }

    /// The class of the step length of the ray in a slot.
    #[inline]
    pub fn length_class(&self, row: usize, column: usize) -> u32 {
        (self.length_u[column] + self.length_v[row]) >> Self::CLASS_SHIFT
    }

    /// How far a ray of a slope moves from a plane to the next, in units of the distance to its neighbours on the plane: a fraction of
    /// `weight_bits`, at most 1.
    #[inline(always)]
    pub fn shear(slope: u32, closeness: u32, weight_bits: u32) -> u32 {
        let bits = 2 * Self::SLOPE_BITS - weight_bits;
        ((slope * closeness + (1 << (bits - 1))) >> bits).min(1 << weight_bits)
    }
}
