//! A recording as a Kanata log, for Konata.
//!
//! Each beam and each ray is an instruction; beams are thread 0, rays thread 1. Its stages on lane 0 are the units and channels
//! that it is in, its stalls on lane 1. A token stays in its channel until the unit behind it is through with it, as it does in
//! the machine; it is in the unit from the cycle of the pop to that of the push.
//!
//! The format: docs/kanata-log-format.md of Konata, version 4.

use super::{Recording, Token, TokenKind, Track};
use cube3_channel::Activity;
use std::collections::HashMap;
use std::fmt::Write;

/// A stretch of cycles with a name.
#[derive(Clone, Copy, Debug)]
struct Stall {
    from: u64,
    to: u64,
    name: &'static str,
}

/// What became of a token.
#[derive(Debug)]
struct Life {
    kind: TokenKind,
    token: Token,
    /// Where it is from each cycle on; the first is its birth.
    stages: Vec<(u64, &'static str)>,
    stalls: Vec<Stall>,
    /// The cycle behind its last.
    end: Option<u64>,
}

impl Life {
    fn enter(&mut self, cycle: u64, stage: &'static str) {
        match self.stages.last_mut() {
            // A token that leaves in the cycle in which it could first be seen was nowhere else.
            Some(last) if last.0 == cycle => last.1 = stage,
            _ => self.stages.push((cycle, stage)),
        }
    }

    fn birth(&self) -> u64 {
        self.stages.first().map_or(0, |stage| stage.0)
    }
}

fn stall(stalls: &mut Vec<Stall>, cycle: u64, name: &'static str) {
    match stalls.last_mut() {
        Some(last) if last.to == cycle && last.name == name => last.to += 1,
        _ => stalls.push(Stall { from: cycle, to: cycle + 1, name }),
    }
}

/// The name of what keeps a unit from going on, where something does.
fn obstacle(activity: Activity) -> Option<&'static str> {
    matches!(activity, Activity::Blocked | Activity::Waiting(_)).then(|| activity.name())
}

/// A token that a source works on, before it can be seen: since when, and its stalls.
type Unborn = Option<(u64, Vec<Stall>)>;

struct Lives<'a> {
    tracks: &'a [Track],
    units: &'a [&'static str],
    all: Vec<Life>,
    alive: HashMap<(TokenKind, Token), usize>,
    /// For each unit, what it makes out of nothing seen.
    unborn: Vec<Unborn>,
}

impl Lives<'_> {
    fn is_source(&self, unit: &str) -> bool {
        self.tracks.iter().all(|track| track.joint.to != unit)
    }

    fn is_sink(&self, unit: &str, kind: TokenKind) -> bool {
        self.tracks.iter().all(|track| track.joint.from != unit || track.joint.tokens != kind)
    }

    /// The life of a token; one that was not seen before begins.
    fn of(&mut self, kind: TokenKind, token: Token, cycle: u64, stage: &'static str) -> &mut Life {
        let new = self.all.len();
        let place = *self.alive.entry((kind, token)).or_insert(new);
        if place == new {
            self.all.push(Life { kind, token, stages: vec![(cycle, stage)], stalls: Vec::new(), end: None });
        }
        &mut self.all[place]
    }

    fn unit(&self, name: &str) -> usize {
        self.units.iter().position(|unit| *unit == name).unwrap_or(0)
    }

    fn cycle(&mut self, events: &super::Events) {
        let cycle = events.cycle;
        for unit in 0..self.units.len() {
            let activity = events.activities[unit];
            if activity != Activity::Starved && self.is_source(self.units[unit]) {
                let (_, stalls) = self.unborn[unit].get_or_insert_with(|| (cycle, Vec::new()));
                if let Some(name) = obstacle(activity) {
                    stall(stalls, cycle, name);
                }
            }
        }
        for (i, track) in self.tracks.iter().enumerate() {
            let joint = track.joint;
            if let Some(token) = events.popped[i] {
                self.of(joint.tokens, token, cycle, joint.to).enter(cycle, joint.to);
                if self.is_sink(joint.to, joint.tokens) {
                    let place = self.alive.remove(&(joint.tokens, token));
                    if let Some(life) = place.and_then(|place| self.all.get_mut(place)) {
                        life.end = Some(cycle + 1);
                    }
                }
            } else if let Some(token) = events.front[i] {
                let obstacle = obstacle(events.activities[self.unit(joint.to)]);
                if let Some(name) = obstacle {
                    stall(&mut self.of(joint.tokens, token, cycle, joint.channel).stalls, cycle, name);
                }
            }
        }
        for (i, track) in self.tracks.iter().enumerate() {
            let joint = track.joint;
            if let Some(token) = events.pushed[i] {
                let from = self.unit(joint.from);
                let (birth, stalls) = self.unborn[from].take().unwrap_or((cycle, Vec::new()));
                let life = self.of(joint.tokens, token, birth, joint.from);
                life.stalls.extend(stalls);
                life.enter(cycle + 1, joint.channel);
            }
        }
    }
}

/// A line of the log for a token; those of a cycle in this order.
enum Command<'a> {
    Begin(&'a Life),
    EndStall(&'static str),
    Stage(&'static str),
    Stall(&'static str),
    Retire,
}

impl Command<'_> {
    fn order(&self) -> u8 {
        match self {
            Command::Begin(_) => 0,
            Command::EndStall(_) => 1,
            Command::Stage(_) => 2,
            Command::Stall(_) => 3,
            Command::Retire => 4,
        }
    }
}

/// The log.
pub fn write(recording: &Recording) -> String {
    let units = recording.units();
    let mut lives = Lives {
        tracks: recording.tracks(),
        units: &units,
        all: Vec::new(),
        alive: HashMap::new(),
        unborn: vec![None; units.len()],
    };
    for track in recording.tracks() {
        for (token, _) in &track.held {
            lives.of(track.joint.tokens, *token, recording.from(), track.joint.channel);
        }
    }
    let seen: Result<(), std::convert::Infallible> = recording.replay(|events| {
        lives.cycle(events);
        Ok(())
    });
    let Ok(()) = seen;
    let to = recording.to();
    let mut all = lives.all;
    all.sort_by_key(Life::birth);
    let mut commands: Vec<(u64, usize, Command<'_>)> = Vec::new();
    for (id, life) in all.iter().enumerate() {
        commands.push((life.birth(), id, Command::Begin(life)));
        let within = life.stages.iter().filter(|(cycle, _)| *cycle < to);
        commands.extend(within.map(|&(cycle, stage)| (cycle, id, Command::Stage(stage))));
        for stall in &life.stalls {
            commands.push((stall.from, id, Command::Stall(stall.name)));
            commands.push((stall.to, id, Command::EndStall(stall.name)));
        }
        commands.extend(life.end.map(|end| (end, id, Command::Retire)));
    }
    commands.sort_by_key(|(cycle, id, command)| (*cycle, *id, command.order()));
    text(recording.from(), &commands)
}

fn text(from: u64, commands: &[(u64, usize, Command<'_>)]) -> String {
    let mut text = format!("Kanata\t0004\nC=\t{from}\n");
    let mut now = from;
    let mut retired = 0;
    for (cycle, id, command) in commands {
        if *cycle > now {
            text += &format!("C\t{}\n", cycle - now);
            now = *cycle;
        }
        // Writing to a string cannot fail.
        let _ = match command {
            Command::Begin(Life { kind, token, .. }) => {
                let (name, place, thread) = (kind.name(), kind.place(), *kind as u8);
                let Token { frame, plane, place: at } = token;
                write!(
                    text,
                    "I\t{id}\t{id}\t{thread}\nL\t{id}\t0\t{name}: frame {frame}, plane {plane}, {place} {at}\n"
                )
            }
            Command::Stage(stage) => writeln!(text, "S\t{id}\t0\t{stage}"),
            Command::Stall(name) => writeln!(text, "S\t{id}\t1\t{name}"),
            Command::EndStall(name) => writeln!(text, "E\t{id}\t1\t{name}"),
            Command::Retire => {
                retired += 1;
                writeln!(text, "R\t{id}\t{}\t0", retired - 1)
            }
        };
    }
    text
}
