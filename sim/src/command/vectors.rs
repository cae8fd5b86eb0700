//! `cube3 vectors`: golden vectors, data sheets and test benches.

use super::fits;
use super::run::print;
use super::scene::SceneArguments;
use crate::output::{make_folder, write_whole};
use crate::problem::{Outcome, Problem};
use clap::Args;
use cube3::Runs;
use cube3::memory::{self, Case, Grid};
use cube3::verify::unit;
use cube3_frame::BasePlane;
use cube3_host::picture_setup;
use cube3_inputs as inputs;
use cube3_pipeline::Machine;
use cube3_vectors::SetFiles;
use cube3_vectors::record::{Excerpt, Recording, Run};
use cube3_vectors::rtl_frame;
use cube3_vectors::{Coverage, Lines, Set, Unit, UnitFormat, pages, testbench, units};
use std::path::PathBuf;

/// Most lines of a file: a test bench reads them into memory.
const MOST_LINES: usize = 1_000_000;
/// The channel that is recorded where none is named.
const DEFAULT_CHANNEL: &str = "samples";
/// Voxels a side of the phantom for the pipeline in RTL.
const FRAME_SIDE: usize = 16;

/// Which unit, in which words.
#[derive(Clone, Debug, Args)]
pub struct UnitArguments {
    /// A unit: `cube3 vectors --list` names them.
    #[arg(long, value_name = "NAME")]
    pub unit: Option<String>,
    /// Bits of a voxel, 1 to 16, and of a weight, 0 to 12, e.g. 16.8; the machine's without it.
    #[arg(long, value_name = "VOXEL.WEIGHT")]
    pub format: Option<String>,
    /// Other words and sizes, e.g. accumulator_bits=8,nearest=0: names as in a vector file's header.
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',')]
    pub set: Vec<String>,
    /// Machine file or preset whose words are taken.
    #[arg(long, value_name = "FILE.toml|NAME", default_value = "cube3-128")]
    pub machine: String,
    /// Lines: transactions, or cycles of a unit with a memory. The directed ones come first.
    #[arg(long, default_value_t = 10_000, value_name = "LINES")]
    pub count: usize,
    /// Seed of everything random.
    #[arg(long, default_value_t = 7)]
    pub seed: u64,
}

impl UnitArguments {
    /// The format.
    ///
    /// # Errors
    /// A length that no unit has, a name that is none.
    pub fn format(&self) -> Outcome<UnitFormat> {
        let mut format = UnitFormat::of(&inputs::machine(&self.machine)?);
        if let Some(lengths) = &self.format {
            format = format.with_lengths(lengths).map_err(|error| Problem::new(format!("--format: {error}")))?;
        }
        let mut names = Vec::new();
        for setting in &self.set {
            names.extend(setting.split('=').next().map(str::trim));
            let (name, value) = setting.split_once('=').unwrap_or((setting, ""));
            let known = format.settings();
            if !known.iter().any(|(other, _)| *other == name.trim()) {
                let known: Vec<&str> = known.into_iter().map(|(name, _)| name).collect();
                return Err(Problem::new(format!(
                    "--set {setting}: give NAME=NUMBER with one of {}",
                    known.join(", ")
                )));
            }
            if !value.trim().parse().is_ok_and(|value| format.set(name.trim(), value)) {
                return Err(Problem::new(format!("--set {setting}: \"{value}\" is no number that {name} can have")));
            }
        }
        format.fit(&names);
        format.check().map_err(|error| Problem::new(format!("the format: {error}")))?;
        Ok(format)
    }

    /// How many lines.
    ///
    /// # Errors
    /// None, and more than fit.
    pub fn lines(&self) -> Outcome<usize> {
        if self.count > MOST_LINES {
            return Err(Problem::new(format!(
                "--count {}: a file holds at most {MOST_LINES} lines; make several with other seeds",
                self.count
            )));
        }
        if self.count == 0 {
            return Err(Problem::new("--count 0: a file without a line tests nothing; give at least 1"));
        }
        Ok(self.count)
    }

    /// The units asked for: the one named, or all.
    ///
    /// # Errors
    /// No unit of that name.
    pub fn units(&self) -> Outcome<Vec<Box<dyn Unit>>> {
        match &self.unit {
            None => Ok(units()),
            Some(name) => Ok(vec![unit(name)?]),
        }
    }
}

/// Arguments of `cube3 vectors`.
#[derive(Debug, Args)]
pub struct VectorsArguments {
    #[command(flatten)]
    unit: UnitArguments,
    /// Every unit.
    #[arg(long, conflicts_with = "unit")]
    all: bool,
    /// Every unit in the default words with small tables, directed lines only: the sets that are kept in `traces/vectors`.
    #[arg(long, conflicts_with_all = ["unit", "format", "set", "machine", "count"])]
    reference: bool,
    /// What really flows through the unit when the machine renders a scene, not made-up lines.
    #[arg(long, conflicts_with_all = ["all", "reference", "format", "set", "seed"])]
    from_run: bool,
    /// First transaction of the run; of a channel, first cycle. 0 without it.
    #[arg(long)]
    first: Option<usize>,
    /// The frame of the run: a perspective view takes several. 0 without it.
    #[arg(long)]
    pass: Option<usize>,
    /// The channel of the run, for the unit `channel`: beams, aligned, rays, samples, shaded or pixels. `samples` without it.
    #[arg(long, value_name = "NAME")]
    channel: Option<String>,
    /// Registers, tables and voxels of a scene's frame for the pipeline of `tests/rtl`, and the pixels that it must give.
    #[arg(long, conflicts_with_all = ["unit", "all", "reference", "format", "set", "from_run", "count", "seed", "testbench"])]
    frame: bool,
    #[command(flatten)]
    scene: SceneArguments,
    /// Name the units and stop.
    #[arg(long, conflicts_with_all = [
        "unit", "format", "set", "machine", "count", "seed", "all", "reference", "from_run", "frame", "sheet", "pages", "testbench", "out",
    ])]
    list: bool,
    /// Print the data sheet in this format and stop.
    #[arg(long, conflicts_with_all = ["count", "seed", "from_run", "frame", "pages", "testbench", "out"])]
    sheet: bool,
    /// Write the data sheets of all units, as pages of the book, into this folder and stop.
    #[arg(long, value_name = "DIR", conflicts_with_all = [
        "unit", "format", "set", "machine", "count", "seed", "all", "reference", "from_run", "frame", "testbench", "out",
    ])]
    pages: Option<PathBuf>,
    /// Also write a test bench in SystemVerilog beside the vectors.
    #[arg(long)]
    testbench: bool,
    /// Folder for the files.
    #[arg(long, value_name = "DIR", default_value = "out/vectors")]
    out: PathBuf,
}

impl VectorsArguments {
    /// Writes the files, and prints what they cover.
    ///
    /// # Errors
    /// What went wrong, in words.
    pub fn execute(self) -> Outcome<()> {
        self.check()?;
        if self.list {
            let line = |unit: Box<dyn Unit>| format!("{:<14} {}\n", unit.sheet().name, unit.sheet().title);
            return print(&units().into_iter().map(line).collect::<String>());
        }
        if let Some(folder) = &self.pages {
            make_folder(folder, "--pages")?;
            return pages::pages()?
                .iter()
                .try_for_each(|page| write_whole(&folder.join(page.file), page.text.as_bytes()));
        }
        if self.from_run || self.frame {
            return self.of_scene();
        }
        let format = if self.reference { UnitFormat::reference() } else { self.unit.format()? };
        let asked = self.unit.units()?;
        if self.sheet {
            let sheets: Result<Vec<String>, _> = asked.iter().map(|unit| unit.sheet().markdown(&format)).collect();
            return print(&sheets?.join("\n"));
        }
        let count = self.unit.lines()?;
        make_folder(&self.out, "--out")?;
        for unit in asked {
            fits(&memory::set(unit.as_ref(), &format, false)?)?;
            let set = Set::new(unit.as_ref(), format, self.unit.seed)?;
            let mut lines = Lines::new(unit.as_ref(), &set)?;
            self.write(unit.as_ref(), &set, |take| match self.reference {
                true => std::iter::from_fn(|| lines.directed()).try_for_each(take),
                false => lines.take(count).try_for_each(take),
            })?;
        }
        Ok(())
    }

    /// Options that go with others only.
    fn check(&self) -> Outcome<()> {
        let of_run =
            [("--first", self.first.is_some()), ("--pass", self.pass.is_some()), ("--channel", self.channel.is_some())];
        let given = of_run.into_iter().find(|(_, given)| *given && !self.from_run);
        if let Some((option, _)) = given {
            return Err(Problem::new(format!(
                "{option}: it chooses from what flowed in a run; give --from-run too, or leave it out"
            )));
        }
        if self.from_run && self.unit.unit.is_none() {
            return Err(Problem::new(
                "--from-run: one unit is recorded at a time; give --unit NAME too, `cube3 vectors --list` names them",
            ));
        }
        if self.channel.is_some() && self.unit.unit.as_deref() != Some("channel") {
            return Err(Problem::new("--channel is for the unit channel; give --unit channel, or leave it out"));
        }
        match self.scene.given() {
            Some(option) if !self.from_run && !self.frame => {
                Err(Problem::new(format!("{option} is for --from-run and --frame; give one of them, or leave it out")))
            }
            _ => Ok(()),
        }
    }

    /// Writes a unit's files from the lines that `lines` gives to what it is given, and prints what they cover.
    fn write(
        &self,
        unit: &dyn Unit,
        set: &Set,
        lines: impl FnOnce(&mut dyn FnMut(Vec<i128>) -> Outcome<()>) -> Outcome<()>,
    ) -> Outcome<()> {
        let name = set.sheet.name;
        let most = if self.testbench { testbench::MOST_WORDS / set.width() } else { usize::MAX };
        let mut coverage = Coverage::new(&set.sheet, &set.format)?;
        let mut left = most;
        let files = SetFiles::write(&self.out, unit, set, Some(&mut coverage), |take| {
            lines(&mut |line| {
                left = left.checked_sub(1).ok_or_else(|| {
                    Problem::new(format!(
                        "--testbench: a bench of {name} holds {most} lines; give --count {most} at most"
                    ))
                })?;
                take(line)
            })
        })?;
        let count = files.written().lines;
        let path = files.keep()?;
        if self.testbench {
            let name = testbench::name(&set.sheet) + ".sv";
            write_whole(&self.out.join(name), testbench::text(&set.sheet, &set.format)?.as_bytes())?;
        }
        let counted = if set.sheet.clocked { "cycles" } else { "transactions" };
        print(&format!("{:<34} {count:>8} {counted:<13} {}", path.display(), covered(&coverage)))
    }

    /// Vectors or a whole frame from the run of a scene.
    fn of_scene(&self) -> Outcome<()> {
        // The pipeline has a lane for each voxel of a side.
        let scene = self.scene.scene(|scene| {
            if self.frame {
                scene.volume.size_voxels = Some(FRAME_SIDE);
            }
        })?;
        let mut machine = self.scene.machine(&self.unit.machine)?;
        let read = self.scene.read_options()?;
        let case = Case {
            scene: &scene,
            machine: &machine,
            grid: Grid::of_scene(&scene.volume, &read)?,
            runs: Runs::Cycle,
            reference: false,
            mask: false,
            threads: memory::threads(None),
        };
        if self.frame {
            fits(&case.rtl_frame())?
        } else {
            fits(&case.recording())?
        }
        let volume = inputs::load_volume(&scene, &machine, &read, false)?;
        let scene = scene.thickened(volume.single);
        make_folder(&self.out, "--out")?;
        let (dims, voxels) = (volume.words.dims, &volume.words.words);
        if self.frame {
            machine.lanes = dims[0];
            let frames = picture_setup(&scene, &machine, &volume.info(), true)?.setups;
            let [setup] = frames.as_slice() else {
                return Err(Problem::new("the RTL pipeline renders parallel views only: leave the perspective out"));
            };
            let frame = rtl_frame::export(&machine, setup, voxels)?;
            let mut run = Machine::cycle(&machine, frames.clone(), dims, voxels)?;
            run.run(&|_, _| {})?;
            let cycles = run.counters().cycles;
            frame.write(&self.out)?;
            let pixels = run.into_base_planes().iter().map(pixels_text).collect::<String>();
            write_whole(&self.out.join("pixels.hex"), pixels.as_bytes())?;
            let parameters: String =
                frame.parameters.iter().map(|(name, value)| format!(" -P{name}={value}")).collect();
            return print(&format!(
                "{}: registers, tables, voxels and the right pixels; {} cycles. Parameters of the pipeline:{parameters}\n",
                self.out.display(),
                cycles
            ));
        }
        let frames = picture_setup(&scene, &machine, &volume.info(), true)?.setups;
        for unit in self.unit.units()? {
            let run = Run { machine: &machine, frames: &frames, dims, voxels };
            let window = Excerpt {
                frame: self.pass.unwrap_or(0),
                first: self.first.unwrap_or(0),
                count: self.unit.lines()?,
                channel: self.channel.as_deref().unwrap_or(DEFAULT_CHANNEL),
            };
            let recording = Recording::new(&run, unit.as_ref(), &window)?;
            self.write(unit.as_ref(), recording.set(), |take| recording.lines(take))?;
        }
        Ok(())
    }
}

/// A base plane as text: a pixel a line, row by row, red, green, blue and opacity.
fn pixels_text(plane: &BasePlane) -> String {
    let digits = plane.bits.div_ceil(4) as usize;
    let word = |word: &u32| format!("{word:0digits$x}");
    let pixel = |pixel: &[u32; 4]| pixel.iter().map(word).collect::<Vec<_>>().join(" ") + "\n";
    format!(
        "// {} x {} pixels, row by row: red, green, blue, opacity\n",
        plane.width,
        plane.pixels.len() / plane.width.max(1)
    ) + &plane.pixels.iter().map(pixel).collect::<String>()
}

/// How many points are covered, and a line for each that is not.
fn covered(coverage: &Coverage) -> String {
    let (points, missed) = (coverage.points().len(), coverage.missed().count());
    let mut text = format!("{} of {points} points covered\n", points - missed);
    for point in coverage.missed() {
        text += &format!("    not covered: {}\n", point.name);
    }
    text
}
