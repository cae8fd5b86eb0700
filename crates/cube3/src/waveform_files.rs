//! Waveforms as files.

use crate::{Error, Outcome};
use cube3_file::write_whole;
use cube3_waveform::Waveform;
use std::path::Path;

/// Writes a waveform, whole or not at all, and beside it how GTKWave (`.gtkw`) and Surfer (`.sucl`) show it.
///
/// # Errors
/// A file that cannot be written.
pub fn write_waveform(path: &Path, waveform: &Waveform) -> Outcome<()> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let write = |path: &Path, bytes: &[u8]| write_whole(path, bytes).map_err(|error| Error::file(path, error));
    write(path, &waveform.fst)?;
    write(&path.with_extension("gtkw"), waveform.gtkwave(&name).as_bytes())?;
    write(&path.with_extension("sucl"), waveform.surfer().as_bytes())
}
