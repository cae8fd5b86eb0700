//! The modules of `tests/rtl` give the bits of the golden vectors, in every format, in two simulators.

use cube3_tests::rtl::{MADE_SOON, folder, require, run, verilator_program};
use cube3_tests::rtl_vectors::Bench;
use cube3_tests::thorough::thorough;
use cube3_vectors::{Unit, UnitFormat, Vectors, testbench, units};
use rayon::prelude::*;
use std::path::Path;
use std::process::Command;

/// Lines for each unit and format: the directed ones, and random ones up to this.
const LINES: usize = 400;

/// Runs a check on every unit in some of its formats, and tells all that fail.
fn all(formats: impl Fn(&dyn Unit) -> Vec<UnitFormat> + Sync, check: impl Fn(&Bench) -> Result<usize, String> + Sync) {
    let cases: Vec<(Box<dyn Unit>, UnitFormat)> = units()
        .into_iter()
        .flat_map(|unit| {
            let name = unit.sheet().name;
            let again = move || units().into_iter().find(|unit| unit.sheet().name == name);
            formats(unit.as_ref()).into_iter().filter_map(move |format| Some((again()?, format)))
        })
        .collect();
    let failed: Vec<String> = cases
        .par_iter()
        .filter_map(|(unit, format)| {
            let found = check(&Bench::new(unit.as_ref(), format, LINES));
            let what = match found {
                Ok(0) => return None,
                Ok(differ) => format!("{differ} lines differ"),
                Err(error) => error,
            };
            Some(format!("{} {:?}: {what}", unit.sheet().name, format))
        })
        .collect();
    assert!(failed.is_empty(), "{} of {} fail\n{}", failed.len(), cases.len(), failed.join("\n"));
}

#[test]
fn every_unit_in_every_format_in_icarus() {
    let (Some(iverilog), Some(vvp)) = (require("iverilog"), require("vvp")) else { return };
    let formats = |unit: &dyn Unit| match thorough("formats of units in Icarus but the reference") {
        true => unit.formats(),
        false => vec![UnitFormat::reference()],
    };
    all(formats, |bench| bench.icarus(&iverilog, &vvp, &folder()));
}

#[test]
fn every_unit_in_verilator() {
    let Some(verilator) = require("verilator") else { return };
    if !thorough("vectors of units in Verilator") {
        return;
    }
    all(|_| vec![UnitFormat::reference()], |bench| bench.verilator(&verilator, &folder()));
}

/// Runs the bench of the lerp on right and on wrong vectors: `program` is it, compiled.
fn check_exit(program: &Path, arguments: &[&str], folder: &Path, answers: &str) {
    let bench = |given: &[&str]| run(Command::new(program).current_dir(folder).args(arguments).args(given));
    assert!(bench(&["+in=right.hex"]).unwrap().contains("0 of 300 lines differ"));
    let failed = bench(&["+in=wrong.hex"]).unwrap_err();
    assert!(failed.contains("line 299 differs first") && failed.contains("1 of 300 lines differ"), "{failed}");
    // Who reads the answers compares them.
    assert!(bench(&["+in=wrong.hex", "+out=answers.hex"]).unwrap().contains("1 of 300 lines differ"));
    assert_eq!(std::fs::read_to_string(folder.join("answers.hex")).unwrap(), answers);
    for vectors in ["unit.hex", "format.hex", "missing.hex"] {
        for more in [&[][..], &["+out=answers.hex"]] {
            let failed = bench(&[&[format!("+in={vectors}").as_str()], more].concat()).unwrap_err();
            assert!(failed.contains(&format!("{vectors} is no vector file with the lines")), "{failed}");
            assert!(failed.contains("// unit lerp\n// format voxel_bits=16"), "{failed}");
        }
    }
    assert!(bench(&[]).unwrap_err().contains("+in=FILE is missing"));
}

#[test]
fn a_bench_fails_where_nobody_else_compares_and_takes_its_own_vectors_only() {
    let made = tempfile::tempdir().unwrap();
    let path = made.path();
    let unit = |name: &str| units().into_iter().find(|unit| unit.sheet().name == name).unwrap();
    let vectors = |name: &str, format: UnitFormat| Vectors::generate(unit(name).as_ref(), format, 300, 7).unwrap();
    let format = UnitFormat::reference();
    let right = vectors("lerp", format);
    let mut wrong = right.clone();
    wrong.outputs[299][0] ^= 1;
    let mut narrow = format;
    narrow.words.voxel_bits = 8;
    let texts = [
        ("right.hex", right.text()),
        ("wrong.hex", wrong.text()),
        ("unit.hex", vectors("leaf", format).text()),
        ("format.hex", vectors("lerp", narrow).text()),
        ("bench.sv", testbench::text(&right.set.sheet, &format).unwrap()),
    ];
    texts.iter().for_each(|(file, text)| std::fs::write(path.join(file), text).unwrap());
    let answers: String = right.outputs.iter().map(|outputs| format!("{:04x}\n", outputs[0])).collect();
    let compile = |mut command: Command| {
        command.current_dir(path).arg("-y").arg(folder());
        command
    };
    if let (Some(iverilog), Some(vvp)) = (require("iverilog"), require("vvp")) {
        let arguments = ["-Y.sv", "-g2012", "-o", "sim.vvp", "-s", "cube3_lerp_tb", "bench.sv"];
        run(compile(Command::new(&iverilog)).args(arguments)).unwrap();
        check_exit(&vvp, &["-n", "sim.vvp"], path, &answers);
    }
    if let Some(verilator) = require("verilator") {
        let arguments = ["--top-module", "cube3_lerp_tb", "-o", "sim", "-Mdir", "made", "bench.sv"];
        run(compile(verilator_program(&verilator)).args(MADE_SOON).args(arguments)).unwrap();
        check_exit(&path.join("made/sim"), &[], path, &answers);
    }
}
