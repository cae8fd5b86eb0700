//! The rays of the picture's pixels.

use crate::span::{Drawn, ON_FACE};
use cube3_scene::ImagePlane;
use glam::DVec3;

/// The axis nearest to the view: the one along which its direction, in voxels, is largest; z before y before x.
pub fn nearest_axis(direction: DVec3, spacing: [f64; 3]) -> usize {
    let steps = [0, 1, 2].map(|axis| (direction[axis] / spacing[axis]).abs());
    let nearer = |best: usize, axis: usize| if steps[axis] > steps[best] { axis } else { best };
    nearer(nearer(2, 1), 0)
}

/// A ray in voxels; its parameter counts the smallest voxel spacing.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// A point of it near the volume, so that the digits are there where the samples are.
    pub origin: [f64; 3],
    /// Voxels along x, y, z for one of the parameter.
    pub direction: [f64; 3],
    /// The parameter of the eye; −∞ in a parallel view.
    pub eye: f64,
    /// The direction in the world, of unit length.
    pub world_direction: DVec3,
}

impl Line {
    /// The ray of the pixel in a column and a row, through voxels of `spacing`, of which the `smallest` is given.
    pub fn of_pixel(plane: &ImagePlane, [column, row]: [usize; 2], spacing: [f64; 3], smallest: f64) -> Line {
        let (column, row) = (column as f64, row as f64);
        let point = plane.crossing(column, row);
        let (world_direction, eye) = match plane.eye {
            None => (plane.direction, f64::NEG_INFINITY),
            Some(_) => {
                let (_, ray) = plane.ray(column, row);
                let length = ray.length();
                (ray / length, -plane.depth * length / smallest)
            }
        };
        Line {
            origin: [0, 1, 2].map(|i| point[i] / spacing[i]),
            direction: [0, 1, 2].map(|i| world_direction[i] / (spacing[i] / smallest)),
            eye,
            world_direction,
        }
    }

    /// Parameters at which the ray enters what is drawn, or begins in it, and leaves it.
    pub fn span(&self, drawn: &Drawn) -> Option<[f64; 2]> {
        let [enter, leave] = drawn.span(self.origin, self.direction)?;
        if self.eye > leave + ON_FACE {
            return None;
        }
        // An eye on a face that looks away still sees the face.
        Some([enter.max(self.eye.min(leave)), leave])
    }

    /// The point at a parameter, held to the box, which reaches `margin` beyond the voxel centres.
    #[inline(always)]
    pub(crate) fn at(&self, parameter: f64, dims: [usize; 3], margin: f64) -> [f64; 3] {
        let held = |i: usize, x: f64| x.clamp(-margin, (dims[i] - 1) as f64 + margin);
        [0, 1, 2].map(|i| held(i, self.origin[i] + self.direction[i] * parameter))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_axis_is_that_of_the_longest_step_in_voxels_and_z_before_y_before_x() {
        let axis = |direction: [f64; 3], spacing| nearest_axis(direction.into(), spacing);
        assert_eq!([[1.0, 1.0, -1.0], [-1.0, 1.0, 0.0], [1.0, 0.0, 0.0]].map(|along| axis(along, [1.0; 3])), [2, 1, 0]);
        assert_eq!(axis([0.0, 0.9, 1.0], [1.0, 1.0, 2.0]), 1);
        assert_eq!(axis([1.0, 2.0, 4.0], [1.0, 2.0, 4.0]), 2);
    }
}
