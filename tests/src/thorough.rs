//! What takes long and finds little that a shorter test does not is left to `.ci/full`.

use std::collections::BTreeSet;
use std::env;
use std::io::Write;
use std::sync::Mutex;

/// With this set to 1 everything is run.
pub const FULL: &str = "CUBE3_FULL";

/// Whether everything is to be run. Where it is not, says in one line, once, what is left out: what the test names.
pub fn thorough(what: &str) -> bool {
    static LEFT: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let everything = env::var(FULL).is_ok_and(|value| value == "1");
    if !everything && LEFT.lock().is_ok_and(|mut left| left.insert(what.to_owned())) {
        // Straight to the stream, which the test harness does not hold back. A closed one is no failure of the test.
        let _ = writeln!(std::io::stderr(), "left out: {what}; {FULL}=1 runs it, as .ci/full does");
    }
    everything
}
