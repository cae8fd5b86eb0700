//! The study's diagrams.

use super::Study;
use super::picture::Aim;
use super::plot::{Look, Mark, Panel, Series, figure};
use super::sweeps::{Base, Row, Sweep};
use super::wire::{Variant, Wire};
use crate::error::Outcome;

/// The diagrams as SVG.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plots {
    /// Cost and error of all designs, the fronts drawn.
    pub front: String,
    /// Picture error against each word's length, the others wide.
    pub wires_wide: String,
    /// The same, the others the machine's own.
    pub wires_machine: String,
    /// Angle of gradients and normals against each word's length; where the scene has gradients.
    pub gradients: Option<String>,
    /// The cone alone; where a wire of the cone was asked for.
    pub thin: Option<String>,
}

/// Draws the study.
///
/// # Errors
/// An error that is not finite.
pub fn plots(study: &Study) -> Outcome<Plots> {
    let wires = &study.options.wires;
    let panels = |base: Base| wires.iter().map(|&wire| wire_panel(study, base, wire)).collect::<Vec<Panel>>();
    let has_gradients = study.rows.iter().any(|row| row.measured.gradient.is_some());
    let gradients: Vec<Panel> = wires
        .iter()
        .filter(|wire| has_gradients && OF_THE_GRADIENT.contains(wire))
        .map(|&wire| gradient_panel(study, wire))
        .collect();
    let thin: Vec<Panel> = Base::ALL
        .into_iter()
        .flat_map(|base| wires.iter().filter(|wire| Wire::OF_THE_CONE.contains(wire)).map(move |&wire| (base, wire)))
        .map(|(base, wire)| thin_panel(study, base, wire))
        .collect();
    let thin_columns = (thin.len() / Base::ALL.len()).max(1);
    let some = |panels: &[Panel], columns: usize| (!panels.is_empty()).then(|| figure(panels, columns, 330.0, 270.0));
    Ok(Plots {
        front: figure(&[front_panel(study, Aim::Picture)?, front_panel(study, Aim::PictureAndThin)?], 1, 940.0, 460.0),
        wires_wide: figure(&panels(Base::Wide), 3, 330.0, 270.0),
        wires_machine: figure(&panels(Base::Machine), 3, 330.0, 270.0),
        gradients: some(&gradients, 3),
        thin: some(&thin, thin_columns),
    })
}

/// Wires before the gradient's direction.
const OF_THE_GRADIENT: [Wire; 5] = [Wire::Voxel, Wire::Weight, Wire::SampleFraction, Wire::Gradient, Wire::Normal];

/// Colours that the colour-blind tell apart: Okabe and Ito 2008.
const BLUE: &str = "#0072b2";
const ORANGE: &str = "#d55e00";
const GREEN: &str = "#00805e";
const BLACK: &str = "#16191d";

fn look(variant: Variant) -> Look {
    let (colour, mark) = match variant.order {
        super::wire::Order::Tree => (BLUE, Mark::Circle),
        super::wire::Order::InOrder => (ORANGE, Mark::Square),
    };
    Look { colour, dashed: variant.truncated, mark }
}

const MEAN: &str = "mean error, levels of 1/255";

/// What the others are, for titles.
fn others(base: Base) -> &'static str {
    match base {
        Base::Wide => "others wide",
        Base::Machine => "others: machine",
    }
}

fn one_wire(row: &Row, base: Base, wire: Wire) -> Option<u32> {
    match row.sweep {
        Sweep::OneWire(of_base, of_wire, bits) if (of_base, of_wire) == (base, wire) => Some(bits),
        _ => None,
    }
}

fn wire_panel(study: &Study, base: Base, wire: Wire) -> Panel {
    let series = Variant::ALL.map(|variant| {
        let point = |row: &Row| {
            let bits = one_wire(row, base, wire).filter(|_| row.design.variant() == variant)?;
            Some([f64::from(bits), row.measured.image.mean])
        };
        let points = study.rows.iter().filter_map(point).collect();
        Series { name: variant.name(), look: look(variant), joined: true, points }
    });
    Panel {
        title: format!("{}_bits, {}", wire.name(), others(base)),
        across: format!("{}_bits", wire.name()),
        up: MEAN.into(),
        series: series.to_vec(),
        bound: Some((study.options.bound_levels, "bound".into())),
        ..Panel::default()
    }
}

fn gradient_panel(study: &Study, wire: Wire) -> Panel {
    let mut series = Vec::new();
    for truncated in [false, true] {
        let variant = Variant { order: super::wire::Order::Tree, truncated };
        for normal in [false, true] {
            let point = |row: &Row| {
                let bits = one_wire(row, Base::Wide, wire).filter(|_| row.design.variant() == variant)?;
                let error = row.measured.gradient?;
                let angles = if normal { error.normal? } else { error.gradient };
                Some([f64::from(bits), angles.mean_deg])
            };
            let (what, colour, mark) =
                if normal { ("normal", GREEN, Mark::Triangle) } else { ("gradient", BLACK, Mark::Diamond) };
            series.push(Series {
                name: format!("{what} word, {}", variant.rounding().name()),
                look: Look { colour, dashed: truncated, mark },
                joined: true,
                points: study.rows.iter().filter_map(point).collect(),
            });
        }
    }
    Panel {
        title: format!("{}_bits, {}", wire.name(), others(Base::Wide)),
        across: format!("{}_bits", wire.name()),
        up: "mean angle, degrees".into(),
        series,
        bound: Some((study.options.bound_deg, "bound".into())),
        ..Panel::default()
    }
}

fn thin_panel(study: &Study, base: Base, wire: Wire) -> Panel {
    let series = Variant::ALL.map(|variant| {
        let points = study.thin.iter().filter_map(|row| match row.sweep {
            Sweep::OneWire(of_base, of_wire, bits)
                if (of_base, of_wire) == (base, wire)
                    && (row.order, row.words.rounding) == (variant.order, variant.rounding()) =>
            {
                Some([f64::from(bits), row.error.mean])
            }
            _ => None,
        });
        Series { name: variant.name(), look: look(variant), joined: true, points: points.collect() }
    });
    Panel {
        title: format!("{}_bits, {}", wire.name(), others(base)),
        across: format!("{}_bits", wire.name()),
        up: MEAN.into(),
        series: series.to_vec(),
        bound: Some((study.options.bound_levels, "bound".into())),
        ..Panel::default()
    }
}

/// Cost in millions of bits.
const MILLION: f64 = 1e6;

fn front_panel(study: &Study, aim: Aim) -> Outcome<Panel> {
    let place = |row: &Row| [row.measured.cost.total_bits() as f64 / MILLION, row.measured.error(aim)];
    let mut series = Vec::new();
    for variant in Variant::ALL {
        let points = study.front(aim, Some(variant))?.iter().map(|&index| place(&study.rows[index])).collect();
        series.push(Series { name: format!("front: {}", variant.name()), look: look(variant), joined: true, points });
    }
    let own = |row: &&Row| row.sweep == Sweep::Machine && row.design.machine(&study.machine) == study.machine;
    series.push(Series {
        name: "the machine".into(),
        look: Look { colour: BLACK, dashed: false, mark: Mark::Star },
        joined: false,
        points: study.rows.iter().filter(own).map(place).collect(),
    });
    Ok(Panel {
        title: match aim {
            Aim::Picture => "Error of the picture".into(),
            Aim::PictureAndThin => "The worse of the picture's error and that of rays of thin opacity".into(),
        },
        across: "cost: cells of logic and bits of tables and buffers, millions".into(),
        up: MEAN.into(),
        log: true,
        series,
        cloud: study.rows.iter().map(place).collect(),
        bound: Some((study.options.bound_levels, format!("bound, {} levels", study.options.bound_levels))),
    })
}
