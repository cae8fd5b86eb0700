//! How far a method is from what it stands for.

use crate::{CONVERGED, Choice, Render, RenderError, Subject};
use cube3_metrics::{ImageError, compare, footprint};
use cube3_picture::Picture;
use cube3_rendering::{SceneMethod, Sparse};

/// How far a picture is from what its method stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnError {
    /// The method.
    pub of: Choice,
    /// What it was held against: the converged integral, or where that is none of the scene's, the method itself with less error.
    pub against: Choice,
    /// The most that what it was held against is itself off by, where that proves a bound.
    pub bound: Option<f64>,
    /// Over the object.
    pub error: ImageError,
    /// Pixels of the object that were looked at.
    pub pixels: usize,
}

/// Pixels each way of which one is looked at.
const EVERY: usize = 4;

/// The tolerance of the converged integral: a hundredth of what half a voxel's step is off by on the default scene, and less.
const TOLERANCE: f64 = 1e-5;

/// How far a method's `picture` of a subject is from the converged integral, over the object, on every fourth pixel each way; in the modes that
/// choose a sample from the method's own with less error. None for a method without steps of its own, as the machine's samples are its own by
/// definition, and where no such pixel shows the object.
///
/// # Errors
/// What the methods refuse.
pub fn own_error(choice: &Choice, subject: &Subject<'_>, picture: &Picture) -> Result<Option<OwnError>, RenderError> {
    let Render::Scene(SceneMethod { finer: Some(finer), .. }) = choice.method.render else {
        return Ok(None);
    };
    let against = if CONVERGED.about.lacks(subject.scene).is_empty() {
        let converged = Choice::of(&CONVERGED);
        Choice { settings: converged.settings.with(cube3_converged::TOLERANCE, TOLERANCE), ..converged }
    } else {
        Choice { method: choice.method, settings: finer(&choice.settings) }
    };
    let Render::Scene(SceneMethod { sparse: Some(sparse), .. }) = against.method.render else {
        return Ok(None);
    };
    let Sparse { picture: better, bound } = sparse(&subject.as_scene(), &against.settings, EVERY)?;
    let rows = picture.pixels.chunks(picture.width).step_by(EVERY);
    let some = rows.flat_map(|row| row.iter().step_by(EVERY).copied()).collect();
    let some = Picture::new(better.width, better.height, some)?;
    let object = footprint(&some, &better, subject.scene.background)?;
    let comparison = compare(&some, &better, Some(&object))?;
    let bound = bound.map(|bound| bound.into_iter().fold(0.0, f64::max));
    Ok(comparison.footprint.map(|error| OwnError {
        of: choice.clone(),
        against,
        bound,
        error,
        pixels: comparison.footprint_pixels,
    }))
}
