//! What is printed: the shortest words, the cone alone, and the cheapest words for each error.

use super::picture::{Aim, Angles, Measured};
use super::sweeps::{Base, Row, Sweep, ThinRow, shortest, shortest_thin};
use super::wire::{Variant, Wire};
use super::{Study, thin};

/// A table: its title, the heads of its columns, and rows.
pub(crate) struct Table {
    /// Above it.
    pub title: String,
    /// Heads.
    pub head: Vec<String>,
    /// Rows of as many cells.
    pub rows: Vec<Vec<String>>,
}

/// Three significant digits, or all before the point.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if value.abs() < 1e-4 {
        return format!("{value:.1e}");
    }
    let decimals = (2 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

fn bits(length: Option<u32>) -> String {
    length.map_or_else(|| "none".into(), |bits| bits.to_string())
}

/// What is measured, in a paragraph.
pub(crate) fn about(study: &Study) -> String {
    let (source, [x, y, z]) = &study.volume;
    let samples = study.rows.iter().find_map(|row| row.measured.gradient).map_or(0, |error| error.samples);
    let gradients = match samples {
        0 => "This scene has no gradients.".to_owned(),
        _ => format!(
            "Gradients and normals are compared with the same estimator in reals, at the sample of each of {samples} rays that gives \
             most light to its pixel."
        ),
    };
    format!(
        "{source}, {x} × {y} × {z}, mode {}, gradient {}: {} designs. Pictures are compared with the same samples in 64-bit reals, over the \
         object, in levels of 1/255. {gradients} The frame rate is the same for all designs: word lengths change no cycle.",
        study.scene.mode,
        study.machine.abc.gradient.name(),
        study.designs,
    )
}

/// The angle that shading sees: of the normal, or of the gradient where there is no normaliser.
fn angles(measured: &Measured) -> Option<Angles> {
    measured.gradient.map(|error| error.normal.unwrap_or(error.gradient))
}

/// What the words beside the varied one are.
fn others(base: Base) -> &'static str {
    match base {
        Base::Wide => "the others at their longest",
        Base::Machine => "the others as the machine has them",
    }
}

fn variant_heads(first: &str) -> Vec<String> {
    std::iter::once(first.to_owned()).chain(Variant::ALL.map(|variant| variant.name())).collect()
}

/// The shortest length of each wire within the bounds.
pub(crate) fn shortest_table(study: &Study, base: Base) -> Table {
    let (levels, degrees) = (study.options.bound_levels, study.options.bound_deg);
    let has_angles = study.rows.iter().any(|row| row.measured.gradient.is_some());
    let mut head = variant_heads("word");
    let mut title = format!("Shortest word for a mean error of at most {levels} levels, {}", others(base));
    if has_angles {
        head.extend(["angle, nearest", "angle, truncate"].map(String::from));
        title += &format!("; and for a mean angle of at most {degrees} degrees");
    }
    let row = |&wire: &Wire| {
        let mut cells = vec![format!("{}_bits", wire.name())];
        cells.extend(Variant::ALL.map(|variant| {
            bits(shortest(&study.rows, (base, wire, variant), |measured| measured.image.mean <= levels))
        }));
        if has_angles {
            // The order of the cone plays no part.
            let within = |measured: &Measured| angles(measured).is_some_and(|angles| angles.mean_deg <= degrees);
            let variants = [false, true].map(|truncated| Variant { truncated, ..Variant::ALL[0] });
            cells.extend(variants.map(|variant| bits(shortest(&study.rows, (base, wire, variant), within))));
        }
        cells
    };
    Table { title, head, rows: study.options.wires.iter().map(row).collect() }
}

/// The machine's own words and the uniform family, in each variant.
pub(crate) fn family_table(study: &Study) -> Table {
    let mut head = variant_heads("words");
    head.extend(["angle, degrees", "cost, Mbit"].map(String::from));
    let mut sweeps: Vec<Sweep> = Vec::new();
    for row in &study.rows {
        if matches!(row.sweep, Sweep::Machine | Sweep::Uniform(_)) && !sweeps.contains(&row.sweep) {
            sweeps.push(row.sweep);
        }
    }
    let row = |sweep: &Sweep| {
        let of = |variant: Variant| {
            study.rows.iter().find(|row| row.sweep == *sweep && row.design.variant() == variant).map(|row| row.measured)
        };
        let name = match sweep {
            Sweep::Uniform(bits) => format!("all {bits} bits"),
            _ => "the machine".into(),
        };
        let mut cells = vec![name];
        cells.extend(Variant::ALL.map(|variant| of(variant).map_or_else(String::new, |m| number(m.image.mean))));
        let first = of(Variant::ALL[0]);
        let angles = first.as_ref().and_then(angles);
        cells.push(angles.map_or_else(String::new, |angles| number(angles.mean_deg)));
        cells.push(first.map_or_else(String::new, |measured| number(measured.cost.total_bits() as f64 / 1e6)));
        cells
    };
    Table {
        title: "Mean error in levels of 1/255, all words alike; angle and cost are those of the first column".into(),
        head,
        rows: sweeps.iter().map(row).collect(),
    }
}

/// The cone alone, at lengths of the design's table and around them.
pub(crate) fn thin_table(study: &Study) -> Table {
    let mut pairs: Vec<(u32, u32)> = study
        .thin
        .iter()
        .filter(|row| row.sweep == Sweep::Grid)
        .map(|row| (row.words.accumulator_bits, row.words.opacity_bits))
        .collect();
    pairs.dedup();
    let row = |&(accumulator, table): &(u32, u32)| {
        let error = |variant: Variant| {
            let same = |row: &&ThinRow| {
                row.sweep == Sweep::Grid
                    && (row.words.accumulator_bits, row.words.opacity_bits) == (accumulator, table)
                    && (row.order, row.words.rounding) == (variant.order, variant.rounding())
            };
            study.thin.iter().find(same).map_or_else(String::new, |row| number(row.error.mean))
        };
        let mut cells = vec![format!("{accumulator} / {table}")];
        cells.extend(Variant::ALL.map(error));
        cells
    };
    Table {
        title: format!(
            "The cone alone: {} rays of {} samples, opacity 0 to {}: mean error in levels of 1/255",
            thin::RAYS,
            thin::SAMPLES,
            thin::THICKEST
        ),
        head: variant_heads("accumulator / table bits"),
        rows: pairs.iter().map(row).collect(),
    }
}

/// The shortest words of the cone for thin opacity.
pub(crate) fn thin_shortest_table(study: &Study, base: Base) -> Table {
    let levels = study.options.bound_levels;
    let row = |&wire: &Wire| {
        let mut cells = vec![format!("{}_bits", wire.name())];
        cells.extend(Variant::ALL.map(|variant| bits(shortest_thin(&study.thin, (base, wire, variant), levels))));
        cells
    };
    Table {
        title: format!("The cone alone: shortest word for a mean error of at most {levels} levels, {}", others(base)),
        head: variant_heads("word"),
        rows: study.options.wires.iter().filter(|wire| Wire::OF_THE_CONE.contains(wire)).map(row).collect(),
    }
}

/// Errors for which the cheapest design is shown, as multiples of the bound.
const TARGETS: [f64; 9] = [16.0, 8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125, 0.0625];

/// The cheapest words for each error: points of the front.
pub(crate) fn front_table(study: &Study, aim: Aim) -> Table {
    let mut head: Vec<String> = ["error at most", "mean", "rms", "max", "thin", "degrees", "logic", "memory", "cost"]
        .map(String::from)
        .to_vec();
    head.extend(["order", "rounding"].map(String::from));
    let shown: Vec<Wire> = Wire::ALL.into_iter().filter(|wire| !study.unused.contains(wire)).collect();
    head.extend(shown.iter().map(|wire| wire.name().replace('_', " ")));
    let cells = |label: String, row: &Row| {
        let measured = &row.measured;
        let million = |bits: u64| number(bits as f64 / 1e6);
        let mut cells = vec![
            label,
            number(measured.image.mean),
            number(measured.image.rms),
            number(measured.image.max),
            number(measured.thin.mean),
            angles(measured).map_or_else(String::new, |angles| number(angles.mean_deg)),
            million(measured.cost.logic_bits),
            million(measured.cost.memory_bits),
            million(measured.cost.total_bits()),
            row.design.order.name().into(),
            row.design.words.rounding.name().into(),
        ];
        cells.extend(shown.iter().map(|wire| wire.of(&row.design.words).to_string()));
        cells
    };
    let own = study
        .rows
        .iter()
        .find(|row| row.sweep == Sweep::Machine && row.design.machine(&study.machine) == study.machine)
        .map(|row| cells("the machine".into(), row));
    let targets = TARGETS.into_iter().filter_map(|part| {
        let levels = part * study.options.bound_levels;
        Some(cells(number(levels), study.cheapest(aim, levels)?))
    });
    Table {
        title: match aim {
            Aim::Picture => "The front: the cheapest words for a mean error of the picture in levels of 1/255; cost in millions of bits",
            Aim::PictureAndThin => "The cheapest words where the cone alone must keep the same error on rays of thin opacity",
        }
        .into(),
        head,
        rows: own.into_iter().chain(targets).collect(),
    }
}

impl Table {
    fn text(&self) -> String {
        let wide = |column: usize| {
            let cells = self.rows.iter().map(|row| row[column].chars().count());
            cells.chain([self.head[column].chars().count()]).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.head.len()).map(wide).collect();
        let line = |cells: &[String]| {
            let padded = cells.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| match column {
                0 => format!("{cell:<width$}"),
                _ => format!("{cell:>width$}"),
            });
            format!("  {}\n", padded.collect::<Vec<String>>().join("  ").trim_end())
        };
        let rows: String = self.rows.iter().map(|row| line(row)).collect();
        format!("{}\n{}{rows}", self.title, line(&self.head))
    }
}

/// What the command prints.
pub fn summary(study: &Study) -> String {
    let mut text = about(study) + "\n";
    if !study.unused.is_empty() {
        let names: Vec<&str> = study.unused.iter().map(|wire| wire.name()).collect();
        text += &format!("Not varied, as this scene does not use them: {}.\n", names.join(", "));
    }
    let tables = [
        family_table(study),
        shortest_table(study, Base::Wide),
        shortest_table(study, Base::Machine),
        thin_shortest_table(study, Base::Wide),
        thin_shortest_table(study, Base::Machine),
        front_table(study, Aim::Picture),
        front_table(study, Aim::PictureAndThin),
    ];
    for table in tables {
        if !table.rows.is_empty() {
            text += &format!("\n{}", table.text());
        }
    }
    text
}
