//! The scene of a command: a file, and the options that change it.

use super::{RawArguments, three};
use crate::problem::{Outcome, Problem};
use clap::Args;
use cube3_machine::{GradientMethod, MachineSpec};
use cube3_scene::{FileAxes, Mode, Perspective, Scene, View, VolumeSource};
use cube3_volume::ReadOptions;
use std::path::{Path, PathBuf};

/// Options of a scene.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// What to show; the head phantom without it.
    #[arg(long, value_name = "FILE.toml")]
    scene: Option<PathBuf>,
    /// Volume: .nrrd, .nhdr, .nii, .nii.gz, .mha, .mhd, or raw with --dims and --type. Several are a series in the order of time,
    /// for run --frames.
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with = "phantom")]
    volume: Vec<PathBuf>,
    /// Built-in volume: head, sphere, marschner-lobb, shepp-logan, shells, fog, engine, checker or beating-heart.
    #[arg(long, value_name = "NAME")]
    phantom: Option<String>,
    /// Voxels along each side of the phantom.
    #[arg(long, value_name = "VOXELS", conflicts_with = "volume")]
    size: Option<usize>,
    /// The volume's values are labels: each sample is its nearest voxel, and nothing is interpolated.
    #[arg(long)]
    labels: bool,
    #[command(flatten)]
    raw: RawArguments,
    /// How a ray becomes a pixel: composite, first-opaque, last-opaque, maximum, minimum or weighted-sum.
    #[arg(long)]
    mode: Option<Mode>,
    /// Degrees that the eye is turned about the vertical axis.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    yaw: Option<f64>,
    /// Degrees that the eye is raised above the horizon.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    tilt: Option<f64>,
    /// Perspective: degrees between the picture's lower and upper edge.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    fov: Option<f64>,
    /// Where the eye of a perspective view is, in voxels; the view's direction stays.
    #[arg(long, value_name = "X,Y,Z", value_parser = eye, allow_hyphen_values = true)]
    eye: Option<[f64; 3]>,
    /// How far before the volume's centre the eye of a perspective view is, in voxels.
    #[arg(long, value_name = "VOXELS", allow_negative_numbers = true, conflicts_with = "eye")]
    distance: Option<f64>,
    /// Gradient estimator: 6, 26, 10, 10n, 12, 6d or 26d.
    #[arg(long, value_name = "NAME", value_parser = gradient)]
    gradient: Option<GradientMethod>,
}

fn gradient(name: &str) -> Result<GradientMethod, String> {
    let all = GradientMethod::ALL;
    let names = || all.map(|(_, name)| name).join(", ");
    all.iter()
        .find(|(_, known)| *known == name)
        .map(|(method, _)| *method)
        .ok_or_else(|| format!("known are {}", names()))
}

fn eye(text: &str) -> Result<[f64; 3], String> {
    three(text, ',', "63.5,-150,63.5")
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
            ("--volume", !self.volume.is_empty()),
            ("--phantom", self.phantom.is_some()),
            ("--size", self.size.is_some()),
            ("--labels", self.labels),
            ("--mode", self.mode.is_some()),
            ("--yaw", self.yaw.is_some()),
            ("--tilt", self.tilt.is_some()),
            ("--fov", self.fov.is_some()),
            ("--eye", self.eye.is_some()),
            ("--distance", self.distance.is_some()),
            ("--gradient", self.gradient.is_some()),
        ];
        let given = given.into_iter().find(|(_, given)| *given).map(|(option, _)| option);
        given.or_else(|| self.raw.given())
    }

    /// How the volume's file is read.
    ///
    /// # Errors
    /// Some of the options of a raw file without the others.
    pub fn read_options(&self) -> Outcome<ReadOptions> {
        self.raw.read_options()
    }

    /// The scene; `default` changes the built-in one where no file is given.
    ///
    /// # Errors
    /// A file that cannot be read, options that do not go together.
    pub fn scene(&self, default: impl FnOnce(&mut Scene)) -> Outcome<Scene> {
        let mut scene = cube3_inputs::scene(self.scene.as_deref())?;
        if self.scene.is_none() {
            default(&mut scene);
        }
        self.place_volume(&mut scene.volume)?;
        if self.yaw.is_some() || self.tilt.is_some() {
            (scene.view.direction, scene.view.up) = (None, None);
        }
        scene.view.yaw_deg = self.yaw.unwrap_or(scene.view.yaw_deg);
        scene.view.tilt_deg = self.tilt.unwrap_or(scene.view.tilt_deg);
        self.place_eye(&mut scene.view)?;
        scene.mode = self.mode.unwrap_or(scene.mode);
        scene.validate()?;
        Ok(scene)
    }

    /// Makes the volume the one that the options ask for.
    fn place_volume(&self, volume: &mut VolumeSource) -> Outcome<()> {
        if !self.volume.is_empty() {
            let VolumeSource { window, axes, time, labels, .. } = *volume;
            let source = match self.volume.as_slice() {
                [file] => VolumeSource::from_file(file),
                files => VolumeSource::from_files(files.to_vec()),
            };
            *volume = VolumeSource { window, axes, time, labels, ..source };
        }
        volume.time = self.raw.time.or(volume.time);
        if self.phantom.is_some() || self.size.is_some() {
            if self.phantom.is_none() && volume.phantom.is_none() {
                return Err(Problem::new(
                    "--size is for phantoms, and the scene's volume is a file; give --phantom too, or leave --size out",
                ));
            }
            if self.phantom.is_some() && self.phantom != volume.phantom {
                (volume.phase, volume.phase_per_frame) = (None, None);
            }
            (volume.file, volume.axes, volume.time) = (None, FileAxes::default(), self.raw.time);
            volume.files = Vec::new();
            volume.phantom = self.phantom.clone().or(volume.phantom.take());
            volume.size_voxels = self.size.or(volume.size_voxels);
        }
        volume.labels |= self.labels;
        Ok(())
    }

    /// Makes the view the perspective that the options ask for.
    fn place_eye(&self, view: &mut View) -> Outcome<()> {
        if let Some(field_of_view_deg) = self.fov {
            let before = view.perspective.unwrap_or(Perspective::new(field_of_view_deg));
            view.perspective = Some(Perspective { field_of_view_deg, ..before });
        }
        if self.eye.is_none() && self.distance.is_none() {
            return Ok(());
        }
        let Some(perspective) = &mut view.perspective else {
            let option = if self.eye.is_some() { "--eye" } else { "--distance" };
            return Err(Problem::new(format!(
                "{option} is for perspective views, and this one is parallel; give --fov DEGREES too, or [view.perspective] \
                 in the scene"
            )));
        };
        (perspective.eye_voxel, perspective.distance_voxel) = (self.eye, self.distance);
        Ok(())
    }

    /// A machine of that name or file, with the gradient estimator that is asked for.
    ///
    /// # Errors
    /// A file that cannot be read, an estimator that it cannot have.
    pub fn machine(&self, name: &str) -> Outcome<MachineSpec> {
        let mut machine = cube3_inputs::machine(name)?;
        machine.abc.gradient = self.gradient.unwrap_or(machine.abc.gradient);
        machine.check(name)?;
        Ok(machine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Debug, Parser)]
    struct Alone {
        #[command(flatten)]
        scene: SceneArguments,
    }

    fn view(arguments: &[&str]) -> Outcome<View> {
        let arguments = Alone::try_parse_from([&["cube3"], arguments].concat()).unwrap();
        arguments.scene.scene(|_| {}).map(|scene| scene.view)
    }

    #[test]
    fn options_place_the_eye() {
        assert_eq!(view(&["--yaw", "20"]).unwrap().perspective, None);
        let perspective = |arguments: &[&str]| view(arguments).unwrap().perspective.unwrap();
        assert_eq!(perspective(&["--fov", "40"]), Perspective::new(40.0));
        let near = Perspective { distance_voxel: Some(90.0), ..Perspective::new(40.0) };
        assert_eq!(perspective(&["--fov", "40", "--distance", "90"]), near);
        let inside = Perspective { eye_voxel: Some([-1.5, 2.0, 3e2]), ..Perspective::new(40.0) };
        assert_eq!(perspective(&["--eye", "-1.5, 2,3e2", "--fov", "40"]), inside);
    }

    #[test]
    fn options_override_the_eye_of_the_scene_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, "[view.perspective]\nfield_of_view_deg = 30\neye_voxel = [1, 2, 3]\n").unwrap();
        let path = path.to_str().unwrap();
        let perspective = |more: &[&str]| view(&[&["--scene", path], more].concat()).unwrap().perspective.unwrap();
        let of_file = Perspective { eye_voxel: Some([1.0, 2.0, 3.0]), ..Perspective::new(30.0) };
        assert_eq!(perspective(&[]), of_file);
        assert_eq!(perspective(&["--fov", "50"]), Perspective { field_of_view_deg: 50.0, ..of_file });
        let moved = Perspective { eye_voxel: Some([4.0, 5.0, 6.0]), ..of_file };
        assert_eq!(perspective(&["--eye", "4,5,6"]), moved);
        let near = Perspective { eye_voxel: None, distance_voxel: Some(7.0), ..of_file };
        assert_eq!(perspective(&["--distance", "7"]), near);
    }
}
