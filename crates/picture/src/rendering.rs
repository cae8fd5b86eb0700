//! What making a picture gave and took.

use crate::Picture;
use std::time::Instant;

/// Called now and then with the name of a phase, what of it is done and what there is to do; from any thread, and calls may overtake each other.
pub type Watch<'a> = &'a (dyn Fn(&'static str, u64, u64) + Sync);

/// A part of the work, and the seconds that it took on the wall's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// What was done.
    pub name: &'static str,
    /// Seconds.
    pub seconds: f64,
}

impl Phase {
    /// Does some work and tells how long it took.
    pub fn of<T>(name: &'static str, work: impl FnOnce() -> T) -> (T, Phase) {
        let start = Instant::now();
        let made = work();
        (made, Phase { name, seconds: start.elapsed().as_secs_f64() })
    }
}

/// A picture, and what making it took.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendering {
    /// The picture over its background.
    pub picture: Picture,
    /// The parts of the work, in order.
    pub phases: Vec<Phase>,
    /// Samples taken along rays; those for gradients alone are not counted.
    pub samples: u64,
    /// Bytes of the volume as the method holds it, and of its tables.
    pub bytes: u64,
    /// The most that any channel of each pixel can be away from the integral that the picture stands for, where the method proves one.
    pub bound: Option<Vec<f64>>,
}

impl Rendering {
    /// Seconds of all phases.
    pub fn seconds(&self) -> f64 {
        self.phases.iter().map(|phase| phase.seconds).sum()
    }
}
