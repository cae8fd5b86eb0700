//! Every module of `tests/rtl` is broken on purpose in several ways (`tests/rtl/breaks.toml`), and golden vectors catch each break.

use cube3_tests::rtl::{modules, require};
use cube3_tests::rtl_vectors::{Bench, Break, breaks, broken};
use cube3_vectors::{Format, units};
use rayon::prelude::*;
use std::path::Path;

/// Breaks of each module at least.
const LEAST: usize = 5;
const LINES: usize = 400;

/// Whether the vectors of the break's unit differ in any of its formats. A break that cannot be compiled would be caught by anything.
fn caught(of: &Break, iverilog: &Path, vvp: &Path) -> Result<(), String> {
    let copy = broken(of)?;
    let unit = units().into_iter().find(|unit| unit.sheet().name == of.unit);
    let unit = unit.ok_or_else(|| format!("{}: there is no unit {}", of.what, of.unit))?;
    for format in std::iter::once(Format::reference()).chain(unit.formats()) {
        let differ = Bench::new(unit.as_ref(), &format, LINES).icarus(iverilog, vvp, copy.path());
        if differ.map_err(|error| format!("{}: \"{}\": {error}", of.module, of.what))? > 0 {
            return Ok(());
        }
    }
    Err(format!("{}: \"{}\" is not caught by the vectors of {}", of.module, of.what, of.unit))
}

#[test]
fn vectors_catch_every_break() {
    let (Some(iverilog), Some(vvp)) = (require("iverilog"), require("vvp")) else { return };
    let breaks = breaks();
    let of_units: Vec<&Break> = breaks.iter().filter(|of| of.unit != "pipeline").collect();
    let missed: Vec<String> = of_units.par_iter().filter_map(|of| caught(of, &iverilog, &vvp).err()).collect();
    assert!(missed.is_empty(), "{} of {}\n{}", missed.len(), of_units.len(), missed.join("\n"));
}

#[test]
fn every_module_is_broken_in_five_ways_at_least() {
    let breaks = breaks();
    for module in modules() {
        let count = breaks.iter().filter(|of| of.module == module).count();
        assert!(count >= LEAST, "{module} has {count} breaks in breaks.toml");
    }
}
