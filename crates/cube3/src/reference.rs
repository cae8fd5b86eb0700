//! What a picture is measured against, and how far that itself is from the truth.

use crate::{Outcome, RunOptions};
use cube3_method::{Choice, Kept, OwnError, Subject};
use cube3_picture::{Rendering, Watch};
use cube3_report::{ErrorReport, ReferenceError};

/// The part of the distance between machine and reference from which on the reference's own error is not small beside it.
const SMALL: f64 = 0.25;

/// An error of the reference that nobody need know of: a tenth of a level of 255.
const NOTHING: f64 = 0.1 / 255.0;

/// The reference's picture of a subject, kept or made, and what to say of that.
pub(crate) fn rendered(
    options: &RunOptions,
    choice: &Choice,
    subject: &Subject<'_>,
    watch: Watch<'_>,
) -> Outcome<(Rendering, Option<String>)> {
    let Some(cache) = &options.cache else {
        return Ok((choice.render(subject, watch)?, None));
    };
    let Kept { rendering, made_s, unkept } = cache.render(choice, subject, watch)?;
    let found = made_s.map(|seconds| format!("the reference was made by an earlier run, in {seconds:.2} s, and kept"));
    Ok((
        rendering,
        found.or_else(|| unkept.map(|why| format!("the reference could not be kept for the next run: {why}"))),
    ))
}

/// A reference's own error as the report has it.
pub(crate) fn report(own: &OwnError) -> ReferenceError {
    ReferenceError {
        of: own.of.to_string(),
        against: own.against.to_string(),
        against_bound: own.bound,
        error: own.error,
        pixels: own.pixels,
    }
}

/// What to say where the reference's own error is not small beside the distance that is measured with it.
pub(crate) fn note(own: Option<&OwnError>, measured: &ErrorReport) -> Option<String> {
    let distance = measured.footprint.error?.mean_relative;
    let own = own.filter(|own| own.error.mean_relative > (SMALL * distance).max(NOTHING))?;
    // What proves a bound is a better reference; a step alone only comes nearer.
    let better = match own.bound {
        Some(_) => Choice::of(own.against.method),
        None => own.against.clone(),
    };
    Some(format!(
        "the reference itself is {:.2} % from {}, over the object, and the picture is {:.2} % from the reference: give --reference {better}",
        100.0 * own.error.mean_relative,
        own.against,
        100.0 * distance
    ))
}
