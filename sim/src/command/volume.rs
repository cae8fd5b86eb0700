//! `cube3 volume`: look at, convert and make volumes.

use super::run::print;
use super::{RawArguments, spacing};
use crate::memory::{self, Grid};
use crate::problem::Outcome;
use crate::progress::Waiting;
use clap::{Args, Subcommand};
use cube3_volume::{
    NonFiniteRule, NrrdEncoding, Phantom, PhantomParams, SampleType, Samples, Volume, WordConversion, read, write,
    write_nrrd,
};
use std::path::{Path, PathBuf};

/// Bars of the histogram.
const BINS: usize = 16;
/// Width of the longest bar, in characters.
const BAR: usize = 40;

/// Arguments of `cube3 volume`.
#[derive(Debug, Args)]
pub struct VolumeArguments {
    #[command(subcommand)]
    command: VolumeCommand,
}

#[derive(Debug, Subcommand)]
enum VolumeCommand {
    /// Size, type, spacing, range and histogram.
    Info {
        /// The volume; the head phantom without it.
        file: Option<PathBuf>,
        #[command(flatten)]
        raw: RawArguments,
    },
    /// Another format; .nrrd and .raw are written.
    Convert {
        /// The volume.
        from: PathBuf,
        /// The new file.
        to: PathBuf,
        #[command(flatten)]
        raw: RawArguments,
        /// Voxel words of so many bits instead of the data's own type, scaled from the window.
        #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u32).range(1..=16))]
        bits: Option<u32>,
        /// Data values of the first and last word, e.g. 0,255; the data's range without it.
        #[arg(long, value_parser = window, value_name = "LOW,HIGH", requires = "bits", allow_hyphen_values = true)]
        window: Option<[f64; 2]>,
        /// Write NRRD without compression.
        #[arg(long)]
        uncompressed: bool,
    },
    /// A volume from a closed form.
    Phantom {
        /// head, sphere, marschner-lobb, shepp-logan, shells, fog, engine, checker or beating-heart.
        #[arg(default_value = "head")]
        name: String,
        /// Voxels along each side.
        #[arg(long, default_value_t = 128)]
        size: usize,
        /// Radius of the sphere in voxels.
        #[arg(long)]
        radius: Option<f64>,
        /// Width of the sphere's ramp in voxels.
        #[arg(long)]
        ramp: Option<f64>,
        /// Centre of the sphere in voxels, e.g. 31.5,31.5,31.5.
        #[arg(long, value_parser = spacing, value_name = "X,Y,Z")]
        centre: Option<[f64; 3]>,
        /// Period of the checker in voxels.
        #[arg(long)]
        period: Option<usize>,
        /// Phase of the beating heart, in beats.
        #[arg(long, allow_negative_numbers = true)]
        phase: Option<f64>,
        /// The new file; NAME.nrrd without it.
        #[arg(long)]
        out: Option<PathBuf>,
    },
}

fn window(text: &str) -> Result<[f64; 2], String> {
    let parts: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    parts.and_then(|parts| <[f64; 2]>::try_from(parts).ok()).ok_or_else(|| "give two numbers, e.g. 0,255".into())
}

impl VolumeArguments {
    /// Does what the arguments ask for.
    ///
    /// # Errors
    /// What went wrong, in words.
    pub fn execute(self) -> Outcome<()> {
        let _waiting = Waiting::new("volume");
        match self.command {
            VolumeCommand::Info { file: Some(file), raw } => {
                let read_options = raw.read_options()?;
                let grid = Grid::of_file(&file, &read_options)?;
                memory::volume(&file.display().to_string(), &grid, false).check()?;
                let volume = read(&file, &read_options)?;
                info(&file.display().to_string(), &volume)
            }
            VolumeCommand::Info { file: None, .. } => {
                info("phantom head", &Phantom::Head.generate(128, &PhantomParams::default())?)
            }
            VolumeCommand::Convert { from, to, raw, bits, window, uncompressed } => {
                let read_options = raw.read_options()?;
                let grid = Grid::of_file(&from, &read_options)?;
                memory::volume(&from.display().to_string(), &grid, bits.is_some()).check()?;
                let volume = read(&from, &read_options)?;
                let volume = match bits {
                    Some(bits) => to_words(&volume, bits, window)?,
                    None => volume,
                };
                save(&to, &volume, uncompressed)
            }
            VolumeCommand::Phantom { name, size, radius, ramp, centre, period, phase, out } => {
                let params = PhantomParams { radius, ramp, centre, period, phase };
                memory::volume(&format!("the phantom {name}"), &Grid::of_phantom(&name, size)?, false).check()?;
                let volume = name.parse::<Phantom>()?.generate(size, &params)?;
                let out = out.unwrap_or_else(|| PathBuf::from(format!("{name}.nrrd")));
                save(&out, &volume, false)
            }
        }
    }
}

fn to_words(volume: &Volume, bits: u32, window: Option<[f64; 2]>) -> Outcome<Volume> {
    let conversion = WordConversion { window, non_finite: NonFiniteRule::Refuse, ..WordConversion::default() };
    let (words, report) = volume.to_words(bits, &conversion)?;
    print(&format!("{report}\n"))?;
    Ok(Volume::new(words.dims, words.spacing, Samples::U16(words.words))?.with_origin(volume.origin)?)
}

fn save(path: &Path, volume: &Volume, uncompressed: bool) -> Outcome<()> {
    if uncompressed {
        write_nrrd(path, volume, NrrdEncoding::Raw)?;
    } else {
        write(path, volume)?;
    }
    let [x, y, z] = volume.dims;
    print(&format!("wrote {}: {x} × {y} × {z} {}\n", path.display(), volume.sample_type()))
}

fn info(source: &str, volume: &Volume) -> Outcome<()> {
    let [x, y, z] = volume.dims;
    let [sx, sy, sz] = volume.spacing;
    let [ox, oy, oz] = volume.origin;
    let sample: SampleType = volume.sample_type();
    let mut text = format!("{source}\n  size     {x} × {y} × {z} voxels\n  type     {sample}\n");
    text += &format!("  spacing  {sx} × {sy} × {sz}\n  origin   {ox}, {oy}, {oz}\n");
    if let Some(place) = volume.first_non_finite() {
        text += &format!("  note     {place}\n");
    }
    let ((low, high), strange) = volume.finite_range();
    if strange < volume.len() as u64 {
        text += &format!("  range    {low} to {high}\n");
        if strange > 0 {
            return print(&format!("{text}  strange  {strange} voxels are NaN or infinite; no histogram\n"));
        }
        let histogram = volume.histogram(BINS)?;
        let most = histogram.counts.iter().copied().max().unwrap_or(1).max(1);
        for (bin, &count) in histogram.counts.iter().enumerate() {
            let width = (high - low) / BINS as f64;
            // Logarithmic, or air hides all else.
            let share = (count as f64 + 1.0).ln() / (most as f64 + 1.0).ln();
            let bar = "█".repeat((share * BAR as f64).round() as usize);
            text += &format!("  {:>12.4}  {bar:<BAR$}  {count}\n", low + bin as f64 * width);
        }
        text += "  bars are logarithmic\n";
    }
    print(&text)
}
