//! The `cube3` command.

mod bench;
mod kept;
mod list;
mod machine;
mod methods;
mod render;
mod run;
mod scene;
mod scene_file;
mod stress;
mod vectors;
mod verify;
mod volume;
mod volume_info;
mod words;

use crate::problem::Outcome;
use clap::{Parser, Subcommand};
use cube3::memory::Need;

/// A cycle-approximate simulator of Cube-3, a real-time volume-rendering machine.
///
/// Without a command: `run`, on the built-in head phantom.
#[derive(Debug, Parser)]
#[command(version, about, max_term_width = 100)]
pub struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// One frame or a sequence: picture, throughput, stalls, error.
    Run(Box<run::RunArguments>),
    /// One picture by any method.
    Render(Box<render::RenderArguments>),
    /// The ways to make a picture, and what each can show.
    Methods(methods::MethodsArguments),
    /// Golden vectors of units, their data sheets and test benches.
    Vectors(Box<vectors::VectorsArguments>),
    /// Units against their specification, devices under test against vectors; the study of word lengths.
    Verify(Box<verify::VerifyArguments>),
    /// Look at, convert and make volumes.
    Volume(volume::VolumeArguments),
    /// Look at machines: presets, parameters, a machine with every key.
    Machine(machine::MachineArguments),
    /// Look at scenes: parameters, a scene with every key.
    Scene(scene_file::SceneFileArguments),
    /// The stiff and the extreme by every method, against the converged integral; ends with 1 where a bound is not kept.
    Stress(stress::StressArguments),
    /// Speed, as ratios and as fractions of the hardware's limit.
    Bench(bench::BenchArguments),
}

impl Arguments {
    /// Does what the arguments ask for.
    ///
    /// # Errors
    /// What went wrong, in words.
    pub fn execute(self) -> Outcome<()> {
        match self.command {
            None => run::RunArguments::defaults().execute(),
            Some(Command::Run(arguments)) => arguments.execute(),
            Some(Command::Render(arguments)) => arguments.execute(),
            Some(Command::Methods(arguments)) => arguments.execute(),
            Some(Command::Vectors(arguments)) => arguments.execute(),
            Some(Command::Verify(arguments)) => arguments.execute(),
            Some(Command::Volume(arguments)) => arguments.execute(),
            Some(Command::Machine(arguments)) => arguments.execute(),
            Some(Command::Scene(arguments)) => arguments.execute(),
            Some(Command::Stress(arguments)) => arguments.execute(),
            Some(Command::Bench(arguments)) => arguments.execute(),
        }
    }
}

/// Options for files that do not say what they hold, or hold several volumes.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct RawArguments {
    /// Size of a raw file, e.g. 256x256x99.
    #[arg(long, value_parser = dims, value_name = "NXxNYxNZ")]
    dims: Option<[usize; 3]>,
    /// Type of a raw file: u8, i8, u16, i16, u32, i32, f32 or f64.
    #[arg(long = "type", value_name = "TYPE")]
    sample_type: Option<cube3_volume::SampleType>,
    /// Byte order of a raw file: little or big.
    #[arg(long)]
    endian: Option<cube3_volume::Endian>,
    /// Voxel size of a raw file, e.g. 1,1,2.
    #[arg(long, value_parser = spacing, value_name = "SX,SY,SZ")]
    spacing: Option<[f64; 3]>,
    /// Bytes before the voxels of a raw file.
    #[arg(long, value_name = "BYTES")]
    skip: Option<u64>,
    /// Which volume of a file that holds a series, from 0.
    #[arg(long, value_name = "N")]
    time: Option<usize>,
}

impl RawArguments {
    /// The first option that was given.
    fn given(&self) -> Option<&'static str> {
        let given = [
            ("--dims", self.dims.is_some()),
            ("--type", self.sample_type.is_some()),
            ("--endian", self.endian.is_some()),
            ("--spacing", self.spacing.is_some()),
            ("--skip", self.skip.is_some()),
            ("--time", self.time.is_some()),
        ];
        given.into_iter().find(|(_, given)| *given).map(|(option, _)| option)
    }

    /// Options for reading a volume.
    ///
    /// # Errors
    /// Some of the options without the others.
    fn read_options(&self) -> Outcome<cube3_volume::ReadOptions> {
        let raw = match (self.dims, self.sample_type) {
            (Some(dims), Some(sample_type)) => {
                let mut layout = cube3_volume::RawLayout::new(dims, sample_type);
                if let Some(endian) = self.endian {
                    layout.endian = endian;
                }
                if let Some(spacing) = self.spacing {
                    layout.spacing = spacing;
                }
                if let Some(skip) = self.skip {
                    layout.skip_bytes = skip;
                }
                Some(layout)
            }
            (None, None) if self.endian.is_none() && self.spacing.is_none() && self.skip.is_none() => None,
            _ => {
                return Err(crate::problem::Problem::new(
                    "--dims and --type go together: a raw file needs both, e.g. --dims 256x256x99 --type u8",
                ));
            }
        };
        let frame = self.time.unwrap_or(0);
        Ok(cube3_volume::ReadOptions { raw, frame, ..cube3_volume::ReadOptions::default() })
    }
}

fn three<T: std::str::FromStr>(text: &str, separator: char, example: &str) -> Result<[T; 3], String> {
    let parts: Result<Vec<T>, _> = text.split(separator).map(|part| part.trim().parse()).collect();
    let parts = parts.ok().and_then(|parts| <[T; 3]>::try_from(parts).ok());
    parts.ok_or_else(|| format!("give three numbers, e.g. {example}"))
}

fn dims(text: &str) -> Result<[usize; 3], String> {
    three(text, 'x', "256x256x99")
}

fn spacing(text: &str) -> Result<[f64; 3], String> {
    three(text, ',', "1,1,2")
}

/// Most threads: beyond this, starting them takes longer than a frame.
const MOST_THREADS: usize = 256;

/// Refuses what does not fit into memory, before any is taken, and tells of what is large.
///
/// # Errors
/// More memory than there is.
fn fits(need: &Need) -> Outcome<()> {
    need.check()?;
    if let Some(note) = need.note() {
        eprintln!("{note}");
    }
    Ok(())
}

/// How many threads a command works on: those asked for, or all cores.
///
/// # Errors
/// None, and more than are of use.
fn threads(asked: Option<usize>) -> Outcome<usize> {
    match asked {
        Some(threads) if !(1..=MOST_THREADS).contains(&threads) => Err(crate::problem::Problem::new(format!(
            "--threads {threads}: give 1 to {MOST_THREADS}, or leave it out for all cores"
        ))),
        _ => Ok(cube3::memory::threads(asked)),
    }
}

/// Runs work on a pool of as many threads as are asked for, or on all cores.
///
/// # Errors
/// A pool that cannot be made, and what the work gives.
fn on_threads<R: Send>(asked: Option<usize>, work: impl FnOnce() -> Outcome<R> + Send) -> Outcome<R> {
    let count = threads(asked)?;
    match asked {
        Some(_) => cube3::on_threads(count, work),
        None => work(),
    }
}
