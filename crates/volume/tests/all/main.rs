//! Tests of `cube3-volume` from outside, one module each.

mod any_bytes;
mod common;
mod directions;
mod foreign_files;
mod header_options;
mod labels;
mod others;
mod outside_readers;
mod outside_writers;
mod phantoms;
mod real_data;
mod refusals;
mod resampling;
mod several_blocks;
mod words;
mod writers;
