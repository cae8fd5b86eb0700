//! Which volume is shown.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

use crate::SceneError;
use crate::check::Checked;

/// The largest side of a phantom, in voxels.
pub const LARGEST_PHANTOM_VOXELS: usize = 4096;

/// The default phantom and the length of its side, in voxels.
const DEFAULT_PHANTOM: (&str, usize) = ("head", 128);

/// How the axes of a volume file become x, y and z of the frame buffer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "lowercase")]
#[strum(serialize_all = "lowercase")]
pub enum FileAxes {
    /// By their directions, where the file says them: x to a patient's right, y to the front, z to the head.
    #[default]
    Ras,
    /// As the file has them: the first is x.
    Stored,
}

impl FileAxes {
    fn is_default(&self) -> bool {
        *self == FileAxes::default()
    }
}

/// Which volume is shown: a file, a series of files or a phantom, exactly one of them.
///
/// In a file, naming none means the default phantom `head` of 128 voxels on a side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "VolumeSourceInFile")]
pub struct VolumeSource {
    /// The volume file. A relative path starts at the current directory.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// Volume files of one grid, in the order of time: a sequence of frames shows them one after another.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<PathBuf>,
    /// The name of a phantom that is computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phantom: Option<String>,
    /// The number of voxels on each side of the phantom, 1 to [`LARGEST_PHANTOM_VOXELS`]; absent
    /// for a file, which has a size of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size_voxels: Option<usize>,
    /// The stored values that become the lowest and the highest voxel value, low below high; `None`
    /// leaves the choice to the reader of the volume.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window: Option<[f64; 2]>,
    /// How the axes of a file become x, y and z.
    #[serde(skip_serializing_if = "FileAxes::is_default")]
    pub axes: FileAxes,
    /// Which volume of a file that holds a series, from 0; `None` is all of them in a sequence, else the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<usize>,
    /// Whether the values are labels, whole numbers that name something: each sample is then its nearest voxel, and nothing is
    /// interpolated.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub labels: bool,
    /// For a phantom that moves: the phase of the first volume, in periods; 0 if `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<f64>,
    /// For a phantom that moves: how far each volume of a sequence is behind the one before, in periods; one period over
    /// all frames if `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase_per_frame: Option<f64>,
}

/// The keys as they may stand in a file, before defaults.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct VolumeSourceInFile {
    file: Option<PathBuf>,
    files: Vec<PathBuf>,
    phantom: Option<String>,
    size_voxels: Option<usize>,
    window: Option<[f64; 2]>,
    axes: FileAxes,
    time: Option<usize>,
    labels: bool,
    phase: Option<f64>,
    phase_per_frame: Option<f64>,
}

impl From<VolumeSourceInFile> for VolumeSource {
    fn from(given: VolumeSourceInFile) -> Self {
        let VolumeSourceInFile {
            file,
            files,
            mut phantom,
            mut size_voxels,
            window,
            axes,
            time,
            labels,
            phase,
            phase_per_frame,
        } = given;
        if file.is_none() && files.is_empty() {
            phantom.get_or_insert_with(|| DEFAULT_PHANTOM.0.to_owned());
            size_voxels.get_or_insert(DEFAULT_PHANTOM.1);
        }
        VolumeSource { file, files, phantom, size_voxels, window, axes, time, labels, phase, phase_per_frame }
    }
}

impl Default for VolumeSource {
    fn default() -> Self {
        VolumeSourceInFile::default().into()
    }
}

impl VolumeSource {
    /// The volume in the file at `path`.
    pub fn from_file(path: impl Into<PathBuf>) -> Self {
        VolumeSourceInFile { file: Some(path.into()), ..VolumeSourceInFile::default() }.into()
    }

    /// The volumes in the files at `paths`, in the order of time.
    pub fn from_files(paths: impl IntoIterator<Item = PathBuf>) -> Self {
        VolumeSourceInFile { files: paths.into_iter().collect(), ..VolumeSourceInFile::default() }.into()
    }

    /// The phantom called `name`, of `size_voxels` on each side.
    pub fn from_phantom(name: impl Into<String>, size_voxels: usize) -> Self {
        VolumeSourceInFile {
            phantom: Some(name.into()),
            size_voxels: Some(size_voxels),
            ..VolumeSourceInFile::default()
        }
        .into()
    }

    pub(crate) fn validate(&self) -> Checked {
        let given = [self.file.is_some(), !self.files.is_empty(), self.phantom.is_some()];
        match given.iter().filter(|given| **given).count() {
            0 => {
                return Err(SceneError::at(
                    "volume",
                    "there is no volume",
                    "give one of `file`, `files` and `phantom`",
                ));
            }
            1 => {}
            _ if self.phantom.is_some() => {
                return Err(SceneError::at(
                    "volume.phantom",
                    "a file and a phantom are both given",
                    "give only one of `file`, `files` and `phantom`",
                ));
            }
            _ => {
                return Err(SceneError::at(
                    "volume.files",
                    "a file and a series of files are both given",
                    "give only one of `file` and `files`",
                ));
            }
        }
        if let Some(file) = &self.file {
            validate_path("volume.file", file)?;
        }
        self.files.iter().enumerate().try_for_each(|(i, file)| validate_path(&format!("volume.files[{i}]"), file))?;
        match &self.phantom {
            None => {
                for (key, given, reason, right) in [
                    (
                        "volume.size_voxels",
                        self.size_voxels.is_some(),
                        "a volume file has a size of its own",
                        "leave `size_voxels` out, or give a phantom",
                    ),
                    (
                        "volume.phase",
                        self.phase.is_some(),
                        "a volume file has no phase",
                        "leave `phase` out, or give the phantom \"beating-heart\"",
                    ),
                    (
                        "volume.phase_per_frame",
                        self.phase_per_frame.is_some(),
                        "a volume file has no phase",
                        "leave `phase_per_frame` out, or give the phantom \"beating-heart\"",
                    ),
                ] {
                    if given {
                        return Err(SceneError::at(key, reason, right));
                    }
                }
            }
            Some(name) if name.is_empty() => {
                return Err(SceneError::at(
                    "volume.phantom",
                    "the name is empty",
                    "give the name of a phantom, such as \"head\"",
                ));
            }
            Some(_) => {}
        }
        if self.labels && self.window.is_some() {
            return Err(SceneError::at(
                "volume.window",
                "labels are words as they are, and a window would make others of them",
                "leave `window` or `labels` out",
            ));
        }
        if let Some([low, high]) = self.window
            && low >= high
        {
            return Err(SceneError::at(
                "volume.window",
                format!("the window from {low} to {high} is empty"),
                "give the low value first and a higher one second",
            ));
        }
        Ok(())
    }
}

/// A path that a scene file can name.
fn validate_path(key: &str, file: &Path) -> Checked {
    if file.as_os_str().is_empty() {
        return Err(SceneError::at(key, "the path is empty", "give the path of a volume file"));
    }
    if file.to_str().is_none() {
        return Err(SceneError::at(
            key,
            format!("the path {file:?} is not Unicode, which a scene file has to be"),
            "rename the volume file",
        ));
    }
    Ok(())
}
