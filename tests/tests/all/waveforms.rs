//! Waveforms as people see them: GTKWave's own reader finds the same times and values as wellen, and the files for viewers show
//! every variable once, in the group of its scope.

use cube3_channel::Activity;
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::MachineSpec;
use cube3_pipeline::Machine;
use cube3_scene::Scene;
use cube3_tests::rtl;
use cube3_tests::waves::{Shown, Waves, of_gtkwave, of_surfer};
use cube3_trace::{CycleWindow, Recorder};
use cube3_vectors::compare::Compared;
use cube3_vectors::{Answer, Comparison, UnitFormat, Vectors, around_mismatch, units};
use cube3_waveform::Waveform;

/// The trace of some cycles of a frame of a small volume.
fn trace(clock_hz: f64, from: u64, to: u64) -> Waveform {
    let machine = MachineSpec { lanes: 4, clock_hz, ..MachineSpec::default() };
    let volume = VolumeInfo { dims: [32; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let setup = frame_setup(&Scene::default(), &machine, &volume, true).unwrap().setup;
    let mut run = Machine::timing(&machine, vec![setup]).unwrap();
    run.run_until(from, &|_, _| {}).unwrap();
    let mut recorder = Recorder::new(&run, CycleWindow { from, to }, clock_hz);
    assert!(!recorder.run(&mut run, to, &|_, _| {}).unwrap(), "the run is longer than the window");
    recorder.finish().waveform().unwrap()
}

/// The waveform of so many lines before and behind line 20 of a unit, whose device is right but for a bit of that line.
fn mismatch(unit: &dyn cube3_vectors::Unit, around: usize) -> (Vectors, Waveform) {
    let vectors = Vectors::generate(unit, UnitFormat::default(), 40, 1).unwrap();
    let mut comparison = Comparison::new(&vectors.set, around);
    for (line, (inputs, outputs)) in vectors.inputs.iter().zip(&vectors.outputs).enumerate() {
        let mut given = outputs.clone();
        given[0] ^= i128::from(line == 20);
        let answers = vectors.set.fields[1].iter().zip(given).map(|(field, value)| Answer::of(field, value)).collect();
        comparison.push(Compared { inputs: inputs.clone(), outputs: outputs.clone(), answers });
    }
    let waveform = around_mismatch(unit, &vectors.set, &comparison.finish().unwrap()).unwrap();
    (vectors, waveform)
}

/// A name as it stands in a waveform.
fn plain(name: &str) -> String {
    name.replace(['[', '.', '-'], "_").replace(']', "")
}

/// The blocks of changes of a file.
fn blocks(fst: &[u8]) -> usize {
    let (mut rest, mut blocks) = (fst, 0);
    while let Some((&kind, behind)) = rest.split_first() {
        blocks += usize::from(kind == 8);
        rest = &behind[u64::from_be_bytes(behind[..8].try_into().unwrap()) as usize..];
    }
    blocks
}

#[test]
fn gtkwave_sees_each_edge_at_its_time_and_the_values_of_wellen() {
    let Some(fst2vcd) = rtl::require("fst2vcd") else { return };
    for (clock_hz, from, to, several) in [
        (8e6, 0, 40, false),
        (8e6, 1, 2, false),
        (8e6, 1000, 1400, false),
        (133e6, 1000, 1100, false),
        (1e9, 1234, 1300, false),
        (8e6, 500, 7000, true),
    ] {
        let waveform = trace(clock_hz, from, to);
        assert_eq!(blocks(&waveform.fst) > 1, several, "{} bytes", waveform.fst.len());
        let waves = Waves::by_fst2vcd(&fst2vcd, &waveform.fst);
        assert_eq!(waves.times.len() as u64, 2 * (to - from) + 1, "two edges a cycle, and the end");
        for (place, halves) in (2 * from..=2 * to).enumerate() {
            let exact = halves as f64 / 2.0 / clock_hz;
            let found = waves.seconds(place);
            assert!(
                (found - exact).abs() <= 0.501 * waves.unit_seconds(),
                "half cycle {halves}: {found} s, not {exact} s"
            );
            let rises = halves % 2 == 0 && halves < 2 * to;
            assert_eq!(waves.bits("cube3.clock", place), if rises { "1" } else { "0" }, "half cycle {halves}");
        }
        if clock_hz == 8e6 {
            let ends = [waves.times[0], *waves.times.last().unwrap()];
            assert_eq!((waves.unit, ends), ((-12, 100), [from, to].map(|cycle| 1250 * cycle as i64)), "125 ns a cycle");
        }
        assert!(waves == Waves::by_wellen(waveform.fst), "{from} to {to} at {clock_hz} Hz");
    }
}

#[test]
fn gtkwave_sees_each_line_of_a_mismatch_at_its_time_and_the_values_of_wellen() {
    let Some(fst2vcd) = rtl::require("fst2vcd") else { return };
    for unit in units() {
        for (around, lines) in [(20, 0..40), (16, 4..37), (0, 20..21)] {
            let (vectors, waveform) = mismatch(unit.as_ref(), around);
            let name = plain(vectors.set.sheet.name);
            let waves = Waves::by_fst2vcd(&fst2vcd, &waveform.fst);
            let times: Vec<i64> = (lines.start..=lines.end).map(|line| 10 * line as i64).collect();
            assert_eq!((waves.unit, &waves.times), ((-9, 1), &times), "{name}");
            for (place, line) in lines.enumerate() {
                assert_eq!(waves.word(&format!("{name}.line"), place), Some(line as u64));
                assert_eq!(waves.word(&format!("{name}.differs"), place), Some(u64::from(line == 20)));
            }
            assert!(waves == Waves::by_wellen(waveform.fst), "{name}");
        }
    }
}

/// The files for viewers show what the waveform has, in its order, and the formats by name.
fn shown(waveform: &Waveform) -> Vec<(Shown, Shown)> {
    let waves = Waves::by_wellen(waveform.fst.clone());
    let (text, commands) = (waveform.gtkwave("a name"), waveform.surfer());
    let (gtkwave, other) = of_gtkwave(&text);
    let surfer = of_surfer(&commands);
    let start = format!("[timestart] {}", waves.times[0]);
    assert_eq!(other[..3], ["[dumpfile] \"a name.fst\"", "[savefile] \"a name.gtkw\"", &start]);
    let mut names: Vec<(&str, u32)> = gtkwave.iter().map(|(shown, bits)| (shown.name.as_str(), *bits)).collect();
    assert!(surfer.iter().map(|shown| shown.name.as_str()).eq(names.iter().map(|(name, _)| *name)));
    names.sort_unstable();
    assert!(names.iter().copied().eq(waves.variables.iter().map(|(name, values)| (name.as_str(), values.bits))));
    for shown in gtkwave.iter().map(|(shown, _)| shown).chain(&surfer) {
        let scopes = shown.name.rsplit_once('.').unwrap().0;
        assert_eq!(Some(shown.group.as_str()), scopes.rsplit('.').next(), "{shown:?}");
    }
    gtkwave.into_iter().map(|(shown, _)| shown).zip(surfer).collect()
}

#[test]
fn viewers_show_every_variable_of_a_trace_and_activities_by_name() {
    let waveform = trace(8e6, 1000, 1040);
    let waves = Waves::by_wellen(waveform.fst.clone());
    let mut kinds = 0;
    for (gtkwave, surfer) in shown(&waveform) {
        let name = gtkwave.name.as_str();
        let formats = match name.rsplit('.').next().unwrap() {
            "kind" => ("820", "ASCII"),
            "occupancy" => ("88024", "Unsigned step"),
            "clock" | "push" | "pop" => ("28", ""),
            _ => ("24", "Unsigned"),
        };
        assert_eq!((gtkwave.format.as_str(), surfer.format.as_str()), formats, "{name}");
        if let Some(unit) = name.strip_suffix(".kind") {
            kinds += 1;
            for place in 0..waves.times.len() {
                let activity = waves.word(&format!("{unit}.activity"), place).unwrap();
                assert_eq!(waves.text(name, place), Activity::from_code(activity as u8).unwrap().name());
            }
        }
    }
    assert_eq!(kinds, cube3_pipeline::UNITS);
}

#[test]
fn viewers_show_every_variable_of_a_mismatch() {
    for unit in units() {
        let (vectors, waveform) = mismatch(unit.as_ref(), 16);
        let shown = shown(&waveform);
        for (gtkwave, surfer) in &shown {
            let formats = [("28", ""), ("22", "Hexadecimal"), ("420", "Signed"), ("24", "Unsigned"), ("22", "Signed")];
            assert!(formats.contains(&(&gtkwave.format, &surfer.format)), "{gtkwave:?} {surfer:?}");
        }
        for field in vectors.set.fields[0].iter().filter(|field| (2..=64).contains(&field.bits)) {
            let name = format!("{}.in.{}", plain(vectors.set.sheet.name), plain(&field.name));
            let (gtkwave, _) = shown.iter().find(|(gtkwave, _)| gtkwave.name == name).unwrap();
            assert_eq!(gtkwave.format, if field.signed { "420" } else { "22" }, "{name}");
        }
    }
}
