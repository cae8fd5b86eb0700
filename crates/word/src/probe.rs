//! Looking at the wires of a unit while its arithmetic is evaluated.

/// Sees the value of every wire of a definition as it is evaluated: for vectors, proofs of range and the account of a mismatch.
///
/// `()` sees nothing and costs nothing.
pub trait Probe {
    /// A value on a wire; `place` counts wires of one name from 0.
    fn wire(&mut self, name: &'static str, place: usize, value: i128);

    /// Evaluates a part, whose wires belong to it: the `place`-th of its name.
    fn within<R>(&mut self, part: &'static str, place: usize, work: impl FnOnce(&mut Self) -> R) -> R;
}

impl Probe for () {
    #[inline(always)]
    fn wire(&mut self, _: &'static str, _: usize, _: i128) {}

    #[inline(always)]
    fn within<R>(&mut self, _: &'static str, _: usize, work: impl FnOnce(&mut Self) -> R) -> R {
        work(self)
    }
}
