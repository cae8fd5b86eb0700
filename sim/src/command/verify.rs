//! `cube3 verify`: units against their specification, and devices under test against golden vectors.

use super::fits;
use super::run::print;
use super::vectors::UnitArguments;
use super::words::WordsArguments;
use crate::output::make_folder;
use crate::problem::{Outcome, Problem};
use clap::Args;
use cube3::memory;
use cube3::verify::{open_vectors, set_of, unit, verify_set};
use cube3::write_waveform;
use cube3_host::{VolumeInfo, frame_setup};
use cube3_inputs as inputs;
use cube3_machine::MachineSpec;
use cube3_pipeline::Machine;
use cube3_scene::{Mode, Scene, View};
use cube3_vectors::SetFiles;
use cube3_vectors::around_mismatch;
use cube3_vectors::compare::{Compared, explain};
use cube3_vectors::{
    Answer, Comparison, FileError, Lines, Mismatch, Set, Unit, UnitDefinition, UnitFormat, ranges, word_formats,
};
use cube3_word::{Words, unit_full};
use rustix::process::{Pid, Signal, kill_process_group};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus};
use std::time::{Duration, Instant};

/// Bytes of the lines that the lanes are given at a time.
const BLOCK_BYTES: usize = 4 << 20;
/// Between two looks at a device that has a limit of time.
const LOOK: Duration = Duration::from_millis(5);

/// Arguments of `cube3 verify`.
#[derive(Debug, Args)]
pub struct VerifyArguments {
    #[command(flatten)]
    unit: UnitArguments,
    /// Take the lines of this vector file, not generated ones.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["format", "set", "machine", "count", "seed"])]
    vectors: Option<PathBuf>,
    /// Compare what a device answered: a line of output fields for each line of the vectors.
    #[arg(long, value_name = "FILE", conflicts_with = "dut")]
    against: Option<PathBuf>,
    /// Run a device under test and compare what it answers: %i is the vector file, %o the file for the answers, %d the folder of both.
    #[arg(long, value_name = "COMMAND")]
    dut: Option<String>,
    /// Seconds that the device may take; then it is killed, with all that it has started. Without it the device takes as long as it likes.
    #[arg(long, value_name = "SECONDS", requires = "dut", allow_negative_numbers = true)]
    dut_timeout: Option<f64>,
    /// Folder for vectors, answers and the waveform of a mismatch, or for the study of word lengths.
    #[arg(long, value_name = "DIR", default_value = "out/verify", default_value_if("words", "true", "out/words"))]
    out: PathBuf,
    /// The study of word lengths: error of picture and gradients, and cost, against the length of each word.
    #[arg(long, conflicts_with_all = ["unit", "format", "set", "vectors", "against", "dut"])]
    words: bool,
    #[command(flatten)]
    study: WordsArguments,
}

/// What drives a device: the unit, what its lines have in common, the file with them, how many they are, and their digest.
struct Stimulus {
    unit: Box<dyn Unit>,
    set: Set,
    path: PathBuf,
    lines: usize,
    digest: String,
}

impl VerifyArguments {
    /// Verifies, and prints what was found.
    ///
    /// # Errors
    /// A mismatch, and what else went wrong, in words.
    pub fn execute(self) -> Outcome<()> {
        if self.words {
            return self.study.execute(&self.unit.machine, &self.out);
        }
        if let Some(option) = self.study.scene.given() {
            return Err(Problem::new(format!(
                "{option} is for the study of word lengths; give --words too, or leave it out"
            )));
        }
        if self.against.is_none() && self.dut.is_none() {
            if let Some(file) = &self.vectors {
                let file = file.display();
                return Err(Problem::new(format!(
                    "--vectors {file}: nothing to compare with; give --dut COMMAND or --against FILE"
                )));
            }
            return self.own();
        }
        let Stimulus { unit, set, path, lines, digest } = self.stimulus()?;
        let answers = match (&self.against, &self.dut) {
            (Some(answers), _) => answers.clone(),
            (None, Some(command)) => run_device(command, &self.out, &path, self.patience()?)?,
            (None, None) => return Ok(()),
        };
        let name = set.sheet.name;
        let verdict = verify_set(unit.as_ref(), &set, &path, &answers, Some(&digest))?;
        let Some(mismatch) = verdict.mismatch else {
            return print(&format!("{name}: all {lines} lines are equal, bit for bit\n"));
        };
        let wave = self.out.join(format!("{name}.fst"));
        write_waveform(&wave, &around_mismatch(unit.as_ref(), &set, &mismatch)?)?;
        print(&explain(unit.as_ref(), &set, &mismatch))?;
        Err(Problem::new(format!(
            "{name}: {} of {lines} lines differ from the specification, the first is {}; {} shows the lines around it",
            mismatch.differ,
            mismatch.line,
            wave.display()
        )))
    }

    /// How long the device may take.
    fn patience(&self) -> Outcome<Option<Duration>> {
        let Some(seconds) = self.dut_timeout else { return Ok(None) };
        match Duration::try_from_secs_f64(seconds) {
            Ok(limit) if !limit.is_zero() => Ok(Some(limit)),
            _ => Err(Problem::new(format!(
                "--dut-timeout {seconds}: give seconds above 0, or leave it out for a device that may take as long as it likes"
            ))),
        }
    }

    /// What drives the device.
    fn stimulus(&self) -> Outcome<Stimulus> {
        let Some(path) = &self.vectors else {
            let name = self.unit.unit.as_deref().ok_or_else(|| {
                Problem::new("--unit is missing: a device is compared with one unit; `cube3 vectors --list` names them")
            })?;
            let unit = unit(name)?;
            let (format, count) = (self.unit.format()?, self.unit.lines()?);
            fits(&memory::set(unit.as_ref(), &format, false)?)?;
            let set = Set::new(unit.as_ref(), format, self.unit.seed)?;
            make_folder(&self.out, "--out")?;
            let lines = |take: &mut dyn FnMut(Vec<i128>) -> Outcome<()>| {
                Lines::new(unit.as_ref(), &set)?.take(count).try_for_each(take)
            };
            let files = SetFiles::write(&self.out, unit.as_ref(), &set, None, lines)?;
            let digest = files.written().digest.clone();
            return Ok(Stimulus { unit, set, path: files.keep()?, lines: count, digest });
        };
        let mut reader = open_vectors(path)?;
        let header = reader.header().clone();
        if self.unit.unit.as_ref().is_some_and(|name| *name != header.unit) {
            return Err(at(path, format!("these are vectors of {}; leave out --unit", header.unit)));
        }
        fits(&memory::set(unit(&header.unit)?.as_ref(), &header.format, false)?)?;
        let (unit, set) = set_of(path)?;
        make_folder(&self.out, "--out")?;
        let files =
            SetFiles::write(&self.out, unit.as_ref(), &set, None, |take: &mut dyn FnMut(Vec<i128>) -> Outcome<()>| {
                while let Some(inputs) = reader.inputs(&set).map_err(|error| at(path, error))? {
                    take(inputs)?;
                }
                Ok(())
            })?;
        let written = files.written();
        if written.lines == 0 {
            let reason = "there is no line to compare, and no result; give a file with lines of vectors";
            return Err(at(path, reason));
        }
        // What was written is the definition's: inputs, outputs and tables that were changed, or lines that are missing, show here.
        if header.digest.is_some_and(|digest| digest != written.digest) {
            return Err(at(path, FileError::Digest));
        }
        let (lines, digest) = (written.lines, written.digest.clone());
        Ok(Stimulus { unit, set, path: files.keep()?, lines, digest })
    }

    /// Our own lanes against the definition, and wires against their ranges.
    fn own(&self) -> Outcome<()> {
        let asked = self.unit.format.is_some() || !self.unit.set.is_empty();
        let count = self.unit.lines()?;
        let mut wrong = Vec::new();
        for unit in self.unit.units()? {
            let formats: Vec<UnitFormat> = if asked { vec![self.unit.format()?] } else { unit.formats() };
            let name = unit.sheet().name;
            let (mut lines, mut answered, mut equal, mut wires, mut hold) = (0, 0, 0, 0, 0);
            for format in &formats {
                fits(&memory::set(unit.as_ref(), format, true)?)?;
                let set = Set::new(unit.as_ref(), *format, self.unit.seed)?;
                let (mismatch, compared) = lanes(unit.as_ref(), &set, count)?;
                lines += count;
                answered += compared;
                equal += compared;
                if let Some(mismatch) = mismatch {
                    equal -= mismatch.differ;
                    print(&explain(unit.as_ref(), &set, &mismatch))?;
                    wrong.push(format!("{name}: lanes differ from the definition"));
                }
                let found = ranges::search(unit.as_ref(), format, count.min(1000), self.unit.seed)?;
                wires += found.wires.len();
                hold += found.wires.iter().filter(|wire| wire.holds()).count();
                for wire in found.wires.iter().filter(|wire| !wire.holds()) {
                    wrong.push(format!(
                        "{name}: the wire {} carries {:?}, beyond {:?}",
                        wire.path, wire.found, wire.derived
                    ));
                }
            }
            let lanes = match answered {
                0 => "no lanes: the machine runs the definition".into(),
                _ => format!("{equal} of {answered} equal in its lanes"),
            };
            print(&format!(
                "{name:<14} {:>2} formats  {lines:>7} lines  {lanes:<41} {hold:>4} of {wires} ranges hold\n",
                formats.len()
            ))?;
        }
        if self.unit.unit.is_none() {
            let words: Vec<Words> = if asked {
                vec![self.unit.format()?.words]
            } else {
                word_formats().iter().map(|format| format.words).collect()
            };
            let machine = inputs::machine(&self.unit.machine)?;
            let mut all = Frames { frames: 0, seen: 0, wrong: Vec::new() };
            for words in words {
                let found = units_in_frames(&machine, words)?;
                all.frames += found.frames;
                all.seen += found.seen;
                all.wrong.extend(found.wrong);
            }
            print(&format!(
                "on channels    of {} frames, with {} pixels that are not empty, {} differ from the definitions\n",
                all.frames,
                all.seen,
                all.wrong.len()
            ))?;
            wrong.extend(all.wrong);
        }
        match wrong.first() {
            None => Ok(()),
            Some(first) => Err(Problem::new(format!("{first} ({} found in all)", wrong.len()))),
        }
    }
}

/// A problem in a file.
fn at(path: &Path, what: impl std::fmt::Display) -> Problem {
    Problem::new(format!("{}: {what}", path.display()))
}

/// The first `count` lines of a set by the unit's lanes against its definition: where they differ first, and how many were compared.
fn lanes(unit: &dyn Unit, set: &Set, count: usize) -> Outcome<(Option<Mismatch>, usize)> {
    let mut lines = Lines::new(unit, set)?.take(count).peekable();
    let mut definition = UnitDefinition::new(unit, set);
    let mut comparison = Comparison::new(set, 0);
    let most = (BLOCK_BYTES / (16 * set.width())).max(1);
    while lines.peek().is_some() {
        let block: Vec<Vec<i128>> = lines.by_ref().take(most).collect();
        let Some(values) = unit.lanes(&set.format, &set.tables, &block) else { break };
        for (inputs, values) in block.into_iter().zip(values) {
            let outputs = definition.answer(&inputs);
            let answers = set.fields[1].iter().zip(values).map(|(field, value)| Answer::of(field, value)).collect();
            comparison.push(Compared { inputs, outputs, answers });
        }
    }
    let compared = comparison.lines();
    Ok((comparison.finish(), compared))
}

/// Voxels a side of a frame that is compared pixel by pixel, and lanes: a ray takes two chunks.
const SIDE: usize = 6;
const LANES: usize = 4;

/// Frames that were compared, pixels in them that are not empty, and what is wrong.
struct Frames {
    frames: usize,
    seen: usize,
    wrong: Vec<String>,
}

/// Runs the units on their channels with a volume of noise, in several views and in every mode, and compares each pixel with the
/// definitions.
fn units_in_frames(machine: &MachineSpec, words: Words) -> Outcome<Frames> {
    let machine = MachineSpec { lanes: LANES, ..machine.clone().with_words(words) };
    let top = u64::from(unit_full(words.voxel_bits));
    // A linear congruence is noise enough; its high bits are the better ones.
    let noise = std::iter::successors(Some(1_u64), |state| {
        Some(state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407))
    });
    let voxels: Vec<u16> = noise.take(SIDE.pow(3)).map(|state| ((state >> 33) % (top + 1)) as u16).collect();
    // The default scene's opacity rises within these data values.
    let volume = VolumeInfo { dims: [SIDE; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let mut found = Frames { frames: 0, seen: 0, wrong: Vec::new() };
    for mode in Mode::ALL {
        for direction in [[0.0, 0.0, 1.0], [0.5, 0.25, 1.0], [-1.0, 0.7, 0.2]] {
            let scene = Scene { view: View::from_direction(direction, None), mode, ..Scene::default() };
            let frames = [frame_setup(&scene, &machine, &volume, true)?.setup];
            let mut run = Machine::cycle(&machine, frames.to_vec(), [SIDE; 3], &voxels)?;
            run.run(&|_, _| {})?;
            let defined = cube3_definition::Definition::new(&frames[0], &voxels).base_plane();
            found.frames += 1;
            found.seen += defined.pixels.iter().filter(|pixel| pixel[3] > 0).count();
            if run.into_base_planes() != [defined] {
                found.wrong.push(format!("the units on channels: mode {mode}, view {direction:?}, {words:?}"));
            }
        }
    }
    Ok(found)
}

/// A command with its `%` letters replaced by paths, quoted for the shell; each once, whatever a path holds.
fn filled(command: &str, paths: [(char, String); 3]) -> String {
    let mut line = String::new();
    let mut letters = command.chars().peekable();
    while let Some(letter) = letters.next() {
        let path = paths.iter().find(|(name, _)| letter == '%' && letters.peek() == Some(name));
        match path {
            Some((_, path)) => {
                letters.next();
                line += &format!("'{}'", path.replace('\'', r"'\''"));
            }
            None => line.push(letter),
        }
    }
    line
}

/// Waits for a child, which leads a process group of its own; none where it took longer than the limit and was killed, and with it the
/// group: a shell waits for what it has started.
fn waited(mut child: Child, limit: Duration) -> std::io::Result<Option<ExitStatus>> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        let left = limit.saturating_sub(start.elapsed());
        if left.is_zero() {
            kill_process_group(Pid::from_child(&child), Signal::KILL)?;
            child.wait()?;
            return Ok(None);
        }
        std::thread::sleep(left.min(LOOK));
    }
}

/// Runs a device under test in the shell; where it wrote its answers.
fn run_device(command: &str, folder: &Path, vectors: &Path, limit: Option<Duration>) -> Outcome<PathBuf> {
    if !command.contains("%o") {
        return Err(Problem::new("--dut: the command has no %o: it must be told where to write its answers"));
    }
    let absolute = |path: &Path| std::path::absolute(path).map(|path| path.display().to_string());
    let answers = vectors.with_extension("out");
    match std::fs::remove_file(&answers) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(Problem::new(format!("{}: {error}", answers.display())));
        }
        _ => {}
    }
    let line = filled(command, [('i', absolute(vectors)?), ('o', absolute(&answers)?), ('d', absolute(folder)?)]);
    let mut shell = Command::new("sh");
    shell.args(["-c", &line]);
    let status = match limit {
        None => shell.status()?,
        Some(limit) => waited(shell.process_group(0).spawn()?, limit)?.ok_or_else(|| {
            let seconds = limit.as_secs_f64();
            Problem::new(format!(
                "--dut: `{line}` had not ended after {seconds} s and was killed; does it wait for something that never comes? \
                 If it only needs longer, give a larger --dut-timeout"
            ))
        })?,
    };
    if !status.success() {
        return Err(Problem::new(format!("--dut: `{line}` ended with {status}")));
    }
    if !answers.exists() {
        return Err(Problem::new(format!("--dut: `{line}` wrote no {}", answers.display())));
    }
    Ok(answers)
}
