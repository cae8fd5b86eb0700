//! The file formats, told apart by name and by content.

use std::path::Path;

use strum::{Display, EnumString};

use crate::VolumeError;

/// A volume file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Display, EnumString)]
#[strum(serialize_all = "lowercase", parse_err_ty = VolumeError, parse_err_fn = unknown)]
pub enum FileFormat {
    /// Nearly raw raster data, `.nrrd`, or `.nhdr` with a data file.
    Nrrd,
    /// NIfTI-1 and NIfTI-2, `.nii`, or `.hdr` with `.img`; Analyze 7.5.
    Nifti,
    /// MetaImage, `.mha`, or `.mhd` with a data file.
    MetaImage,
    /// Bare numbers, `.raw` or `.bin`.
    Raw,
}

impl FileFormat {
    /// The format that a file's name stands for, with or without a `.gz` at its end.
    pub fn of_path(path: &Path) -> Option<FileFormat> {
        let name = path.file_name()?.to_string_lossy().to_lowercase();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        match name.rsplit_once('.')?.1 {
            "nrrd" | "nhdr" => Some(FileFormat::Nrrd),
            "nii" | "hdr" | "img" => Some(FileFormat::Nifti),
            "mha" | "mhd" => Some(FileFormat::MetaImage),
            "raw" | "bin" => Some(FileFormat::Raw),
            _ => None,
        }
    }

    /// The format that a file's first bytes (about 400) stand for, unpacked if it is gzipped. Raw numbers cannot be told.
    pub fn of_content(head: &[u8]) -> Option<FileFormat> {
        if head.starts_with(b"NRRD00") {
            return Some(FileFormat::Nrrd);
        }
        if [b"n+1\0", b"ni1\0"].into_iter().any(|magic| head.get(344..348) == Some(magic))
            || [b"n+2\0", b"ni2\0"].into_iter().any(|magic| head.get(4..8) == Some(magic))
        {
            return Some(FileFormat::Nifti);
        }
        let text = String::from_utf8_lossy(head);
        let first = text.lines().find(|l| !l.trim().is_empty())?;
        let key = first.split_once('=')?.0.trim();
        let known = ["ObjectType", "NDims", "Comment", "ObjectSubType", "DimSize"];
        known.contains(&key).then_some(FileFormat::MetaImage)
    }
}

fn unknown(name: &str) -> VolumeError {
    VolumeError::unknown("format", name, "write nrrd, nifti, metaimage or raw")
}
