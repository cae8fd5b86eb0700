//! Tests of `cube3-twin` from outside, one module each.

mod agreement;
mod basis;
mod common;
mod convergence;
mod ct_head;
mod extremes;
mod eye;
mod eye_rays;
mod gradients;
mod interpolation;
mod invariance;
mod labels;
mod lengths;
mod modes;
