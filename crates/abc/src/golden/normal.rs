//! The direction and the length of a gradient.

use super::counted::show;
use cube3_frame::Normaliser;
use cube3_word::{Probe, Words};

/// A normalised gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Normal {
    /// Direction, fractions of `normal_bits − 1`, −1 to 1 inclusive; all 0 where the gradient is.
    pub direction: [i32; 3],
    /// Length of the gradient, in its own words.
    pub magnitude: u32,
}

/// Normalises a gradient: a block shift brings its largest component to `normal_bits` B, and a table of reciprocal
/// roots over the squared length, `2^(2B−2)` to `3·2^(2B)`, does the rest. Odd in every component.
pub fn normalise(gradient: [i32; 3], table: &Normaliser, words: &Words) -> Normal {
    normalise_wires(gradient, table, words, &mut ())
}

/// [`normalise`], and what its wires carry.
pub fn normalise_wires(gradient: [i32; 3], table: &Normaliser, words: &Words, probe: &mut impl Probe) -> Normal {
    let bits = words.normal_bits;
    let sizes = gradient.map(i32::unsigned_abs);
    let largest = sizes[0] | sizes[1] | sizes[2];
    show(probe, "size", sizes);
    if largest == 0 {
        return Normal { direction: [0; 3], magnitude: 0 };
    }
    let zeros = largest.leading_zeros();
    let block = sizes.map(|size| (size << zeros) >> (32 - bits));
    let square: u32 = block.iter().map(|a| a * a).sum();
    let index = (square >> (2 * bits - 2 - table.root_bits)) - (1 << table.root_bits);
    let reciprocal = table.root[index as usize];
    let one = 1 << (bits - 1);
    let products = block.map(|a| a * reciprocal);
    let rounded = products.map(|product| (product + (1 << (bits - 1))) >> bits);
    let unit = rounded.map(|component| component.min(one));
    let direction = [0, 1, 2].map(|i| if gradient[i] < 0 { -(unit[i] as i32) } else { unit[i] as i32 });
    let length: u64 = (0..3).map(|i| u64::from(block[i]) * u64::from(unit[i])).sum();
    let magnitude = magnitude(length, zeros, bits);
    probe.wire("highest", 0, (31 - zeros).into());
    show(probe, "block", block);
    probe.wire("square", 0, square.into());
    probe.wire("index", 0, index.into());
    probe.wire("reciprocal", 0, reciprocal.into());
    show(probe, "product", products);
    show(probe, "rounded", rounded);
    show(probe, "unit", unit);
    show(probe, "direction", direction);
    probe.wire("length", 0, length.into());
    probe.wire("aligned", 0, (length << (31 - zeros)).into());
    probe.wire("magnitude", 0, magnitude.into());
    Normal { direction, magnitude }
}

/// The product of block and direction in the gradient's words: the block was shifted left by `zeros + bits − 32`, and the
/// direction has a fraction of `bits − 1`. A gradient of 31 bits has 1 zero; with 4 `bits` that is 24 bits to the left.
#[inline(always)]
pub(crate) fn magnitude(length: u64, zeros: u32, bits: u32) -> u32 {
    let back = zeros + 2 * bits - 9;
    (((length << 24) + (1 << back >> 1)) >> back) as u32
}

/// The entry of a reflectance table for a gradient's direction: the face of its largest component (u before v before w
/// where equal), and the others divided by that one. None where there is no direction.
pub fn direction_index(gradient: [i32; 3], bits: u32) -> Option<usize> {
    direction_index_wires(gradient, bits, &mut ())
}

/// [`direction_index`], and what its wires carry.
pub fn direction_index_wires(gradient: [i32; 3], bits: u32, probe: &mut impl Probe) -> Option<usize> {
    let sizes = gradient.map(i32::unsigned_abs);
    let largest = sizes[0].max(sizes[1]).max(sizes[2]);
    show(probe, "size", sizes);
    probe.wire("largest", 0, largest.into());
    if largest == 0 {
        return None;
    }
    let axis = sizes.iter().position(|&size| size == largest)?;
    let half = 1_u32 << (bits - 1);
    let others = [(axis + 1) % 3, (axis + 2) % 3];
    let dividends = others.map(|axis| u64::from(sizes[axis]) << (bits - 1));
    let quotients = dividends.map(|dividend| (dividend / u64::from(largest)) as u32);
    let held = quotients.map(|quotient| quotient.min(half - 1));
    let coordinate = |held: u32, axis: usize| if gradient[axis] < 0 { half - 1 - held } else { half + held };
    let [first, second] = [0, 1].map(|i| coordinate(held[i], others[i]));
    let face = 2 * axis as u32 + u32::from(gradient[axis] < 0);
    let entry = (face << bits | second) << bits | first;
    probe.wire("face", 0, face.into());
    show(probe, "dividend", dividends);
    show(probe, "quotient", quotients);
    show(probe, "held", held);
    show(probe, "coordinate", [first, second]);
    probe.wire("entry", 0, entry.into());
    Some(entry as usize)
}
