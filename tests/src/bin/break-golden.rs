//! Code is broken on purpose, one break at a time in a copy of the workspace, and tests must catch each break. As many suites at a time
//! as there are cores.
//!
//! `cargo run --release -p cube3-tests --bin break-golden -- [OPTIONS] [PART_OF_A_FILE_NAME]`. Without options every break of a definition
//! (`tests/golden_breaks.toml`) is tried, and the tests of its crate must catch it. Ends with 1 where a break is not caught or does not
//! compile.
//!
//! - `--measurements`: those of `tests/measurement_breaks.toml` instead, of what is counted, limited, measured and left out; the test that
//!   a break names must catch it.
//! - `--all`: both lists.
//! - `--changed-since REV`: of those, the breaks of files that differ from the revision, and breaks that its lists do not have.
//! - `--one-each`: the first break of each definition; with `--changed-since` these beside the others.

use cube3_tests::golden_breaks::{
    Break, Changes, Copy, Outcome, Suite, breaks, definitions, measurement_breaks, one_each,
};
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

/// What is asked for.
#[derive(Debug, Default)]
struct Options {
    measurements: bool,
    all: bool,
    one_each: bool,
    changed_since: Option<String>,
    parts: Vec<String>,
}

impl Options {
    fn read(mut words: impl Iterator<Item = String>) -> Result<Options, String> {
        let mut options = Options::default();
        while let Some(word) = words.next() {
            match word.as_str() {
                "--measurements" => options.measurements = true,
                "--all" => options.all = true,
                "--one-each" => options.one_each = true,
                "--changed-since" => {
                    options.changed_since = Some(words.next().ok_or("--changed-since: give a revision")?);
                }
                word if word.starts_with('-') => return Err(format!("{word} is no option")),
                _ => options.parts.push(word),
            }
        }
        Ok(options)
    }

    /// The breaks, each once.
    fn breaks(&self) -> Result<Vec<Break>, String> {
        let lists = match (self.all, self.measurements) {
            (true, _) => [breaks(), measurement_breaks()].concat(),
            (false, true) => measurement_breaks(),
            (false, false) => breaks(),
        };
        let changes = self.changed_since.as_deref().map(Changes::since).transpose()?;
        let definitions = definitions();
        let firsts = if self.one_each { one_each(&lists) } else { Vec::new() };
        let first = |of: &Break| firsts.contains(of) && definitions.contains(&of.file);
        let narrowed = self.one_each || changes.is_some();
        let wanted = |of: &Break| !narrowed || first(of) || changes.as_ref().is_some_and(|changes| changes.touch(of));
        let named = |of: &Break| self.parts.iter().all(|part| of.file.contains(part));
        Ok(lists.into_iter().filter(|of| wanted(of) && named(of)).collect())
    }
}

fn main() -> ExitCode {
    match Options::read(std::env::args().skip(1)).and_then(|options| run(&options)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// Tries the breaks that are asked for.
fn run(options: &Options) -> Result<(), String> {
    let chosen = options.breaks()?;
    // Nothing need have changed; but a part of a name that no file has is a mistake.
    if chosen.is_empty() && options.changed_since.is_none() {
        return Err("no such break".into());
    }
    match missed(&chosen)? {
        0 => Ok(()),
        missed => Err(format!("{missed} of {} breaks are not caught", chosen.len())),
    }
}

/// How many breaks are not caught. Suites are shared out among workers, each with a copy of its own.
fn missed(chosen: &[Break]) -> Result<usize, String> {
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
        copy.try_breaks(&suite, &breaks, |of, outcome| {
            missed += usize::from(outcome == Outcome::Missed);
            let word = if outcome == Outcome::Caught { "caught" } else { "MISSED" };
            println!("{word}  {}: {}", of.file, of.what);
        })?;
    }
    Ok(missed)
}
