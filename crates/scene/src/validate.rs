//! Whether a scene can be shown.

use crate::{Crop, MOST_CUTS, MOST_LIGHTS, SCENE_PARAMETERS, Scene, SceneError, Threshold, check};
use cube3_parameter::check as check_rows;

impl Scene {
    /// Checks every value of the scene, so that no renderer has to: its range first, by [`SCENE_PARAMETERS`], then what must hold
    /// between values.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong: a format of another version, a number that is not finite or out
    /// of its range, points out of order, a vector without direction, a pixel size in a perspective view,
    /// too many cuts or lights.
    pub fn validate(&self) -> Result<(), SceneError> {
        check_rows(SCENE_PARAMETERS, self).map_err(|fault| SceneError::out_of_range(&fault))?;
        self.volume.validate()?;
        self.view.validate()?;
        self.path.as_ref().map_or(Ok(()), |path| path.validate(&self.view))?;
        if self.view.perspective.is_some() && self.image.pixel_size_voxel.is_some() {
            return Err(SceneError::at(
                "image.pixel_size_voxel",
                "a pixel has no one size in a perspective view",
                "leave it out: `view.perspective.field_of_view_deg` sets what the picture shows",
            ));
        }
        self.transfer.validate()?;
        check::at_most("light", self.lights.len(), MOST_LIGHTS)?;
        self.lights.iter().enumerate().try_for_each(|(i, light)| light.validate(i))?;
        check::at_most("cut", self.cuts.len(), MOST_CUTS)?;
        self.cuts.iter().enumerate().try_for_each(|(i, cut)| cut.validate(i))?;
        self.crop.as_ref().map_or(Ok(()), Crop::validate)?;
        self.threshold.as_ref().map_or(Ok(()), Threshold::validate)
    }
}
