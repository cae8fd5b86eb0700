//! A recording as track events in JSON, for Perfetto and chrome://tracing.
//!
//! A track for each unit, on which a run of equal cycles is a slice, and a counter for each channel. Time is the machine's, to
//! the nanosecond, which is Perfetto's unit. The format: "Trace Event TraceFormat", complete (X), counter (C) and metadata (M) events.

use crate::Recording;
use cube3_channel::Activity;
use cube3_pipeline::{CHANNELS, UNITS};
use std::fmt::Write;

const PROCESS: u32 = 1;

/// Microseconds from the start of the run to that of a cycle, to the nanosecond.
fn microseconds(clock_hz: f64, cycle: u64) -> Time {
    Time { nanoseconds: (cycle as f64 * 1e9 / clock_hz).round() as u64 }
}

#[derive(Clone, Copy)]
struct Time {
    nanoseconds: u64,
}

impl std::ops::Sub for Time {
    type Output = Time;

    fn sub(self, other: Time) -> Time {
        Time { nanoseconds: self.nanoseconds - other.nanoseconds }
    }
}

impl std::fmt::Display for Time {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}.{:03}", self.nanoseconds / 1000, self.nanoseconds % 1000)
    }
}

struct Writer {
    text: String,
    clock_hz: f64,
}

impl Writer {
    /// An event; its names are the machine's, which need no escapes in JSON. Writing to a string cannot fail.
    fn event(&mut self, event: std::fmt::Arguments<'_>) {
        let _ = write!(self.text, ",\n{event}");
    }

    fn slice(&mut self, unit: usize, activity: Activity, from: u64, to: u64) {
        let (start, end) = (microseconds(self.clock_hz, from), microseconds(self.clock_hz, to));
        let (name, track, cycles, duration) = (activity.name(), unit + 1, to - from, end - start);
        self.event(format_args!(
            r#"{{"ph":"X","pid":{PROCESS},"tid":{track},"name":"{name}","ts":{start},"dur":{duration},"args":{{"cycle":{from},"cycles":{cycles}}}}}"#
        ));
    }

    fn counter(&mut self, channel: &str, cycle: u64, tokens: usize) {
        let at = microseconds(self.clock_hz, cycle);
        self.event(format_args!(
            r#"{{"ph":"C","pid":{PROCESS},"name":"{channel}","ts":{at},"args":{{"tokens":{tokens}}}}}"#
        ));
    }
}

/// The JSON text.
pub fn write(recording: &Recording) -> String {
    let clock_hz = recording.clock_hz();
    let text = format!(
        "{{\"displayTimeUnit\":\"ns\",\"otherData\":{{\"clock_hz\":{clock_hz},\"from\":{},\"to\":{}}},\"traceEvents\":[\n{}",
        recording.from(),
        recording.to(),
        format_args!(r#"{{"ph":"M","pid":{PROCESS},"name":"process_name","args":{{"name":"cube3"}}}}"#)
    );
    let mut writer = Writer { text, clock_hz };
    for (unit, name) in recording.units().into_iter().enumerate() {
        let track = unit + 1;
        writer.event(format_args!(
            r#"{{"ph":"M","pid":{PROCESS},"tid":{track},"name":"thread_name","args":{{"name":"{name}"}}}}"#
        ));
        writer.event(format_args!(
            r#"{{"ph":"M","pid":{PROCESS},"tid":{track},"name":"thread_sort_index","args":{{"sort_index":{track}}}}}"#
        ));
    }
    for track in recording.tracks() {
        writer.counter(track.joint.channel, recording.from(), track.held.len());
    }
    let mut runs: [Option<(Activity, u64)>; UNITS] = [None; UNITS];
    let mut held: [usize; CHANNELS] = std::array::from_fn(|i| recording.tracks()[i].held.len());
    let seen: Result<(), std::convert::Infallible> = recording.replay(|events| {
        for (unit, activity) in events.activities.into_iter().enumerate() {
            match runs[unit] {
                Some((running, _)) if running == activity => {}
                before => {
                    if let Some((running, from)) = before {
                        writer.slice(unit, running, from, events.cycle);
                    }
                    runs[unit] = Some((activity, events.cycle));
                }
            }
        }
        for (i, track) in recording.tracks().iter().enumerate() {
            if events.occupancy[i] != held[i] {
                held[i] = events.occupancy[i];
                writer.counter(track.joint.channel, events.cycle + 1, held[i]);
            }
        }
        Ok(())
    });
    let Ok(()) = seen;
    for (unit, run) in runs.into_iter().enumerate() {
        if let Some((activity, from)) = run {
            writer.slice(unit, activity, from, recording.to());
        }
    }
    writer.text + "\n]}\n"
}
