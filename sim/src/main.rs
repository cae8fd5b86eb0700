//! The `cube3` command.

use clap::Parser;
use cube3_sim::command::Arguments;
use cube3_sim::problem::{Outcome, Problem};
use std::process::ExitCode;

fn main() -> ExitCode {
    match arguments().and_then(Arguments::execute) {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("cube3: {problem}");
            ExitCode::from(problem.code())
        }
    }
}

/// The command line, or what is wrong with it in one line.
fn arguments() -> Outcome<Arguments> {
    Arguments::try_parse().map_err(|error| {
        if !error.use_stderr() {
            error.exit();
        }
        let text = error.to_string();
        let told =
            text.lines().take_while(|line| !line.starts_with("Usage:")).map(str::trim).filter(|line| !line.is_empty());
        let told = told
            .filter(|line| !line.starts_with("For more information"))
            .collect::<Vec<_>>()
            .join("; ")
            .replace(":; ", ": ");
        Problem::new(format!("{}; --help lists what can be given", told.strip_prefix("error: ").unwrap_or(&told)))
    })
}
