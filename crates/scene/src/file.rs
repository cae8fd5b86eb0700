//! Scenes as TOML text.

use std::path::Path;

use cube3_parameter::locate::{line_at, span_of};
use cube3_parameter::{Unread, number_fault};
use toml::de::DeTable;

use crate::check::Checked;
use crate::{SCENE_PARAMETERS, SCHEMA, Scene, SceneError, ScenePlace};

impl Scene {
    /// The default scene as a text to edit: every key explained, optional ones commented out.
    pub const COMMENTED_DEFAULT: &str = include_str!("default.toml");

    /// The scene that `text` describes, called `source_name` in messages; missing keys have their
    /// defaults.
    ///
    /// # Errors
    ///
    /// Text that is not TOML, an unknown key, a wrong type, and all that [`Scene::validate`] finds,
    /// with the key and the line where the text has one.
    pub fn from_toml(text: &str, source_name: &str) -> Result<Scene, SceneError> {
        let document = DeTable::parse(text).map_err(|error| toml_error(&error, text, &DeTable::new(), source_name))?;
        let document = document.get_ref();
        let with_place = |error: SceneError| {
            let line = span_of(document, error.key()).map(|span| line_at(text, span.start));
            error.in_file(source_name, line)
        };
        // First of all, as a file of another format may have any keys.
        if let Some(schema) = document.get("schema")
            && let Some(integer) = schema.get_ref().as_integer()
            && let Ok(schema) = i64::from_str_radix(integer.as_str(), integer.radix())
        {
            validate_schema(schema).map_err(with_place)?;
        }
        let scene: Scene = toml::from_str(text).map_err(|error| {
            let error = toml_error(&error, text, document, source_name);
            match number_fault(SCENE_PARAMETERS, text, document, error.key()) {
                Some(fault) => with_place(SceneError::out_of_range(&fault)),
                None => error,
            }
        })?;
        scene.validate().map_err(with_place)?;
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
        toml::to_string(self).map_err(|error| {
            SceneError::at(
                "",
                format!("the scene cannot be written as TOML: {error}"),
                "give the volume file a name in Unicode",
            )
        })
    }
}

/// The TOML reader's error, with its place in `text`.
fn toml_error(error: &toml::de::Error, text: &str, document: &DeTable, source_name: &str) -> SceneError {
    let Unread { line, key, reason, right } = Unread::new(error, text, document);
    SceneError::Invalid { place: ScenePlace { file: Some(source_name.to_owned()), line, key }, reason, right }
}

/// `schema` is a format that this program reads.
fn validate_schema(schema: i64) -> Checked {
    if (1..=i64::from(SCHEMA)).contains(&schema) {
        return Ok(());
    }
    Err(SceneError::at(
        "schema",
        format!("the scene has format {schema}"),
        format!("give a scene of format 1 to {SCHEMA}"),
    ))
}
