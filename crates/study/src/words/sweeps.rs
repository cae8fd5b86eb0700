//! The points of the study: one wire at a time, all words alike, and a walk from long words to short ones.

use super::levels::ImageLevels;
use super::picture::{Aim, Measured, SceneCase};
use super::thin::ThinCase;
use super::wire::{Design, Order, Variant, Wire, uniform, widest};
use crate::error::Outcome;
use cube3_word::Words;
use rayon::prelude::*;
use serde::Serialize;
use std::ops::RangeInclusive;

/// What the other words are, where one is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Base {
    /// Every word at its largest length.
    Wide,
    /// The machine's own.
    Machine,
}

impl Base {
    /// Both.
    pub const ALL: [Base; 2] = [Base::Wide, Base::Machine];

    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Base::Wide => "wide",
            Base::Machine => "machine",
        }
    }
}

/// Why a point was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sweep {
    /// One wire is varied.
    OneWire(Base, Wire, u32),
    /// All words have about so many bits.
    Uniform(u32),
    /// A grid of accumulator and table lengths.
    Grid,
    /// A step of a walk from long words to short ones, or a neighbour of one.
    Search(Aim),
    /// The machine's own words.
    Machine,
}

impl Sweep {
    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Sweep::OneWire(Base::Wide, ..) => "one-wire-wide",
            Sweep::OneWire(Base::Machine, ..) => "one-wire-machine",
            Sweep::Uniform(_) => "uniform",
            Sweep::Grid => "grid",
            Sweep::Search(Aim::Picture) => "search",
            Sweep::Search(Aim::PictureAndThin) => "search-with-thin",
            Sweep::Machine => "machine",
        }
    }
}

/// A point of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Why.
    pub sweep: Sweep,
    /// The design.
    pub design: Design,
    /// Errors and cost.
    pub measured: Measured,
}

/// A point of the cone alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinRow {
    /// Why.
    pub sweep: Sweep,
    /// Opacity, colour, accumulator and rounding count.
    pub words: Words,
    /// Order in the cone.
    pub order: Order,
    /// Error of red.
    pub error: ImageLevels,
}

/// Bits of the uniform family.
const UNIFORM: RangeInclusive<u32> = 4..=16;

/// The words of a base, and whether tables are fine.
fn base_design(base: Base, machine: &Words, variant: Variant) -> Design {
    match base {
        Base::Wide => Design::widest(variant),
        Base::Machine => Design::of(*machine, variant),
    }
}

/// Measures a sweep's designs.
fn rows(case: &mut SceneCase<'_>, points: Vec<(Sweep, Design)>) -> Outcome<Vec<Row>> {
    let designs: Vec<Design> = points.iter().map(|(_, design)| *design).collect();
    let measured = case.measure(&designs)?;
    let row = |((sweep, design), measured)| Row { sweep, design, measured };
    Ok(points.into_iter().zip(measured).map(row).collect())
}

/// The machine's own words and the uniform family, in all variants.
pub fn families(case: &mut SceneCase<'_>, machine: &Words) -> Outcome<Vec<Row>> {
    let own = Variant::ALL.map(|variant| (Sweep::Machine, Design::of(*machine, variant)));
    let alike = UNIFORM.flat_map(|bits| {
        Variant::ALL.map(|variant| (Sweep::Uniform(bits), Design::of(uniform(bits, variant.rounding()), variant)))
    });
    rows(case, own.into_iter().chain(alike).collect())
}

/// Each wire over its legal lengths, the others wide and then the machine's own.
pub fn one_wire(case: &mut SceneCase<'_>, machine: &Words, wires: &[Wire]) -> Outcome<Vec<Row>> {
    let mut points = Vec::new();
    for base in Base::ALL {
        for &wire in wires {
            for bits in wire.lengths() {
                for variant in Variant::ALL {
                    let start = base_design(base, machine, variant);
                    let words = wire.with(start.words, bits);
                    // A gradient or an index is no longer than the sample.
                    if wire.of(&words) == bits {
                        points.push((Sweep::OneWire(base, wire, bits), Design { words, ..start }));
                    }
                }
            }
        }
    }
    rows(case, points)
}

/// The shortest length from which on, in a sweep of one wire, the error is never above the bound.
pub fn shortest(
    rows: &[Row],
    (base, wire, variant): (Base, Wire, Variant),
    within: impl Fn(&Measured) -> bool,
) -> Option<u32> {
    let points = rows.iter().filter_map(|row| match row.sweep {
        Sweep::OneWire(of_base, of_wire, bits) if (of_base, of_wire) == (base, wire) => {
            (row.design.variant() == variant).then_some((bits, within(&row.measured)))
        }
        _ => None,
    });
    first_of_the_good_end(points.collect())
}

/// The same for rays of thin opacity.
pub fn shortest_thin(rows: &[ThinRow], (base, wire, variant): (Base, Wire, Variant), bound: f64) -> Option<u32> {
    let points = rows.iter().filter_map(|row| match row.sweep {
        Sweep::OneWire(of_base, of_wire, bits) if (of_base, of_wire) == (base, wire) => {
            let same = (row.order, row.words.rounding) == (variant.order, variant.rounding());
            same.then_some((bits, row.error.mean <= bound))
        }
        _ => None,
    });
    first_of_the_good_end(points.collect())
}

/// The first length of the longest run of good ones that ends with the longest length.
fn first_of_the_good_end(mut points: Vec<(u32, bool)>) -> Option<u32> {
    points.sort_unstable();
    points.iter().rev().take_while(|(_, good)| *good).last().map(|(bits, _)| *bits)
}

/// How far above the error of wide words a wire's may be where a walk begins, as a part of the bound; all wires together stay
/// well below it.
const START: f64 = 1.0 / 64.0;

/// A walk ends above this multiple of the bound.
const END: f64 = 16.0;

/// From words that are long enough to short ones, for each aim and variant: of all wires, the one is shortened by a bit that adds
/// the least error for each bit of cost that it saves. All neighbours that were tried are points. `one_wire` are rows of that sweep.
pub fn search(
    case: &mut SceneCase<'_>,
    machine: &Words,
    wires: &[Wire],
    one_wire: &[Row],
    bound: f64,
) -> Outcome<Vec<Row>> {
    let mut found = Vec::new();
    for aim in Aim::ALL {
        for variant in Variant::ALL {
            let wide = case.measure(&[Design::widest(variant)])?;
            let enough = wide.first().map_or(0.0, |wide| wide.error(aim)) + START * bound;
            let words = wires.iter().fold(Design::of(*machine, variant).words, |words, &wire| {
                let longest = *wire.lengths().end();
                let within = |measured: &Measured| measured.error(aim) <= enough;
                wire.with(words, shortest(one_wire, (Base::Wide, wire, variant), within).unwrap_or(longest))
            });
            found.extend(walk(case, Design::of(words, variant), aim, wires, bound)?);
        }
    }
    Ok(found)
}

/// One walk, with all neighbours.
fn walk(case: &mut SceneCase<'_>, from: Design, aim: Aim, wires: &[Wire], bound: f64) -> Outcome<Vec<Row>> {
    let mut found = Vec::new();
    let mut next = rows(case, vec![(Sweep::Search(aim), from)])?.pop();
    while let Some(last) = next.filter(|row| row.measured.error(aim) <= END * bound) {
        found.push(last);
        let shorter = |wire: &Wire| {
            let bits = wire.of(&last.design.words).checked_sub(1).filter(|bits| wire.lengths().contains(bits))?;
            Some((Sweep::Search(aim), Design::of(wire.with(last.design.words, bits), last.design.variant())))
        };
        let tried = rows(case, wires.iter().filter_map(shorter).collect())?;
        let price = |row: &Row| {
            let added = (row.measured.error(aim) - last.measured.error(aim)).max(0.0);
            let saved = last.measured.cost.total_bits().saturating_sub(row.measured.cost.total_bits());
            (added / saved.max(1) as f64, saved)
        };
        let cheaper = |a: &Row, b: &Row| {
            let ((a, saved_a), (b, saved_b)) = (price(a), price(b));
            a.total_cmp(&b).then(saved_b.cmp(&saved_a))
        };
        next = tried.iter().copied().min_by(cheaper);
        found.extend(tried.into_iter().filter(|row| next.is_none_or(|next| next.design != row.design)));
    }
    Ok(found)
}

/// Lengths of the grid of the cone alone: accumulator, and opacity and colour.
const GRID: ([u32; 8], [u32; 5]) = ([8, 10, 12, 14, 16, 20, 24, 32], [8, 10, 12, 14, 16]);

/// The cone alone: its wires one at a time, then accumulator against opacity and colour.
pub fn thin(case: &ThinCase, machine: &Words, wires: &[Wire]) -> Vec<ThinRow> {
    let mut points: Vec<(Sweep, Words, Order)> = Vec::new();
    for base in Base::ALL {
        for wire in Wire::OF_THE_CONE.into_iter().filter(|wire| wires.contains(wire)) {
            for bits in wire.lengths() {
                for variant in Variant::ALL {
                    let words = wire.with(base_design(base, machine, variant).words, bits);
                    points.push((Sweep::OneWire(base, wire, bits), words, variant.order));
                }
            }
        }
    }
    for accumulator in GRID.0 {
        for table in GRID.1 {
            for variant in Variant::ALL {
                let wide = widest(variant.rounding());
                let words = Words { accumulator_bits: accumulator, opacity_bits: table, colour_bits: table, ..wide };
                points.push((Sweep::Grid, words, variant.order));
            }
        }
    }
    let row = |(sweep, words, order)| ThinRow { sweep, words, order, error: case.measure(&words, order) };
    points.into_par_iter().map(row).collect()
}
