//! `cube3 volume`: look at, convert and make volumes.

use super::run::print;
use super::volume_info::info;
use super::{RawArguments, dims, fits, spacing};
use crate::problem::{Outcome, Problem};
use crate::progress::Waiting;
use clap::{Args, Subcommand};
use cube3::memory::{self, Grid};
use cube3_volume::{
    FileFormat, FileInfo, Filter, NewGrid, NonFiniteRule, Ordering, Packing, Phantom, PhantomParams, ReadOptions,
    Resampling, Samples, Space, Volume, WordConversion, check_name, inspect, read, readable, resample, write_packed,
};
use std::path::{Path, PathBuf};

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
    /// Another format; .nrrd, .nii, .nii.gz, .mha and .raw are written, in the order in which the voxels are stored.
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
        /// Write .nrrd and .mha without compression.
        #[arg(long)]
        uncompressed: bool,
        /// Write the order that is drawn: x to the right, y to the front, z to the head.
        #[arg(long)]
        ras: bool,
    },
    /// Another grid: cubes, other distances or sizes, or axes along the world's; x, y and z are those that are drawn.
    Resample {
        /// The volume; a raw file is converted first.
        from: PathBuf,
        /// The new file.
        to: PathBuf,
        /// Voxels as far apart along every axis as along the finest.
        #[arg(long, conflicts_with_all = ["spacing", "size"], required_unless_present_any = ["spacing", "size", "straight"])]
        cubes: bool,
        /// New distances between voxels, e.g. 1,1,1.
        #[arg(long, value_parser = spacing, value_name = "SX,SY,SZ", conflicts_with = "size")]
        spacing: Option<[f64; 3]>,
        /// New numbers of voxels, with the first and the last where they were, e.g. 256x256x225.
        #[arg(long, value_parser = dims, value_name = "NXxNYxNZ")]
        size: Option<[usize; 3]>,
        /// Axes along the world's: takes away an oblique turn and a gantry's tilt. Cubes, unless distances or sizes are given.
        #[arg(long)]
        straight: bool,
        /// What lies between voxels: nearest (for labels), linear, or cubic (a B-spline through them).
        #[arg(long, default_value_t)]
        filter: Filter,
        /// Value outside of the data; the least one without it.
        #[arg(long, requires = "straight", allow_negative_numbers = true)]
        outside: Option<f64>,
        /// Which volume of a file that holds a series, from 0.
        #[arg(long, value_name = "N")]
        time: Option<usize>,
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
                let options = raw.read_options()?;
                let about = inspect(&file, &options)?;
                fits(&memory::volume(&file.display().to_string(), &Grid::of(&about), false))?;
                let volume = read(&file, &options)?;
                info(&file.display().to_string(), &volume, Some((&about, options.frame)))
            }
            VolumeCommand::Info { file: None, .. } => {
                info("phantom head", &Phantom::Head.generate(128, &PhantomParams::default())?, None)
            }
            VolumeCommand::Convert { from, to, raw, bits, window, uncompressed, ras } => {
                check_name(&to)?;
                let mut options = raw.read_options()?;
                let about = inspect(&from, &options)?;
                fits(&memory::volume(&from.display().to_string(), &Grid::of(&about), bits.is_some()))?;
                one_of_a_series(&about, [&from, &to], options.frame)?;
                // Where no world is known, an axis of negative spacing is the one thing that is turned: no file keeps that.
                if !ras && about.world.space != Space::Unknown {
                    options.ordering = Ordering::AsStored;
                }
                let volume = read(&from, &options)?;
                let volume = match bits {
                    Some(bits) => to_words(&volume, bits, window)?,
                    None => volume,
                };
                save(&to, &volume, if uncompressed { Packing::Plain } else { Packing::Compressed })
            }
            VolumeCommand::Resample { from, to, cubes: _, spacing, size, straight, filter, outside, time } => {
                check_name(&to)?;
                if FileFormat::of_path(&from) == Some(FileFormat::Raw) {
                    return Err(Problem::new(format!(
                        "{0}: a raw file does not say how far apart its voxels are; convert it first, \
                         e.g. cube3 volume convert {0} volume.nrrd --dims 256x256x99 --type u8 --spacing 1,1,2",
                        from.display()
                    )));
                }
                let grid = match (spacing, size) {
                    (Some(spacing), _) => NewGrid::Spacing(spacing),
                    (_, Some(size)) => NewGrid::Size(size),
                    _ => NewGrid::Cubes,
                };
                let how = Resampling { grid, straight, filter, outside, ..Resampling::default() };
                let options = ReadOptions { frame: time.unwrap_or(0), ..ReadOptions::default() };
                let about = inspect(&from, &options)?;
                fits(&memory::resampling(&from.display().to_string(), &about, &how)?)?;
                one_of_a_series(&about, [&from, &to], options.frame)?;
                let volume = resampled(&read(&from, &options)?, &how)?;
                save(&to, &volume, Packing::Compressed)
            }
            VolumeCommand::Phantom { name, size, radius, ramp, centre, period, phase, out } => {
                let out = out.unwrap_or_else(|| PathBuf::from(format!("{name}.nrrd")));
                check_name(&out)?;
                let params = PhantomParams { radius, ramp, centre, period, phase };
                fits(&memory::volume(&format!("the phantom {name}"), &Grid::of_phantom(&name, size)?, false))?;
                let volume = name.parse::<Phantom>()?.generate(size, &params)?;
                save(&out, &volume, Packing::Compressed)
            }
        }
    }
}

/// Says which volume of a series it is; the others stay behind, and are not lost.
fn one_of_a_series(about: &FileInfo, [from, to]: [&Path; 2], time: usize) -> Outcome<()> {
    if about.volumes == 1 {
        return Ok(());
    }
    let same = |a: &Path, b: &Path| Some(a.canonicalize().ok()? == b.canonicalize().ok()?);
    if same(from, to) == Some(true) {
        let (file, volumes) = (from.display(), about.volumes);
        return Err(Problem::new(format!(
            "{file} holds a series of {volumes} volumes, and one of them would take its place; give another file to write"
        )));
    }
    print(&format!("{}: volume {time} of a series of {}; --time takes another\n", from.display(), about.volumes))
}

fn to_words(volume: &Volume, bits: u32, window: Option<[f64; 2]>) -> Outcome<Volume> {
    let conversion = WordConversion { window, non_finite: NonFiniteRule::Refuse, ..WordConversion::default() };
    let (words, report) = volume.to_words(bits, &conversion)?;
    print(&format!("{report}\n"))?;
    Ok(Volume::new(words.dims, words.spacing, Samples::U16(words.words))?.with_world(volume.origin, volume.world)?)
}

fn resampled(volume: &Volume, how: &Resampling) -> Outcome<Volume> {
    let (new, report) = resample(volume, how)?;
    let grid = |volume: &Volume| {
        let ([x, y, z], [sx, sy, sz]) = (volume.dims, volume.spacing.map(readable));
        format!("{x} × {y} × {z} at {sx} × {sy} × {sz}")
    };
    let mut text = format!("{} -> {}, {}\n", grid(volume), grid(&new), how.filter);
    if report.clipped > 0 {
        text += &format!("clipped {} voxels to the range of {}\n", report.clipped, new.sample_type());
    }
    if report.outside > 0 {
        text += &format!("{} voxels outside of the data\n", report.outside);
    }
    if report.coarser {
        text +=
            "note: the new grid is coarser along an axis; nothing is smoothed before, and finer detail is aliased\n";
    }
    print(&text)?;
    Ok(new)
}

fn save(path: &Path, volume: &Volume, packing: Packing) -> Outcome<()> {
    let remarks = write_packed(path, volume, packing)?;
    let [x, y, z] = volume.dims;
    let mut text = format!("wrote {}: {x} × {y} × {z} {}\n", path.display(), volume.sample_type());
    for remark in remarks {
        // The one that a raw file has is about the order of its voxels.
        let remedy = if FileFormat::of_path(path) == Some(FileFormat::Raw) {
            "; --ras writes the order that is drawn"
        } else {
            ""
        };
        text += &format!("note: {remark}{remedy}\n");
    }
    print(&text)
}
