//! A recording as an FST waveform.
//!
//! Time is the machine's: the clock rises at the start of a cycle, and the other signals hold what the cycle did. The file
//! starts and ends with the window.
//!
//! ```text
//!   cube3.clock
//!   cube3.<unit>.kind, .activity                          what the unit did, as ASCII and as a number
//!   cube3.<channel>.occupancy, .push, .pop                at the end of the cycle; in the cycle
//!   cube3.<channel>.pushed_frame, _plane, _depth | _slot  of the token pushed, X where there is none; popped_… likewise
//! ```

use crate::{Events, Recording, TraceError};
use cube3_channel::Activity;
use cube3_pipeline::Token;
use cube3_pipeline::UNITS;
use cube3_waveform::{Body, Radix, Signal, Waveform, WaveformHeader};

/// Letters of the longest activity's name.
const NAME_LETTERS: usize = 13;
const ACTIVITY_BITS: usize = 4;
const OCCUPANCY_BITS: usize = 32;
const TOKEN_BITS: usize = 32;

/// The time unit of a waveform: a power of ten of a second of which a cycle has 1000 to 10,000.
pub fn timescale_exponent(clock_hz: f64) -> i8 {
    (-clock_hz.log10()).floor() as i8 - 3
}

/// Time units from the start of the run to that of a half cycle.
fn time(clock_hz: f64, halves: u64) -> u64 {
    (halves as f64 * 0.5 * 10_f64.powi(-i32::from(timescale_exponent(clock_hz))) / clock_hz).round() as u64
}

/// Frame, plane, and depth or slot: the signals, and the words that they have.
#[derive(Clone, Copy)]
struct TokenSignals {
    signals: [Signal; 3],
    last: Option<[Option<u32>; 3]>,
}

struct UnitSignals {
    activity: Signal,
    kind: Signal,
}

struct ChannelSignals {
    occupancy: Signal,
    push: Signal,
    pop: Signal,
    pushed: TokenSignals,
    popped: TokenSignals,
}

fn token_variables(header: &mut WaveformHeader, way: &str, place: &str) -> Result<TokenSignals, TraceError> {
    let mut of = |field: &str| header.variable(&format!("{way}_{field}"), TOKEN_BITS as u32, Radix::Unsigned);
    Ok(TokenSignals { signals: [of("frame")?, of("plane")?, of(place)?], last: None })
}

/// A word as the letters that the writer takes, most significant first.
fn bits<const N: usize>(word: u64) -> [u8; N] {
    std::array::from_fn(|i| b'0' + (word >> (N - 1 - i) & 1) as u8)
}

/// A name as the bits of its letters, blanks behind it: viewers cut off what they have no room for.
fn letters(name: &str) -> Vec<u8> {
    format!("{name:<NAME_LETTERS$}").bytes().flat_map(|letter| bits::<8>(u64::from(letter))).collect()
}

struct Writer {
    body: Body,
    clock: Signal,
    units: Vec<UnitSignals>,
    /// Each with its index in the recording.
    channels: Vec<(usize, ChannelSignals)>,
    names: Vec<Vec<u8>>,
    /// What was written last: most signals keep their value from cycle to cycle.
    last: Option<Events>,
}

impl TokenSignals {
    /// Writes the words that are not those of before.
    fn write(&mut self, body: &mut Body, token: Option<Token>) -> Result<(), TraceError> {
        let words = token.map_or([None; 3], |Token { frame, plane, place }| [frame, plane, place].map(Some));
        for i in 0..3 {
            if self.last.is_none_or(|last| last[i] != words[i]) {
                let value = words[i].map_or([b'X'; TOKEN_BITS], |word| bits(u64::from(word)));
                body.change(self.signals[i], &value)?;
            }
        }
        self.last = Some(words);
        Ok(())
    }
}

impl Writer {
    fn cycle(&mut self, clock_hz: f64, events: &Events) -> Result<(), TraceError> {
        self.body.time(time(clock_hz, 2 * events.cycle))?;
        self.body.change(self.clock, b"1")?;
        let last = self.last.take();
        for i in 0..UNITS {
            let activity = events.activities[i];
            if last.as_ref().is_none_or(|last| last.activities[i] != activity) {
                let code = activity.code();
                self.body.change(self.units[i].activity, &bits::<ACTIVITY_BITS>(u64::from(code)))?;
                self.body.change(self.units[i].kind, &self.names[usize::from(code)])?;
            }
        }
        for (i, channel) in &mut self.channels {
            let i = *i;
            if last.as_ref().is_none_or(|last| last.occupancy[i] != events.occupancy[i]) {
                let word = bits::<OCCUPANCY_BITS>(events.occupancy[i] as u64);
                self.body.change(channel.occupancy, &word)?;
            }
            for (flag, signals, token, before) in [
                (channel.push, &mut channel.pushed, events.pushed[i], last.as_ref().map(|last| last.pushed[i])),
                (channel.pop, &mut channel.popped, events.popped[i], last.as_ref().map(|last| last.popped[i])),
            ] {
                if before.map(|before| before.is_some()) != Some(token.is_some()) {
                    self.body.change(flag, if token.is_some() { b"1" } else { b"0" })?;
                }
                signals.write(&mut self.body, token)?;
            }
        }
        self.last = Some(events.clone());
        self.body.time(time(clock_hz, 2 * events.cycle + 1))?;
        self.body.change(self.clock, b"0")?;
        Ok(())
    }
}

/// The waveform. Each unit is followed by the channels that it fills.
pub fn write(recording: &Recording) -> Result<Waveform, TraceError> {
    let clock_hz = recording.clock_hz();
    let mut header = WaveformHeader::new(time(clock_hz, 2 * recording.from()), timescale_exponent(clock_hz))?;
    header.scope("cube3")?;
    let clock = header.flag("clock")?;
    let mut units = Vec::new();
    let mut channels = Vec::new();
    for unit in recording.units() {
        header.scope(unit)?;
        units.push(UnitSignals {
            kind: header.variable("kind", 8 * NAME_LETTERS as u32, Radix::Text)?,
            activity: header.variable("activity", ACTIVITY_BITS as u32, Radix::Unsigned)?,
        });
        header.up_scope()?;
        for (i, track) in recording.tracks().iter().enumerate().filter(|(_, track)| track.joint.from == unit) {
            header.scope(track.joint.channel)?;
            let place = track.joint.tokens.place();
            let signals = ChannelSignals {
                occupancy: header.variable("occupancy", OCCUPANCY_BITS as u32, Radix::Level)?,
                push: header.flag("push")?,
                pushed: token_variables(&mut header, "pushed", place)?,
                pop: header.flag("pop")?,
                popped: token_variables(&mut header, "popped", place)?,
            };
            channels.push((i, signals));
            header.up_scope()?;
        }
    }
    header.up_scope()?;
    let mut writer = Writer {
        body: header.finish()?,
        clock,
        units,
        channels,
        names: (0..Activity::COUNT as u8).filter_map(Activity::from_code).map(|a| letters(a.name())).collect(),
        last: None,
    };
    recording.replay(|events| writer.cycle(clock_hz, events))?;
    Ok(writer.body.finish(time(clock_hz, 2 * recording.to()))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_has_a_thousand_to_ten_thousand_time_units() {
        for clock_hz in [1.0, 3.0, 8e6, 133e6, 999e6, 1e9, 1e15] {
            let cycle = time(clock_hz, 2);
            assert!((1000..=10_000).contains(&cycle), "{clock_hz} Hz: {cycle}");
        }
        assert_eq!((timescale_exponent(8e6), time(8e6, 2)), (-10, 1250));
    }

    #[test]
    fn every_activity_name_fits() {
        let names = (0..Activity::COUNT as u8).filter_map(Activity::from_code).map(Activity::name);
        assert_eq!(names.map(str::len).max(), Some(NAME_LETTERS));
    }
}
