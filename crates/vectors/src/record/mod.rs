//! The traffic of a real run as vectors: what flowed through a unit of arithmetic or addressing while the machine rendered a frame.
//!
//! Lines are in the machine's order: sections and planes of ray slots, slots, depths; beams by section, plane and depth. From the ABC units on,
//! the first plane and the first slot come last where slots are shared, as [`FrameSetup::shading_order`] says. Values are those of the unit crates'
//! definitions on the frame's registers and voxels, which the cycle machine equals to the bit; channels are those of a timing run.

mod channel;
mod error;
mod run;
mod traffic;

pub use error::RecordError;
pub use run::{Excerpt, Run};

use crate::{Set, Tables, Unit, UnitFormat, Vectors};
use channel::{channel, cycles};
use cube3_frame::{FrameSetup, Shading};
use std::ops::ControlFlow::{Break, Continue};
use traffic::{Frame, Lines};

/// The traffic of a unit in a run: the format is the machine's with what the frame's registers set, and tables are the frame's.
///
/// - `lerp` is the first along w of each TRILIN unit: of rays (u, v).
/// - From the gradient on, samples inside of every half-space; from the light on, those of them that are not transparent. `clip`
///   has a line for each half-space.
/// - `leaf` has a line for every depth of every slot, `node` one for each call of a node, in the order of the tree.
/// - `cone` has a line for each chunk of a slot, of a tree with as many leaves as the machine has lanes.
/// - `cfb` and `bus` are what beams are read and turned by, `dsb` where rays are read.
/// - `channel` begins at the first cycle of the window in which the channel is empty; data are the tokens' numbers modulo 2^16.
pub struct Recording<'a> {
    run: &'a Run<'a>,
    window: &'a Excerpt<'a>,
    set: Set,
}

impl<'a> Recording<'a> {
    /// The recording of a unit, before its first line.
    ///
    /// # Errors
    /// A frame or channel that is not there, a unit that the frame does not use.
    pub fn new(run: &'a Run<'a>, unit: &dyn Unit, window: &'a Excerpt<'a>) -> Result<Recording<'a>, RecordError> {
        let name = unit.sheet().name;
        let frames = run.frames.len();
        let setup = run.frames.get(window.frame).ok_or(RecordError::Frame { frame: window.frame, frames })?;
        if name == "classify" && setup.ends.is_some() {
            return Err(RecordError::Ends);
        }
        let mut format = format(run, setup, name);
        if name == "channel" {
            let (machine, place) = channel(run, window)?;
            let reading = machine.counters().channels[place];
            (format.capacity, format.latency) = (reading.capacity as u32, reading.latency as u32);
        } else if let Some(reason) = Frame::new(run, setup).idle(name) {
            return Err(RecordError::Idle { unit: name, reason });
        }
        let set = Set::with_tables(unit, format, 0, tables(setup, name, unit, &format))?;
        Ok(Recording { run, window, set })
    }

    /// What the lines have in common.
    pub fn set(&self) -> &Set {
        &self.set
    }

    /// Gives the input fields of each line of the window to `take`, in order.
    ///
    /// # Errors
    /// A window behind the last line, traffic that the unit's vectors cannot hold, and what `take` says.
    pub fn lines<E: From<RecordError>>(&self, take: &mut dyn FnMut(Vec<i128>) -> Result<(), E>) -> Result<(), E> {
        let Recording { run, window, set } = self;
        let name = set.sheet.name;
        let mut checked = |line: usize, inputs: Vec<i128>| {
            check(set, line, &inputs)?;
            take(inputs)
        };
        if name == "channel" {
            return cycles(run, window, &mut checked);
        }
        let frame = Frame::new(run, &run.frames[window.frame]);
        let mut failed = None;
        let mut lines = Lines {
            first: window.first,
            count: window.count,
            seen: 0,
            taken: 0,
            take: &mut |line, inputs| {
                let taken = checked(line, inputs);
                failed = taken.err();
                if failed.is_none() { Continue(()) } else { Break(()) }
            },
        };
        let _ = frame.traffic(name, &mut lines).map_err(RecordError::from)?;
        let (taken, seen) = (lines.taken, lines.seen);
        match failed {
            Some(error) => Err(error),
            None if taken == 0 && seen <= window.first && window.count > 0 => {
                Err(RecordError::Beyond { unit: name, found: seen, first: window.first }.into())
            }
            None => Ok(()),
        }
    }
}

/// The vectors of a unit from a run, in memory.
///
/// # Errors
/// Those of [`Recording`].
pub fn record(run: &Run<'_>, unit: &dyn Unit, window: &Excerpt<'_>) -> Result<Vectors, RecordError> {
    let recording = Recording::new(run, unit, window)?;
    let mut inputs = Vec::new();
    recording.lines(&mut |line| {
        inputs.push(line);
        Ok::<(), RecordError>(())
    })?;
    Ok(Vectors::of(unit, recording.set, inputs))
}

/// Whether the unit's vectors hold a line.
fn check(set: &Set, line: usize, inputs: &[i128]) -> Result<(), RecordError> {
    for (field, &value) in set.fields[0].iter().zip(inputs) {
        let [low, high] = field.range;
        if !(low..=high).contains(&value) {
            let unit = set.sheet.name;
            let remedy = "take a smaller volume or another view";
            return Err(RecordError::Value { unit, line, field: field.name.clone(), value, low, high, remedy });
        }
    }
    Ok(())
}

/// The format of a unit in a frame.
fn format(run: &Run<'_>, setup: &FrameSetup, unit: &str) -> UnitFormat {
    let machine = run.machine;
    let mut format = UnitFormat { words: setup.words, ..UnitFormat::of(machine) };
    format.lanes = if unit == "cone" { setup.cone.leaves } else { machine.lanes } as u32;
    format.dims = run.dims.map(|n| n as u32);
    if let Some(scale) = setup.gradient.and_then(|registers| registers.scale) {
        format.kept_bits = scale.kept_bits;
    }
    if let Some(table) = &setup.normaliser {
        format.root_bits = table.root_bits;
    }
    match &setup.shading {
        Some(Shading::Phong(phong)) => {
            format.power_bits = phong.power_bits;
            format.lights = phong.lights.len().max(1) as u32;
        }
        Some(Shading::Table(table)) => format.reflectance_bits = table.bits,
        None => {}
    }
    format.rows = setup.classification.gradient_rows.map_or(1, |rows| rows.rows);
    format.classes = setup.rays.as_ref().map_or(1, |rays| rays.length_classes);
    format
}

/// The contents of a unit's tables in a frame.
fn tables(setup: &FrameSetup, name: &str, unit: &dyn Unit, format: &UnitFormat) -> Tables {
    let words = |table: &[u32]| table.iter().map(|&entry| entry.into()).collect::<Vec<i128>>();
    let packed = |table: &[[u32; 3]], bits: u32| {
        let pack = |entry: &[u32; 3]| (0..3).map(|i| i128::from(entry[i]) << (bits * i as u32)).sum();
        table.iter().map(pack).collect::<Vec<i128>>()
    };
    let colour_bits = setup.words.colour_bits;
    match (name, &setup.normaliser, &setup.shading) {
        ("normalise", Some(normaliser), _) => vec![words(&normaliser.root)],
        ("classify", ..) => {
            vec![words(&setup.classification.opacity), packed(&setup.classification.colour, colour_bits)]
        }
        ("phong", _, Some(Shading::Phong(phong))) => vec![words(&phong.power)],
        ("reflectance", _, Some(Shading::Table(table))) => {
            vec![packed(&table.diffuse, colour_bits + 4), packed(&table.specular, colour_bits + 4)]
        }
        _ => unit.tables(format),
    }
}
