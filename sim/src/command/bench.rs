//! `cube3 bench`: speed on this machine, as ratios and as fractions of the hardware's limit.

use super::run::print;
use super::{fits, on_threads, threads};
use crate::bench::{COPY_BYTES, Measurement, Sizes, measure};
use crate::problem::Outcome;
use clap::Args;
use cube3::memory;

/// Arguments of `cube3 bench`.
#[derive(Debug, Args)]
pub struct BenchArguments {
    /// Voxels a side of the volume for the function run.
    #[arg(long, default_value_t = 256)]
    size: usize,
    /// Voxels a side of the volume for the timing run.
    #[arg(long, default_value_t = 512)]
    timing_size: usize,
    /// Times that everything is measured; medians are printed.
    #[arg(long, default_value_t = 5)]
    repeats: usize,
    /// Threads; all cores without it.
    #[arg(long)]
    threads: Option<usize>,
}

impl BenchArguments {
    /// Measures and prints.
    ///
    /// # Errors
    /// What went wrong, in words.
    pub fn execute(self) -> Outcome<()> {
        let sizes = Sizes { size: self.size, timing_size: self.timing_size, repeats: self.repeats.max(1) };
        fits(&memory::bench(COPY_BYTES as u64, self.size, self.timing_size, threads(self.threads)?))?;
        let rows = on_threads(self.threads, || measure(&sizes))?;
        let mut text = String::new();
        for Measurement { what, value, unit, note } in rows {
            text += &format!("{what:<44} {value:>12} {unit:<14} {note}\n");
        }
        print(&text)
    }
}
