//! A base-plane image in reals.

use cube3_frame::Geometry;
use cube3_scene::{ImagePlane, over};
use glam::DVec3;

/// What a caster on the base plane made.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseRendering {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green, blue (opacity-weighted) and opacity, row-major from ray (−Y, −X), as
    /// [`cube3_frame::BasePlane`].
    pub pixels: Vec<[f64; 4]>,
    /// Samples of the rays; those taken for gradients are the same ones.
    pub samples: u64,
}

impl BaseRendering {
    /// The pixel at a column and row; transparent beyond the edge.
    pub fn pixel(&self, column: i64, row: i64) -> [f64; 4] {
        let inside = (0..self.width as i64).contains(&column) && (0..self.height as i64).contains(&row);
        if inside { self.pixels[row as usize * self.width + column as usize] } else { [0.0; 4] }
    }

    /// The base plane over a background.
    pub fn over(&self, background: [f64; 3]) -> Vec<[f64; 3]> {
        self.pixels.iter().map(|&pixel| over(pixel, background)).collect()
    }

    /// The picture of a parallel view over `background`, row-major from the top left. A pixel of it is a place in the volume, of voxel
    /// `spacing` (x, y, z); the ray of the `geometry` through that place meets the base plane w = 0 between four pixels, and theirs are
    /// interpolated. Pfister et al. 1995, section 2.
    pub fn warp(
        &self,
        geometry: &Geometry,
        plane: &ImagePlane,
        spacing: [f64; 3],
        background: [f64; 3],
    ) -> Vec<[f64; 3]> {
        let [du, dv] = geometry.real_slopes();
        let first = geometry.first_ray();
        let mut picture = Vec::with_capacity(plane.width * plane.height);
        for row in 0..plane.height {
            for column in 0..plane.width {
                let place = plane.point(column as f64, row as f64) / DVec3::from(spacing);
                let [u, v, w] = geometry.axes.canonical_position(geometry.size, place.to_array());
                let pixel = self.between(u - w * du - first.u as f64, v - w * dv - first.v as f64);
                picture.push(over(pixel, background));
            }
        }
        picture
    }

    /// The pixels around a place, each by its share.
    pub(crate) fn between(&self, column: f64, row: f64) -> [f64; 4] {
        let (left, above) = (column.floor(), row.floor());
        let (to_right, down) = (column - left, row - above);
        let mut sum = [0.0; 4];
        for (right, share_along) in [(0, 1.0 - to_right), (1, to_right)] {
            for (below, share_across) in [(0, 1.0 - down), (1, down)] {
                let pixel = self.pixel(left as i64 + right, above as i64 + below);
                for (sum, part) in sum.iter_mut().zip(pixel) {
                    *sum += share_along * share_across * part;
                }
            }
        }
        sum
    }
}
