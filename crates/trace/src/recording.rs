//! The event stream: packed while the machine runs, unpacked cycle by cycle afterwards.

use cube3_channel::{Account, Activity, Deadlock};
use cube3_pipeline::{CHANNELS, Fidelity, Joint, Machine, Token, UNITS};
use cube3_waveform::WaveformError;
use std::collections::VecDeque;
use std::path::Path;

/// Why there is no trace.
#[derive(Debug, thiserror::Error)]
pub enum TraceError {
    /// A file whose name does not tell its format.
    #[error("{path}: a trace is an .fst, .kanata or .json file, for waveform viewers, Konata, or Perfetto")]
    Extension {
        /// The file.
        path: String,
    },
    /// A window without a cycle.
    #[error(
        "--from {from} --to {to} is no window of cycles: the trace holds the cycles from --from to the one before --to"
    )]
    Empty {
        /// First cycle.
        from: u64,
        /// The cycle behind the last.
        to: u64,
    },
    /// A window that would fill memory and disk.
    #[error(
        "a trace of {cycles} cycles would take up to {bytes} bytes as {format}, above the limit of {limit}: give {most} cycles at most",
        limit = TraceFormat::LIMIT_BYTES
    )]
    Size {
        /// Cycles asked for.
        cycles: u64,
        /// Bytes that they may take.
        bytes: u64,
        /// The format's name.
        format: &'static str,
        /// Cycles that may be asked for.
        most: u64,
    },
    /// A window behind the end of the run.
    #[error("the run took {cycles} cycles, and the trace was to start at cycle {from}: give --from below {cycles}")]
    Beyond {
        /// Cycles of the run.
        cycles: u64,
        /// First cycle asked for.
        from: u64,
    },
    /// A window before the state that a run was resumed from.
    #[error(
        "the run goes on from cycle {cycle}, and the trace was to start at cycle {from}: give --from {cycle} or above"
    )]
    Before {
        /// First cycle of the run.
        cycle: u64,
        /// First cycle asked for.
        from: u64,
    },
    /// The waveform writer.
    #[error("the waveform cannot be written: {0}")]
    Waveform(#[from] WaveformError),
}

/// How a trace is written down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceFormat {
    /// A waveform, for GTKWave or Surfer.
    Fst,
    /// Tokens in their stages, for Konata.
    Kanata,
    /// Track events, for Perfetto.
    Perfetto,
}

impl TraceFormat {
    /// Most bytes of a trace.
    pub const LIMIT_BYTES: u64 = 1 << 30;

    /// The format that a file's extension asks for.
    ///
    /// # Errors
    /// Another extension.
    pub fn of(path: &Path) -> Result<TraceFormat, TraceError> {
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("fst") => Ok(TraceFormat::Fst),
            Some("kanata") => Ok(TraceFormat::Kanata),
            Some("json") => Ok(TraceFormat::Perfetto),
            _ => Err(TraceError::Extension { path: path.display().to_string() }),
        }
    }

    /// The name in messages.
    pub fn name(self) -> &'static str {
        match self {
            TraceFormat::Fst => "FST",
            TraceFormat::Kanata => "Kanata",
            TraceFormat::Perfetto => "Perfetto JSON",
        }
    }

    /// Bytes that a cycle takes at most, beside a few thousand for the whole: what is written if every unit changes and every
    /// channel moves in each cycle.
    pub fn bytes_per_cycle(self) -> u64 {
        match self {
            TraceFormat::Fst => 512,
            TraceFormat::Kanata => 1024,
            TraceFormat::Perfetto => 2048,
        }
    }
}

/// The cycles `from..to`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CycleWindow {
    /// First cycle.
    pub from: u64,
    /// The cycle behind the last.
    pub to: u64,
}

impl CycleWindow {
    /// A window that a format can hold.
    ///
    /// # Errors
    /// No cycle in it, or too many.
    pub fn new(from: u64, to: u64, format: TraceFormat) -> Result<CycleWindow, TraceError> {
        if from >= to {
            return Err(TraceError::Empty { from, to });
        }
        let cycles = to - from;
        let bytes = cycles.saturating_mul(format.bytes_per_cycle());
        if bytes > TraceFormat::LIMIT_BYTES {
            let most = TraceFormat::LIMIT_BYTES / format.bytes_per_cycle();
            return Err(TraceError::Size { cycles, bytes, format: format.name(), most });
        }
        Ok(CycleWindow { from, to })
    }
}

/// A cycle, packed: four bits for what each unit did, a bit for each push, pop, pushed token that does not follow the one
/// before, and pushed token that waits for words on links.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Packed {
    activities: u64,
    pushed: u16,
    popped: u16,
    jumped: u16,
    late: u16,
}

const _: () = assert!(UNITS <= 16 && CHANNELS <= 16 && Activity::COUNT <= 16);

/// Sees the cycles of a window.
#[derive(Clone, Debug)]
pub struct Recorder {
    recording: Recording,
    /// What the units had done, and pushes and pops, before the cycle.
    accounts: [Account; UNITS],
    moves: [[u64; 2]; CHANNELS],
    /// The token that is expected next in each channel.
    next: [Token; CHANNELS],
}

impl Recorder {
    /// A recorder for a window of a machine that stands at the window's first cycle.
    pub fn new<F: Fidelity>(machine: &Machine<F>, window: CycleWindow, clock_hz: f64) -> Recorder {
        let channels = Machine::<F>::JOINTS.into_iter().zip(machine.counters().channels).zip(machine.held());
        let tracks = channels.map(|((joint, reading), held)| Track {
            joint,
            capacity: reading.capacity,
            latency: reading.latency,
            extra: machine.extra_latency(joint),
            held,
        });
        let recording = Recording {
            from: window.from,
            clock_hz,
            units: Machine::<F>::UNITS,
            tracks: tracks.collect(),
            cycles: Vec::with_capacity((window.to - window.from) as usize),
            jumps: Vec::new(),
            late: Vec::new(),
        };
        Recorder {
            recording,
            accounts: machine.accounts().map(|account| *account),
            moves: machine.newest().map(|(counters, _)| [counters.pushes, counters.pops]),
            next: [Token::default(); CHANNELS],
        }
    }

    /// What was seen.
    pub fn finish(self) -> Recording {
        self.recording
    }

    /// Runs a machine on to the last pixel, or until `stop` cycles have passed, and sees each cycle. Whether the last pixel has come.
    ///
    /// # Errors
    /// As [`Machine::run`].
    pub fn run<F: Fidelity>(
        &mut self,
        machine: &mut Machine<F>,
        stop: u64,
        progress: &dyn Fn(u64, u64),
    ) -> Result<bool, Deadlock> {
        while machine.now() < stop {
            let before = machine.now();
            let done = machine.run_until(before + 1, progress);
            if machine.now() > before {
                self.see(machine);
            }
            if done? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Sees the cycle that has just passed, by what the counters have become.
    fn see<F: Fidelity>(&mut self, machine: &Machine<F>) {
        let mut packed = Packed { activities: 0, pushed: 0, popped: 0, jumped: 0, late: 0 };
        for (i, (before, account)) in self.accounts.iter_mut().zip(machine.accounts()).enumerate() {
            let activity = before.record(account.since(before));
            packed.activities |= u64::from(activity.code()) << (4 * i);
        }
        for (i, (counters, newest)) in machine.newest().into_iter().enumerate() {
            let [pushes, pops] = &mut self.moves[i];
            packed.popped |= u16::from(counters.pops != *pops) << i;
            if let Some((token, late)) = newest.filter(|_| counters.pushes != *pushes) {
                packed.pushed |= 1 << i;
                if late > 0 {
                    packed.late |= 1 << i;
                    self.recording.late.push(late);
                }
                if token != self.next[i] {
                    packed.jumped |= 1 << i;
                    self.recording.jumps.push(token);
                }
                self.next[i] = successor(token);
            }
            (*pushes, *pops) = (counters.pushes, counters.pops);
        }
        self.recording.cycles.push(packed);
    }
}

/// The token that mostly comes after another in a channel.
#[inline]
fn successor(token: Token) -> Token {
    Token { place: token.place.wrapping_add(1), ..token }
}

/// A channel of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Track {
    /// Its place.
    pub joint: Joint,
    /// Tokens that fit.
    pub capacity: usize,
    /// Cycles from push to pop.
    pub latency: u64,
    /// Cycles that tokens of each frame take longer.
    pub extra: Vec<u64>,
    /// Tokens in it when the recording starts, oldest first, each with the cycles until it can be popped.
    pub held: Vec<(Token, u64)>,
}

/// What happened in a window of cycles.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    from: u64,
    clock_hz: f64,
    units: [&'static str; UNITS],
    tracks: Vec<Track>,
    cycles: Vec<Packed>,
    jumps: Vec<Token>,
    /// Cycles that tokens wait for words on links.
    late: Vec<u64>,
}

/// A cycle of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Events {
    /// The cycle, from 0 at the start of the run.
    pub cycle: u64,
    /// What each unit did.
    pub activities: [Activity; UNITS],
    /// The token that each channel was given.
    pub pushed: [Option<Token>; CHANNELS],
    /// The token that each channel gave.
    pub popped: [Option<Token>; CHANNELS],
    /// The oldest token of each channel at the start of the cycle, where it could be popped.
    pub front: [Option<Token>; CHANNELS],
    /// Tokens in each channel at the end of the cycle.
    pub occupancy: [usize; CHANNELS],
}

impl Recording {
    /// The first cycle.
    pub fn from(&self) -> u64 {
        self.from
    }

    /// The cycle behind the last.
    pub fn to(&self) -> u64 {
        self.from + self.cycles.len() as u64
    }

    /// Cycles a second of the machine.
    pub fn clock_hz(&self) -> f64 {
        self.clock_hz
    }

    /// The units' names.
    pub fn units(&self) -> [&'static str; UNITS] {
        self.units
    }

    /// The channels.
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// Shows each cycle in turn.
    ///
    /// # Errors
    /// That of `see`, which ends the replay.
    pub fn replay<E>(&self, mut see: impl FnMut(&Events) -> Result<(), E>) -> Result<(), E> {
        let from = self.from;
        let mut queues: Vec<VecDeque<(Token, u64)>> = self
            .tracks
            .iter()
            .map(|track| track.held.iter().map(|&(token, cycles)| (token, from + cycles)).collect())
            .collect();
        let (mut jumps, mut late) = (self.jumps.iter(), self.late.iter());
        let mut next = [Token::default(); CHANNELS];
        for (packed, cycle) in self.cycles.iter().zip(from..) {
            let activity = |i: usize| Activity::from_code((packed.activities >> (4 * i)) as u8 & 15);
            let mut events = Events {
                cycle,
                activities: std::array::from_fn(|i| activity(i).unwrap_or(Activity::Starved)),
                pushed: [None; CHANNELS],
                popped: [None; CHANNELS],
                front: [None; CHANNELS],
                occupancy: [0; CHANNELS],
            };
            for (i, (queue, track)) in queues.iter_mut().zip(&self.tracks).enumerate() {
                let bit = |bits: u16| bits >> i & 1 == 1;
                events.front[i] = queue.front().filter(|(_, ready)| *ready <= cycle).map(|(token, _)| *token);
                if bit(packed.popped) {
                    events.popped[i] = queue.pop_front().map(|(token, _)| token);
                }
                if bit(packed.pushed) {
                    let jump = if bit(packed.jumped) { jumps.next().copied() } else { None };
                    let token = jump.unwrap_or(next[i]);
                    events.pushed[i] = Some(token);
                    next[i] = successor(token);
                    let extra = track.extra.get(token.frame as usize).copied().unwrap_or(0);
                    let late = if bit(packed.late) { late.next().copied().unwrap_or(0) } else { 0 };
                    queue.push_back((token, cycle + track.latency + extra + late));
                }
                events.occupancy[i] = queue.len();
            }
            see(&events)?;
        }
        Ok(())
    }
}
