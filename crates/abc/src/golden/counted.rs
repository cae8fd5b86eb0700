//! Words that count what was saturated, and what the parts of a sample's way share.

use cube3_word::Probe;

/// The sample and its 26 neighbours, `[w][v][u]` with the sample itself at `[1][1][1]`: w along the ray, v from
/// plane to plane, u from ray to ray, in near frames [`FrameSetup::reach`](cube3_frame::FrameSetup::reach) of them away. Samples beyond the volume are the border word.
pub type Neighbourhood = [[[i32; 3]; 3]; 3];

/// Something with the number of words that overflowed and were saturated on the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted<T> {
    /// The value.
    pub value: T,
    /// Saturated words.
    pub overflows: u32,
}

/// Counts the words that were saturated.
pub(super) fn counted<T>(words: [(T, bool); 3]) -> Counted<[T; 3]> {
    let overflows = words.iter().map(|(_, saturated)| u32::from(*saturated)).sum();
    Counted { value: words.map(|(word, _)| word), overflows }
}

/// Shows a row of wires.
pub(super) fn show<T: Into<i128>>(probe: &mut impl Probe, name: &'static str, values: impl IntoIterator<Item = T>) {
    for (place, value) in values.into_iter().enumerate() {
        probe.wire(name, place, value.into());
    }
}
