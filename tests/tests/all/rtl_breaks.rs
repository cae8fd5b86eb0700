//! Every module of `tests/rtl` is broken on purpose in several ways (`tests/rtl/breaks.toml`). Golden vectors catch each break of a
//! block, and frames that run beside `Machine::cycle` each break of the units and of the pipeline.

use cube3_machine::{GradientMethod, MachineSpec, RaySlots, Rays};
use cube3_scene::{Mode, Scene};
use cube3_tests::rtl::{all_modules, folder, require};
use cube3_tests::rtl_pipeline::{Case, Design, Effort, PreparedFrame, Simulator, lit, machine, narrow, noise, scene};
use cube3_tests::rtl_vectors::{Bench, Break, breaks, broken};
use cube3_tests::thorough::thorough;
use cube3_vectors::{UnitFormat, units};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::Path;

/// Breaks of each module at least.
const LEAST: usize = 5;
const LINES: usize = 400;

/// The breaks that the vectors of a unit must catch, or those that frames must: all, or in a quick run the first of each module.
fn breaks_of(pipeline: bool) -> Vec<Break> {
    let mut modules = BTreeSet::new();
    let all = thorough("RTL breaks but the first of each module");
    let tried = |of: &Break| (of.unit == "pipeline") == pipeline && (modules.insert(of.module.clone()) || all);
    breaks().into_iter().filter(tried).collect()
}

/// Whether the vectors of the break's unit differ in any of its formats. A break that cannot be compiled would be caught by anything.
fn caught(of: &Break, iverilog: &Path, vvp: &Path) -> Result<(), String> {
    let copy = broken(of)?;
    let unit = units().into_iter().find(|unit| unit.sheet().name == of.unit);
    let unit = unit.ok_or_else(|| format!("{}: there is no unit {}", of.what, of.unit))?;
    for format in std::iter::once(UnitFormat::reference()).chain(unit.formats()) {
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
    let breaks = breaks_of(false);
    let missed: Vec<String> = breaks.par_iter().filter_map(|of| caught(of, &iverilog, &vvp).err()).collect();
    assert!(missed.is_empty(), "{} of {}\n{}", missed.len(), breaks.len(), missed.join("\n"));
}

/// The frames that catch the breaks of the pipeline, in sets of the same parameters, those that catch most first: rays tilted along
/// both axes and lit; against their direction; tilted along one axis alone; at 45°, where samples lie on planes, without a gradient;
/// and slots that are not shared, where units stall. Short words are simulated faster.
fn frames(folder: &Path) -> Vec<Vec<PreparedFrame>> {
    let words = narrow();
    let shared = machine(8, GradientMethod::Twelve, words);
    let padded = MachineSpec { rays: Rays { slots: RaySlots::Padded, ..Rays::default() }, ..shared.clone() };
    let (noise, info) = (noise(8, &words), noise(8, &words).info());
    let both = lit([0.55, 0.3, 1.0], Mode::Composite);
    let case = |scene: &Scene, machine| Case::new(scene, machine, &noise, &info, false);
    let sets = [
        vec![
            case(&both, &shared),
            case(&lit([-0.9, -0.35, 0.6], Mode::WeightedSum), &shared),
            case(&lit([0.4, 0.0, 1.0], Mode::Composite), &shared),
            Case::new(&scene([1.0, 1.0, 1.0], Mode::Maximum), &shared, &noise, &info, true),
        ],
        vec![case(&both, &padded)],
    ];
    let prepare = |set: usize, cases: &[Case<'_>]| {
        let frame = |(i, case): (usize, &Case<'_>)| case.prepare(&folder.join(format!("frame{set}.{i}")));
        cases.iter().enumerate().map(frame).collect()
    };
    sets.iter().enumerate().map(|(set, cases)| prepare(set, cases)).collect()
}

/// The first thing that a folder of modules does otherwise than our simulator in the frames, with the frame.
fn first_difference(modules: &Path, sets: &[Vec<PreparedFrame>]) -> Result<Option<String>, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    for set in sets {
        let design = Design::of(modules, Simulator::Icarus, &set[0].parameters, Effort::Quick, folder.path())?;
        for frame in set {
            assert_eq!(frame.parameters, set[0].parameters, "{}", frame.name);
            if let Some(difference) = frame.difference(&design)? {
                return Ok(Some(format!("{}: {difference}", frame.name)));
            }
        }
    }
    Ok(None)
}

#[test]
fn the_pipeline_catches_every_break_of_its_units() {
    if !Simulator::Icarus.is_there() {
        return;
    }
    let written = tempfile::tempdir().unwrap();
    let sets = frames(written.path());
    assert_eq!(first_difference(&folder(), &sets), Ok(None), "the modules as they are");
    let breaks = breaks_of(true);
    let missed = |of: &Break| {
        let found = broken(of).and_then(|copy| first_difference(copy.path(), &sets));
        let of = format!("{}: \"{}\"", of.module, of.what);
        match found {
            Ok(Some(difference)) => {
                println!("{of}: {}", difference.chars().take(160).collect::<String>());
                None
            }
            Ok(None) => Some(format!("{of} is not caught")),
            Err(problem) => Some(format!("{of}: {problem}")),
        }
    };
    let missed: Vec<String> = breaks.par_iter().filter_map(missed).collect();
    assert!(missed.is_empty(), "{} of {}\n{}", missed.len(), breaks.len(), missed.join("\n"));
}

#[test]
fn every_module_is_broken_in_five_ways_at_least() {
    let breaks = breaks();
    for module in all_modules() {
        let count = breaks.iter().filter(|of| of.module == module).count();
        assert!(count >= LEAST, "{module} has {count} breaks in breaks.toml");
    }
}
