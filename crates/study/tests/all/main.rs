//! Tests of `cube3-study` from outside, one module each.

mod word_lengths;
