//! Tests of the command and its library from outside, one module each.

mod cli;
mod file_volumes;
mod labels;
mod lengths;
mod memory;
mod opacity_tables;
mod sequence;
mod stops;
mod word_lengths;
