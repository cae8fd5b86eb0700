//! Tests of `cube3-scene` from outside, one module each.

mod parameters;
mod toml_files;
