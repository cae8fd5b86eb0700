//! Tests of `cube3-study` from outside, one module each.

mod stress;
mod word_lengths;
