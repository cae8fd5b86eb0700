//! What comes first in every view of a report: the error over the object, and what limits the frame rate. Neither says much without the other.

use cube3_metrics::ImageError;
use maud::{Markup, html};

use crate::RunReport;
use crate::fact::Fact;
use crate::quantity::{number, percentage};

/// Levels of a channel of an 8-bit display above black.
const LEVELS: f64 = 255.0;

/// Of a run with a clock that did not look for what limits it.
const NO_SEARCH: &str = "not looked for";

/// One measure of the error over the object.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Measure {
    /// Its name.
    pub(crate) name: &'static str,
    /// In parts of the full range of a channel, such as `2.81 %`.
    pub(crate) part: String,
    /// In levels of 255.
    pub(crate) levels: String,
}

/// Mean, 99th percentile, largest and bias over the object, or why there are none. In a sequence they are those of the first frame.
pub(crate) fn object_error(report: &RunReport) -> Result<[Measure; 4], String> {
    match &report.error {
        Some(error) => match &error.footprint.error {
            Some(object) => Ok(measures(object)),
            None => Err(error.remark.clone().unwrap_or_else(|| "there was nothing to measure".into())),
        },
        None if report.digest.image.is_none() => Err("no picture was made: only the clock ran".into()),
        None => Err("the picture was made without a reference to compare it with".into()),
    }
}

fn measures(object: &ImageError) -> [Measure; 4] {
    let levels = |value: f64| format!("{} levels", number(LEVELS * value));
    let plain = |name, value: f64| Measure { name, part: percentage(value), levels: levels(value) };
    let bias = object.bias;
    let side = match bias {
        _ if bias > 0.0 => "brighter than the reference",
        _ if bias < 0.0 => "darker than the reference",
        _ => "as bright as the reference",
    };
    let sign = match bias {
        _ if bias > 0.0 => "+",
        _ if bias < 0.0 => "−",
        _ => "",
    };
    [
        plain("Mean", object.mean_relative),
        plain("99th percentile", object.percentile_99),
        plain("Largest", object.max),
        Measure {
            name: "Bias",
            part: format!("{sign}{}", percentage(bias.abs())),
            levels: format!("{}, {side}", levels(bias.abs())),
        },
    ]
}

/// What the numbers of the error are measured against, such as `image-order, first frame`.
pub(crate) fn against(report: &RunReport) -> Option<String> {
    let first = if report.sequence.is_some() { ", first frame" } else { "" };
    report.error.as_ref().map(|error| format!("{}{first}", error.against))
}

/// Frames per second and the critical resource, or that no clock ran.
pub(crate) fn throughput(report: &RunReport) -> Vec<Fact> {
    let Some(timing) = &report.timing else {
        return vec![("Frames per second", "not measured: no clock ran".into())];
    };
    let rate = format!("{} in an animation, {} alone", number(timing.fps_sustained), number(timing.fps));
    let mut facts = vec![("Frames per second", rate)];
    let sentence = report.limits.as_ref().map_or_else(|| NO_SEARCH.into(), |limits| limits.sentence.clone());
    facts.push(("What limits", sentence));
    facts
}

/// Tiles for the top of the page.
pub(crate) fn headline(report: &RunReport) -> Markup {
    let mut tiles: Vec<(String, String, String)> = Vec::new();
    match object_error(report) {
        Ok([mean, rest @ ..]) => {
            let against = against(report).map_or(String::new(), |against| format!(", against {against}"));
            let note = format!("{} of 255 on average{against}", mean.levels);
            tiles.push(("Error over the object".into(), mean.part, note));
            tiles.extend(rest.map(|measure| (measure.name.into(), measure.part, measure.levels)));
        }
        Err(why) => tiles.push(("Error over the object".into(), "not measured".into(), why)),
    }
    if let Some((frame, error)) = report.sequence.as_ref().and_then(|sequence| sequence.worst()) {
        let note = format!("mean over the object in frame {frame}, of all frames");
        tiles.push(("Worst frame".into(), percentage(error.mean_relative), note));
    }
    match &report.timing {
        Some(timing) => {
            let note = format!("in an animation; {} for one frame alone", number(timing.fps));
            tiles.push(("Frames per second".into(), number(timing.fps_sustained), note));
        }
        None => tiles.push(("Frames per second".into(), "not measured".into(), "no clock ran".into())),
    }
    match &report.limits {
        Some(limits) => tiles.push(("What limits".into(), limits.critical.clone(), limits.sentence.clone())),
        None if report.timing.is_some() => tiles.push(("What limits".into(), "not measured".into(), NO_SEARCH.into())),
        None => {}
    }
    html! {
        dl.tiles {
            @for (what, value, note) in &tiles {
                div { dt { (what) } dd.value { (value) } dd.note { (note) } }
            }
        }
    }
}
