//! The base-plane image.

use crate::Geometry;
use cube3_scene::over;

/// The machine's output: a pixel for each ray, red, green, blue (opacity-weighted) and opacity, unit words of
/// `bits`. Row-major from ray (−Y, −X).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BasePlane {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Bits of a component.
    pub bits: u32,
    /// The pixels.
    pub pixels: Vec<[u32; 4]>,
}

impl BasePlane {
    /// An empty base plane of a geometry's size.
    pub fn empty(geometry: &Geometry, bits: u32) -> BasePlane {
        let [width, height] = geometry.base_plane_size();
        BasePlane { width, height, bits, pixels: vec![[0; 4]; width * height] }
    }

    /// The pixel as reals 0 to 1; transparent beyond the edge.
    pub fn real(&self, column: i64, row: i64) -> [f64; 4] {
        if column < 0 || row < 0 || column >= self.width as i64 || row >= self.height as i64 {
            return [0.0; 4];
        }
        let full = f64::from(cube3_word::unit_full(self.bits));
        self.pixels[row as usize * self.width + column as usize].map(|word| f64::from(word) / full)
    }

    /// The base plane over a background, row-major: opacity-weighted colour plus what shows through.
    pub fn over(&self, background: [f64; 3]) -> Vec<[f64; 3]> {
        let full = f64::from(cube3_word::unit_full(self.bits));
        self.pixels.iter().map(|pixel| over(pixel.map(|word| f64::from(word) / full), background)).collect()
    }
}
