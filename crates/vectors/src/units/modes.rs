//! The port of the cone's mode, and what its nodes never hold.

use crate::UnitFormat;
use cube3_word::unit_full;

/// The mode's port: [`cube3_scene::Mode::code`].
pub const MODE: crate::Port = crate::Port::unsigned(
    "mode",
    "3",
    "0 composite, 1 first-opaque, 2 last-opaque, 3 maximum, 4 minimum, 5 weighted-sum",
)
.within("0", "5");

/// A node that the cone can hold: nothing is all 0, opacity is at most full but in a weighted sum, and a colour weighted with its
/// opacity does not exceed it.
pub fn legal(format: &UnitFormat, mode: i128, present: i128, sample: &mut i128, rgba: &mut [i128]) {
    if present == 0 {
        *sample = 0;
        rgba.fill(0);
    }
    let full = i128::from(unit_full(format.words.accumulator_bits));
    // Too large a value becomes the largest legal one where it is the largest of its port, else any.
    let held = |value: i128, most: i128| match value {
        _ if value <= most => value,
        _ if value >= 2048 * full || value == full => most,
        _ => value % (most + 1),
    };
    if mode != 5 {
        rgba[3] = held(rgba[3], full);
    }
    for i in 0..3 {
        rgba[i] = held(rgba[i], rgba[3]);
    }
}
