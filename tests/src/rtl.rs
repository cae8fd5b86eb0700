//! The synthesizable modules of `tests/rtl`, and the tools that read them: Verilator, Icarus Verilog, Yosys.

use std::collections::BTreeSet;
use std::env;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

/// With this set to 1 a missing tool is a failure.
pub const REQUIRE_TOOLS: &str = "CUBE3_REQUIRE_TOOLS";

/// The folder of the modules, one to a file of the module's name.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("rtl")
}

/// The names of all modules, in order.
///
/// # Panics
/// Where the folder cannot be read.
pub fn all_modules() -> Vec<String> {
    let folder = folder();
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let files = entries.map(|entry| entry.unwrap_or_else(|error| panic!("{}: {error}", folder.display())).path());
    let sources = files.filter(|path| path.extension().is_some_and(|extension| extension == "sv"));
    let mut names: Vec<String> =
        sources.filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned())).collect();
    names.sort();
    names
}

/// The names of the modules that are a block of arithmetic or addressing, or a channel, in order: not of the units and of the
/// pipeline that are made of them.
///
/// # Panics
/// Where the folder cannot be read.
pub fn modules() -> Vec<String> {
    all_modules().into_iter().filter(|name| !name.ends_with("_unit") && !name.starts_with("cube3_pipeline")).collect()
}

/// Where a tool is on the `PATH`.
pub fn find(tool: &str) -> Option<PathBuf> {
    let path = env::var_os("PATH")?;
    env::split_paths(&path).map(|folder| folder.join(tool)).find(|file| file.is_file())
}

/// A tool that a test needs. Where it is missing, says so in one line, once for each tool, and the test is to return.
///
/// # Panics
/// Where it is missing and [`REQUIRE_TOOLS`] is 1.
pub fn require(tool: &str) -> Option<PathBuf> {
    static MISSED: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let found = find(tool);
    if found.is_none() {
        let package = match tool {
            "vvp" => "iverilog",
            "fst2vcd" => "gtkwave",
            tool => tool,
        };
        let missing = format!("{tool} is not installed; install it with apt-get install {package}");
        assert!(!env::var(REQUIRE_TOOLS).is_ok_and(|value| value == "1"), "{missing}");
        let first = MISSED.lock().is_ok_and(|mut missed| missed.insert(tool.to_owned()));
        if first {
            // Straight to the stream, which the test harness does not hold back. A closed one is no failure of the test.
            let _ = writeln!(std::io::stderr(), "skipped: {missing}");
        }
    }
    found
}

/// Runs a command to its end and gives what it wrote, standard output before standard error.
///
/// # Errors
/// The command, and how it failed with what it wrote.
pub fn run(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| format!("{command:?} cannot be started: {error}"))?;
    let written = [output.stdout, output.stderr].concat();
    let written = String::from_utf8_lossy(&written).into_owned();
    if output.status.success() { Ok(written) } else { Err(format!("{command:?}: {}\n{written}", output.status)) }
}

/// Values of a module's integer parameters; those not named have their defaults.
pub type Parameters = Vec<(&'static str, i64)>;

/// A command of Verilator that makes a program. Where ccache is installed, it compiles the simulator's own sources once for all.
pub fn verilator_program(verilator: &Path) -> Command {
    let mut command = Command::new(verilator);
    command.args(["--binary", "--timing"]);
    if find("ccache").is_some() {
        command.env("OBJCACHE", "ccache");
    }
    command
}

/// Arguments of [`verilator_program`] for a program that is made sooner than it is run. Its makefile puts these after `-CFLAGS`.
pub const MADE_SOON: [&str; 2] = ["-MAKEFLAGS", "OPT_FAST=-O0 OPT_SLOW=-O0 OPT_GLOBAL=-O0"];

/// Checks a module and all below it with every warning of Verilator.
///
/// # Errors
/// What it reports.
pub fn verilator_lint(verilator: &Path, module: &str, parameters: &Parameters) -> Result<(), String> {
    let mut command = Command::new(verilator);
    command.current_dir(folder()).args(["--lint-only", "-Wall", "-y", ".", "--top-module", module]);
    command.args(parameters.iter().map(|(name, value)| format!("-G{name}={value}"))).arg(format!("{module}.sv"));
    silent(run(&mut command)?)
}

/// Compiles a module and all below it with every warning of Icarus Verilog; `into` takes the result.
///
/// # Errors
/// What it reports.
pub fn icarus_lint(iverilog: &Path, module: &str, parameters: &Parameters, into: &Path) -> Result<(), String> {
    let mut command = Command::new(iverilog);
    command.current_dir(folder()).args(["-g2012", "-Wall", "-y.", "-Y.sv", "-s", module, "-o"]).arg(into);
    command.args(parameters.iter().map(|(name, value)| format!("-P{module}.{name}={value}")));
    silent(run(command.arg(format!("{module}.sv")))?)
}

fn silent(written: String) -> Result<(), String> {
    if written.trim().is_empty() { Ok(()) } else { Err(written) }
}
