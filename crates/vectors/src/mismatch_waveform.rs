//! The lines around a mismatch as an FST waveform: a line is ten time units.
//!
//! ```text
//!   <unit>.line, .differs
//!   <unit>.in.<port>        fields that drive the unit
//!   <unit>.wires.<wire>     what the definition's wires carry
//!   <unit>.expected.<port>, <unit>.got.<port>
//! ```

use crate::compare::{Compared, Mismatch};
use crate::{LineField, Set, Unit, WireRecorder, bits_of};
use cube3_waveform::{Radix, Signal, Waveform, WaveformError, WaveformHeader};

/// Time units of a line.
const LINE: u64 = 10;

fn digits(bits: u128, width: u32) -> Vec<u8> {
    (0..width).rev().map(|bit| if bits >> bit & 1 == 1 { b'1' } else { b'0' }).collect()
}

fn unknown(width: u32) -> Vec<u8> {
    vec![b'x'; width as usize]
}

fn radix(signed: bool) -> Radix {
    if signed { Radix::Signed } else { Radix::Hexadecimal }
}

fn variables(header: &mut WaveformHeader, name: &str, fields: &[LineField]) -> Result<Vec<Signal>, WaveformError> {
    header.scope(name)?;
    let signals = fields.iter().map(|field| header.variable(&field.name, field.bits, radix(field.signed))).collect();
    header.up_scope()?;
    signals
}

/// The waveform of the lines around a mismatch.
///
/// # Errors
/// What the writer of the format says.
pub fn around_mismatch(unit: &dyn Unit, set: &Set, mismatch: &Mismatch) -> Result<Waveform, WaveformError> {
    let sheet = &set.sheet;
    let mut header = WaveformHeader::new(mismatch.from as u64 * LINE, -9)?;
    header.scope(sheet.name)?;
    let number = header.variable("line", 32, Radix::Unsigned)?;
    let differs = header.flag("differs")?;
    let inputs = variables(&mut header, "in", &set.fields[0])?;
    header.scope("wires")?;
    let mut wires = Vec::new();
    for wire in &sheet.wires {
        let count = set.format.evaluate(wire.count).unwrap_or(1).max(1) as usize;
        let ends = [0, 1].map(|end| set.format.evaluate(wire.range[end]).unwrap_or(0));
        let bits = bits_of(ends);
        let mut row = Vec::new();
        for place in 0..count {
            let name = if count == 1 { wire.path() } else { format!("{}[{place}]", wire.path()) };
            row.push(header.variable(&name, bits, radix(ends[0] < 0))?);
        }
        wires.push((row, bits));
    }
    header.up_scope()?;
    let expected = variables(&mut header, "expected", &set.fields[1])?;
    let got = variables(&mut header, "got", &set.fields[1])?;
    header.up_scope()?;
    let mut body = header.finish()?;
    let mut recorder = WireRecorder::default();
    for (line, Compared { inputs: values, outputs, answers }) in (mismatch.from..).zip(&mismatch.around) {
        body.time(line as u64 * LINE)?;
        body.change(number, &digits(line as u128, 32))?;
        for ((field, value), signal) in set.fields[0].iter().zip(values).zip(&inputs) {
            body.change(*signal, &digits(*value as u128, field.bits))?;
        }
        let mut carried: Vec<Vec<Vec<u8>>> = wires.iter().map(|(row, bits)| vec![unknown(*bits); row.len()]).collect();
        if !sheet.clocked {
            recorder.clear();
            unit.evaluate(&set.format, &set.tables, values, &mut recorder);
            for seen in recorder.seen() {
                let wire = sheet.wire(seen.part, seen.name);
                if let Some((place, bits)) =
                    wire.and_then(|wire| Some((carried[wire].get_mut(seen.place)?, wires[wire].1)))
                {
                    *place = digits(seen.value as u128, bits);
                }
            }
        }
        for ((row, _), values) in wires.iter().zip(&carried) {
            for (signal, value) in row.iter().zip(values) {
                body.change(*signal, value)?;
            }
        }
        let mut wrong = false;
        for (i, field) in set.fields[1].iter().enumerate() {
            let right = digits(outputs[i] as u128, field.bits);
            let answer = answers[i].bits.map_or(unknown(field.bits), |bits| digits(bits, field.bits));
            wrong |= right != answer;
            body.change(expected[i], &right)?;
            body.change(got[i], &answer)?;
        }
        body.change(differs, if wrong { b"1" } else { b"0" })?;
    }
    body.finish((mismatch.from + mismatch.around.len()) as u64 * LINE)
}
