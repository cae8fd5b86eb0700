//! The pictures on the page: those of a frame, and the animation of a sequence.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, html};

use crate::SequenceReport;
use crate::fact::listed;
use crate::png::png_size;
use crate::quantity::{count, percentage};

/// Pictures up to this wide are magnified as squares, not blurred.
const SMALL: u32 = 400;

/// A picture on the page.
#[derive(Debug, Clone, Copy)]
pub struct Figure<'a> {
    /// A word or two, such as `Difference`.
    pub title: &'a str,
    /// A sentence on what is seen.
    pub caption: &'a str,
    /// The PNG file; one of several frames plays.
    pub png: &'a [u8],
    /// Of a PNG file that plays, a picture that stands still in its place where the reader's system asks for less motion.
    pub still: Option<&'a [u8]>,
}

pub(crate) fn pictures(figures: &[Figure]) -> Markup {
    html! {
        @if !figures.is_empty() {
            section {
                h2 { "Pictures" }
                div.pictures {
                    @for figure in figures { (picture(figure)) }
                }
            }
        }
    }
}

fn picture(figure: &Figure) -> Markup {
    let size = png_size(figure.png);
    let [width, height] = size.map_or([None, None], |[width, height]| [Some(width), Some(height)]);
    let small = width.is_some_and(|width| width <= SMALL);
    html! {
        figure {
            picture {
                @if let Some(still) = figure.still {
                    source media="(prefers-reduced-motion: reduce)" srcset=(data_url(still));
                }
                img.small[small] src=(data_url(figure.png)) width=[width] height=[height] alt={ (figure.title) ": " (figure.caption) };
            }
            figcaption {
                strong { (figure.title) }
                @if let Some([width, height]) = size { " " span.size { (width) " × " (height) } }
                br;
                (figure.caption)
            }
        }
    }
}

fn data_url(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(png))
}

pub(crate) fn sequence(sequence: Option<&SequenceReport>) -> Markup {
    html! {
        @if let Some(sequence) = sequence {
            section {
                h2 { "Sequence" }
                @if let Some(file) = &sequence.animation {
                    p { "All frames, as a file beside this page: " a href=(file) { (file) } "." }
                }
                (listed(&sequence.facts()))
                div.wide { table {
                    caption { "Frames; the error is the mean over the object" }
                    thead {
                        tr {
                            @for column in ["Frame", "Cycles", "Volume", "Newer voxels", "Mixed beams", "Error"] {
                                th.number scope="col" { (column) }
                            }
                        }
                    }
                    tbody {
                        @for (index, frame) in sequence.frames.iter().enumerate() {
                            tr {
                                th.number scope="row" { (index) }
                                td.number { (frame.cycles.map_or_else(String::new, count)) }
                                td.number { (frame.volume) @if frame.torn { " to " (frame.newest_volume) } }
                                td.number { @if frame.torn { (percentage(frame.newer_fraction)) } }
                                td.number { @if frame.torn { (count(frame.mixed_beams)) } }
                                @if frame.remark.is_some() {
                                    td { (frame.error_in_words()) }
                                } @else {
                                    td.number { (frame.error_in_words()) }
                                }
                            }
                        }
                    }
                } }
            }
        }
    }
}
