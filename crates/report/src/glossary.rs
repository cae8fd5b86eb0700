//! The words of the page, for one who has not read the paper.

use maud::{Markup, html};

/// Each word and what it means, in the order in which a reader comes upon them.
const WORDS: [(&str, &str); 24] = [
    ("voxel", "A number of the volume at a point of its grid. Its word is that number in the machine's bits."),
    (
        "reference",
        "A picture of the same scene by a slower way in 64-bit reals, which the machine's picture is held against.",
    ),
    (
        "error over the object",
        "The distance of a pixel from the reference: the length of the difference of red, green and blue, of which black to white is 100 %. It is taken \
         over the pixels where either picture shows something, so that an empty background cannot make it small.",
    ),
    (
        "level",
        "A step of a channel of a display of 8 bits, of which there are 255. Below one level nothing can be seen.",
    ),
    ("99th percentile", "Of 100 pixels of the object, 99 are off by no more than this."),
    (
        "bias",
        "The mean of picture less reference. Near 0 the errors cancel; else the picture is brighter (+) or darker (−) all over.",
    ),
    ("PSNR", "Peak signal-to-noise ratio, the error in decibels: 20 dB more are a tenth of the error."),
    (
        "yaw, tilt, roll",
        "Turn of the eye about the vertical axis, its height over the horizon, and the turn of the picture.",
    ),
    (
        "transfer function",
        "What gives each data value a colour and an opacity; opacity 0 is clear, 1 hides what is behind.",
    ),
    ("mode", "How the samples of a ray become a pixel: composite blends them, maximum takes the largest."),
    (
        "gradient estimator",
        "How the direction of a surface is found from samples near it, for shading; its name begins with the number of samples that it takes.",
    ),
    ("plan", "What the machine leaves out because it cannot change a bit of this picture."),
    ("preset", "A machine that is built in, such as cube3-128: a Cube-3 with 128 lanes."),
    (
        "lane",
        "One of the copies of the pipeline that work side by side, each on a voxel of a beam or a sample of a ray.",
    ),
    ("beam", "A row of voxels along an axis, read in one cycle."),
    (
        "base plane",
        "The face of the volume that the rays start from. The machine makes its picture there; the host warps it to the view.",
    ),
    ("slopes du, dv", "How far a ray moves sideways, in voxels, for one voxel into the volume."),
    (
        "discrete ray, template",
        "The column of voxels next to a ray. In a parallel view all rays have one form, kept in a template.",
    ),
    ("ray slot", "A place in the pipeline for a ray; wrapped slots hold parts of two."),
    (
        "cycle",
        "A tick of the machine's clock. Each unit is busy, starved (nothing came), blocked (no room behind it) or waiting for a resource.",
    ),
    (
        "fill",
        "Cycles that a frame alone needs until the pipeline is full; in an animation the frame before hides them.",
    ),
    ("frame interval", "Cycles from a frame's last pixel to the next one's, in an animation."),
    ("what limits", "The resource, such as memory or bus, without which the frame rate would rise most."),
    ("saturated", "A result that was too large for its word and became the largest that the word holds."),
];

pub(crate) fn glossary() -> Markup {
    html! {
        section #glossary {
            h2 { "Glossary" }
            dl.facts {
                @for (word, meaning) in WORDS { div { dt { (word) } dd { (meaning) } } }
            }
        }
    }
}
