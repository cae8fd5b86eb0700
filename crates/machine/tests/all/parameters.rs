//! The table of parameters against the machines that it is of.

use cube3_machine::{Layout, MachineError, MachineSpec, MemoryType, PARAMETERS, PRESETS};
use cube3_parameter::{Legal, Parameter, Value, ValueKind};
use std::collections::BTreeSet;

/// A machine in which every key that may be absent is given.
fn full() -> MachineSpec {
    let mut machine = MachineSpec::default();
    (machine.cfb.memory, machine.cfb.layout) = (MemoryType::Sdram, Layout::MiniBlocks);
    for row in PARAMETERS.iter().filter(|row| row.optional) {
        let document = format!("key = {}", row.example);
        let document = toml::de::DeTable::parse(&document).unwrap();
        (row.set)(&mut machine, &Value::of_toml(document.get_ref()["key"].get_ref()).unwrap()).unwrap();
    }
    machine.check("full").unwrap();
    machine
}

fn machines() -> Vec<MachineSpec> {
    let presets = PRESETS.iter().map(|(name, text)| MachineSpec::from_toml(text, name).unwrap());
    presets.chain([full()]).collect()
}

fn keys_of(table: &toml::Table, path: &str, keys: &mut BTreeSet<String>) {
    for (name, value) in table {
        match value {
            toml::Value::Table(table) => keys_of(table, &format!("{path}{name}."), keys),
            _ => assert!(keys.insert(format!("{path}{name}"))),
        }
    }
}

#[test]
fn the_keys_of_a_file_are_those_of_the_table() {
    let mut keys = BTreeSet::new();
    keys_of(&full().to_toml().parse().unwrap(), "", &mut keys);
    let rows: BTreeSet<String> = PARAMETERS.iter().map(|row| row.key.to_owned()).collect();
    assert_eq!(rows.len(), PARAMETERS.len(), "each key once");
    assert_eq!(keys, rows);
}

#[test]
fn values_are_legal_and_set_as_they_are_got() {
    for machine in machines() {
        for row in PARAMETERS {
            row.check(&machine).unwrap();
            let value = (row.get)(&machine);
            let mut other = full();
            (row.set)(&mut other, &value).unwrap();
            assert_eq!((row.get)(&other), value, "{}", row.key);
            let mut same = machine.clone();
            (row.set)(&mut same, &value).unwrap();
            assert_eq!(same, machine, "{}", row.key);
        }
    }
}

/// Values below, in and above the range of a number; in and beside those of others.
fn around(row: &Parameter<MachineSpec>, machine: &MachineSpec) -> Vec<Value> {
    let values = match (row.legal)(machine) {
        Legal::Whole { low, high } => [low - 1, low, (low + high) / 2, high, high + 1].map(Value::Whole).to_vec(),
        Legal::Real { low, high, .. } => {
            [low - 1.0, low, (low + high) / 2.0, high, high * 2.0, f64::NAN].map(Value::Real).to_vec()
        }
        Legal::OneOf(values) => {
            let others = [Value::Whole(0), Value::Whole(99), Value::Text("nothing".into())];
            values.into_iter().chain(others).collect()
        }
        Legal::Anything if row.kind == ValueKind::Flag => [true, false].map(Value::Flag).to_vec(),
        Legal::Anything => ["one", "another"].map(|name| Value::Text(name.into())).to_vec(),
    };
    match row.kind {
        ValueKind::List(_) => values.into_iter().map(|value| Value::List(vec![value; 3])).collect(),
        _ => values,
    }
}

#[test]
fn the_nearest_legal_value_can_be_set_and_is_legal() {
    for mut machine in machines() {
        for row in PARAMETERS {
            let was = (row.get)(&machine);
            for value in around(row, &machine) {
                let legal = (row.legal)(&machine);
                let nearest = legal.nearest(&value);
                assert_eq!(nearest == value, legal.contains(&value), "{} = {value}", row.key);
                (row.set)(&mut machine, &nearest).unwrap();
                assert_eq!((row.get)(&machine), nearest, "{}", row.key);
                row.check(&machine).unwrap();
                (row.set)(&mut machine, &was).unwrap();
            }
        }
    }
}

/// A file that sets a key, with a line before it, and the line of the key.
fn file(row: &Parameter<MachineSpec>, value: &str) -> (String, usize) {
    let (section, name) = row.key.rsplit_once('.').unwrap_or(("", row.key));
    let other = match row.key.strip_prefix("channel.") {
        Some(_) if name == "capacity" => "\nlatency = 3",
        Some(_) => "\ncapacity = 3",
        None => "",
    };
    if section.is_empty() {
        (format!("# a machine\n{name} = {value}\n"), 2)
    } else {
        (format!("# a machine\n[{section}]\n{name} = {value}{other}\n"), 3)
    }
}

#[test]
fn a_number_out_of_range_names_line_key_range_and_the_nearest() {
    let machine = MachineSpec::default();
    for row in PARAMETERS {
        let legal = (row.legal)(&machine);
        let outside = match legal {
            Legal::Whole { low, high } => [Value::Whole(low - 1), Value::Whole(high + 1)],
            Legal::Real { low, high, .. } => [Value::Real(low - 1.0), Value::Real(high * 1.25)],
            _ => {
                let number = matches!(
                    row.kind,
                    ValueKind::Whole | ValueKind::Real | ValueKind::List(ValueKind::Whole | ValueKind::Real)
                );
                assert!(!number || row.key == "cfb.burst_words", "{}: a number has a range", row.key);
                continue;
            }
        };
        for value in outside {
            let nearest = legal.nearest(&value);
            let text =
                if matches!(row.kind, ValueKind::List(_)) { format!("[1, {value}, 1]") } else { value.to_string() };
            let (file, line) = file(row, &text);
            let error = MachineSpec::from_toml(&file, "m.toml").unwrap_err();
            let MachineError::Value { place, fault } = &error else { panic!("{error}") };
            assert_eq!(*place, format!("m.toml:{line}"), "{error}");
            let key =
                if matches!(row.kind, ValueKind::List(_)) { format!("{}[1]", row.key) } else { row.key.to_owned() };
            assert_eq!((&fault.key, &fault.value, &fault.legal, &fault.nearest), (&key, &value, &legal, &nearest));
            assert!(error.to_string().starts_with(&format!("m.toml:{line}: {key} = {value} is ")), "{error}");
        }
    }
}

#[test]
fn the_book_shows_the_default_as_it_is_printed() {
    assert!(
        MachineSpec::default().commented() == include_str!("../../../../docs/src/default-machine.toml"),
        "print it anew"
    );
}

fn error(text: &str) -> String {
    MachineSpec::from_toml(text, "m.toml").unwrap_err().to_string()
}

#[test]
fn ranges_name_what_sets_them() {
    for (text, expected) in [
        ("# one\n\nlanes = 0", "m.toml:3: lanes = 0 is outside 1 to 4096; the nearest legal value is 1"),
        (
            "[rays]\noffset = 1",
            "m.toml:2: rays.offset = 1.0 is outside 0 to below 1 voxels; the nearest legal value is just below 1",
        ),
        (
            "lanes = 4\n[boards]\ncount = -1",
            "m.toml:3: boards.count = -1 is outside 1 to 4 (the lanes are the most); the nearest legal value is 1",
        ),
        (
            "[cfb]\nmemory = \"sdram\"\nwindow = 9",
            "m.toml:3: cfb.window = 9 is outside 1 to 8 (cfb.look_ahead is the most); the nearest legal value is 8",
        ),
        (
            "[cfb]\nmemory = \"sdram\"\nburst_words = 3",
            "m.toml:3: cfb.burst_words = 3 is not one of 1, 2, 4, 8 words (what cfb.memory has); the nearest legal value is 2",
        ),
        (
            "[cfb]\nmemory = \"hbm\"\nburst_order = \"sequential\"",
            "m.toml:3: cfb.burst_order = \"sequential\" cannot be chosen here (only bursts of cfb.memory = \"sdram\" start at the word \
             asked for); leave it out",
        ),
        (
            "[words]\nnormal_bits = 4\n[abc]\npower_bits = 3",
            "m.toml: abc.root_bits = 8 is outside 4 to 6 bits (twice words.normal_bits - 1 is the most, and 10); the nearest legal value is 6",
        ),
        (
            "[words]\nvoxel_bits = 40",
            "m.toml:2: words.voxel_bits = 40 is outside 1 to 16 bits; the nearest legal value is 16",
        ),
        (
            "[rays]\ntemplate = \"nearest\"",
            "m.toml:2: rays.template = \"nearest\" is not one of \"sample-floor\", \"plane-floor\" (labels, which take the nearest voxel, are \
             the scene's: volume.labels = true); the nearest legal value is \"sample-floor\"",
        ),
        (
            "clock_hz = 8e6\n[bus]\nclock_hz = 10.0",
            "m.toml:3: bus.clock_hz = 10.0 is outside 8000 to 1e15 hertz (a thousandth of clock_hz is the least); the nearest legal value \
             is 8000.0",
        ),
    ] {
        assert_eq!(error(text), expected);
    }
}

#[test]
fn an_unknown_key_or_name_names_the_nearest_known() {
    for (text, expected) in [
        (
            "lanse = 3",
            "m.toml:1: lanse: there is no key `lanse`; did you mean `lanes`? The keys here are schema, name, ",
        ),
        (
            "\n[cfb]\nskw = [1, 1, 1]",
            "m.toml:3: cfb.skw: there is no key `skw`; did you mean `skew`? The keys here are skew, ",
        ),
        (
            "[cfb]\nbank_hash = \"xo\"",
            "m.toml:2: cfb.bank_hash: `xo` is not known; did you mean `xor`? The choices are plain, xor, digit-sum",
        ),
        ("[abc]\ngradient = \"7\"", "m.toml:2: abc.gradient: `7` is not known; the choices are 6, 26, "),
        (
            "[channel]\nbeams = { capacity = 3 }",
            "m.toml:2: channel.beams: the key `latency` is missing; give `latency`",
        ),
        ("lanes = \"many\"", "m.toml:1: lanes: invalid type: string \"many\"; give a whole number from 0 up"),
        ("lanes = 2.5", "m.toml:1: lanes = 2.5 is not a whole number, 1 to 4096; the nearest legal value is 3"),
        (
            "lanes = 99999999999999999999",
            "m.toml:1: lanes = 99999999999999999999 is outside 1 to 4096; the nearest legal value is 4096",
        ),
        ("schema = 2", "m.toml:1: schema = 2 is not 1; the nearest legal value is 1"),
        ("lanes =", "m.toml:1: "),
    ] {
        assert!(error(text).starts_with(expected), "{}", error(text));
    }
}

#[test]
fn values_that_do_not_go_together_say_why() {
    let cases = [
        (
            "[cfb]\nmemory = \"sdram\"\nmemory_clock_hz = 1e6",
            "m.toml:3: cfb.memory_clock_hz = 1e6 is too slow: refreshing would take more than a quarter of the time; give a faster clock",
        ),
        (
            "clock_hz = 1.0\n[cfb]\nmemory = \"sdram\"",
            "m.toml: cfb.memory_clock_hz = 1.33e8 is above 65536 ticks in a cycle of clock_hz; give a slower clock, or a faster pipeline",
        ),
        (
            "lanes = 6\n[cfb]\nlayout = \"mini-blocks\"\nskew = [3, 1, 1]",
            "m.toml:4: cfb.skew = [3, 1, 1] is not for cfb.layout = \"mini-blocks\": its first coefficient shares a factor with the lanes; \
             choose another skew or layout",
        ),
        (
            "[cfb]\nlayout = \"mini-blocks\"\nmemory = \"sdram\"\ncontroller = \"fr-fcfs\"",
            "m.toml:4: cfb.controller = \"fr-fcfs\" is not for cfb.layout = \"mini-blocks\": their rows are read in order; leave it \"in-order\", \
             or choose another layout",
        ),
        (
            "[cfb]\nreorder_words = 4096",
            "m.toml:2: cfb.reorder_words = 4096 is only for cfb.layout = \"mini-blocks\": other layouts are read in the order of the beams; \
             leave it out",
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(error(text), expected);
    }
    let good = "lanes = 6\n[cfb]\nlayout = \"mini-blocks\"\nskew = [-5, 3, 2]\nreorder_words = 8";
    assert!(MachineSpec::from_toml(good, "m.toml").is_ok());
}

#[test]
fn a_value_that_no_file_gave_has_the_machines_name_alone() {
    let error = MachineSpec { lanes: 5000, ..MachineSpec::default() }.check("cube3-128").unwrap_err();
    assert_eq!(error.to_string(), "cube3-128: lanes = 5000 is outside 1 to 4096; the nearest legal value is 4096");
    assert_eq!(error.key(), "lanes");
}
