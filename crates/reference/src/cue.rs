//! Depth cueing along a ray.

use cube3_scene::{DepthCue, ViewFrame, depth_range};
use cube3_volume::Volume;

/// Depth cueing as a function of the position in voxels.
#[derive(Clone, Copy, Debug)]
pub struct LinearCue<'a> {
    /// The factors in front and at the back.
    pub cue: &'a DepthCue,
    /// Depth, 0 to 1 between the corners of the volume, for each voxel along x, y, z.
    pub rate: [f64; 3],
    /// Depth of voxel (0, 0, 0).
    pub first: f64,
}

impl<'a> LinearCue<'a> {
    /// The cue of a volume that is seen in the frame `view`.
    pub fn new(cue: &'a DepthCue, volume: &Volume, view: &ViewFrame) -> Self {
        let [near, far] = depth_range(view, volume.dims, volume.spacing);
        // A volume without depth is all front.
        let scale = if far > near { 1.0 / (far - near) } else { 0.0 };
        let rate = [0, 1, 2].map(|i| view.direction[i] * volume.spacing[i] * scale);
        LinearCue { cue, rate, first: -near * scale }
    }

    #[inline]
    pub(crate) fn at(&self, position: [f64; 3]) -> f64 {
        let along: f64 = (0..3).map(|i| self.rate[i] * position[i]).sum();
        self.cue.factor_at(self.first + along)
    }
}
