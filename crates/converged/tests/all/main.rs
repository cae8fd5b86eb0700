//! Tests of `cube3-converged` from outside, one module each.

mod bound;
mod enclosure;
mod fifty_digits;
mod nasty;
mod scenes;
