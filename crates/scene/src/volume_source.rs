//! Which volume is shown.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::SceneError;
use crate::check::{self, Checked};

/// The largest side of a phantom, in voxels.
pub const LARGEST_PHANTOM_VOXELS: usize = 4096;

/// The default phantom and the length of its side, in voxels.
const DEFAULT_PHANTOM: (&str, usize) = ("head", 128);

/// Which volume is shown: a file or a phantom, exactly one of them.
///
/// In a file, naming neither means the default phantom `head` of 128 voxels on a side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "VolumeSourceInFile")]
pub struct VolumeSource {
    /// The volume file. A relative path starts at the current directory.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
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
}

/// The keys as they may stand in a file, before defaults.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct VolumeSourceInFile {
    file: Option<PathBuf>,
    phantom: Option<String>,
    size_voxels: Option<usize>,
    window: Option<[f64; 2]>,
}

impl From<VolumeSourceInFile> for VolumeSource {
    fn from(given: VolumeSourceInFile) -> Self {
        let VolumeSourceInFile { file, mut phantom, mut size_voxels, window } = given;
        if file.is_none() {
            phantom.get_or_insert_with(|| DEFAULT_PHANTOM.0.to_owned());
            size_voxels.get_or_insert(DEFAULT_PHANTOM.1);
        }
        VolumeSource { file, phantom, size_voxels, window }
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
        VolumeSource { file: Some(path.into()), phantom: None, size_voxels: None, window: None }
    }

    /// The phantom called `name`, of `size_voxels` on each side.
    pub fn from_phantom(name: impl Into<String>, size_voxels: usize) -> Self {
        VolumeSource { file: None, phantom: Some(name.into()), size_voxels: Some(size_voxels), window: None }
    }

    pub(crate) fn validate(&self) -> Checked {
        match (&self.file, &self.phantom) {
            (Some(_), Some(_)) => {
                return Err(SceneError::at(
                    "volume.phantom",
                    "a file and a phantom are both given",
                    "give only one of `file` and `phantom`",
                ));
            }
            (None, None) => {
                return Err(SceneError::at("volume", "there is no volume", "give one of `file` and `phantom`"));
            }
            (Some(file), None) => {
                if file.as_os_str().is_empty() {
                    return Err(SceneError::at("volume.file", "the path is empty", "give the path of a volume file"));
                }
                if file.to_str().is_none() {
                    return Err(SceneError::at(
                        "volume.file",
                        format!("the path {file:?} is not Unicode, which a scene file has to be"),
                        "rename the volume file",
                    ));
                }
                if self.size_voxels.is_some() {
                    return Err(SceneError::at(
                        "volume.size_voxels",
                        "a volume file has a size of its own",
                        "leave `size_voxels` out, or give a phantom",
                    ));
                }
            }
            (None, Some(name)) => {
                if name.is_empty() {
                    return Err(SceneError::at(
                        "volume.phantom",
                        "the name is empty",
                        "give the name of a phantom, such as \"head\"",
                    ));
                }
            }
        }
        if let Some(size) = self.size_voxels
            && !(1..=LARGEST_PHANTOM_VOXELS).contains(&size)
        {
            return Err(SceneError::at(
                "volume.size_voxels",
                format!("a phantom cannot have {size} voxels on a side"),
                format!("give a whole number from 1 to {LARGEST_PHANTOM_VOXELS}"),
            ));
        }
        if let Some([low, high]) = self.window {
            check::finite("volume.window[0]", low)?;
            check::finite("volume.window[1]", high)?;
            if low >= high {
                return Err(SceneError::at(
                    "volume.window",
                    format!("the window from {low} to {high} is empty"),
                    "give the low value first and a higher one second",
                ));
            }
        }
        Ok(())
    }
}
