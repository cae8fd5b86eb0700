//! Why a study cannot be made.

use cube3_host::HostError;
use cube3_method::RenderError;
use cube3_metrics::MetricsError;
use cube3_picture::PictureError;
use cube3_rendering::MethodError;
use cube3_volume::VolumeError;

/// Why a study cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The machine cannot be set up for the scene.
    #[error(transparent)]
    Host(#[from] HostError),
    /// The reference has no picture of the scene.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// The reference made no picture.
    #[error(transparent)]
    Render(Box<RenderError>),
    /// The volume cannot be turned into words.
    #[error(transparent)]
    Volume(#[from] VolumeError),
    /// Pictures that cannot be compared.
    #[error(transparent)]
    Metrics(#[from] MetricsError),
    /// A picture without pixels, or with too many.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Samples in reals that cannot be had.
    #[error(transparent)]
    Samples(#[from] cube3_twin::TwinError),
    /// A file's text.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// A view in which no ray comes near the volume.
    #[error("the volume has no frame in this view; try another view")]
    NoFrame,
    /// An eye, whose picture may have several frames, each with words of its own.
    #[error(
        "word lengths are studied in one frame, and a perspective view may have several; leave view.perspective out of the scene, or --fov"
    )]
    ManyFrames,
    /// A scene that shows nothing.
    #[error("the scene shows nothing, in words or in reals, and there is no error to study; try another scene or view")]
    NothingShown,
    /// A design that was not measured, or has no reference: a fault of this crate.
    #[error("a design was not measured")]
    NotMeasured,
}

impl From<RenderError> for StudyError {
    fn from(error: RenderError) -> StudyError {
        StudyError::Render(Box::new(error))
    }
}

/// Something, or why it cannot be had.
pub(crate) type Outcome<T> = Result<T, StudyError>;
