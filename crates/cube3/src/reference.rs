//! What a picture is measured against, and how far that itself is from the truth.

use cube3_method::{Choice, OwnError};
use cube3_report::{ErrorReport, ReferenceError};

/// The part of the distance between machine and reference from which on the reference's own error is not small beside it.
const SMALL: f64 = 0.25;

/// An error of the reference that nobody need know of: a tenth of a level of 255.
const NOTHING: f64 = 0.1 / 255.0;

/// A reference's own error as the report has it.
pub(crate) fn report(own: &OwnError) -> ReferenceError {
    let [step_voxel, against_step_voxel] =
        own.choices.clone().map(|choice| choice.settings.value(cube3_reference::STEP));
    ReferenceError { step_voxel, against_step_voxel, error: own.error, pixels: own.pixels }
}

/// What to say where the reference's own error is not small beside the distance that is measured with it.
pub(crate) fn note(own: Option<&OwnError>, measured: &ErrorReport) -> Option<String> {
    let distance = measured.footprint.error?.mean_relative;
    let own = own.filter(|own| own.error.mean_relative > (SMALL * distance).max(NOTHING))?;
    let [_, finer] = &own.choices;
    let step = cube3_reference::STEP;
    let better =
        Choice { settings: finer.settings.clone().with(step, finer.settings.value(step) / 2.0), ..finer.clone() };
    Some(format!(
        "the reference itself is {:.2} % from the same at half its step, over the object, and the picture is {:.2} % from the reference: \
         give --reference {better}",
        100.0 * own.error.mean_relative,
        100.0 * distance
    ))
}
