//! What vectors have covered: each end of each input, each opcode, each case of each rounding and saturation.

use crate::expression::ExpressionError;
use crate::{LineField, Seen, Sheet, UnitFormat, WireKind};
use std::collections::HashMap;

/// Values of a port or wire up to which each is a case.
const FEW: i128 = 8;

/// Something that should happen at least once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Event {
    /// An element of an input port has a value.
    Input { port: usize, value: i128 },
    /// An element of an output port has a value.
    Output { port: usize, value: i128 },
    /// A wire has a value.
    Value { wire: usize, value: i128 },
    /// A wire is below, at or above 0.
    Sign { wire: usize, sign: i128 },
    /// What a shift drops of a wire: nothing, less than a half, a half, more; of a value below 0 or not.
    Dropped { wire: usize, bits: u32, case: Rest, negative: bool },
    /// What a division by a full word leaves.
    Remainder { wire: usize, full: i128, case: Rest },
    /// A wire is below a bound, between two, or above.
    Held { wire: usize, bounds: [i128; 2], side: i128 },
}

/// What rounding drops, beside the unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::Display)]
enum Rest {
    #[strum(serialize = "exact")]
    Nothing,
    #[strum(serialize = "below the tie")]
    Less,
    #[strum(serialize = "tie")]
    Half,
    #[strum(serialize = "above the tie")]
    More,
}

impl Rest {
    fn of(rest: i128, whole: i128) -> Rest {
        match (2 * rest).cmp(&whole) {
            _ if rest == 0 => Rest::Nothing,
            std::cmp::Ordering::Less => Rest::Less,
            std::cmp::Ordering::Equal => Rest::Half,
            std::cmp::Ordering::Greater => Rest::More,
        }
    }
}

/// A point of coverage.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Point {
    /// What is to happen.
    pub name: String,
    /// How often it did.
    pub hits: u64,
    event: Event,
}

/// The points of a unit in a format.
#[derive(Clone, Debug)]
pub struct Coverage {
    points: Vec<Point>,
    ports_in: Vec<usize>,
    ports_out: Vec<usize>,
    wires: HashMap<(&'static str, &'static str), usize>,
}

impl Coverage {
    /// No point hit.
    ///
    /// # Errors
    /// An expression of the sheet without a value.
    pub fn new(sheet: &Sheet, format: &UnitFormat) -> Result<Coverage, ExpressionError> {
        let inputs = Sheet::fields(&sheet.inputs, format)?;
        let outputs = Sheet::fields(&sheet.outputs, format)?;
        let mut points = Vec::new();
        let mut point = |name: String, event: Event| points.push(Point { name, hits: 0, event });
        let first = |fields: &[LineField], port: usize| fields.iter().find(|field| field.port == port).map(|f| f.range);
        for (port, of) in sheet.inputs.iter().enumerate() {
            let Some([low, high]) = first(&inputs, port) else { continue };
            let values: Vec<i128> = if high - low < FEW { (low..=high).collect() } else { vec![low, high] };
            for value in values {
                let end = if high - low < FEW {
                    value.to_string()
                } else if value == low {
                    "lowest".into()
                } else {
                    "highest".into()
                };
                point(format!("input {} {end}", of.name), Event::Input { port, value });
            }
        }
        for (wire, of) in sheet.wires.iter().enumerate() {
            let path = of.path();
            let [low, high] = [format.evaluate(of.range[0])?, format.evaluate(of.range[1])?];
            if low < 0 {
                for (sign, name) in [(-1, "negative"), (0, "zero"), (1, "positive")] {
                    if !(sign == 1 && high <= 0) {
                        point(format!("{path} {name}"), Event::Sign { wire, sign });
                    }
                }
            }
            let source = |name: &str| sheet.wire(of.part, name).map(|wire| (wire, sheet.wires[wire]));
            match of.kind {
                WireKind::Exact => {}
                WireKind::Cases => {
                    for value in low..=high {
                        point(format!("{path} {value}"), Event::Value { wire, value });
                    }
                }
                WireKind::Rounded { of: name, bits } => {
                    let Some((wire, from)) = source(name) else { continue };
                    let bits = format.evaluate(bits)? as u32;
                    let signs = if format.evaluate(from.range[0])? < 0 { vec![false, true] } else { vec![false] };
                    let cases: &[Rest] = match bits {
                        0 => &[Rest::Nothing],
                        1 => &[Rest::Nothing, Rest::Half],
                        _ => &[Rest::Nothing, Rest::Less, Rest::Half, Rest::More],
                    };
                    for &case in cases {
                        for &negative in &signs {
                            let sign = if negative { " of a negative value" } else { "" };
                            let event = Event::Dropped { wire, bits, case, negative };
                            point(format!("{path} {case}{sign}"), event);
                        }
                    }
                }
                WireKind::UnitProduct { of: name, bits } => {
                    let Some((wire, _)) = source(name) else { continue };
                    let full = (1 << format.evaluate(bits)?) - 1;
                    // The full word is odd: no product lies halfway. Of one bit, each is exact.
                    let cases: &[Rest] =
                        if full == 1 { &[Rest::Nothing] } else { &[Rest::Nothing, Rest::Less, Rest::More] };
                    for &case in cases {
                        point(format!("{path} {case}"), Event::Remainder { wire, full, case });
                    }
                }
                WireKind::Held { of: name, low, high } => {
                    let Some((wire, from)) = source(name) else { continue };
                    let bounds = [format.evaluate(low)?, format.evaluate(high)?];
                    let reach = [format.evaluate(from.range[0])?, format.evaluate(from.range[1])?];
                    for (side, name, there) in [
                        (-1, "held from below", reach[0] < bounds[0]),
                        (0, "passes", true),
                        (1, "held from above", reach[1] > bounds[1]),
                    ] {
                        if there {
                            point(format!("{path} {name}"), Event::Held { wire, bounds, side });
                        }
                    }
                }
            }
        }
        for (port, of) in sheet.outputs.iter().enumerate() {
            let Some([low, high]) = first(&outputs, port) else { continue };
            if high - low < 2 {
                for value in low..=high {
                    point(format!("output {} {value}", of.name), Event::Output { port, value });
                }
            }
        }
        let wires = sheet.wires.iter().enumerate().map(|(i, wire)| ((wire.part, wire.name), i)).collect();
        let ports = |fields: &[LineField]| fields.iter().map(|field| field.port).collect();
        Ok(Coverage { points, ports_in: ports(&inputs), ports_out: ports(&outputs), wires })
    }

    /// Counts a line: its inputs, what its wires carried, its outputs. Whether it hit a point for the first time.
    pub fn see(&mut self, inputs: &[i128], seen: &[Seen], outputs: &[i128]) -> bool {
        let mut new = false;
        let Coverage { points, ports_in, ports_out, wires } = self;
        let mut carried = vec![Vec::new(); wires.len()];
        for seen in seen {
            if let Some(&wire) = wires.get(&(seen.part, seen.name)) {
                carried[wire].push(seen.value);
            }
        }
        for Point { hits, event, .. } in points {
            let of_wire = |wire: usize, test: &dyn Fn(i128) -> bool| carried[wire].iter().any(|&value| test(value));
            let of_port = |fields: &[i128], ports: &[usize], port: usize, value: i128| {
                fields.iter().zip(ports).any(|(field, of)| *of == port && *field == value)
            };
            let hit = match *event {
                Event::Input { port, value } => of_port(inputs, ports_in, port, value),
                Event::Output { port, value } => of_port(outputs, ports_out, port, value),
                Event::Value { wire, value } => of_wire(wire, &|seen| seen == value),
                Event::Sign { wire, sign } => of_wire(wire, &|seen| seen.signum() == sign),
                Event::Dropped { wire, bits, case, negative } => of_wire(wire, &|seen| {
                    (seen < 0) == negative && Rest::of(seen & ((1 << bits) - 1), 1 << bits) == case
                }),
                Event::Remainder { wire, full, case } => {
                    of_wire(wire, &|seen| Rest::of(seen.rem_euclid(full), full) == case)
                }
                Event::Held { wire, bounds: [low, high], side } => of_wire(wire, &|seen| {
                    side == if seen < low {
                        -1
                    } else if seen > high {
                        1
                    } else {
                        0
                    }
                }),
            };
            if hit {
                new |= *hits == 0;
                *hits += 1;
            }
        }
        new
    }

    /// The points.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// The points that were not hit.
    pub fn missed(&self) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(|point| point.hits == 0)
    }
}
