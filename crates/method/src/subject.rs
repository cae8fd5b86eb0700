//! What a picture is made of.

use cube3_host::{HostError, PictureFrames, picture_setup};
use cube3_inputs::LoadedVolume;
use cube3_machine::MachineSpec;
use cube3_rendering::SceneSubject;
use cube3_scene::Scene;
use std::borrow::Cow;

/// A scene in a volume, and the machine that some methods run or whose rays they take.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// What to show, in the grid of the volume: [`Scene::thickened`] where an axis had one voxel.
    pub scene: &'a Scene,
    /// The machine.
    pub machine: &'a MachineSpec,
    /// The volume, as data and as the machine's words.
    pub volume: &'a LoadedVolume,
    /// Whether what cannot change a bit of the picture is left out.
    pub plan: bool,
    /// The frames of the picture, where they have been set up already.
    pub frames: Option<&'a PictureFrames>,
}

impl<'a> Subject<'a> {
    /// A scene, in the grid of a volume, on a machine.
    pub fn new(scene: &'a Scene, machine: &'a MachineSpec, volume: &'a LoadedVolume) -> Subject<'a> {
        Subject { scene, machine, volume, plan: true, frames: None }
    }

    /// The frames of the picture.
    ///
    /// # Errors
    /// A scene or volume that the machine cannot be set up for.
    pub fn frames(&self) -> Result<Cow<'a, PictureFrames>, HostError> {
        match self.frames {
            Some(frames) => Ok(Cow::Borrowed(frames)),
            None => picture_setup(self.scene, self.machine, &self.volume.info(), self.plan).map(Cow::Owned),
        }
    }

    /// Scene and volume alone.
    pub fn as_scene(&self) -> SceneSubject<'a> {
        SceneSubject { scene: self.scene, volume: &self.volume.data, border: self.volume.words.window[0] }
    }
}
