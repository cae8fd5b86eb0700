//! The volumes of a sequence.

use crate::{
    Incoming, InputError, LoadedVolume, TwoGrids, labels_to_words, notes, read_options, read_volume, to_words,
};
use cube3_machine::MachineSpec;
use cube3_scene::{Scene, VolumeSource};
use cube3_volume::{Phantom, ReadOptions};
use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// Spacings that differ by less, as a part, are one: single precision has 6·10⁻⁸.
const SAME_SPACING: f64 = 1e-6;

/// Volumes that are kept: a torn frame shows two or three, and the next frame the last of them again.
pub const KEPT_VOLUMES: usize = 4;

/// The volumes of a sequence, in the order of time.
pub struct Series {
    source: VolumeSource,
    machine: MachineSpec,
    options: ReadOptions,
    mask: bool,
    /// The first volume's, which all share.
    window: [f64; 2],
    phase_per_volume: f64,
    /// Each volume's file and its place in it; empty where a phantom is computed.
    items: Vec<(PathBuf, usize)>,
    first: Arc<LoadedVolume>,
    kept: VecDeque<(u64, Arc<LoadedVolume>)>,
    /// Words held at the ends of the window, of each volume that has been loaded.
    clipped: BTreeMap<u64, u64>,
    /// Seconds that all volumes together took to read or make.
    made_s: f64,
}

impl Series {
    /// The volumes of a scene for a sequence of `frames`; the first is loaded.
    ///
    /// # Errors
    /// A volume that cannot be read or made, and a phase for something that does not move.
    pub fn open(
        scene: &Scene,
        machine: &MachineSpec,
        options: &ReadOptions,
        mask: bool,
        frames: usize,
    ) -> Result<Series, InputError> {
        let source = scene.volume.clone();
        if let (Some(name), Some(_)) = (&source.phantom, source.phase_per_frame)
            && !name.parse::<Phantom>()?.moves()
        {
            return Err(InputError::StillPhantom { name: name.clone() });
        }
        let phase_per_volume = source.phase_per_frame.unwrap_or(1.0 / frames.max(1) as f64);
        let items = items(&source, options)?;
        let mut first = load(&source, &items, 0, phase_per_volume, source.window, machine, options, mask)?;
        first.notes.extend(notes::old_format_note(scene, &first.data.world));
        let clipped = BTreeMap::from([(0, first.conversion.clipped_below + first.conversion.clipped_above)]);
        Ok(Series {
            window: first.words.window,
            made_s: first.made_s.unwrap_or(0.0),
            source,
            machine: machine.clone(),
            options: options.clone(),
            mask,
            phase_per_volume,
            items,
            first: Arc::new(first),
            kept: VecDeque::new(),
            clipped,
        })
    }

    /// The first volume.
    pub fn first(&self) -> &LoadedVolume {
        &self.first
    }

    /// The first volume, to keep.
    pub fn shared_first(&self) -> Arc<LoadedVolume> {
        Arc::clone(&self.first)
    }

    /// Words held at the ends of the window, of all volumes that have been loaded.
    pub fn clipped(&self) -> u64 {
        self.clipped.values().sum()
    }

    /// Seconds that all volumes together took to read or make.
    pub fn made_s(&self) -> f64 {
        self.made_s
    }

    /// Most bytes that may be taken.
    pub fn limit_bytes(&self) -> u64 {
        self.options.limit()
    }

    /// How many volumes there are; a phantom that moves has no end.
    pub fn count(&self) -> Option<u64> {
        count(&self.source, self.items.len())
    }

    /// Whether a source has more than one volume.
    ///
    /// # Errors
    /// A file whose header cannot be read.
    pub fn moves(source: &VolumeSource, options: &ReadOptions) -> Result<bool, InputError> {
        Ok(count(source, items(source, options)?.len()) != Some(1))
    }

    /// Volume `index`, from 0; behind the last, the last.
    ///
    /// # Errors
    /// A volume that cannot be read or made, or whose grid is not that of the first.
    pub fn volume(&mut self, index: u64) -> Result<Arc<LoadedVolume>, InputError> {
        let index = self.count().map_or(index, |count| index.min(count - 1));
        if index == 0 {
            return Ok(Arc::clone(&self.first));
        }
        if let Some((_, volume)) = self.kept.iter().find(|(kept, _)| *kept == index) {
            return Ok(Arc::clone(volume));
        }
        let Series { source, items, machine, options, .. } = &*self;
        let window = Some(self.window);
        let mut volume = load(source, items, index, self.phase_per_volume, window, machine, options, self.mask)?;
        let (first, here) = (&self.first.words, &volume.words);
        // Headers keep spacing as decimals or in single precision: the last digits may differ.
        let one = |a: f64, b: f64| (a - b).abs() <= SAME_SPACING * b;
        if here.dims != first.dims || !here.spacing.iter().zip(first.spacing).all(|(a, b)| one(*a, b)) {
            return Err(InputError::Grids(Box::new(TwoGrids {
                first: self.first.source.clone(),
                first_dims: first.dims,
                first_spacing: first.spacing,
                dims: here.dims,
                spacing: here.spacing,
                volume: volume.source,
            })));
        }
        self.made_s += volume.made_s.unwrap_or(0.0);
        (volume.words.spacing, volume.data.spacing) = (first.spacing, first.spacing);
        self.clipped.insert(index, volume.conversion.clipped_below + volume.conversion.clipped_above);
        let volume = Arc::new(volume);
        if self.kept.len() == KEPT_VOLUMES {
            self.kept.pop_front();
        }
        self.kept.push_back((index, Arc::clone(&volume)));
        Ok(volume)
    }
}

/// Each volume's file and its place in it; none where a phantom is computed.
fn items(source: &VolumeSource, options: &ReadOptions) -> Result<Vec<(PathBuf, usize)>, InputError> {
    let mut items = Vec::new();
    for file in source.file.iter().chain(&source.files) {
        let about = cube3_volume::inspect(file, &read_options(source, options))?;
        match source.time {
            Some(time) => items.push((file.clone(), time)),
            None => items.extend((0..about.volumes).map(|time| (file.clone(), time))),
        }
    }
    Ok(items)
}

/// How many volumes a source has, of so many in files; a phantom that moves has no end.
fn count(source: &VolumeSource, items: usize) -> Option<u64> {
    let moves = source.phantom.as_ref().is_some_and(|name| name.parse().is_ok_and(Phantom::moves));
    (!moves).then_some(items.max(1) as u64)
}

/// Volume `index` of a source, one of these `items` where it is files.
#[allow(clippy::too_many_arguments)]
fn load(
    source: &VolumeSource,
    items: &[(PathBuf, usize)],
    index: u64,
    phase_per_volume: f64,
    window: Option<[f64; 2]>,
    machine: &MachineSpec,
    options: &ReadOptions,
    mask: bool,
) -> Result<LoadedVolume, InputError> {
    let start = Instant::now();
    let mut one = source.clone();
    if let Some((file, time)) = items.get(index as usize) {
        (one.file, one.files, one.time) = (Some(file.clone()), Vec::new(), Some(*time));
    } else if let Some(name) = &source.phantom
        && name.parse::<Phantom>()?.moves()
    {
        one.phase = Some(source.phase.unwrap_or_default() + phase_per_volume * index as f64);
    }
    let Incoming { source: name, data, notes } = read_volume(&one, options)?;
    let loaded = if source.labels {
        labels_to_words(name, data, window, machine, mask)?
    } else {
        to_words(name, data, window, machine, mask)?
    };
    Ok(LoadedVolume { notes, made_s: Some(start.elapsed().as_secs_f64()), ..loaded })
}
