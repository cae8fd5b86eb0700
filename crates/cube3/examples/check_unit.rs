//! A unit checked against outside vectors: `cargo run --release -p cube3 --example check_unit [-- VECTORS ANSWERS]`.
//!
//! With two files, a device's answers are compared with the definition of the vectors' unit. Without, two devices are made here: a lerp by the
//! book, and the same without the half that rounds.

use cube3::verify::{Verdict, open_vectors, set_of, verify};
use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The lines of the unit `lerp` that are kept with the program: words of 16 bits, weights of 8.
const VECTORS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../traces/vectors/lerp.hex");

/// Compares two files, or the two devices.
pub fn main() -> Result<(), Box<dyn Error>> {
    let files: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    if let [vectors, answers] = files.as_slice() {
        print(&verify(vectors, answers)?);
        return Ok(());
    }
    devices()
}

/// Compares the two devices that are made here.
pub fn devices() -> Result<(), Box<dyn Error>> {
    let folder = std::env::temp_dir().join(format!("cube3-check-unit-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    for (name, half) in [("rounded", 128), ("cut", 0)] {
        let answers = folder.join(format!("{name}.hex"));
        std::fs::write(&answers, device(Path::new(VECTORS), half)?)?;
        print(&verify(Path::new(VECTORS), &answers)?);
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}

/// What a device answers: a word a line.
fn device(vectors: &Path, half: i128) -> Result<String, Box<dyn Error>> {
    let (_, set) = set_of(vectors)?;
    let mut lines = open_vectors(vectors)?;
    let mut answers = String::new();
    while let Some(fields) = lines.inputs(&set)? {
        let [near, far, weight] = fields[..] else { return Err("a lerp has three inputs".into()) };
        writeln!(answers, "{:04x}", near + (((far - near) * weight + half) >> 8))?;
    }
    Ok(answers)
}

fn print(verdict: &Verdict) {
    match &verdict.mismatch {
        None => println!("{}: all {} lines are equal, bit for bit", verdict.unit, verdict.lines),
        Some(mismatch) => println!(
            "{}: {} of {} lines differ, the first is {}",
            verdict.unit, mismatch.differ, verdict.lines, mismatch.line
        ),
    }
}
