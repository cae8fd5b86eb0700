//! A base-plane image in reals.

use cube3_frame::Geometry;

use cube3_host::warp_reals;

use cube3_scene::{ImagePlane, over};

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

    /// The picture, warped as the host warps the machine's base plane.
    pub fn warp(
        &self,
        geometry: &Geometry,
        plane: &ImagePlane,
        spacing: [f64; 3],
        background: [f64; 3],
    ) -> Vec<[f64; 3]> {
        warp_reals(&|column, row| self.pixel(column, row), geometry, plane, spacing, background)
    }
}
