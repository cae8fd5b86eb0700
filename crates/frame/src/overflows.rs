//! Words that did not hold what was put into them.

/// Words that were saturated, by wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overflows {
    /// Gradient components and lit colours of samples that are not transparent.
    pub shading: u64,
    /// Pixels of a weighted sum.
    pub pixel: u64,
}

impl Overflows {
    /// Those of two runs together.
    pub fn plus(self, other: Overflows) -> Overflows {
        Overflows { shading: self.shading + other.shading, pixel: self.pixel + other.pixel }
    }
}
