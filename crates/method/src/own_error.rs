//! How far a method is from itself with less error.

use crate::{Choice, Render, RenderError, Subject};
use cube3_metrics::{ImageError, compare, footprint};
use cube3_picture::Picture;

/// How far a picture is from the same method's with less error.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnError {
    /// The method, and the same with less error.
    pub choices: [Choice; 2],
    /// Over the object.
    pub error: ImageError,
    /// Pixels of the object that were looked at.
    pub pixels: usize,
}

/// Pixels each way of which one is looked at.
const EVERY: usize = 4;

/// How far a method's `picture` of a subject is from the same with less error, over the object, on every fourth pixel each way; none for a method
/// whose samples are the machine's by definition, and where no such pixel shows the object.
///
/// # Errors
/// What the method refuses.
pub fn own_error(choice: &Choice, subject: &Subject<'_>, picture: &Picture) -> Result<Option<OwnError>, RenderError> {
    let Render::Scene(method) = choice.method.render else {
        return Ok(None);
    };
    let Some(finer) = method.finer else {
        return Ok(None);
    };
    let (finer, settings) = finer(&subject.as_scene(), &choice.settings, EVERY)?;
    let rows = picture.pixels.chunks(picture.width).step_by(EVERY);
    let some = rows.flat_map(|row| row.iter().step_by(EVERY).copied()).collect();
    let some = Picture::new(finer.width, finer.height, some)?;
    let object = footprint(&some, &finer, subject.scene.background)?;
    let comparison = compare(&some, &finer, Some(&object))?;
    Ok(comparison.footprint.map(|error| OwnError {
        choices: [choice.clone(), Choice { method: choice.method, settings }],
        error,
        pixels: comparison.footprint_pixels,
    }))
}
