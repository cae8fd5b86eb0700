//! Tests of `cube3-report` from outside, one module each.

mod check;
mod drawing;
mod follows;
mod headline;
mod json;
mod no_object;
mod page;
mod png;
mod sample;
mod schema;
mod sequence;
mod text;
