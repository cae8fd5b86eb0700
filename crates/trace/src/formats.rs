//! A recording as a file.

use crate::{Recording, TraceError, TraceFormat, fst, kanata, perfetto};
use cube3_waveform::Waveform;

impl Recording {
    /// The recording as a waveform.
    ///
    /// # Errors
    /// A waveform that cannot be written.
    pub fn waveform(&self) -> Result<Waveform, TraceError> {
        fst::write(self)
    }

    /// The recording as a file of a format.
    ///
    /// # Errors
    /// A waveform that cannot be written.
    pub fn write(&self, format: TraceFormat) -> Result<Vec<u8>, TraceError> {
        Ok(match format {
            TraceFormat::Fst => self.waveform()?.fst,
            TraceFormat::Kanata => kanata::write(self).into_bytes(),
            TraceFormat::Perfetto => perfetto::write(self).into_bytes(),
        })
    }
}
