//! Modules of `tests/rtl` against golden vectors, in Icarus Verilog and in Verilator, and modules that are broken on purpose.

use crate::rtl::{MADE_SOON, folder, run, verilator_program};
use cube3_vectors::{Unit, UnitFormat, Vectors, testbench};
use serde::Deserialize;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// A folder with the vectors of a unit, its tables and its test bench.
pub struct Bench {
    folder: TempDir,
    name: String,
    lines: usize,
}

impl Bench {
    /// Makes the folder for the directed lines in a format, and random ones up to `count`.
    ///
    /// # Panics
    /// Where it cannot be made.
    pub fn new(unit: &dyn Unit, format: &UnitFormat, count: usize) -> Bench {
        let directed = Vectors::directed(unit, *format, 7).expect("the sheet has values").inputs.len();
        let vectors = Vectors::generate(unit, *format, count.max(directed), 7).expect("the sheet has values");
        let folder = tempfile::tempdir().expect("a folder");
        let name = testbench::name(&vectors.set.sheet);
        let text = testbench::text(&vectors.set.sheet, format).expect("the sheet has values");
        let write = |file: &str, text: &str| std::fs::write(folder.path().join(file), text).expect("a file");
        write(&format!("{name}.sv"), &text);
        write("in.hex", &vectors.text());
        for (table, text) in vectors.table_texts() {
            write(&format!("{}.{table}.hex", vectors.set.sheet.name), &text);
        }
        Bench { folder, name, lines: vectors.inputs.len() }
    }

    /// Runs the modules of a folder in Icarus; lines that differ, of all.
    ///
    /// # Errors
    /// What cannot be compiled or run.
    pub fn icarus(&self, iverilog: &Path, vvp: &Path, modules: &Path) -> Result<usize, String> {
        let mut compile = Command::new(iverilog);
        compile.current_dir(self.folder.path()).args(["-g2012", "-Y.sv", "-o", "sim.vvp", "-s", &self.name]);
        compile.arg(format!("-y{}", modules.display())).arg(format!("{}.sv", self.name));
        run(&mut compile)?;
        let mut simulate = Command::new(vvp);
        self.differ(run(simulate.current_dir(self.folder.path()).args([
            "-n",
            "sim.vvp",
            "+in=in.hex",
            "+out=out.hex",
        ]))?)
    }

    /// The same in Verilator.
    ///
    /// # Errors
    /// What cannot be compiled or run.
    pub fn verilator(&self, verilator: &Path, modules: &Path) -> Result<usize, String> {
        let mut compile = verilator_program(verilator);
        compile.current_dir(self.folder.path()).args(MADE_SOON).args(["-Mdir", "made"]);
        compile.args(["-o", "sim", "--top-module", &self.name, "-y"]).arg(modules).arg(format!("{}.sv", self.name));
        run(&mut compile)?;
        let mut simulate = Command::new(self.folder.path().join("made/sim"));
        self.differ(run(simulate.current_dir(self.folder.path()).args(["+in=in.hex", "+out=out.hex"]))?)
    }

    /// Reads the bench's last words.
    fn differ(&self, written: String) -> Result<usize, String> {
        let counts = written.lines().find_map(|line| {
            let (_, rest) = line.split_once(": ")?;
            let (differ, rest) = rest.split_once(" of ")?;
            Some((differ.parse::<usize>().ok()?, rest.strip_suffix(" lines differ")?.parse::<usize>().ok()?))
        });
        match counts {
            Some((differ, lines)) if lines == self.lines => Ok(differ),
            _ => Err(format!("{}: the bench did not compare {} lines:\n{written}", self.name, self.lines)),
        }
    }
}

/// A module broken on purpose: one place of its text is replaced.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Break {
    /// What is wrong then.
    pub what: String,
    /// The module.
    pub module: String,
    /// The unit whose vectors catch it, or `pipeline`.
    pub unit: String,
    /// Text that is there once.
    pub find: String,
    /// What stands there instead.
    pub replace: String,
}

/// `tests/rtl/breaks.toml`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Breaks {
    #[serde(rename = "break")]
    breaks: Vec<Break>,
}

/// All breaks of `tests/rtl/breaks.toml`.
///
/// # Panics
/// Where the file cannot be read.
pub fn breaks() -> Vec<Break> {
    let path = folder().join("breaks.toml");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let Breaks { breaks } = toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    breaks
}

/// A copy of all modules, one of them broken.
///
/// # Errors
/// A text to be replaced that is not there exactly once.
pub fn broken(of: &Break) -> Result<TempDir, String> {
    let copy = tempfile::tempdir().map_err(|error| error.to_string())?;
    for module in crate::rtl::all_modules() {
        let file = format!("{module}.sv");
        let mut text = std::fs::read_to_string(folder().join(&file)).map_err(|error| format!("{file}: {error}"))?;
        if module == of.module {
            let count = text.matches(&of.find).count();
            if count != 1 {
                return Err(format!("{file}: `{}` is there {count} times, not once ({})", of.find, of.what));
            }
            text = text.replacen(&of.find, &of.replace, 1);
        }
        std::fs::write(copy.path().join(&file), text).map_err(|error| format!("{file}: {error}"))?;
    }
    Ok(copy)
}
