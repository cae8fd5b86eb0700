//! How a frame or a sequence is run.

use cube3_method::{Cache, Choice, IMAGE_ORDER};

/// Most frames of a sequence.
pub const MOST_FRAMES: usize = 100_000;

/// Which runs are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Runs {
    /// *timing* and *function* side by side.
    #[default]
    Both,
    /// Cycles only.
    Timing,
    /// The picture only.
    Function,
    /// Both at once: real data in every token.
    Cycle,
}

impl Runs {
    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Runs::Both => "timing+function",
            Runs::Timing => "timing",
            Runs::Function => "function",
            Runs::Cycle => "cycle",
        }
    }
}

/// How a frame is run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunOptions {
    /// Which runs are made.
    pub runs: Runs,
    /// What the picture is measured against.
    pub reference: Option<Choice>,
    /// Where references that are worth it are kept; they are made anew without.
    pub cache: Option<Cache>,
    /// Leave out what cannot change the picture.
    pub plan: bool,
    /// Find what limits the frame rate: the machine is run again with one resource at a time out of the way.
    pub limits: bool,
    /// Written into the report.
    pub seed: u64,
}

impl Default for RunOptions {
    /// *timing* and *function*, against image order in steps of half a voxel.
    fn default() -> RunOptions {
        let reference = Some(Choice::of(&IMAGE_ORDER));
        RunOptions { runs: Runs::Both, reference, cache: None, plan: true, limits: true, seed: 0 }
    }
}
