//! The image plane: where each pixel of the final picture is in the world and on the base plane.

use crate::Geometry;
use cube3_scene::{Image, ViewFrame};
use glam::{DAffine2, DMat2, DVec2, DVec3};

/// A parallel view's image plane through the centre of the volume. World lengths are those of the spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImagePlane {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// The world point at the centre of pixel (0, 0), the top left one.
    pub first: DVec3,
    /// World step from a pixel to the one on its right.
    pub across: DVec3,
    /// World step from a pixel to the one below.
    pub down: DVec3,
}

impl ImagePlane {
    /// The plane for a volume of `dims` voxels of `spacing`. Without a pixel size in the scene, the sphere around the
    /// volume's voxels fits.
    pub fn new(image: &Image, frame: &ViewFrame, dims: [usize; 3], spacing: [f64; 3]) -> ImagePlane {
        let size = DVec3::from_array([0, 1, 2].map(|i| dims[i] as f64 * spacing[i]));
        let centre = DVec3::from_array([0, 1, 2].map(|i| (dims[i] - 1) as f64 * spacing[i] * 0.5));
        let smallest = spacing.iter().copied().fold(f64::INFINITY, f64::min);
        let (width, height) = (image.width_px as usize, image.height_px as usize);
        let pixel = match image.pixel_size_voxel {
            Some(voxels) => voxels * smallest,
            None => size.length() / width.min(height) as f64,
        };
        let across = frame.right * pixel;
        let down = -frame.up * pixel;
        let first = centre - across * ((width as f64 - 1.0) * 0.5) - down * ((height as f64 - 1.0) * 0.5);
        ImagePlane { width, height, first, across, down }
    }

    /// World point of a pixel's centre.
    pub fn point(&self, column: f64, row: f64) -> DVec3 {
        self.first + self.across * column + self.down * row
    }

    /// The affine map from pixel (column, row) to the base plane's ray coordinates (u, v).
    pub fn to_base_plane(&self, geometry: &Geometry, spacing: [f64; 3]) -> DAffine2 {
        let [du, dv] = geometry.real_slopes();
        let project = |world: DVec3, affine: bool| {
            let xyz = [0, 1, 2].map(|i| world[i] / spacing[i]);
            let c = [0, 1, 2].map(|i| {
                let along = xyz[geometry.axes.axis[i]];
                match (geometry.axes.reversed[i], affine) {
                    (true, true) => (geometry.size[i] - 1) as f64 - along,
                    (true, false) => -along,
                    (false, _) => along,
                }
            });
            DVec2::new(c[0] - c[2] * du, c[1] - c[2] * dv)
        };
        DAffine2::from_mat2_translation(
            DMat2::from_cols(project(self.across, false), project(self.down, false)),
            project(self.first, true),
        )
    }
}
