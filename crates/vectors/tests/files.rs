//! Vector files and answers: what is written is read again, and what is wrong is told.

use cube3_vectors::compare::{Mismatch, explain, first_mismatch};
use cube3_vectors::waveform::around_mismatch;
use cube3_vectors::{FileError, Format, Responses, ResponsesError, Table, Unit, VectorFile, Vectors, testbench, units};
use wellen::simple::read_from_reader;

fn unit(name: &str) -> Box<dyn Unit> {
    units().into_iter().find(|unit| unit.sheet().name == name).unwrap()
}

fn trilin() -> (Box<dyn Unit>, Vectors) {
    let unit = unit("trilin");
    let vectors = Vectors::generate(unit.as_ref(), Format::default(), 300, 7).unwrap();
    (unit, vectors)
}

/// The answers of a device that is right.
fn answers(vectors: &Vectors) -> String {
    let line = |values: &Vec<i128>| {
        let words: Vec<String> =
            vectors.fields[1].iter().zip(values).map(|(field, value)| field.text(*value)).collect();
        words.join(" ") + "\n"
    };
    vectors.outputs.iter().map(line).collect()
}

#[test]
fn a_file_is_read_as_it_was_written() {
    for unit in units() {
        for format in unit.formats() {
            let vectors = Vectors::generate(unit.as_ref(), format, 50, 9).unwrap();
            let text = vectors.text();
            let read = VectorFile::parse(&text).unwrap();
            assert_eq!((read.unit.as_str(), read.seed), (vectors.sheet.name, 9));
            let tables = vectors.sheet.tables.iter().zip(vectors.table_texts());
            let tables = tables.map(|(of, (_, text))| read.table(of, &text).unwrap()).collect();
            assert_eq!(tables, vectors.tables);
            let again = read.vectors(unit.as_ref(), tables).unwrap();
            assert_eq!((&again.inputs, &again.outputs), (&vectors.inputs, &vectors.outputs), "{}", read.unit);
            assert_eq!(again.text(), text);
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_does_not() {
    let unit = unit("trilin");
    let text = |seed| Vectors::generate(unit.as_ref(), Format::default(), 300, seed).unwrap().text();
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
    assert_eq!(VectorFile::parse("nothing"), Err(FileError::Magic));
    let broken = text.replace("nearest=1", "nearest=x");
    assert!(matches!(VectorFile::parse(&broken), Err(FileError::Header { line: 3, .. })));
    let broken = text.replace("voxel_bits=16", "voxel_bits=99");
    assert!(matches!(VectorFile::parse(&broken), Err(FileError::Format(_))));
    assert!(matches!(VectorFile::parse(&(text.clone() + "12 34 5g\n")), Err(FileError::Word { .. })));
    let short = VectorFile::parse(&(text.clone() + "12 34\n")).unwrap();
    assert!(matches!(
        short.vectors(unit.as_ref(), Vec::new()),
        Err(FileError::Fields { line: 300, found: 2, expected: 12 })
    ));
    let edited = VectorFile::parse(&text.replacen(" 100 ", " 0ff ", 1)).unwrap();
    assert_eq!(edited.vectors(unit.as_ref(), Vec::new()).unwrap_err(), FileError::Digest);
    let inputs: String = text
        .replacen(" 100 ", " 0ff ", 1)
        .lines()
        .filter(|line| !line.contains("sha256"))
        .map(|l| l.to_owned() + "\n")
        .collect();
    assert!(VectorFile::parse(&inputs).unwrap().vectors(unit.as_ref(), Vec::new()).is_ok());
    let large = VectorFile::parse(&text.replacen(" 100 ", " 101 ", 1)).unwrap();
    let error = large.vectors(unit.as_ref(), Vec::new()).unwrap_err();
    assert!(error.to_string().ends_with("weight_w = 257 is outside 0 to 256"), "{error}");
    let table = Table { name: "root", entries: "3", bits: "4", meaning: "" };
    assert_eq!(short.table(&table, "1\n2 // two\n\nf\n"), Ok(vec![1, 2, 15]));
    assert!(matches!(short.table(&table, "1\n2\n"), Err(FileError::Table { found: 2, expected: 3, .. })));
    assert!(matches!(short.table(&table, "1\n2\n10\n"), Err(FileError::Table { bits: 4, .. })));
    assert!(matches!(short.table(&table, "1\nx\n3\n"), Err(FileError::Word { line: 2, .. })));
}

#[test]
fn a_right_device_is_equal_and_each_kind_of_wrong_answer_is_told() {
    let (_, vectors) = trilin();
    let right = answers(&vectors);
    let parse = |text: &str| Responses::parse(text, &vectors);
    assert_eq!(first_mismatch(&vectors, &parse(&right).unwrap()), None);
    let upper = format!("// my device\n\n{}", right.to_uppercase());
    assert_eq!(first_mismatch(&vectors, &parse(&upper).unwrap()), None);
    let lines: Vec<&str> = right.lines().collect();
    assert_eq!(parse(&lines[1..].join("\n")), Err(ResponsesError::Lines { found: 299, expected: 300 }));
    assert!(matches!(parse(&right.replacen('\n', " 1\n", 1)), Err(ResponsesError::Fields { line: 1, found: 2, .. })));
    assert!(matches!(parse(&right.replacen('\n', "hello\n", 1)), Err(ResponsesError::Word { line: 1, .. })));
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
        let responses = Responses::parse(&lines.join("\n"), &vectors).unwrap();
        let mismatch = first_mismatch(&vectors, &responses).unwrap();
        assert_eq!(mismatch, Mismatch { line, fields: vec![0], lines: 1 });
        let text = explain(unit.as_ref(), &vectors, &responses, &mismatch);
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
    let responses = Responses::parse(&lines.join("\n"), &vectors).unwrap();
    let waveform = around_mismatch(unit.as_ref(), &vectors, &responses, 10..30).unwrap();
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
    for line in [10, 19, 21, 29] {
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
        let text = testbench::text(&sheet, &Format::default()).unwrap();
        for port in sheet.inputs.iter().chain(&sheet.outputs) {
            assert!(text.contains(&format!(".{0}({0})", port.name)), "{} {}", sheet.name, port.name);
        }
        for parameter in sheet.parameters {
            assert!(text.contains(&format!(".{}(", parameter.to_uppercase())), "{} {parameter}", sheet.name);
        }
    }
}
