//! A recording as a Kanata log, for Konata.
//!
//! Each beam and each ray is an instruction; beams are thread 0, rays thread 1. Its stages on lane 0 are the units and channels
//! that it is in, its stalls on lane 1. A token stays in its channel until the unit behind it is through with it, as it does in
//! the machine; it is in the unit from the cycle of the pop to that of the push.
//!
//! The format: docs/kanata-log-format.md of Konata, version 4.

use crate::{Events, Recording};
use cube3_channel::Activity;
use cube3_pipeline::{Token, TokenKind};
use std::collections::{HashMap, VecDeque};

/// A stretch of cycles with a name.
#[derive(Clone, Copy, Debug)]
struct Stall {
    from: u64,
    to: u64,
    name: &'static str,
}

/// A token as it is now.
#[derive(Debug)]
struct Life {
    kind: TokenKind,
    token: Token,
    birth: u64,
    /// Where it is, and since when; not written yet.
    stage: (u64, &'static str),
    /// What keeps it from going on; not written yet.
    stall: Option<Stall>,
}

/// What a line of the log tells of a token; those of a cycle in this order.
#[derive(Clone, Copy, Debug)]
enum Command {
    Begin,
    EndStall(&'static str),
    Stage(&'static str),
    Stall(&'static str),
    Retire,
}

impl Command {
    fn order(self) -> u8 {
        match self {
            Command::Begin => 0,
            Command::EndStall(_) => 1,
            Command::Stage(_) => 2,
            Command::Stall(_) => 3,
            Command::Retire => 4,
        }
    }
}

/// The lines of the log in the order in which they become known: cycle, token, and what is told.
#[derive(Debug, Default)]
struct Lines(Vec<(u64, u32, Command)>);

impl Lines {
    fn enter(&mut self, place: usize, life: &mut Life, cycle: u64, stage: &'static str) {
        // A token that leaves in the cycle in which it could first be seen was nowhere else.
        if life.stage.0 < cycle {
            self.0.push((life.stage.0, place as u32, Command::Stage(life.stage.1)));
        }
        life.stage = (cycle, stage);
    }

    fn stall(&mut self, place: usize, life: &mut Life, stall: Stall) {
        if let Some(before) = &mut life.stall {
            if before.to == stall.from && before.name == stall.name {
                before.to = stall.to;
                return;
            }
            self.end_stall(place, life);
        }
        life.stall = Some(stall);
    }

    fn end_stall(&mut self, place: usize, life: &mut Life) {
        if let Some(Stall { from, to, name }) = life.stall.take() {
            self.0.push((from, place as u32, Command::Stall(name)));
            self.0.push((to, place as u32, Command::EndStall(name)));
        }
    }

    fn end(&mut self, place: usize, life: &mut Life) {
        self.0.push((life.stage.0, place as u32, Command::Stage(life.stage.1)));
        self.end_stall(place, life);
    }
}

/// The name of what keeps a unit from going on, where something does.
fn obstacle(activity: Activity) -> Option<&'static str> {
    matches!(activity, Activity::Blocked | Activity::Waiting(_)).then(|| activity.name())
}

/// A channel with the tokens in it, and the units at its ends as places.
struct Between {
    name: &'static str,
    kind: TokenKind,
    from: usize,
    to: usize,
    /// Whether tokens go no further than the unit behind it.
    last: bool,
    held: VecDeque<usize>,
}

/// What a unit has in hand.
#[derive(Debug, Default)]
struct Hand {
    /// Whether it makes tokens out of none that could be seen before.
    source: bool,
    /// Since when it has been making the next, and that token's stalls.
    since: Option<u64>,
    stalls: Vec<Stall>,
    /// The token that it took in this cycle.
    taken: Option<usize>,
}

struct Lives {
    units: Vec<&'static str>,
    channels: Vec<Between>,
    hands: Vec<Hand>,
    all: Vec<Life>,
    /// Tokens that units have taken and not given.
    inside: HashMap<(TokenKind, Token), usize>,
    lines: Lines,
}

impl Lives {
    fn new(recording: &Recording) -> Lives {
        let units = recording.units().to_vec();
        let tracks = recording.tracks();
        let unit = |name: &str| units.iter().position(|unit| *unit == name).unwrap_or(0);
        let source = |name: &&str| tracks.iter().all(|track| track.joint.to != *name);
        let hands = units.iter().map(|name| Hand { source: source(name), ..Hand::default() }).collect();
        let mut lives = Lives {
            channels: Vec::new(),
            hands,
            all: Vec::new(),
            inside: HashMap::new(),
            lines: Lines::default(),
            units: units.clone(),
        };
        for track in tracks {
            let joint = track.joint;
            let goes_on = |next: &super::Track| next.joint.from == joint.to && next.joint.tokens == joint.tokens;
            let begin = |(token, _): &(Token, u64)| lives.begin(joint.tokens, *token, recording.from(), joint.channel);
            let held = track.held.iter().map(begin).collect();
            lives.channels.push(Between {
                name: joint.channel,
                kind: joint.tokens,
                from: unit(joint.from),
                to: unit(joint.to),
                last: !tracks.iter().any(goes_on),
                held,
            });
        }
        lives
    }

    /// A token that was not seen before.
    fn begin(&mut self, kind: TokenKind, token: Token, birth: u64, stage: &'static str) -> usize {
        self.all.push(Life { kind, token, birth, stage: (birth, stage), stall: None });
        self.lines.0.push((birth, self.all.len() as u32 - 1, Command::Begin));
        self.all.len() - 1
    }

    fn cycle(&mut self, events: &Events) {
        let cycle = events.cycle;
        for (hand, activity) in self.hands.iter_mut().zip(events.activities) {
            if hand.source && activity != Activity::Starved {
                hand.since.get_or_insert(cycle);
                if let Some(name) = obstacle(activity) {
                    hand.stalls.push(Stall { from: cycle, to: cycle + 1, name });
                }
            }
        }
        for (i, channel) in self.channels.iter_mut().enumerate() {
            if events.popped[i].is_some() {
                if let Some(place) = channel.held.pop_front() {
                    let life = &mut self.all[place];
                    self.lines.enter(place, life, cycle, self.units[channel.to]);
                    if channel.last {
                        self.lines.end(place, life);
                        self.lines.0.push((cycle + 1, place as u32, Command::Retire));
                    } else {
                        self.hands[channel.to].taken = Some(place);
                    }
                }
            } else if events.front[i].is_some()
                && let Some(name) = obstacle(events.activities[channel.to])
                && let Some(&place) = channel.held.front()
            {
                let stall = Stall { from: cycle, to: cycle + 1, name };
                self.lines.stall(place, &mut self.all[place], stall);
            }
        }
        for i in 0..self.channels.len() {
            if let Some(token) = events.pushed[i] {
                let Between { name, kind, from, .. } = self.channels[i];
                let place = self.given(kind, token, from, cycle);
                self.lines.enter(place, &mut self.all[place], cycle + 1, name);
                self.channels[i].held.push_back(place);
            }
        }
        for hand in &mut self.hands {
            if let Some(place) = hand.taken.take() {
                self.inside.insert((self.all[place].kind, self.all[place].token), place);
            }
        }
    }

    /// The token that a unit gives: taken in this cycle or before, made, or taken before the window.
    fn given(&mut self, kind: TokenKind, token: Token, from: usize, cycle: u64) -> usize {
        let is = |place: &mut usize| self.all[*place].kind == kind && self.all[*place].token == token;
        if let Some(place) = self.hands[from].taken.take_if(is) {
            return place;
        }
        if !self.hands[from].source
            && let Some(place) = self.inside.remove(&(kind, token))
        {
            return place;
        }
        let birth = self.hands[from].since.take().unwrap_or(cycle);
        let place = self.begin(kind, token, birth, self.units[from]);
        for stall in std::mem::take(&mut self.hands[from].stalls) {
            self.lines.stall(place, &mut self.all[place], stall);
        }
        place
    }
}

/// The log.
pub fn write(recording: &Recording) -> String {
    let mut lives = Lives::new(recording);
    let seen: Result<(), std::convert::Infallible> = recording.replay(|events| {
        lives.cycle(events);
        Ok(())
    });
    let Ok(()) = seen;
    let Lives { mut all, mut lines, channels, inside, .. } = lives;
    // What is still on its way; a stage that would begin behind the window is not shown.
    for place in channels.iter().flat_map(|channel| &channel.held).chain(inside.values()) {
        let life = &mut all[*place];
        if life.stage.0 < recording.to() {
            lines.end(*place, life);
        } else {
            lines.end_stall(*place, life);
        }
    }
    text(recording, &all, &lines.0)
}

/// The lines in order of cycles, and of tokens within one; tokens are numbered as they begin.
fn text(recording: &Recording, all: &[Life], lines: &[(u64, u32, Command)]) -> String {
    let from = recording.from();
    let mut begun: Vec<u32> = (0..all.len() as u32).collect();
    begun.sort_by_key(|place| all[*place as usize].birth);
    let mut ids = vec![0; all.len()];
    for (id, place) in (0_u32..).zip(begun) {
        ids[place as usize] = id;
    }
    // Sorted by counting: where the lines of each cycle start.
    let cycles = (recording.to() - from) as usize + 1;
    let mut starts = vec![0; cycles + 1];
    for (cycle, ..) in lines {
        starts[(cycle - from) as usize + 1] += 1;
    }
    for i in 0..cycles {
        starts[i + 1] += starts[i];
    }
    let mut sorted = vec![(0, Command::Begin, 0); lines.len()];
    let mut next = starts.clone();
    for &(cycle, place, command) in lines {
        let at = &mut next[(cycle - from) as usize];
        sorted[*at] = (ids[place as usize], command, place);
        *at += 1;
    }
    let mut text = Text(format!("Kanata\t0004\nC=\t{from}\n"));
    let (mut waited, mut retired) = (0, 0);
    for cycle in 0..cycles {
        let lines = &mut sorted[starts[cycle]..starts[cycle + 1]];
        lines.sort_by_key(|(id, command, _)| (*id, command.order()));
        if !lines.is_empty() && waited > 0 {
            text.words(&["C"]).number(waited).end();
            waited = 0;
        }
        for (id, command, place) in lines {
            let id = u64::from(*id);
            match command {
                Command::Begin => {
                    let Life { kind, token, .. } = &all[*place as usize];
                    text.words(&["I"]).number(id).number(id).number(*kind as u64).end();
                    text.words(&["L"]).number(id).words(&["0", kind.name()]);
                    text.field(": frame ", token.frame).field(", plane ", token.plane);
                    text.field(", ", kind.place()).field(" ", token.place).end();
                }
                Command::Stage(stage) => text.words(&["S"]).number(id).words(&["0", stage]).end(),
                Command::Stall(name) => text.words(&["S"]).number(id).words(&["1", name]).end(),
                Command::EndStall(name) => text.words(&["E"]).number(id).words(&["1", name]).end(),
                Command::Retire => {
                    text.words(&["R"]).number(id).number(retired).words(&["0"]).end();
                    retired += 1;
                }
            }
        }
        waited += 1;
    }
    text.0
}

/// Lines of words between tabs. A line is written in parts, without the machinery of formatting: there are a dozen in a cycle.
struct Text(String);

impl Text {
    fn tab(&mut self) {
        if !self.0.ends_with('\n') {
            self.0.push('\t');
        }
    }

    fn words(&mut self, words: &[&str]) -> &mut Text {
        for word in words {
            self.tab();
            self.0.push_str(word);
        }
        self
    }

    fn number(&mut self, number: u64) -> &mut Text {
        self.tab();
        self.digits(number);
        self
    }

    fn digits(&mut self, number: u64) {
        if number >= 10 {
            self.digits(number / 10);
        }
        self.0.push(char::from(b'0' + (number % 10) as u8));
    }

    /// A name and a value, without a tab.
    fn field(&mut self, name: &str, value: impl Into<Value>) -> &mut Text {
        self.0.push_str(name);
        match value.into() {
            Value::Number(number) => self.digits(u64::from(number)),
            Value::Word(word) => self.0.push_str(word),
        }
        self
    }

    fn end(&mut self) {
        self.0.push('\n');
    }
}

enum Value {
    Number(u32),
    Word(&'static str),
}

impl From<u32> for Value {
    fn from(number: u32) -> Value {
        Value::Number(number)
    }
}

impl From<&'static str> for Value {
    fn from(word: &'static str) -> Value {
        Value::Word(word)
    }
}
