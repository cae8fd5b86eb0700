//! Python scripts that ask other programs, for the tests that need them.
#![allow(dead_code)] // Each test file uses its part.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// How to get what the scripts need.
const REMEDY: &str = "pip install numpy nibabel SimpleITK pynrrd vtk, apt-get install teem-apps, and name the Python in CUBE3_PYTHON";

/// The exit code by which a script says that a module is missing.
const MISSING: i32 = 3;

/// Runs a script of `tests/outside` with the Python that `CUBE3_PYTHON` names, or `python3`.
///
/// `None` where it or a module is missing; a line says so. Where `CUBE3_REQUIRE_TOOLS` is set that is a panic, as is a script
/// that fails.
pub fn run(script: &str, arguments: &[&OsStr]) -> Option<Output> {
    let python = std::env::var_os("CUBE3_PYTHON").unwrap_or("python3".into());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/outside").join(script);
    let said = |output: &Output| String::from_utf8_lossy(&output.stderr).trim().to_owned();
    let missing = match Command::new(&python).env("PYTHONDONTWRITEBYTECODE", "1").arg(path).args(arguments).output() {
        Err(error) => format!("{}: {error}", PathBuf::from(&python).display()),
        Ok(output) if output.status.code() == Some(MISSING) => said(&output),
        Ok(output) => {
            assert!(output.status.success(), "{script}: {}\n{}", output.status, said(&output));
            return Some(output);
        }
    };
    assert!(std::env::var_os("CUBE3_REQUIRE_TOOLS").is_none(), "{missing}; {REMEDY}");
    eprintln!("skipped, {missing}; {REMEDY}");
    None
}
