//! Every definition is broken on purpose in several ways (`tests/golden_breaks.toml`), one at a time in a copy of the workspace, and
//! the tests of its crate must catch each break. As many crates at a time as there are cores.
//!
//! `cargo run --release -p cube3-tests --bin break-golden [PART_OF_A_FILE_NAME]`. Ends with 1 where a break is not caught or does not compile.

use cube3_tests::golden_breaks::{Break, Copy, Outcome, breaks};
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

/// How many breaks are not caught. Crates are shared out among workers, each with a copy of its own.
fn run(chosen: &[Break]) -> Result<usize, String> {
    let folder = folder().ok_or("the folder of this program is not known")?;
    let start = Instant::now();
    let mut crates: BTreeMap<&str, Vec<&Break>> = BTreeMap::new();
    for of in chosen {
        crates.entry(of.folder()).or_default().push(of);
    }
    let mut crates: Vec<(&str, Vec<&Break>)> = crates.into_iter().collect();
    // The longest comes first, from the end.
    crates.sort_by_key(|(_, breaks)| breaks.len());
    let workers = thread::available_parallelism().map_or(1, NonZero::get).min(crates.len());
    let waiting = Mutex::new(crates);
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

/// How many breaks of the crates that a worker takes are not caught.
fn work(folder: &Path, waiting: &Mutex<Vec<(&str, Vec<&Break>)>>) -> Result<usize, String> {
    let next = || waiting.lock().map_or(None, |mut waiting| waiting.pop());
    let copy = Copy::new(folder)?;
    let mut missed = 0;
    while let Some((name, breaks)) = next() {
        // Whole, the tests pass: else they would catch anything.
        if copy.test(name)? != Outcome::Passed {
            return Err(format!("the tests of cube3-{name} fail although nothing is broken"));
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
