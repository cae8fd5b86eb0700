//! The modules of `tests/rtl` give the bits of the golden vectors, in every format, in two simulators.

use cube3_tests::rtl::{folder, require};
use cube3_tests::rtl_vectors::Bench;
use cube3_vectors::{Format, Unit, units};
use rayon::prelude::*;

/// Lines for each unit and format: the directed ones, and random ones up to this.
const LINES: usize = 400;

/// Runs a check on every unit in some of its formats, and tells all that fail.
fn all(formats: impl Fn(&dyn Unit) -> Vec<Format> + Sync, check: impl Fn(&Bench) -> Result<usize, String> + Sync) {
    let cases: Vec<(Box<dyn Unit>, Format)> = units()
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
    all(|unit| unit.formats(), |bench| bench.icarus(&iverilog, &vvp, &folder()));
}

#[test]
fn every_unit_in_verilator() {
    let Some(verilator) = require("verilator") else { return };
    all(|_| vec![Format::reference()], |bench| bench.verilator(&verilator, &folder()));
}
