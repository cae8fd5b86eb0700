//! A progress bar that shows itself only when something takes longer than a second.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// How long something may take without a bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// Something of unknown length: a line that appears if it takes longer than a second, and goes with the value.
pub struct Waiting {
    start: Instant,
    line: ProgressBar,
}

impl Waiting {
    /// Starts waiting.
    pub fn new(what: &'static str) -> Waiting {
        let line = ProgressBar::new_spinner().with_message(what);
        // Nothing is drawn before the first tick.
        line.enable_steady_tick(PATIENCE);
        Waiting { start: Instant::now(), line }
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        self.line.finish_and_clear();
    }
}

/// Progress of one piece of work.
pub struct Progress {
    start: Instant,
    shown: Mutex<bool>,
    bar: ProgressBar,
}

impl Progress {
    /// Starts the clock.
    pub fn new(what: &'static str) -> Progress {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{msg:>10} [{bar:40}] {percent:>3} %  {eta} left");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(what);
        Progress { start: Instant::now(), shown: Mutex::new(false), bar }
    }

    /// `done` of `all` is done.
    pub fn set(&self, done: u64, all: u64) {
        if self.start.elapsed() < PATIENCE {
            return;
        }
        if let Ok(mut shown) = self.shown.lock()
            && !*shown
        {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
            *shown = true;
        }
        self.bar.set_length(all);
        self.bar.set_position(done);
    }

    /// Seconds since the start; the bar goes.
    pub fn finish(self) -> f64 {
        self.bar.finish_and_clear();
        self.start.elapsed().as_secs_f64()
    }
}
