//! Progress bars that show themselves only when something takes longer than a second.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// How long something may take without a bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// Something of unknown length: a line that appears if it takes longer than a second, and goes with the value.
pub struct Waiting(ProgressBar);

impl Waiting {
    /// Starts waiting.
    pub fn new(what: &'static str) -> Waiting {
        let line = ProgressBar::new_spinner().with_message(what);
        // Nothing is drawn before the first tick.
        line.enable_steady_tick(PATIENCE);
        Waiting(line)
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// The bars of a command, one for each part of its work; they go with the value.
#[derive(Default)]
pub struct Bars(Mutex<Vec<Bar>>);

struct Bar {
    what: &'static str,
    start: Instant,
    shown: bool,
    bar: ProgressBar,
}

impl Bars {
    /// `done` of `all` of a part is done. A part that begins again has a new bar.
    pub fn set(&self, what: &'static str, done: u64, all: u64) {
        let Ok(mut bars) = self.0.lock() else { return };
        let place = bars.iter().position(|bar| bar.what == what && !bar.bar.is_finished());
        let place = place.unwrap_or_else(|| {
            bars.push(Bar::new(what));
            bars.len() - 1
        });
        bars[place].set(done, all);
    }
}

impl Bar {
    fn new(what: &'static str) -> Bar {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{msg:>10} [{bar:40}] {percent:>3} %  {eta} left");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(what);
        Bar { what, start: Instant::now(), shown: false, bar }
    }

    fn set(&mut self, done: u64, all: u64) {
        if done >= all {
            self.bar.finish_and_clear();
        }
        if self.start.elapsed() < PATIENCE || done >= all {
            return;
        }
        if !self.shown {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
            self.shown = true;
        }
        self.bar.set_length(all);
        self.bar.set_position(done);
    }
}

impl Drop for Bars {
    fn drop(&mut self) {
        for bar in self.0.get_mut().into_iter().flatten() {
            bar.bar.finish_and_clear();
        }
    }
}
