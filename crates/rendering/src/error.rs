//! Why a method made no picture.

use crate::Feature;
use cube3_parameter::nearest_name;
use cube3_picture::PictureError;
use cube3_scene::SceneError;
use std::error::Error;

/// Why a method made no picture.
#[derive(Debug, thiserror::Error)]
pub enum MethodError {
    /// A name that is not in the table.
    #[error("there is no method {name}{}; known are {known}", near.as_ref().map_or(String::new(), |near| format!(": did you mean {near}?")))]
    Unknown {
        /// The name that was given.
        name: String,
        /// The name that is nearest to it, where one is near.
        near: Option<&'static str>,
        /// The names that there are.
        known: String,
    },
    /// A scene that asks for what the method cannot show.
    #[error("the method {method} cannot show what the scene asks for: {}; {}", names(lacks), others(able))]
    Lacks {
        /// The method.
        method: &'static str,
        /// What it lacks.
        lacks: Vec<Feature>,
        /// The methods that can show the scene.
        able: Vec<&'static str>,
    },
    /// An option that the method has not.
    #[error("'{text}' is no option of the method {method}; {}", if known.is_empty() { "it has none".to_owned() } else { format!("give {known}") })]
    Option {
        /// The method.
        method: &'static str,
        /// What was given.
        text: String,
        /// What can be given.
        known: String,
    },
    /// The scene.
    #[error(transparent)]
    Scene(Box<SceneError>),
    /// The picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// What the method itself refuses.
    #[error("{0}")]
    Refused(Box<dyn Error + Send + Sync>),
}

impl From<SceneError> for MethodError {
    fn from(error: SceneError) -> MethodError {
        MethodError::Scene(Box::new(error))
    }
}

impl MethodError {
    /// What a method itself refuses.
    pub fn refused(error: impl Error + Send + Sync + 'static) -> MethodError {
        MethodError::Refused(Box::new(error))
    }

    /// A name that is not among those that there are.
    pub fn unknown(name: &str, known: &[&'static str]) -> MethodError {
        let near = nearest_name(name, known.iter().copied());
        MethodError::Unknown { name: name.to_owned(), near, known: known.join(", ") }
    }
}

fn names(features: &[Feature]) -> String {
    features.iter().map(|feature| feature.name()).collect::<Vec<_>>().join(", ")
}

fn others(able: &[&str]) -> String {
    match able {
        [] => "no method can: `cube3 methods` lists what each shows".into(),
        able => format!("take {}", able.join(" or ")),
    }
}
