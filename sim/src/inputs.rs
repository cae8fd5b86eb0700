//! Scene, machine and volume of a run: files, presets and phantoms.

use crate::problem::{Outcome, Problem};
use crate::progress::Waiting;
use cube3_host::{MachineSpec, VolumeInfo};
use cube3_scene::{Scene, VolumeSource};
use cube3_volume::{
    ConversionReport, NonFiniteRule, Phantom, PhantomParams, ReadOptions, Volume, VoxelWords, WordConversion,
    WordRounding,
};
use cube3_word::Rounding;
use std::path::Path;

/// Machines that have a name: name and file.
pub const PRESETS: [(&str, &str); 7] = [
    ("cube3-128", MachineSpec::COMMENTED_DEFAULT),
    ("cube3-256", include_str!("../machines/cube3-256.toml")),
    ("cube3-512", include_str!("../machines/cube3-512.toml")),
    ("cube3-board", include_str!("../machines/cube3-board.toml")),
    ("cube4-teramac", include_str!("../machines/cube4-teramac.toml")),
    ("em-cube", include_str!("../machines/em-cube.toml")),
    ("volumepro-500", include_str!("../machines/volumepro-500.toml")),
];

/// Reads a machine file, or takes a preset by its name.
///
/// # Errors
/// No such file or preset, and what is wrong in the file.
pub fn machine(name: &str) -> Outcome<MachineSpec> {
    if let Some((name, text)) = PRESETS.iter().find(|(preset, _)| *preset == name) {
        return Ok(MachineSpec::from_toml(text, name)?);
    }
    let text = std::fs::read_to_string(name).map_err(|error| {
        let presets: Vec<&str> = PRESETS.iter().map(|(name, _)| *name).collect();
        Problem::new(format!("{name}: {error}; give a machine file, or one of {}", presets.join(", ")))
    })?;
    Ok(MachineSpec::from_toml(&text, name)?)
}

/// A volume as data and as voxel words.
pub struct LoadedVolume {
    /// Where it comes from, for the report.
    pub source: String,
    /// Which of x, y, z have a single voxel; data and words have two equal ones there ([`Volume::thickened`]).
    pub single: [bool; 3],
    /// The data; masked voxels have the value of word 0.
    pub data: Volume,
    /// The machine's words.
    pub words: VoxelWords,
    /// How the one became the other.
    pub conversion: ConversionReport,
}

impl LoadedVolume {
    /// What the host needs to know.
    pub fn info(&self) -> VolumeInfo {
        VolumeInfo { dims: self.words.dims, spacing: self.words.spacing, window: self.words.window }
    }

    /// Voxels along x, y, z as they came in.
    pub fn dims(&self) -> [usize; 3] {
        [0, 1, 2].map(|i| if self.single[i] { 1 } else { self.words.dims[i] })
    }
}

/// Reads or makes a scene's volume.
///
/// # Errors
/// A file that cannot be read, a phantom that is not known.
pub fn data(source: &VolumeSource, options: &ReadOptions) -> Outcome<(String, Volume)> {
    if let Some(path) = &source.file {
        return Ok((path.display().to_string(), cube3_volume::read(path, options)?));
    }
    if let [first, ..] = source.files.as_slice() {
        let (count, first) = (source.files.len(), first.display());
        return Err(Problem::new(format!(
            "{first} is the first of a series of {count} volumes; give --frames N too, or a single volume"
        )));
    }
    let default = Scene::default().volume;
    let name = source.phantom.clone().or(default.phantom).unwrap_or_default();
    let size = source.size_voxels.or(default.size_voxels).unwrap_or(128);
    let params = PhantomParams { phase: source.phase, ..PhantomParams::default() };
    let volume = name.parse::<Phantom>()?.generate(size, &params)?;
    Ok((format!("phantom {name}, {size} voxels a side"), volume))
}

/// Reads or makes a scene's volume, and converts it to a machine's voxel words.
///
/// # Errors
/// As [`data`], and values that are not finite where `mask` is not set.
pub fn volume(scene: &Scene, machine: &MachineSpec, options: &ReadOptions, mask: bool) -> Outcome<LoadedVolume> {
    let _waiting = Waiting::new("volume");
    let (source, data) = data(&scene.volume, options)?;
    to_words(source, data, scene.volume.window, machine, mask)
}

/// Converts data to a machine's voxel words; the window is that of the data where none is given.
///
/// # Errors
/// Values that are not finite where `mask` is not set.
pub fn to_words(
    source: String,
    data: Volume,
    window: Option<[f64; 2]>,
    machine: &MachineSpec,
    mask: bool,
) -> Outcome<LoadedVolume> {
    let conversion = WordConversion {
        window,
        rounding: match machine.words.rounding {
            Rounding::Nearest => WordRounding::Nearest,
            Rounding::Truncate => WordRounding::Truncate,
        },
        non_finite: if mask { NonFiniteRule::Mask } else { NonFiniteRule::Refuse },
    };
    let single = data.dims.map(|n| n == 1);
    let data = if single.contains(&true) { data.thickened().into_owned() } else { data };
    let (words, conversion) = data.to_words(machine.words.voxel_bits, &conversion)?;
    let data = if conversion.masked > 0 {
        let low = words.window[0];
        data.map::<f64>(|value| if value.is_finite() { value } else { low })
    } else {
        data
    };
    Ok(LoadedVolume { source, single, data, words, conversion })
}

/// Reads a scene file, or takes the default scene.
///
/// # Errors
/// What is wrong in the file.
pub fn scene(path: Option<&Path>) -> Outcome<Scene> {
    Ok(path.map_or_else(|| Ok(Scene::default()), Scene::read)?)
}
