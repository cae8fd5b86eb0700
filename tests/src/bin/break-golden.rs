//! Every definition is broken on purpose in several ways (`tests/golden_breaks.toml`), one at a time in a copy of the workspace, and
//! the tests of its crate must catch each break; with `--measurements` what is counted, limited, measured and left out is
//! (`tests/measurement_breaks.toml`), and the test that a break names must catch it. As many suites at a time as there are cores.
//!
//! `cargo run --release -p cube3-tests --bin break-golden [--measurements] [PART_OF_A_FILE_NAME]`. Ends with 1 where a break is not caught or does not
//! compile.

use cube3_tests::golden_breaks::{Break, Copy, Outcome, Suite, breaks, measurement_breaks};
use std::collections::BTreeMap;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::thread;
use std::time::Instant;

/// The copies lie beside what cargo makes, so that a second run compiles only what has changed.
fn folder() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    Some(program.parent().and_then(Path::parent)?.join("break-golden"))
}

fn main() -> ExitCode {
    let (options, parts): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|word| word == "--measurements");
    let list = if options.is_empty() { breaks() } else { measurement_breaks() };
    let chosen: Vec<Break> = list.into_iter().filter(|of| parts.iter().all(|part| of.file.contains(part))).collect();
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

/// How many breaks are not caught. Suites are shared out among workers, each with a copy of its own.
fn run(chosen: &[Break]) -> Result<usize, String> {
    let folder = folder().ok_or("the folder of this program is not known")?;
    let start = Instant::now();
    let mut suites: BTreeMap<Suite, Vec<&Break>> = BTreeMap::new();
    for of in chosen {
        suites.entry(of.suite()).or_default().push(of);
    }
    let mut suites: Vec<(Suite, Vec<&Break>)> = suites.into_iter().collect();
    // The longest comes first, from the end.
    suites.sort_by_key(|(_, breaks)| breaks.len());
    let workers = thread::available_parallelism().map_or(1, NonZero::get).min(suites.len());
    let waiting = Mutex::new(suites);
    let missed: Vec<Result<usize, String>> = thread::scope(|scope| {
        let share = |number: usize| work(&folder.join(number.to_string()), &waiting);
        let workers: Vec<_> = (0..workers).map(|number| scope.spawn(move || share(number))).collect();
        let joined = workers.into_iter().map(|worker| worker.join());
        joined.map(|missed| missed.unwrap_or_else(|_| Err("a worker panicked".into()))).collect()
    });
    let missed = missed.into_iter().sum::<Result<usize, String>>()?;
    println!("{} of {} breaks caught, {:.0} s", chosen.len() - missed, chosen.len(), start.elapsed().as_secs_f64());
    Ok(missed)
}

/// How many breaks of the suites that a worker takes are not caught.
fn work(folder: &Path, waiting: &Mutex<Vec<(Suite, Vec<&Break>)>>) -> Result<usize, String> {
    let next = || waiting.lock().map_or(None, |mut waiting| waiting.pop());
    let copy = Copy::new(folder)?;
    let mut missed = 0;
    while let Some((suite, breaks)) = next() {
        // Whole, the tests pass: else they would catch anything.
        if copy.test(&suite)? != Outcome::Passed {
            return Err(format!("{suite:?} of {} fails although nothing is broken", suite.package()));
        }
        for of in breaks {
            let outcome = copy.test_broken(of).map_err(|error| format!("{}: \"{}\": {error}", of.file, of.what))?;
            let caught = outcome == Outcome::Failed;
            missed += usize::from(!caught);
            println!("{}  {}: {}", if caught { "caught" } else { "MISSED" }, of.file, of.what);
        }
    }
    Ok(missed)
}
