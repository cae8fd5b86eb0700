//! Volumes as data and as a machine's voxel words.

use crate::{InputError, notes};
use cube3_host::VolumeInfo;
use cube3_machine::MachineSpec;
use cube3_scene::{FileAxes, Scene, VolumeSource};
use cube3_volume::{
    ConversionReport, NonFinite, NonFiniteRule, Ordering, Phantom, PhantomParams, ReadOptions, Volume, VolumeError,
    VoxelWords, WordConversion, WordRounding,
};
use cube3_word::Rounding;
use std::time::Instant;

/// A volume as data and as voxel words.
pub struct LoadedVolume {
    /// Where it comes from, for the report.
    pub source: String,
    /// Which of x, y, z have a single voxel; data and words have two equal ones there ([`Volume::thickened`]). None of labels.
    pub single: [bool; 3],
    /// The data; masked voxels have the value of word 0.
    pub data: Volume,
    /// The machine's words.
    pub words: VoxelWords,
    /// How the one became the other.
    pub conversion: ConversionReport,
    /// What its file left to be said, in sentences.
    pub notes: Vec<String>,
    /// Seconds that it took to read or make the data and to turn them into words; none where the data were given.
    pub made_s: Option<f64>,
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

/// A volume as it comes in.
pub struct Incoming {
    /// Where it comes from, for the report.
    pub source: String,
    /// The data.
    pub data: Volume,
    /// What its file left to be said, in sentences.
    pub notes: Vec<String>,
}

/// Reads or makes a scene's volume.
///
/// # Errors
/// A file that cannot be read, a phantom that is not known.
pub fn read_volume(source: &VolumeSource, options: &ReadOptions) -> Result<Incoming, InputError> {
    if let Some(path) = &source.file {
        let options = read_options(source, options);
        let about = cube3_volume::inspect(path, &options)?;
        let data = cube3_volume::read(path, &options)?;
        let remark = |remark: &String| format!("{}: {remark}", path.display());
        let mut notes: Vec<String> = about.remarks.iter().map(remark).collect();
        notes.extend(notes::left_over_note(path, &data.world, source.labels));
        let mut name = path.display().to_string();
        if about.volumes > 1 {
            let last = about.volumes - 1;
            name += &format!(", volume {} of 0 to {last}", options.frame);
            if source.time.is_none() && options.frame == 0 {
                notes.push(format!(
                    "{} holds a series of {} volumes, of which this is the first; --time takes another, 0 to {last}, and --frames plays them",
                    path.display(),
                    about.volumes
                ));
            }
        }
        return Ok(Incoming { source: name, data, notes });
    }
    if let [first, ..] = source.files.as_slice() {
        return Err(InputError::Series { first: first.clone(), count: source.files.len() });
    }
    if source.time.is_some() {
        return Err(InputError::TimeOfPhantom);
    }
    let default = Scene::default().volume;
    let name = source.phantom.clone().or(default.phantom).unwrap_or_default();
    let size = source.size_voxels.or(default.size_voxels).unwrap_or(128);
    let params = PhantomParams { phase: source.phase, ..PhantomParams::default() };
    let data = name.parse::<Phantom>()?.generate(size, &params)?;
    Ok(Incoming { source: format!("phantom {name}, {size} voxels a side"), data, notes: Vec::new() })
}

/// How a scene has its file read.
pub fn read_options(source: &VolumeSource, options: &ReadOptions) -> ReadOptions {
    let ordering = match source.axes {
        FileAxes::Ras => Ordering::Ras,
        FileAxes::Stored => Ordering::AsStored,
    };
    ReadOptions { ordering, frame: source.time.unwrap_or(options.frame), ..options.clone() }
}

/// Reads or makes a scene's volume, and converts it to a machine's voxel words.
///
/// # Errors
/// As [`read_volume`], and values that are not finite where `mask` is not set.
pub fn load_volume(
    scene: &Scene,
    machine: &MachineSpec,
    options: &ReadOptions,
    mask: bool,
) -> Result<LoadedVolume, InputError> {
    let start = Instant::now();
    let Incoming { source, data, mut notes } = read_volume(&scene.volume, options)?;
    notes.extend(notes::old_format_note(scene, &data.world));
    let loaded = if scene.volume.labels {
        labels_to_words(source, data, None, machine, mask)?
    } else {
        to_words(source, data, scene.volume.window, machine, mask)?
    };
    Ok(LoadedVolume { notes, made_s: Some(start.elapsed().as_secs_f64()), ..loaded })
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
) -> Result<LoadedVolume, InputError> {
    let single = data.dims.map(|n| n == 1);
    let data = if single.contains(&true) { data.thickened().into_owned() } else { data };
    convert(source, data, single, window, machine, mask)
}

/// Converts labels to a machine's voxel words, in the `window` of the first volume of a series. An axis of one voxel is not made two: a
/// voxel of labels has a thickness.
///
/// # Errors
/// Values that are no labels, labels without a word, and values that are not finite where `mask` is not set.
pub fn labels_to_words(
    source: String,
    data: Volume,
    window: Option<[f64; 2]>,
    machine: &MachineSpec,
    mask: bool,
) -> Result<LoadedVolume, InputError> {
    let bits = machine.words.voxel_bits;
    let largest = data
        .largest_label(bits)
        .map_err(|error| InputError::Labels { volume: source.clone(), error: Box::new(error) })?;
    let window = window.or(WordConversion::labels(largest, bits, machine.words.table_bits).window);
    if let Some([_, high]) = window.filter(|[_, high]| largest > *high) {
        return Err(InputError::LabelsBeyond { volume: source, largest, most: high.floor(), bits });
    }
    convert(source, data, [false; 3], window, machine, mask)
}

fn convert(
    source: String,
    data: Volume,
    single: [bool; 3],
    window: Option<[f64; 2]>,
    machine: &MachineSpec,
    mask: bool,
) -> Result<LoadedVolume, InputError> {
    let conversion = WordConversion {
        window,
        rounding: match machine.words.rounding {
            Rounding::Nearest => WordRounding::Nearest,
            Rounding::Truncate => WordRounding::Truncate,
        },
        non_finite: if mask { NonFiniteRule::Mask } else { NonFiniteRule::Refuse },
    };
    let converted = data.to_words(machine.words.voxel_bits, &conversion);
    let (words, conversion) = converted.map_err(|error| match error {
        VolumeError::NonFinite(NonFinite { position, value }) => {
            InputError::NonFinite { volume: source.clone(), position, value }
        }
        other => other.into(),
    })?;
    let data = if conversion.masked > 0 {
        let low = words.window[0];
        data.map::<f64>(|value| if value.is_finite() { value } else { low })
    } else {
        data
    };
    Ok(LoadedVolume { source, single, data, words, conversion, notes: Vec::new(), made_s: None })
}
