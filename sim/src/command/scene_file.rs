//! `cube3 scene`: parameters, a scene with every key.

use super::list::ListArguments;
use super::run::print;
use crate::problem::Outcome;
use clap::Args;
use cube3_scene::{SCENE_PARAMETERS, Scene};
use std::path::PathBuf;

/// Arguments of `cube3 scene`.
#[derive(Debug, Args)]
pub struct SceneFileArguments {
    /// Scene file to print with every key; the default scene, commented, without it.
    #[arg(value_name = "FILE.toml", conflicts_with = "parameters")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    list: ListArguments,
}

impl SceneFileArguments {
    /// Prints what is asked for.
    ///
    /// # Errors
    /// A scene that cannot be read.
    pub fn execute(self) -> Outcome<()> {
        if let Some(list) = self.list.of(SCENE_PARAMETERS, &Scene::default())? {
            return print(&list);
        }
        match self.scene {
            None => print(Scene::COMMENTED_DEFAULT),
            Some(file) => print(&Scene::read(file)?.to_toml()?),
        }
    }
}
