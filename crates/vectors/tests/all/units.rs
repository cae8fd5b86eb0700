//! What holds for every unit: sheet, definition, lanes, ranges and coverage agree.

use cube3_vectors::{Coverage, LineField, Sheet, UnitFormat, Vectors, WireRecorder, bits_of, ranges, units};
use std::collections::BTreeSet;

/// Lines for each unit and format.
const LINES: usize = 600;

fn each(mut check: impl FnMut(&dyn cube3_vectors::Unit, UnitFormat)) {
    for unit in units() {
        for format in unit.formats() {
            check(unit.as_ref(), format);
        }
    }
}

#[test]
fn fields_hold_their_ranges_and_names_are_unique() {
    let mut names = BTreeSet::new();
    for unit in units() {
        assert!(names.insert(unit.sheet().name), "{} is there twice", unit.sheet().name);
    }
    each(|unit, format| {
        let sheet = unit.sheet();
        let mut names = BTreeSet::new();
        for fields in [Sheet::fields(&sheet.inputs, &format), Sheet::fields(&sheet.outputs, &format)] {
            for LineField { name, bits, signed, range, .. } in fields.unwrap() {
                let width = if signed { [-(1 << (bits - 1)), (1 << (bits - 1)) - 1] } else { [0, (1 << bits) - 1] };
                assert!(width[0] <= range[0] && range[0] <= range[1] && range[1] <= width[1], "{} {name}", sheet.name);
                assert!(names.insert(name.clone()), "{} {name}", sheet.name);
            }
        }
        for wire in &sheet.wires {
            let ends = wire.range.map(|end| format.evaluate(end).unwrap());
            assert!(ends[0] <= ends[1], "{} {}: {ends:?}", sheet.name, wire.path());
        }
        let tables = unit.tables(&format);
        assert_eq!(tables.len(), sheet.tables.len());
        for (of, table) in sheet.tables.iter().zip(&tables) {
            assert_eq!(table.len() as i128, format.evaluate(of.entries).unwrap(), "{} {}", sheet.name, of.name);
            let bits = format.evaluate(of.bits).unwrap() as u32;
            assert!(table.iter().all(|&entry| entry >= 0 && bits_of([0, entry]) <= bits), "{} {}", sheet.name, of.name);
        }
    });
}

#[test]
fn the_definition_shows_the_wires_of_the_sheet_and_gives_what_its_outputs_hold() {
    each(|unit, format| {
        let vectors = Vectors::generate(unit, format, LINES, 1).unwrap();
        let sheet = &vectors.set.sheet;
        let mut shown = BTreeSet::new();
        let mut recorder = WireRecorder::default();
        for (inputs, outputs) in vectors.inputs.iter().zip(&vectors.outputs) {
            assert_eq!(outputs.len(), vectors.set.fields[1].len(), "{}", sheet.name);
            for (field, value) in vectors.set.fields[0].iter().zip(inputs) {
                let [low, high] = field.range;
                assert!((low..=high).contains(value), "{} {}: {value}", sheet.name, field.name);
            }
            for (field, value) in vectors.set.fields[1].iter().zip(outputs) {
                let [low, high] = field.range;
                assert!((low..=high).contains(value), "{} {}: {value}, {inputs:?}", sheet.name, field.name);
            }
            if sheet.clocked {
                continue;
            }
            recorder.clear();
            unit.evaluate(&format, &vectors.set.tables, inputs, &mut recorder);
            for seen in recorder.seen() {
                let wire = sheet.wire(seen.part, seen.name);
                let wire = wire.unwrap_or_else(|| panic!("{}: no wire {}.{}", sheet.name, seen.part, seen.name));
                let count = format.evaluate(sheet.wires[wire].count).unwrap();
                assert!((seen.place as i128) < count, "{} {}.{}[{}]", sheet.name, seen.part, seen.name, seen.place);
                shown.insert((wire, seen.place));
            }
        }
        for (i, wire) in sheet.wires.iter().enumerate() {
            let count = format.evaluate(wire.count).unwrap() as usize;
            for place in 0..count {
                assert!(shown.contains(&(i, place)), "{} never shows {}[{place}]", sheet.name, wire.path());
            }
        }
    });
}

#[test]
fn lanes_give_the_bits_of_the_definition() {
    each(|unit, format| {
        let vectors = Vectors::generate(unit, format, LINES, 2).unwrap();
        if let Some(lanes) = unit.lanes(&format, &vectors.set.tables, &vectors.inputs) {
            for (line, (lanes, golden)) in lanes.iter().zip(&vectors.outputs).enumerate() {
                assert_eq!(lanes, golden, "{} {:?} {:?}", vectors.set.sheet.name, vectors.inputs[line], format.words);
            }
        }
    });
}

/// No wire carries what its sheet says it cannot, and what it says is reached is.
#[test]
fn ranges_hold_and_are_reached() {
    each(|unit, format| {
        let found = ranges::search(unit, &format, LINES, 3).unwrap();
        for wire in &found.wires {
            let name = unit.sheet().name;
            assert!(wire.holds(), "{name} {wire:?} {format:?}");
            assert!(wire.reached() || !wire.tight, "{name} {wire:?} {format:?}");
        }
    });
}

#[test]
fn the_directed_lines_hit_every_point_of_coverage() {
    each(|unit, format| {
        let vectors = Vectors::directed(unit, format, 4).unwrap();
        let coverage: Coverage = vectors.coverage(unit).unwrap();
        let missed: Vec<&str> = coverage.missed().map(|point| point.name.as_str()).collect();
        assert!(missed.is_empty(), "{} {:?} {:?}", vectors.set.sheet.name, format.words, missed);
    });
}
