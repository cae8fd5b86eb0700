//! What can be wrong with a report.

/// Why a report was refused, or could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The cycles of a unit do not add up to the run.
    #[error("unit {unit} accounts for {accounted} cycles of a run of {cycles}")]
    UnitCycles {
        /// The unit's name.
        unit: String,
        /// Busy, starved, blocked and waiting together.
        accounted: u128,
        /// The cycles of the run.
        cycles: u64,
    },
    /// Units were counted, but no clock ran.
    #[error("there are counters of {units} units but no timing to hold them against")]
    UnitsWithoutTiming {
        /// The number of units.
        units: usize,
    },
    /// A channel lost or invented tokens.
    #[error("channel {channel} took {pushes} tokens, but gave {pops} and holds {occupancy}")]
    ChannelTokens {
        /// The channel's name.
        channel: String,
        /// Tokens pushed.
        pushes: u64,
        /// Tokens popped.
        pops: u64,
        /// Tokens in it at the end.
        occupancy: u64,
    },
    /// A channel's occupancies contradict each other or its capacity.
    #[error(
        "channel {channel} of capacity {capacity} holds {occupancy} tokens, \
         {max} at the most and {mean} on the average"
    )]
    ChannelOccupancy {
        /// The channel's name.
        channel: String,
        /// Its capacity.
        capacity: u64,
        /// Tokens at the end.
        occupancy: u64,
        /// The largest number of tokens.
        max: u64,
        /// The mean number of tokens.
        mean: f64,
    },
    /// A number is NaN or infinite, which JSON cannot hold.
    #[error("{key} is {value}, and not a finite number")]
    NotFinite {
        /// The key in the report.
        key: String,
        /// What was found.
        value: f64,
    },
    /// Numbers that follow from each other do not.
    #[error("{key} is {found}, but the rest of the report gives {expected}")]
    Inconsistent {
        /// The key in the report.
        key: &'static str,
        /// What was found.
        found: f64,
        /// What follows from the other numbers.
        expected: f64,
    },
    /// The report has another layout.
    #[error("the report has schema {found}, but this program reads schema {expected}")]
    Schema {
        /// The number in the report.
        found: u64,
        /// The number that would be right.
        expected: u32,
    },
    /// The text is not a report.
    #[error("the report cannot be read or written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// The pixels do not fill the picture.
    #[error("a picture of {width} x {height} pixels needs 3 bytes a pixel, but {found} bytes were given")]
    PictureSize {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
        /// The number of bytes given.
        found: usize,
    },
    /// The picture could not be encoded.
    #[error("the picture cannot be encoded: {0}")]
    Png(#[from] png::EncodingError),
    /// The report could not be written.
    #[error("the report cannot be written: {0}")]
    Io(#[from] std::io::Error),
}

/// A number that must be finite.
pub(crate) fn finite(key: &str, value: f64) -> Result<(), ReportError> {
    if value.is_finite() { Ok(()) } else { Err(ReportError::NotFinite { key: key.into(), value }) }
}
