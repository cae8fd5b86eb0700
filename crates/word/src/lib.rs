//! Fixed-point words: rounding, saturation, interpolation; every bit-exact operation of the machine.
//!
//! Three kinds of word occur in Cube-3:
//!
//! - **integers**, signed or not, that saturate at their width: samples, gradients;
//! - **fractions** of `f` bits that stand for `raw / 2^f`, the closed range [0, 1] included: weights;
//! - **unit words** of `b` bits that stand for `raw / (2^b − 1)`, so that both 0 and 1 are exact:
//!   opacity and colour. That a full opacity hides *everything* and a zero one *nothing*, to the bit,
//!   is what lets a plan leave samples out.
//!
//! The functions here are the definition; units and their vectorised lanes are built from them.

mod formats;
mod lanes;
mod probe;
mod rounding;
mod unit;
mod unit_lanes;

pub use formats::{Length, WordError, Words};
pub use lanes::{BLOCK_LANES, LaneBlock, LerpLanes, block, put_block, turn, vectorised};
pub use probe::Probe;
pub use rounding::{Rounding, Shift, lerp, lerp_wires, saturate};
pub use unit::{quantise_fraction, quantise_unit, unit_full, unit_mul, unit_mul_wires, unit_resize};
pub use unit_lanes::{UnitMul, UnitResize};
