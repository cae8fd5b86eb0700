//! The data sheets as pages of the book: a page for each unit of the machine, made from sheets and from the units' own specs.

use crate::expression::ExpressionError;
use crate::{Unit, UnitFormat, units};
use cube3_abc::AbcSpec;
use cube3_cfb::CfbSpec;
use cube3_cone::ConeSpec;
use cube3_dsb::{DsbSpec, bus::BusSpec};
use cube3_frame::{FrameSetup, Geometry, Schedule};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::{ChannelSize, MachineSpec};
use cube3_scene::{Scene, View};
use std::fmt::Write;

/// A page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Page {
    /// Its file, in `docs/src`.
    pub file: &'static str,
    /// Its text.
    pub text: String,
}

/// A machine unit's page before its numbers.
struct Outline {
    file: &'static str,
    title: &'static str,
    chapter: &'static str,
    intro: &'static str,
    /// Channels at its ends: direction, name, what a token holds.
    tokens: &'static [(&'static str, &'static str, &'static str)],
    /// Units of vectors, by the start of their names.
    units: &'static [&'static str],
}

const OUTLINES: [Outline; 8] = [
    Outline {
        file: "sheet-cfb.md",
        title: "Cubic frame buffer",
        chapter: "cfb.md",
        intro: "Skewed memory modules that give a beam of voxels along any axis. For each slot of a plane of rays and each depth, the unit \
                sends the row of voxels that the plane meets there.",
        tokens: &[("out", "beams", "frame, plane, depth, row; a voxel word of V bits for each lane, in lane order")],
        units: &["cfb"],
    },
    Outline {
        file: "sheet-bus.md",
        title: "Fast bus",
        chapter: "dsb.md",
        intro: "Turns a beam from the lanes of the frame buffer to those of the skewed buffers. In perspective it gathers voxel by voxel \
                instead; that has no vectors.",
        tokens: &[
            ("in", "beams", "a beam, as the frame buffer sends it"),
            ("out", "aligned", "the same beam, each voxel in the lane of its ray slot"),
        ],
        units: &["bus"],
    },
    Outline {
        file: "sheet-dsb.md",
        title: "2-D skewed buffers",
        chapter: "dsb.md",
        intro: "Planes of voxels, written beam by beam and read ray by ray without conflicts. Where the last plane of slots is followed by \
                the first, that one is kept.",
        tokens: &[
            ("in", "aligned", "a beam: a voxel word for each lane"),
            (
                "out",
                "rays",
                "frame, plane, slot; a voxel word for each depth of the ray, of this plane and of the next",
            ),
        ],
        units: &["dsb"],
    },
    Outline {
        file: "sheet-trilin.md",
        title: "TRILIN",
        chapter: "trilin.md",
        intro: "A sample in each lane from eight voxels. A ray leaves when the next one of its plane has come, the last one of a plane while \
                the next plane begins.",
        tokens: &[
            ("in", "rays", "a ray slot of two planes"),
            ("out", "samples", "frame, plane, slot; a sample word of S bits and whether it is there, for each depth"),
        ],
        units: &["lerp", "trilin"],
    },
    Outline {
        file: "sheet-gradient.md",
        title: "ABC gradient",
        chapter: "abc.md",
        intro: "The gradient of a sample from those around it. The unit keeps planes of samples: the one above, the current, the one below \
                and those that come in. A neighbour beyond the volume, or beyond a seam, is the border word.",
        tokens: &[
            ("in", "samples", "a ray of samples"),
            ("out", "shaded", "by way of classification and shading, in the same cycle: see there"),
        ],
        units: &["gradient-", "normalise"],
    },
    Outline {
        file: "sheet-shading.md",
        title: "Classification and shading",
        chapter: "abc.md",
        intro: "Opacity and colour of a sample by table, and light by Phong's formula or by a table over the gradient's direction.",
        tokens: &[
            ("in", "samples", "a ray of samples, by way of the gradient"),
            (
                "out",
                "shaded",
                "frame, plane, slot; for each depth: present, sample word, opacity of O bits, colour of 3·C bits",
            ),
        ],
        units: &["clip", "classify", "phong", "reflectance", "lit", "cue"],
    },
    Outline {
        file: "sheet-cone.md",
        title: "Ray projection cone",
        chapter: "cone.md",
        intro: "A segmented reduction over leaves in circular order: the samples of a slot become the pixels of its rays, up to three where \
                rays share a slot.",
        tokens: &[
            ("in", "shaded", "a ray of shaded samples"),
            ("out", "pixels", "frame, plane, slot; for each ray that ends there its number and four words of A bits"),
        ],
        units: &["leaf", "node", "cone", "pixel"],
    },
    Outline {
        file: "sheet-channel.md",
        title: "Channel",
        chapter: "channel.md",
        intro: "What joins two units: a bounded queue with a latency, whose credits come back with the clock's edge. All joints of the \
                machine are such channels.",
        tokens: &[("in and out", "", "a token: a beam, a ray or a pixel group")],
        units: &["channel"],
    },
];

/// A row of a page's table of timing: what, as a formula, in the machine that the page is for.
type Timing = (&'static str, &'static str, u64);

/// The machine, the frame and the format that the pages give numbers for.
struct Example {
    machine: MachineSpec,
    setup: FrameSetup,
    format: UnitFormat,
}

/// Why pages cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// A sheet.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
    /// The frame.
    #[error(transparent)]
    Host(#[from] cube3_host::HostError),
}

impl Example {
    fn new() -> Result<Example, PageError> {
        let machine = MachineSpec::default();
        let scene = Scene { view: View::from_direction([0.5, 0.25, 1.0], None), ..Scene::default() };
        let volume = VolumeInfo { dims: [machine.lanes; 3], spacing: [1.0; 3], window: [0.0, 1.0] };
        let setup = frame_setup(&scene, &machine, &volume, true)?.setup;
        Ok(Example { format: UnitFormat::of(&machine), machine, setup })
    }

    fn geometry(&self) -> &Geometry {
        &self.setup.geometry
    }

    /// The channel of a name.
    fn channel(&self, name: &str) -> Option<ChannelSize> {
        let sizes = self.machine.channel;
        Some(match name {
            "beams" => sizes.beams,
            "aligned" => sizes.aligned,
            "rays" => sizes.rays,
            "samples" => sizes.samples,
            "shaded" => sizes.shaded,
            "pixels" => ConeSpec::pixels(&self.machine),
            _ => return None,
        })
    }

    /// The timing of a page's unit, read from its spec.
    fn timing(&self, file: &str) -> Vec<Timing> {
        let (machine, geometry) = (&self.machine, self.geometry());
        let schedule = Schedule::new(machine, geometry);
        match file {
            "sheet-cfb.md" => {
                let spec = CfbSpec::new(machine, geometry, schedule);
                vec![
                    (
                        "initiation interval: a beam",
                        "⌈n_u / lanes⌉, and what modules need that serve several voxels; behind a reorder buffer nothing more",
                        spec.cycles(Some(0)),
                    ),
                    ("of that, conflicts", "0 with the paper's skew, and with mini-blocks", spec.conflict_cycles),
                    ("a depth at which a padded plane is outside", "1", spec.cycles(None)),
                ]
            }
            "sheet-bus.md" => {
                let spec = BusSpec::new(machine, schedule);
                vec![
                    (
                        "initiation interval: a beam",
                        "⌈n_u / lanes⌉, or its slices if they take longer",
                        spec.lane_cycles,
                    ),
                    ("slices of a beam", "⌈n_u / channels⌉", spec.slices),
                ]
            }
            "sheet-dsb.md" => {
                let spec = DsbSpec::new(machine, schedule);
                vec![
                    ("initiation interval of the write port: a beam", "⌈n_u / lanes⌉", schedule.aligned_cycles()),
                    ("initiation interval of the read port: a ray", "⌈n_w / lanes⌉", schedule.ray_cycles()),
                    (
                        "beams before the first ray",
                        "two planes: 2·n_w",
                        schedule.planes_read(0, 0) * geometry.size[2] as u64,
                    ),
                    (
                        "planes",
                        "`dsb.planes`, and the first one where slots close along v",
                        spec.planes as u64 + u64::from(geometry.closes()[1]),
                    ),
                ]
            }
            "sheet-trilin.md" => {
                vec![
                    ("initiation interval: a ray", "⌈n_w / lanes⌉", schedule.ray_cycles()),
                    ("rays before the first sample", "the next of its plane: 2", 2),
                ]
            }
            "sheet-gradient.md" | "sheet-shading.md" => {
                let AbcSpec { order, ring } = AbcSpec::new(machine, &self.setup, &schedule);
                let [plane, slot] = order.shaded().next().unwrap_or_default();
                vec![
                    ("initiation interval: a ray", "⌈n_w / lanes⌉", schedule.ray_cycles()),
                    (
                        "rays before the first is shaded",
                        "those of the planes and rays beside it",
                        order.needed(plane, slot),
                    ),
                    (
                        "planes of samples",
                        "`abc.planes`, and the first two where slots close along v",
                        ring + 2 * u64::from(geometry.closes()[1]),
                    ),
                ]
            }
            "sheet-cone.md" => {
                let spec = ConeSpec::new(machine, &schedule);
                vec![
                    ("initiation interval: a ray", "⌈n_w / lanes⌉; n_w in a single accumulator", spec.ray_cycles),
                    ("latency", "⌈log₂ lanes⌉ + 1 of a folded tree", spec.latency()),
                    ("nodes", "lanes − 1, and one that joins chunks", spec.nodes() as u64),
                ]
            }
            _ => Vec::new(),
        }
    }

    fn page(&self, outline: &Outline, all: &[Box<dyn Unit>]) -> Result<Page, PageError> {
        let mut text = format!(
            "# Data sheet: {}\n\n<!-- Made by `cube3 vectors --pages docs/src`; a test holds it to the code. -->\n\n{}\n\nHow it works: \
             [{}]({}). Names and rounding: [data sheets](data-sheets.md).\n",
            outline.title,
            outline.intro,
            outline.chapter.trim_end_matches(".md"),
            outline.chapter
        );
        let _ = writeln!(text, "\n| | channel | a token holds | capacity | latency |\n| --- | --- | --- | --- | --- |");
        for (direction, name, holds) in outline.tokens {
            let size = self.channel(name);
            let [capacity, latency] = match size {
                Some(size) => [size.capacity.to_string(), size.latency.to_string()],
                None => ["at least 1".into(), "at least 1".into()],
            };
            let name = if name.is_empty() { "any".into() } else { format!("`{name}`") };
            let _ = writeln!(text, "| {direction} | {name} | {holds} | {capacity} | {latency} |");
        }
        let timing = self.timing(outline.file);
        if !timing.is_empty() {
            let _ = writeln!(
                text,
                "\n| timing, in cycles or tokens | | n = lanes = {} |\n| --- | --- | --- |",
                self.machine.lanes
            );
            for (what, formula, value) in timing {
                let _ = writeln!(text, "| {what} | {formula} | {value} |");
            }
        }
        for unit in all {
            let sheet = unit.sheet();
            let of_page = |name: &&str| sheet.name == *name || (name.ends_with('-') && sheet.name.starts_with(*name));
            if outline.units.iter().any(of_page) {
                let _ = write!(text, "\n{}", sheet.markdown(&self.format)?);
            }
        }
        Ok(Page { file: outline.file, text })
    }
}

/// All pages.
///
/// # Errors
/// A sheet with an expression that has no value.
pub fn pages() -> Result<Vec<Page>, PageError> {
    let example = Example::new()?;
    let all = units();
    OUTLINES.iter().map(|outline| example.page(outline, &all)).collect()
}
