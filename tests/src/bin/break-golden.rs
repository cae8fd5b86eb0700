//! Every definition is broken on purpose in several ways (`tests/golden_breaks.toml`), one at a time in a copy of the workspace, and
//! the tests of its crate must catch each break.
//!
//! `cargo run --release -p cube3-tests --bin break-golden [PART_OF_A_FILE_NAME]`. Ends with 1 where a break is not caught or does not compile.

use cube3_tests::golden_breaks::{Break, Copy, Outcome, breaks};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// The copy lies beside what cargo makes, so that a second run compiles only what has changed.
fn folder() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    Some(program.parent().and_then(Path::parent)?.join("break-golden"))
}

fn main() -> ExitCode {
    let part = std::env::args().nth(1).unwrap_or_default();
    let chosen: Vec<Break> = breaks().into_iter().filter(|of| of.file.contains(&part)).collect();
    match run(&chosen) {
        Ok(0) if !chosen.is_empty() => ExitCode::SUCCESS,
        Ok(missed) => {
            eprintln!("{missed} of {} breaks are not caught", chosen.len());
            ExitCode::FAILURE
        }
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// How many breaks are not caught.
fn run(chosen: &[Break]) -> Result<usize, String> {
    let folder = folder().ok_or("the folder of this program is not known")?;
    let copy = Copy::new(&folder)?;
    let start = Instant::now();
    // Whole, the tests pass: else they would catch anything.
    let crates: BTreeSet<&str> = chosen.iter().map(Break::folder).collect();
    for name in crates {
        if copy.test(name)? != Outcome::Passed {
            return Err(format!("the tests of cube3-{name} fail although nothing is broken"));
        }
    }
    let mut missed = 0;
    for of in chosen {
        let outcome = copy.test_broken(of).map_err(|error| format!("{}: \"{}\": {error}", of.file, of.what))?;
        let caught = outcome == Outcome::Failed;
        missed += usize::from(!caught);
        println!("{}  {}: {}", if caught { "caught" } else { "MISSED" }, of.file, of.what);
    }
    println!("{} of {} breaks caught, {:.0} s", chosen.len() - missed, chosen.len(), start.elapsed().as_secs_f64());
    Ok(missed)
}
