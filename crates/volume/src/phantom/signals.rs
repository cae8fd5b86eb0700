//! Phantoms that are a function of position and no body: Marschner-Lobb, fog, checker.

use std::f64::consts::PI;

use super::PhantomParams;
use crate::{Volume, VolumeError};

/// The test signal of Marschner and Lobb 1994, equation (3), point-sampled on [−1, 1]³ with the first
/// and the last voxel at the ends, in f32 from 0 to 1:
///
/// ρ(x,y,z) = (1 − sin(πz/2) + α·(1 + ρᵣ(√(x²+y²)))) / (2·(1+α)),  ρᵣ(r) = cos(2π·f_M·cos(πr/2)),
///
/// α = 0.25 and f_M = 6. No filter: up to about 41³ voxels the sampling itself is the test.
pub(super) fn marschner_lobb(size: usize) -> Result<Volume, VolumeError> {
    const ALPHA: f64 = 0.25;
    const FREQUENCY: f64 = 6.0;
    let place = |i: usize| if size > 1 { 2.0 * i as f64 / (size as f64 - 1.0) - 1.0 } else { 0.0 };
    Volume::from_fn([size; 3], [1.0; 3], |x, y, z| {
        let (x, y, z) = (place(x), place(y), place(z));
        let ripple = (2.0 * PI * FREQUENCY * (PI * x.hypot(y) / 2.0).cos()).cos();
        ((1.0 - (PI * z / 2.0).sin() + ALPHA * (1.0 + ripple)) / (2.0 * (1.0 + ALPHA))) as f32
    })
}

/// A smooth field of low density, u16: with p in [−1, 1]³ over the voxel centres' cells,
///
/// value = 6553.5·w(px)·w(py)·w(pz)·(1 + ½·cos(2π·px)·cos(3π·py)·cos(2π·pz))/1.5,  w(t) = cos²(πt/2),
///
/// which is 0 with its gradient at the cube's faces and at most a tenth of full scale. Point-sampled:
/// its shortest wave is 2/3 of the cube's side, so no filter is needed.
pub(super) fn fog(size: usize) -> Result<Volume, VolumeError> {
    let place = |i: usize| (2 * i + 1) as f64 / size as f64 - 1.0;
    let window = |t: f64| (PI * t / 2.0).cos().powi(2);
    Volume::from_fn([size; 3], [1.0; 3], |x, y, z| {
        let (x, y, z) = (place(x), place(y), place(z));
        let waves = (2.0 * PI * x).cos() * (3.0 * PI * y).cos() * (2.0 * PI * z).cos();
        let density = window(x) * window(y) * window(z) * (1.0 + 0.5 * waves) / 1.5;
        (6553.5 * density).round() as u16
    })
}

/// Blocks of `period` voxels a side (default 8), 0 and 65535 in turn, 0 in the first: value =
/// 65535·((⌊x/period⌋ + ⌊y/period⌋ + ⌊z/period⌋) mod 2). No filter: the hard edge is the purpose.
pub(super) fn checker(size: usize, params: &PhantomParams) -> Result<Volume, VolumeError> {
    let period = params.period.unwrap_or(8);
    if period == 0 {
        return Err(VolumeError::Parameter {
            name: "period",
            reason: "blocks of 0 voxels".to_owned(),
            remedy: "give at least 1",
        });
    }
    Volume::from_fn(
        [size; 3],
        [1.0; 3],
        |x, y, z| {
            if (x / period + y / period + z / period) % 2 == 1 { u16::MAX } else { 0 }
        },
    )
}
