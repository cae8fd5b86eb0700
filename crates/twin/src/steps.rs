//! Where sample k of every ray lies: the one thing in which true and sheared interpolation differ.

use cube3_frame::Geometry;
use cube3_machine::TemplateRule;

/// Which eight voxels a sample of a discrete ray is interpolated from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SampleCell {
    /// The exact 8-neighbourhood of the sample's position: True3D.
    Exact,
    /// The sheared cell, four voxels of plane k and four of plane k+1 on the same discrete rays: Sheared3D.
    Sheared,
}

/// The cell of sample k, relative to its ray: the same for all rays of a parallel view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// The two planes of voxels; the same where the offset is 0.
    pub planes: [usize; 2],
    /// Column of the cell's corner in each plane, from the ray's u.
    pub columns: [usize; 2],
    /// Row of the cell's corner in each plane, from the ray's v.
    pub rows: [usize; 2],
    /// Weights along u, v, w.
    pub weights: [f64; 3],
}

/// The step of every sample, in reals: exactly the registers' slopes and offset, no rounding of weights.
///
/// Of a label volume a sample is its nearest voxel, in either cell, and all weights are 0. In the sheared cell `w_u = p_u − lerp(X(k), X(k+1), o)` (design, section 3). The last sample has no far plane; it is
/// given the near one again and, with an offset above 0, is in no ray's valid set.
pub(crate) fn steps(geometry: &Geometry, interpolation: SampleCell) -> Vec<Step> {
    let offset = geometry.real_offset();
    let depth = geometry.size[2];
    let slopes = geometry.real_slopes();
    let templates = [&geometry.u, &geometry.v];
    let step = |k: usize| {
        let far = if geometry.offset == 0 { k } else { (k + 1).min(depth - 1) };
        let axis = |i: usize| {
            let moved = (k as f64 + offset) * slopes[i];
            match (geometry.rule, interpolation) {
                (TemplateRule::Nearest, _) => ([(moved + 0.5).floor() as usize; 2], 0.0),
                (_, SampleCell::Exact) => {
                    let column = moved.floor();
                    ([column as usize; 2], moved - column)
                }
                (_, SampleCell::Sheared) => {
                    let columns = [templates[i].columns[k], templates[i].columns[far]];
                    let left = f64::from(columns[0]) + offset * f64::from(columns[1] - columns[0]);
                    (columns.map(|column| column as usize), moved - left)
                }
            }
        };
        let ((columns, along_u), (rows, along_v)) = (axis(0), axis(1));
        Step { planes: [k, far], columns, rows, weights: [along_u, along_v, offset] }
    };
    (0..depth).map(step).collect()
}
