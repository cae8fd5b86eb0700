//! The base plane and the canonical octant of a view.

use cube3_frame::Axes;
use glam::DVec3;

/// The canonical view: axes, and the slopes du and dv in voxels of u and v for each voxel of w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CanonicalView {
    /// Which axis is which.
    pub axes: Axes,
    /// du and dv: 1 ≥ du ≥ dv ≥ 0.
    pub slopes: [f64; 2],
}

/// Brings a view direction (world, from the eye into the scene) to the canonical octant.
///
/// The major axis w is the one along which the direction, in voxels, is largest; u is the next. Ties go to
/// z before y before x. `spacing` is the size of a voxel. The direction must be finite and not zero.
pub fn canonical(direction: DVec3, spacing: [f64; 3]) -> CanonicalView {
    let in_voxels = [direction.x / spacing[0], direction.y / spacing[1], direction.z / spacing[2]];
    let mut order = [2, 1, 0];
    order.sort_by(|&a: &usize, &b: &usize| in_voxels[b].abs().total_cmp(&in_voxels[a].abs()));
    let [w, u, v] = order;
    let axis = [u, v, w];
    let slope = |a: usize| (in_voxels[a] / in_voxels[w]).abs();
    CanonicalView { axes: Axes { axis, reversed: axis.map(|a| in_voxels[a] < 0.0) }, slopes: [slope(u), slope(v)] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_go_to_z_before_y_before_x() {
        let view = canonical(DVec3::new(1.0, 1.0, 1.0), [1.0; 3]);
        assert_eq!(view.axes.axis, [1, 0, 2]);
        let view = canonical(DVec3::new(-1.0, 1.0, 0.0), [1.0; 3]);
        assert_eq!((view.axes.axis, view.axes.reversed), ([0, 2, 1], [true, false, false]));
    }

    #[test]
    fn spacing_is_folded_in_before_the_major_axis_is_chosen() {
        let view = canonical(DVec3::new(0.0, 0.9, 1.0), [1.0, 1.0, 2.0]);
        assert_eq!(view.axes.axis, [2, 0, 1]);
        assert!((view.slopes[0] - 0.5 / 0.9).abs() < 1e-15);
    }
}
