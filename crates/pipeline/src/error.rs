//! Why a machine cannot be built or run.

use cube3_cfb::FrameBufferError;
use cube3_cfb::memory::ReorderError;
use cube3_channel::{ChannelError, Deadlock};

/// Why a machine cannot be built or run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A channel of the machine file.
    #[error(transparent)]
    Channel(#[from] ChannelError),
    /// The frame buffer.
    #[error(transparent)]
    FrameBuffer(#[from] FrameBufferError),
    /// A reorder buffer that is too small.
    #[error(transparent)]
    Reorder(#[from] ReorderError),
    /// Nothing can move.
    #[error(transparent)]
    Deadlock(#[from] Deadlock),
}
