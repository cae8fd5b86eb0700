//! `cube3 verify`: the machine against its specification.

use super::words::WordsArguments;
use crate::problem::{Outcome, Problem};
use clap::Args;

/// Arguments of `cube3 verify`.
#[derive(Debug, Args)]
pub struct VerifyArguments {
    /// The study of word lengths: error of picture and gradients, and cost, against the length of each word.
    #[arg(long)]
    words: bool,
    #[command(flatten)]
    study: WordsArguments,
}

impl VerifyArguments {
    /// Verifies, prints and writes files.
    ///
    /// # Errors
    /// What went wrong, in words.
    pub fn execute(self) -> Outcome<()> {
        if self.words {
            return self.study.execute();
        }
        Err(Problem::new("verify does not know what to verify; give --words for the study of word lengths"))
    }
}
