//! Tests of `cube3-reference` from outside, one module each.

mod common;
mod convergence;
mod extremes;
mod from_the_book;
mod invariance;
mod labels;
mod lengths;
mod modes;
mod perspective;
mod preintegration;
mod sampling;
