//! Why there is no picture.

use cube3_host::HostError;
use cube3_metrics::MetricsError;
use cube3_picture::PictureError;
use cube3_pipeline::RunError;
use cube3_rendering::MethodError;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The method cannot show it, or refuses it.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// The machine cannot be set up for it.
    #[error(transparent)]
    Host(#[from] HostError),
    /// The machine cannot run it.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The picture itself.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Pictures that cannot be compared.
    #[error(transparent)]
    Metrics(#[from] MetricsError),
    /// A view in which no ray comes near the volume, for a method that takes its rays from a frame.
    #[error("no ray of the picture comes near the volume; turn the view, or move the eye")]
    NoFrame,
}
