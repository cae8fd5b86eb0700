//! Scene and machine files, and presets by name.

use crate::InputError;
use cube3_machine::{MachineSpec, PRESETS};
use cube3_scene::Scene;
use std::path::Path;

/// Reads a machine file, or takes a preset by its name.
///
/// # Errors
/// No such file or preset, and what is wrong in the file.
pub fn machine(name: &str) -> Result<MachineSpec, InputError> {
    if let Some((name, text)) = PRESETS.iter().find(|(preset, _)| *preset == name) {
        return Ok(MachineSpec::from_toml(text, name)?);
    }
    let text = std::fs::read_to_string(name).map_err(|error| InputError::MachineFile { name: name.into(), error })?;
    Ok(MachineSpec::from_toml(&text, name)?)
}

/// Reads a scene file, or takes the default scene.
///
/// # Errors
/// What is wrong in the file.
pub fn scene(path: Option<&Path>) -> Result<Scene, InputError> {
    Ok(path.map_or_else(|| Ok(Scene::default()), Scene::read)?)
}
