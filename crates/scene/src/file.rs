//! Scenes as TOML text.

use std::path::Path;

use crate::{Scene, SceneError};

impl Scene {
    /// The default scene as a text to edit: every key explained, optional ones commented out.
    pub const COMMENTED_DEFAULT: &str = include_str!("default.toml");

    /// The scene that `text` describes, called `source_name` in messages; missing keys have their
    /// defaults.
    ///
    /// # Errors
    ///
    /// Text that is not TOML, an unknown key, a wrong type, and all that [`Scene::validate`] finds,
    /// with the line where the text has one.
    pub fn from_toml(text: &str, source_name: &str) -> Result<Scene, SceneError> {
        let scene: Scene = toml::from_str(text).map_err(|error| SceneError::at(source_name, error.to_string(), ""))?;
        scene.validate()?;
        Ok(scene)
    }

    /// The scene in the file at `path`.
    ///
    /// # Errors
    ///
    /// A file that cannot be read as text, and all errors of [`Scene::from_toml`].
    pub fn read(path: impl AsRef<Path>) -> Result<Scene, SceneError> {
        let path = path.as_ref();
        let text =
            std::fs::read_to_string(path).map_err(|source| SceneError::Unreadable { path: path.to_owned(), source })?;
        Scene::from_toml(&text, &path.display().to_string())
    }

    /// The whole scene, defaults included, as TOML that [`Scene::from_toml`] reads back.
    ///
    /// # Errors
    ///
    /// What TOML cannot hold: a path that is not Unicode.
    pub fn to_toml(&self) -> Result<String, SceneError> {
        toml::to_string(self)
            .map_err(|error| SceneError::at("", format!("cannot be written as TOML: {error}"), "correct the scene"))
    }
}
