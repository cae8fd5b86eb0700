//! The scene of a command that is not `run`: a file, and the options that change it.

use super::run::gradient;
use crate::problem::{Outcome, Problem};
use clap::Args;
use cube3_inputs as inputs;
use cube3_machine::{GradientMethod, MachineSpec};
use cube3_scene::{Mode, Scene, VolumeSource};
use std::path::{Path, PathBuf};

/// Options of a scene.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// What to show; the head phantom without it.
    #[arg(long, value_name = "FILE.toml")]
    scene: Option<PathBuf>,
    /// Volume: .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd.
    #[arg(long, value_name = "FILE", conflicts_with = "phantom")]
    volume: Option<PathBuf>,
    /// Built-in volume.
    #[arg(long, value_name = "NAME")]
    phantom: Option<String>,
    /// Voxels along each side of the phantom.
    #[arg(long, value_name = "VOXELS", conflicts_with = "volume")]
    size: Option<usize>,
    /// The values are labels: each sample is its nearest voxel, and nothing is interpolated.
    #[arg(long)]
    labels: bool,
    /// How a ray becomes a pixel.
    #[arg(long)]
    mode: Option<Mode>,
    /// Degrees that the eye is turned about the vertical axis.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    yaw: Option<f64>,
    /// Degrees that the eye is raised above the horizon.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    tilt: Option<f64>,
    /// Gradient estimator: 6, 26, 10, 10n, 12, 6d or 26d.
    #[arg(long, value_name = "NAME", value_parser = gradient)]
    gradient: Option<GradientMethod>,
}

impl SceneArguments {
    /// The scene file.
    pub fn file(&self) -> Option<&Path> {
        self.scene.as_deref()
    }

    /// The first option that was given.
    pub fn given(&self) -> Option<&'static str> {
        let given = [
            ("--scene", self.scene.is_some()),
            ("--volume", self.volume.is_some()),
            ("--phantom", self.phantom.is_some()),
            ("--size", self.size.is_some()),
            ("--labels", self.labels),
            ("--mode", self.mode.is_some()),
            ("--yaw", self.yaw.is_some()),
            ("--tilt", self.tilt.is_some()),
            ("--gradient", self.gradient.is_some()),
        ];
        given.into_iter().find(|(_, given)| *given).map(|(option, _)| option)
    }

    /// The scene; `default` changes the built-in one where no file is given.
    ///
    /// # Errors
    /// A file that cannot be read, options that do not go together.
    pub fn scene(&self, default: impl FnOnce(&mut Scene)) -> Outcome<Scene> {
        let mut scene = inputs::scene(self.scene.as_deref())?;
        if self.scene.is_none() {
            default(&mut scene);
        }
        if let Some(file) = &self.volume {
            let VolumeSource { window, axes, time, labels, .. } = scene.volume;
            scene.volume = VolumeSource { window, axes, time, labels, ..VolumeSource::from_file(file) };
        }
        if self.phantom.is_some() || self.size.is_some() {
            if self.phantom.is_none() && scene.volume.phantom.is_none() {
                return Err(Problem::new(
                    "--size is for phantoms, and the scene's volume is a file; give --phantom too, or leave --size out",
                ));
            }
            let size = self.size.or(scene.volume.size_voxels);
            let phantom = self.phantom.clone().or(scene.volume.phantom);
            let VolumeSource { window, labels, .. } = scene.volume;
            scene.volume = VolumeSource { phantom, size_voxels: size, window, labels, ..VolumeSource::default() };
        }
        scene.volume.labels |= self.labels;
        if self.yaw.is_some() || self.tilt.is_some() {
            (scene.view.direction, scene.view.up) = (None, None);
        }
        scene.view.yaw_deg = self.yaw.unwrap_or(scene.view.yaw_deg);
        scene.view.tilt_deg = self.tilt.unwrap_or(scene.view.tilt_deg);
        scene.mode = self.mode.unwrap_or(scene.mode);
        scene.validate()?;
        Ok(scene)
    }

    /// A machine of that name or file, with the gradient estimator that is asked for.
    ///
    /// # Errors
    /// A file that cannot be read, an estimator that it cannot have.
    pub fn machine(&self, name: &str) -> Outcome<MachineSpec> {
        let mut machine = inputs::machine(name)?;
        machine.abc.gradient = self.gradient.unwrap_or(machine.abc.gradient);
        machine.check(name)?;
        Ok(machine)
    }
}
