//! Waveforms as two readers see them, wellen and GTKWave's `fst2vcd`, and the files with which viewers show them.

use crate::rtl::run;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;
use std::process::Command;
use wellen::SignalRef;

/// A variable: its width, and its bits from the places of the times on at which they change, unknown before the first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Values {
    /// Width.
    pub bits: u32,
    /// The highest bit first, in small letters.
    pub changes: Vec<(usize, String)>,
}

impl Values {
    /// The bits at a place of the times; none for unknown ones before the first change.
    pub fn at(&self, place: usize) -> Option<&str> {
        let count = self.changes.partition_point(|(from, _)| *from <= place);
        self.changes[..count].last().map(|(_, value)| value.as_str())
    }

    fn change(&mut self, place: usize, value: &str) {
        let value = value.to_lowercase();
        match self.changes.last_mut() {
            Some((_, last)) if *last == value => {}
            Some((from, last)) if *from == place => *last = value,
            None if value.bytes().all(|letter| letter == b'x') => {}
            _ => self.changes.push((place, value)),
        }
    }
}

/// A waveform that has been read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Waves {
    /// Seconds of a time unit, as a power of ten, and how many of those.
    pub unit: (i32, u32),
    /// The times, in units.
    pub times: Vec<i64>,
    /// The variables by their paths, with dots.
    pub variables: BTreeMap<String, Values>,
}

impl Waves {
    /// As wellen reads it.
    ///
    /// # Panics
    /// For a file that it does not read.
    pub fn by_wellen(fst: Vec<u8>) -> Waves {
        let mut wave = wellen::simple::read_from_reader(Cursor::new(fst)).unwrap();
        let hierarchy = wave.hierarchy();
        let variable = |of: wellen::VarRef| {
            let of = &hierarchy[of];
            (of.full_name(hierarchy), of.length(hierarchy).unwrap(), of.signal_ref())
        };
        let found: Vec<(String, u32, SignalRef)> = hierarchy.all_vars().map(variable).collect();
        let timescale = hierarchy.timescale().unwrap();
        wave.load_signals(&found.iter().map(|(_, _, signal)| *signal).collect::<Vec<_>>());
        let times: Vec<i64> = wave.time_table().iter().map(|&time| time as i64).collect();
        let variables = found.into_iter().map(|(name, bits, signal)| {
            let mut values = Values { bits, changes: Vec::new() };
            for (place, value) in wave.get_signal(signal).unwrap().iter_changes() {
                values.change(place as usize, &value.to_string());
            }
            (name, values)
        });
        let unit = (i32::from(timescale.unit.to_exponent().unwrap()), timescale.factor);
        Waves { unit, variables: variables.collect(), times }
    }

    /// As GTKWave's tool reads it, and with it GTKWave itself.
    ///
    /// # Panics
    /// For a file that it does not read, and where what it writes is no VCD as it should be.
    pub fn by_fst2vcd(fst2vcd: &Path, fst: &[u8]) -> Waves {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("wave.fst");
        std::fs::write(&file, fst).unwrap();
        Waves::of_vcd(&run(Command::new(fst2vcd).arg(&file)).unwrap())
    }

    fn of_vcd(text: &str) -> Waves {
        let (mut unit, mut zero) = (None, 0);
        let (mut scopes, mut names) = (Vec::new(), BTreeMap::new());
        let (mut times, mut variables) = (Vec::new(), BTreeMap::<String, Values>::new());
        let mut words = text.split_whitespace();
        while let Some(word) = words.next() {
            match word {
                "$date" | "$version" => assert!(words.any(|word| word == "$end")),
                "$timescale" => unit = Some(timescale(words.next().unwrap())),
                // What a viewer adds to every time.
                "$timezero" => zero = words.next().unwrap().parse().unwrap(),
                "$scope" => scopes.push(words.nth(1).unwrap().to_owned()),
                "$upscope" => drop(scopes.pop()),
                "$var" => {
                    let bits: u32 = words.nth(1).unwrap().parse().unwrap();
                    let id = words.next().unwrap();
                    let name = format!("{}.{}", scopes.join("."), words.next().unwrap());
                    variables.insert(name.clone(), Values { bits, changes: Vec::new() });
                    assert!(names.insert(id, name).is_none(), "{id}");
                }
                _ if word.starts_with('#') => times.push(word[1..].parse::<i64>().unwrap() + zero),
                _ if word.starts_with(['b', '0', '1', 'x']) => {
                    // What comes before the first time is of time 0.
                    if times.is_empty() {
                        times.push(zero);
                    }
                    let (value, id) = match word.strip_prefix('b') {
                        Some(value) => (value, words.next().unwrap()),
                        None => word.split_at(1),
                    };
                    variables.get_mut(&names[id]).unwrap().change(times.len() - 1, value);
                }
                _ => {}
            }
        }
        Waves { unit: unit.unwrap(), times, variables }
    }

    /// The bits of a variable at a place of the times.
    ///
    /// # Panics
    /// Where it is not in the waveform, or has had no value yet.
    pub fn bits(&self, name: &str, place: usize) -> &str {
        self.variables[name].at(place).unwrap()
    }

    /// A word, or none where its bits are unknown.
    pub fn word(&self, name: &str, place: usize) -> Option<u64> {
        u64::from_str_radix(self.variables[name].at(place)?, 2).ok()
    }

    /// The letters of a variable of eight bits each, without blanks around them.
    ///
    /// # Panics
    /// Where bits are unknown.
    pub fn text(&self, name: &str, place: usize) -> String {
        let letters = self.bits(name, place).as_bytes().chunks(8);
        let letter = |bits| char::from(u8::from_str_radix(std::str::from_utf8(bits).unwrap(), 2).unwrap());
        letters.map(letter).collect::<String>().trim().to_owned()
    }

    /// The seconds from time 0 to that of a place.
    pub fn seconds(&self, place: usize) -> f64 {
        self.times[place] as f64 * self.unit_seconds()
    }

    /// The seconds of a time unit.
    pub fn unit_seconds(&self) -> f64 {
        f64::from(self.unit.1) * 10_f64.powi(self.unit.0)
    }
}

fn timescale(text: &str) -> (i32, u32) {
    let digits = text.find(|letter: char| !letter.is_ascii_digit()).unwrap();
    let prefixes = [("s", 0), ("ms", -3), ("us", -6), ("ns", -9), ("ps", -12), ("fs", -15), ("as", -18), ("zs", -21)];
    let exponent = prefixes.iter().find(|(prefix, _)| *prefix == &text[digits..]).unwrap().1;
    (exponent, text[..digits].parse().unwrap())
}

/// A variable as a viewer's file shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    /// Its path, with dots.
    pub name: String,
    /// The heading that it stands below.
    pub group: String,
    /// Flags in hexadecimal, or the name of a format; empty where the file says nothing.
    pub format: String,
}

/// What a save file of GTKWave shows, each variable with its width, and its lines of other kinds.
///
/// # Panics
/// For a line that is none of GTKWave's.
pub fn of_gtkwave(text: &str) -> (Vec<(Shown, u32)>, Vec<&str>) {
    let (mut shown, mut other) = (Vec::new(), Vec::new());
    let (mut flags, mut group) = (0, None);
    for line in text.lines() {
        if let Some(digits) = line.strip_prefix('@') {
            flags = u32::from_str_radix(digits, 16).unwrap();
        } else if let Some(name) = line.strip_prefix('-') {
            match flags {
                0x80_0200 => assert_eq!(group.replace(name.to_owned()), None, "a group within {name}"),
                0x100_0200 => assert_eq!(group.take().as_deref(), Some(name)),
                _ => assert_eq!((flags, name), (0x2_0000, ""), "room for the curve above"),
            }
        } else if line.starts_with(['[', '*']) {
            other.push(line);
        } else {
            let (name, bits) = match line.split_once('[') {
                Some((name, range)) => (name, range.strip_suffix(":0]").unwrap().parse::<u32>().unwrap() + 1),
                None => (line, 1),
            };
            let group = group.clone().unwrap();
            shown.push((Shown { name: name.to_owned(), group, format: format!("{flags:x}") }, bits));
        }
    }
    assert_eq!(group, None);
    (shown, other)
}

/// What a command file of Surfer shows.
///
/// # Panics
/// For a command that it should not hold.
pub fn of_surfer(text: &str) -> Vec<Shown> {
    let mut items: Vec<Option<Shown>> = Vec::new();
    let (mut group, mut focus) = (String::new(), None);
    for line in text.lines() {
        let (command, parameter) = line.split_once(' ').unwrap_or((line, ""));
        match command {
            "divider_add" => {
                assert!(parameter.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_'), "{line}");
                group = parameter.to_owned();
                items.push(None);
            }
            "variable_add" => {
                assert_eq!(focus, None, "items go behind the one in focus");
                items.push(Some(Shown { name: parameter.to_owned(), group: group.clone(), format: String::new() }));
            }
            "item_focus" => {
                let (letters, name) = parameter.split_once('_').unwrap();
                let item = letters.bytes().fold(0, |item, letter| 16 * item + usize::from(letter - b'a'));
                assert!(letters.bytes().all(|letter| (b'a'..=b'p').contains(&letter)), "{line}");
                assert_eq!(items[item].as_ref().unwrap().name, name);
                focus = Some(item);
            }
            "item_set_format" => parameter.clone_into(&mut items[focus.unwrap()].as_mut().unwrap().format),
            "item_set_analog" => items[focus.unwrap()].as_mut().unwrap().format += &format!(" {parameter}"),
            _ => assert!(["item_unfocus", "zoom_fit"].contains(&line), "{line}"),
        }
    }
    items.into_iter().flatten().collect()
}
