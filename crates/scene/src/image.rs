//! The picture's raster.

use serde::{Deserialize, Serialize};

/// The largest width and height of a picture, in pixels.
pub const LARGEST_IMAGE_PX: u32 = 16384;

/// The raster of the picture; the centre of the volume is in its middle, unless the eye is moved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Image {
    /// The number of columns, 1 to [`LARGEST_IMAGE_PX`].
    pub width_px: u32,
    /// The number of rows, 1 to [`LARGEST_IMAGE_PX`].
    pub height_px: u32,
    /// The distance between pixels, in units of the smallest voxel spacing, above 0; `None` makes
    /// the volume's bounding sphere fit the picture. Parallel views only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pixel_size_voxel: Option<f64>,
}

impl Default for Image {
    fn default() -> Self {
        Image { width_px: 512, height_px: 512, pixel_size_voxel: None }
    }
}
