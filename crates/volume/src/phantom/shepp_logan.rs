//! The Shepp-Logan head in three dimensions.

use crate::{Volume, VolumeError};

/// One ellipsoid: density, half axes, centre, turn about z in degrees.
struct Ellipsoid(f64, [f64; 3], [f64; 3], f64);

/// The ten ellipsoids with the contrast of Toft 1996 ("modified Shepp-Logan") and the third axes of
/// Schabel's `phantom3d` for MATLAB (2006), on [−1, 1]³. Densities add up.
const ELLIPSOIDS: [Ellipsoid; 10] = [
    Ellipsoid(1.0, [0.69, 0.92, 0.81], [0.0, 0.0, 0.0], 0.0),
    Ellipsoid(-0.8, [0.6624, 0.874, 0.78], [0.0, -0.0184, 0.0], 0.0),
    Ellipsoid(-0.2, [0.11, 0.31, 0.22], [0.22, 0.0, 0.0], -18.0),
    Ellipsoid(-0.2, [0.16, 0.41, 0.28], [-0.22, 0.0, 0.0], 18.0),
    Ellipsoid(0.1, [0.21, 0.25, 0.41], [0.0, 0.35, -0.15], 0.0),
    Ellipsoid(0.1, [0.046, 0.046, 0.05], [0.0, 0.1, 0.25], 0.0),
    Ellipsoid(0.1, [0.046, 0.046, 0.05], [0.0, -0.1, 0.25], 0.0),
    Ellipsoid(0.1, [0.046, 0.023, 0.05], [-0.08, -0.605, 0.0], 0.0),
    Ellipsoid(0.1, [0.023, 0.023, 0.02], [0.0, -0.606, 0.0], 0.0),
    Ellipsoid(0.1, [0.023, 0.046, 0.02], [0.06, -0.605, 0.0], 0.0),
];

/// Points along each side of a voxel.
const POINTS: usize = 3;

/// The phantom as u16, value = 65535·density, density 0 to 1. Each voxel is the mean of 3×3×3 points
/// in it (a box filter); voxel i covers [2i/n − 1, 2(i+1)/n − 1].
pub(super) fn shepp_logan(size: usize) -> Result<Volume, VolumeError> {
    let turned: Vec<(&Ellipsoid, f64, f64)> =
        ELLIPSOIDS.iter().map(|e| (e, e.3.to_radians().cos(), e.3.to_radians().sin())).collect();
    let density = |p: [f64; 3]| -> f64 {
        let inside = |(Ellipsoid(density, axes, centre, _), c, s): &(&Ellipsoid, f64, f64)| {
            let [x, y, z] = [0, 1, 2].map(|a| p[a] - centre[a]);
            let q = [(c * x + s * y) / axes[0], (c * y - s * x) / axes[1], z / axes[2]];
            if q[0] * q[0] + q[1] * q[1] + q[2] * q[2] <= 1.0 { *density } else { 0.0 }
        };
        turned.iter().map(inside).sum()
    };
    let cell = 2.0 / size as f64;
    let point = |i: usize, k: usize| (i as f64 + (k as f64 + 0.5) / POINTS as f64) * cell - 1.0;
    Volume::from_fn([size; 3], [1.0; 3], |x, y, z| {
        let mut sum = 0.0;
        for k in 0..POINTS {
            for j in 0..POINTS {
                for i in 0..POINTS {
                    sum += density([point(x, i), point(y, j), point(z, k)]);
                }
            }
        }
        (sum / (POINTS * POINTS * POINTS) as f64 * f64::from(u16::MAX)).round() as u16
    })
}
