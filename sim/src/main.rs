//! The `cube3` command.

use clap::Parser;
use cube3::command::Arguments;
use std::process::ExitCode;

fn main() -> ExitCode {
    match Arguments::parse().execute() {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("cube3: {problem}");
            ExitCode::from(2)
        }
    }
}
