//! Lines of a channel in a timing run.

use super::error::RecordError;
use super::run::{Excerpt, Run};
use cube3_pipeline::{Machine, RunError, Timing};
use cube3_trace::{CycleWindow, Events, Recorder};

/// Cycles that are recorded of a timing run at a time.
const CYCLES: u64 = 4096;

/// A timing run of all frames, and the place of the window's channel among its channels.
pub(super) fn channel<'a>(run: &Run<'a>, window: &Excerpt<'_>) -> Result<(Machine<Timing>, usize), RecordError> {
    let machine = Machine::timing(run.machine, run.frames.to_vec())?;
    let joints = Machine::<Timing>::JOINTS;
    let names = || joints.map(|joint| joint.channel).join(", ");
    let place = joints.iter().position(|joint| joint.channel == window.channel);
    let place = place.ok_or_else(|| RecordError::Channel { channel: window.channel.to_owned(), names: names() })?;
    Ok((machine, place))
}

/// The cycles of a channel in a timing run of all frames: gives each line and its number to `take`.
pub(super) fn cycles<E: From<RecordError>>(
    run: &Run<'_>,
    window: &Excerpt<'_>,
    take: &mut dyn FnMut(usize, Vec<i128>) -> Result<(), E>,
) -> Result<(), E> {
    let (mut machine, place) = channel(run, window)?;
    let stuck = |deadlock| RecordError::from(RunError::from(deadlock));
    let first = window.first as u64;
    machine.run_until(first, &|_, _| {}).map_err(stuck)?;
    if machine.now() < first {
        let found = machine.now() as usize;
        return Err(RecordError::Beyond { unit: "channel", found, first: window.first }.into());
    }
    let mut token = machine.counters().channels[place].counters.pushes;
    let mut empty = machine.counters().channels[place].occupancy == 0;
    let (mut lines, mut done) = (0, false);
    while !done && lines < window.count {
        let from = machine.now();
        let cycles = CycleWindow { from, to: from + CYCLES };
        let mut recorder = Recorder::new(&machine, cycles, run.machine.clock_hz);
        done = recorder.run(&mut machine, cycles.to, &|_, _| {}).map_err(stuck)?;
        recorder.finish().replay(|events: &Events| {
            let pushed = events.pushed[place].is_some();
            if (empty || lines > 0) && lines < window.count {
                let data = if pushed { i128::from(token & 0xffff) } else { 0 };
                take(lines, vec![pushed.into(), data, events.popped[place].is_some().into()])?;
                lines += 1;
            }
            token += u64::from(pushed);
            empty = events.occupancy[place] == 0;
            Ok::<(), E>(())
        })?;
    }
    if lines == 0 && window.count > 0 {
        return Err(RecordError::Held { channel: window.channel.to_owned(), first: window.first }.into());
    }
    Ok(())
}
