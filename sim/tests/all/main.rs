//! Tests of the command from outside, one module each.

mod checked;
mod cli;
mod file_volumes;
mod memory;
mod methods;
mod report;
mod sequence;
mod stops;
mod stress;
