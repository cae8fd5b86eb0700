//! Tests of `cube3-method` from outside, one module each.

mod cache;
mod table;
