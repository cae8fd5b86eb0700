//! Vector files and answers: what is written is read again, and what is wrong is told.

use cube3_vectors::around_mismatch;
use cube3_vectors::compare::{Compared, explain};
use cube3_vectors::{
    AnswerReader, Comparison, FileError, Lines, Mismatch, ResponsesError, Set, Table, Tables, Unit, UnitFormat,
    VectorHeader, VectorReader, Vectors, testbench, units,
};
use wellen::simple::read_from_reader;

fn unit(name: &str) -> Box<dyn Unit> {
    units().into_iter().find(|unit| unit.sheet().name == name).unwrap()
}

fn trilin() -> (Box<dyn Unit>, Vectors) {
    let unit = unit("trilin");
    let vectors = Vectors::generate(unit.as_ref(), UnitFormat::default(), 300, 7).unwrap();
    (unit, vectors)
}

/// The answers of a device that is right.
fn answers(vectors: &Vectors) -> String {
    let line = |values: &Vec<i128>| {
        let words: Vec<String> =
            vectors.set.fields[1].iter().zip(values).map(|(field, value)| field.text(*value)).collect();
        words.join(" ") + "\n"
    };
    vectors.outputs.iter().map(line).collect()
}

/// What a file says of its lines.
fn header(text: &str) -> Result<VectorHeader, FileError> {
    VectorReader::new(text.as_bytes()).map(|reader| reader.header().clone())
}

/// The vectors of a file with these contents of the tables.
fn read(text: &str, unit: &dyn Unit, tables: Tables) -> Result<Vectors, FileError> {
    let mut reader = VectorReader::new(text.as_bytes())?;
    let VectorHeader { format, seed, .. } = *reader.header();
    let set = Set::with_tables(unit, format, seed, tables)?;
    let mut inputs = Vec::new();
    while let Some(line) = reader.inputs(&set)? {
        inputs.push(line);
    }
    Ok(Vectors::of(unit, set, inputs))
}

/// Where answers differ from vectors, with lines around it.
fn compare(vectors: &Vectors, text: &str, around: usize) -> Result<Option<Mismatch>, ResponsesError> {
    let mut answers = AnswerReader::new(&vectors.set, text.as_bytes());
    let mut comparison = Comparison::new(&vectors.set, around);
    for (inputs, outputs) in vectors.inputs.iter().zip(&vectors.outputs) {
        let Some(answers) = answers.answers()? else { break };
        comparison.push(Compared { inputs: inputs.clone(), outputs: outputs.clone(), answers });
    }
    Ok(comparison.finish())
}

#[test]
fn a_file_is_read_as_it_was_written() {
    for unit in units() {
        for format in unit.formats() {
            let vectors = Vectors::generate(unit.as_ref(), format, 50, 9).unwrap();
            let text = vectors.text();
            let found = header(&text).unwrap();
            assert_eq!((found.unit.as_str(), found.seed), (vectors.set.sheet.name, 9));
            let tables = vectors.set.sheet.tables.iter().zip(vectors.table_texts());
            let tables = tables.map(|(of, (_, text))| found.table(of, text.as_bytes()).unwrap()).collect();
            assert_eq!(tables, vectors.set.tables);
            let again = read(&text, unit.as_ref(), tables).unwrap();
            assert_eq!((&again.inputs, &again.outputs), (&vectors.inputs, &vectors.outputs), "{}", found.unit);
            assert_eq!(again.text(), text);
            let mut reader = VectorReader::new(text.as_bytes()).unwrap();
            while reader.inputs(&again.set).unwrap().is_some() {}
            assert_eq!(Some(reader.digest(&again.set)), found.digest);
        }
    }
}

/// A shorter file is the beginning of a longer one, and the directed lines are that of all.
#[test]
fn the_count_cuts_one_sequence_of_lines() {
    for unit in units() {
        let of = |count| Vectors::generate(unit.as_ref(), UnitFormat::default(), count, 3).unwrap();
        let directed = Vectors::directed(unit.as_ref(), UnitFormat::default(), 3).unwrap();
        let all = of(directed.inputs.len() + 40);
        assert_eq!(all.inputs.len(), directed.inputs.len() + 40);
        assert_eq!(all.inputs[..directed.inputs.len()], directed.inputs);
        for count in [1, 7, directed.inputs.len() - 1, directed.inputs.len() + 1] {
            let part = of(count);
            assert_eq!((&part.inputs[..], &part.outputs[..]), (&all.inputs[..count], &all.outputs[..count]));
        }
    }
}

/// Directed lines grow with the square of the leaves, and none is made before it is asked for.
#[test]
fn the_lines_of_the_widest_cone_are_made_one_by_one() {
    let unit = unit("cone");
    let set = Set::new(unit.as_ref(), UnitFormat { lanes: 4096, ..UnitFormat::default() }, 7).unwrap();
    let lines: Vec<Vec<i128>> = Lines::new(unit.as_ref(), &set).unwrap().take(6).collect();
    assert_eq!((lines.len(), lines[5].len()), (6, 2 + 7 * 4096));
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_does_not() {
    let unit = unit("trilin");
    let text = |seed| Vectors::generate(unit.as_ref(), UnitFormat::default(), 300, seed).unwrap().text();
    assert_eq!(text(7), text(7));
    assert_ne!(text(7), text(8));
}

#[test]
fn the_digest_is_of_all_below_the_header() {
    use sha2::{Digest, Sha256};
    let (_, vectors) = trilin();
    let text = vectors.text();
    let (header, body): (Vec<&str>, Vec<&str>) = text.split_inclusive('\n').partition(|line| line.starts_with("//"));
    let digest: String = Sha256::digest(body.concat()).iter().map(|byte| format!("{byte:02x}")).collect();
    assert!(header.contains(&format!("// sha256 {digest}\n").as_str()));
}

#[test]
fn what_is_wrong_in_a_file_is_told_with_its_line() {
    let (unit, vectors) = trilin();
    let text = vectors.text();
    assert_eq!(header("nothing"), Err(FileError::Magic));
    let broken = text.replace("nearest=1", "nearest=x");
    assert!(matches!(header(&broken), Err(FileError::Header { line: 3, .. })));
    let broken = text.replace("voxel_bits=16", "voxel_bits=99");
    assert!(matches!(header(&broken), Err(FileError::Format(_))));
    let lines = |text: &str| read(text, unit.as_ref(), Tables::new()).map(|vectors| vectors.inputs.len());
    assert_eq!(lines(&text), Ok(300));
    assert!(matches!(lines(&(text.clone() + "12 34 5g\n")), Err(FileError::Word { line: 311, .. })));
    let found = Err(FileError::Fields { line: 300, found: 2, expected: 12 });
    assert_eq!(lines(&(text.clone() + "12 34\n")), found);
    assert!(matches!(lines(&(text.clone() + "// seed 3\n")), Err(FileError::Header { line: 311, .. })));
    let large = lines(&text.replacen(" 100 ", " 101 ", 1)).unwrap_err();
    assert!(large.to_string().ends_with("weight_w = 257 is outside 0 to 256"), "{large}");
    // Inputs that were changed have another digest than the header's.
    let edited = read(&text.replacen(" 100 ", " 0ff ", 1), unit.as_ref(), Tables::new()).unwrap();
    assert!(!edited.text().contains(&header(&text).unwrap().digest.unwrap()));
    let table = Table { name: "root", entries: "3", bits: "4", meaning: "" };
    let table = |text: &str| header(&vectors.text()).unwrap().table(&table, text.as_bytes());
    assert_eq!(table("1\n2 // two\n\nf\n"), Ok(vec![1, 2, 15]));
    assert!(matches!(table("1\n2\n"), Err(FileError::Table { found: 2, expected: 3, .. })));
    assert!(matches!(table("1\n2\n3\n4\n5\n"), Err(FileError::Table { found: 5, expected: 3, .. })));
    assert!(matches!(table("1\n2\n10\n"), Err(FileError::Table { bits: 4, .. })));
    assert!(matches!(table("1\nx\n3\n"), Err(FileError::Word { line: 2, .. })));
}

#[test]
fn a_right_device_is_equal_and_each_kind_of_wrong_answer_is_told() {
    let (_, vectors) = trilin();
    let right = answers(&vectors);
    let compare = |text: &str| compare(&vectors, text, 0);
    assert_eq!(compare(&right), Ok(None));
    assert_eq!(compare(&format!("// my device\n\n{}", right.to_uppercase())), Ok(None));
    let fields = compare(&right.replacen('\n', " 1\n", 1));
    assert!(matches!(fields, Err(ResponsesError::Fields { line: 1, found: 2, .. })));
    assert!(matches!(compare(&right.replacen('\n', "hello\n", 1)), Err(ResponsesError::Word { line: 1, .. })));
}

/// The prefix 0x stands before as many digits as a field has; in a word as long as the field its x is an unknown nibble.
#[test]
fn a_prefix_is_no_unknown_nibble() {
    let (unit, vectors) = trilin();
    let right = answers(&vectors);
    let prefixed = |prefix: &str| right.lines().map(|line| format!("{prefix}{line}\n")).collect::<String>();
    for prefix in ["0x", "0X"] {
        assert_eq!(compare(&vectors, &prefixed(prefix), 0), Ok(None));
        let text = prefixed(prefix).replacen(prefix, &(prefix.to_owned() + "0"), 1);
        let message = compare(&vectors, &text, 0).unwrap_err().to_string();
        let word = format!("line 1: `{prefix}00000`: 0x is no digit; sample has 4 hexadecimal digits");
        assert!(message.starts_with(&word), "{message}");
    }
    for (wrong, text) in [("0x12", "0x12"), ("0x0x12", "0x12"), ("0xzzzz", "zzzz")] {
        let mismatch = compare(&vectors, &right.replacen("0000", wrong, 1), 0).unwrap().unwrap();
        let answer = &mismatch.around[0].answers[0];
        assert_eq!((mismatch.line, answer.text.as_str(), answer.bits), (0, text, None));
        let told = explain(unit.as_ref(), &vectors.set, &mismatch);
        assert!(told.contains(&format!("got      {text} (x and z are unknown nibbles)")), "{told}");
    }
    assert!(matches!(compare(&vectors, &right.replacen("0000", "0x1", 1), 0), Err(ResponsesError::Prefix { .. })));
}

#[test]
fn a_wrong_bit_an_unknown_digit_and_a_word_too_wide_are_mismatches() {
    let (unit, vectors) = trilin();
    let line = vectors.outputs.iter().position(|out| out[0] == 0x5a5a || out[0] > 255 && out[0] < 0xff00).unwrap();
    for (wrong, shown) in [
        (format!("{:04x}", vectors.outputs[line][0] ^ 0x40), "^"),
        ("12x4".into(), "unknown"),
        (format!("1{:04x}", vectors.outputs[line][0]), "got"),
    ] {
        let text = answers(&vectors);
        let mut lines: Vec<&str> = text.lines().collect();
        lines[line] = &wrong;
        let mismatch = compare(&vectors, &lines.join("\n"), 2).unwrap().unwrap();
        assert_eq!((mismatch.line, &mismatch.fields[..], mismatch.differ, mismatch.of), (line, &[0][..], 1, 300));
        assert_eq!((mismatch.from, mismatch.around.len()), (line - 2, 5));
        let text = explain(unit.as_ref(), &vectors.set, &mismatch);
        assert!(text.contains(shown) && text.contains(&format!("transaction {line} is the first of 1")), "{text}");
        assert!(text.contains("along_v.product") && text.contains("voxel[7]") && text.contains(&wrong), "{text}");
    }
}

#[test]
fn the_waveform_shows_the_lines_around_a_mismatch() {
    let (unit, vectors) = trilin();
    let text = answers(&vectors);
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines[20] = "zzzz".into();
    let mismatch = compare(&vectors, &lines.join("\n"), 10).unwrap().unwrap();
    let waveform = around_mismatch(unit.as_ref(), &vectors.set, &mismatch).unwrap();
    let mut wave = read_from_reader(std::io::Cursor::new(waveform.fst)).unwrap();
    let mut value = |name: &str, line: usize| {
        let mut path: Vec<&str> = vec!["trilin"];
        path.extend(name.split('/'));
        let (scopes, name) = path.split_at(path.len() - 1);
        let variable = wave.hierarchy().lookup_var(scopes, name[0]).unwrap();
        let signal = wave.hierarchy()[variable].signal_ref();
        wave.load_signals(&[signal]);
        let time = wave.time_table().iter().position(|&time| time == 10 * line as u64).unwrap() as u32;
        let signal = wave.get_signal(signal).unwrap();
        let offset = signal.get_offset(time).unwrap();
        signal.get_value_at(&offset, 0).to_bit_string().unwrap()
    };
    let of = |line: usize| format!("{:016b}", vectors.outputs[line][0]);
    for line in [10, 19, 21, 30] {
        assert_eq!(value("differs", line), "0");
        assert_eq!((value("expected/sample", line), value("got/sample", line)), (of(line), of(line)));
        assert_eq!(value("in/voxel_3", line), format!("{:016b}", vectors.inputs[line][3]));
        assert_eq!(value("wires/along_v_value", line), of(line));
    }
    assert_eq!((value("differs", 20), value("expected/sample", 20)), ("1".into(), of(20)));
    assert_eq!(value("got/sample", 20), "x".repeat(16));
}

#[test]
fn a_bench_names_every_port_and_parameter() {
    for unit in units() {
        let sheet = unit.sheet();
        let text = testbench::text(&sheet, &UnitFormat::default()).unwrap();
        for port in sheet.inputs.iter().chain(&sheet.outputs) {
            assert!(text.contains(&format!(".{0}({0})", port.name)), "{} {}", sheet.name, port.name);
        }
        for parameter in sheet.parameters {
            assert!(text.contains(&format!(".{}(", parameter.to_uppercase())), "{} {parameter}", sheet.name);
        }
    }
}
