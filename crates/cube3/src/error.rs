//! Why something cannot be done.

use crate::memory::MemoryError;
use cube3_host::HostError;
use cube3_inputs::InputError;
use cube3_machine::MachineError;
use cube3_method::RenderError;
use cube3_metrics::MetricsError;
use cube3_picture::PictureError;
use cube3_pipeline::RunError;
use cube3_pipeline::checkpoint::CheckpointError;
use cube3_rendering::MethodError;
use cube3_report::ReportError;
use cube3_scene::SceneError;
use cube3_trace::TraceError;
use cube3_waveform::WaveformError;
use std::path::{Path, PathBuf};

/// Why something cannot be done; each message has place, reason and what would be right.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Scene, machine or volume cannot be had.
    #[error(transparent)]
    Input(Box<InputError>),
    /// The machine cannot be set up for the scene.
    #[error(transparent)]
    Host(Box<HostError>),
    /// The machine cannot be built, or cannot move: [`RunError::Deadlock`].
    #[error(transparent)]
    Run(#[from] RunError),
    /// A method made no picture.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// A checkpoint that cannot be written, read or taken up.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A trace outside of the run.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// A waveform that cannot be written.
    #[error(transparent)]
    Waveform(#[from] WaveformError),
    /// Pictures that cannot be compared.
    #[error(transparent)]
    Metrics(#[from] MetricsError),
    /// A picture without pixels, or with too many.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A report whose numbers do not add up.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A report that is no JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// A file that cannot be written.
    #[error("{}: {error}; give a file in a folder that can be written", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why not.
        error: std::io::Error,
    },
    /// More memory than there is.
    #[error(transparent)]
    Memory(Box<MemoryError>),
    /// Threads that cannot be started.
    #[error("{0}; give fewer threads")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// Something that has cycles is asked of a run that has none.
    #[error("--fidelity function has no cycles to trace, save or resume; give --fidelity timing, both or cycle")]
    NoCycles,
    /// A sequence of no frames.
    #[error("--frames 0: give 1 to {}", crate::options::MOST_FRAMES)]
    NoFrames,
    /// Volumes that change under the frames of an eye.
    #[error(
        "in perspective a frame may read a voxel more than once, and a volume that changes meanwhile has no one picture: give \
         acquisition.mode = \"double-buffer\" in the machine file, or a volume that stands still"
    )]
    VolumesUnderAnEye,
    /// More volumes come in than memory holds.
    #[error(
        "--fidelity cycle holds the {volumes} volumes that come in, {bytes} bytes, and {limit} are free: give fewer frames, or another fidelity"
    )]
    Volumes {
        /// How many come in.
        volumes: u64,
        /// Their bytes.
        bytes: u64,
        /// Bytes that are free.
        limit: u64,
    },
    /// There is no picture to measure.
    #[error("there is no picture to measure")]
    NoPicture,
    /// What a caller's own function refused.
    #[error("{0}")]
    Refused(Box<dyn std::error::Error + Send + Sync>),
    /// A part of the program stopped where it should not: a fault of this crate.
    #[error("the {0} run stopped unexpectedly")]
    Stopped(&'static str),
}

/// Something, or why it cannot be had.
pub type Outcome<T> = Result<T, Error>;

impl Error {
    /// A file that cannot be written.
    pub fn file(path: &Path, error: std::io::Error) -> Error {
        Error::File { path: path.to_owned(), error }
    }
}

impl From<RenderError> for Error {
    fn from(error: RenderError) -> Error {
        match error {
            RenderError::Method(error) => error.into(),
            RenderError::Host(error) => error.into(),
            RenderError::Run(error) => error.into(),
            RenderError::Picture(error) => error.into(),
            RenderError::Metrics(error) => error.into(),
            RenderError::NoFrame => MethodError::refused(RenderError::NoFrame).into(),
        }
    }
}

impl From<HostError> for Error {
    fn from(error: HostError) -> Error {
        Error::Host(Box::new(error))
    }
}

impl From<InputError> for Error {
    fn from(error: InputError) -> Error {
        Error::Input(Box::new(error))
    }
}

impl From<SceneError> for Error {
    fn from(error: SceneError) -> Error {
        InputError::from(error).into()
    }
}

impl From<MachineError> for Error {
    fn from(error: MachineError) -> Error {
        InputError::from(error).into()
    }
}

impl From<MemoryError> for Error {
    fn from(error: MemoryError) -> Error {
        Error::Memory(Box::new(error))
    }
}
