//! Why there is no recording.

use crate::ExpressionError;
use cube3_cfb::FrameBufferError;
use cube3_pipeline::RunError;

/// Why there is no recording.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// A frame that is not there.
    #[error("the picture has {frames} frames, and frame {frame} was asked for, counted from 0")]
    Frame {
        /// Asked for.
        frame: usize,
        /// There.
        frames: usize,
    },
    /// A unit that does nothing in the frame.
    #[error("the unit {unit} carries nothing in this frame: {reason}")]
    Idle {
        /// The unit.
        unit: &'static str,
        /// Why not.
        reason: String,
    },
    /// A window behind the last transaction.
    #[error("the unit {unit} has {found} transactions in this frame, and the window starts at {first}, counted from 0")]
    Beyond {
        /// The unit.
        unit: &'static str,
        /// Transactions of the frame.
        found: usize,
        /// First one asked for.
        first: usize,
    },
    /// A channel that is never empty again.
    #[error(
        "the channel {channel} is not empty in any cycle from {first} on, and vectors of a channel begin with an empty one: start earlier"
    )]
    Held {
        /// The channel.
        channel: String,
        /// The first cycle asked for.
        first: usize,
    },
    /// No channel of that name.
    #[error("the machine has no channel \"{channel}\"; its channels are {names}")]
    Channel {
        /// The name.
        channel: String,
        /// Those that there are.
        names: String,
    },
    /// A value that the unit's sheet does not allow.
    #[error(
        "transaction {line} has {field} = {value}, and vectors of the unit {unit} hold {low} to {high} in this format: {remedy}"
    )]
    Value {
        /// The unit.
        unit: &'static str,
        /// Transaction of the recording, from 0.
        line: usize,
        /// The field.
        field: String,
        /// Its value.
        value: i128,
        /// The lowest.
        low: i128,
        /// The highest.
        high: i128,
        /// What to change.
        remedy: &'static str,
    },
    /// More opacity tables than the vectors of classification number.
    #[error(
        "vectors of the unit classify tell up to 16 opacity tables apart, and rays whose ends have parts of a step have more: set \
         rays.ends = \"published\" in the machine file"
    )]
    Ends,
    /// A sheet.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
    /// The machine.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The frame buffer.
    #[error(transparent)]
    FrameBuffer(#[from] FrameBufferError),
}
