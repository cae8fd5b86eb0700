//! What a method is stressed with: a scene in a volume, and the machine.

use cube3_inputs::{InputError, LoadedVolume, labels_to_words, to_words};
use cube3_machine::{MachineSpec, RayEnds, Rays, TemplateRule};
use cube3_scene::{ColourPoint, Image, Scene, View};
use cube3_volume::{Samples, Volume, World};
use cube3_word::Words;

/// The values of the least and the largest voxel word.
pub(crate) const WINDOW: [f64; 2] = [0.0, 255.0];

/// Pixels of a picture each way.
const SIDE_PX: u32 = 24;

/// A scene in a volume, and the machine that shows it.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The scene.
    pub scene: Scene,
    /// The volume, of values within 0 to 255 unless they are labels.
    pub volume: Volume,
    /// The machine.
    pub machine: MachineSpec,
    /// Give voxels that are not finite the word 0.
    pub mask: bool,
}

impl Subject {
    /// Fog of one value everywhere, not lit, of an opacity for a unit length, over grey.
    pub fn new(dims: [usize; 3], value: impl Fn([usize; 3]) -> f64) -> Subject {
        let mut samples = Vec::with_capacity(dims.iter().product());
        for z in 0..dims[2] {
            for y in 0..dims[1] {
                for x in 0..dims[0] {
                    samples.push(value([x, y, z]));
                }
            }
        }
        Subject::of_samples(dims, Samples::F64(samples))
    }

    /// Of samples as they are.
    pub fn of_samples(dims: [usize; 3], samples: Samples) -> Subject {
        let mut scene = Scene { background: [0.25; 3], ..Scene::default() };
        scene.material.shaded = false;
        scene.transfer.opacity = vec![[0.0, 0.0], [255.0, 0.2]];
        scene.transfer.colour =
            vec![ColourPoint { value: 0.0, rgb: [1.0, 0.4, 0.1] }, ColourPoint { value: 255.0, rgb: [0.2, 0.9, 1.0] }];
        scene.view = View::from_angles(24.0, 11.0);
        scene.image = Image { width_px: SIDE_PX, height_px: SIDE_PX, pixel_size_voxel: None };
        let volume = Volume { dims, spacing: [1.0; 3], origin: [0.0; 3], world: World::default(), samples };
        Subject { scene, volume, machine: machine(), mask: false }
    }

    /// With other opacities over the values.
    #[must_use]
    pub fn opacity(mut self, points: &[[f64; 2]]) -> Subject {
        self.scene.transfer.opacity = points.to_vec();
        self
    }

    /// Seen otherwise.
    #[must_use]
    pub fn view(mut self, view: View) -> Subject {
        self.scene.view = view;
        self
    }

    /// Of other voxels.
    #[must_use]
    pub fn spacing(mut self, spacing: [f64; 3]) -> Subject {
        self.volume.spacing = spacing;
        self
    }

    /// Lit.
    #[must_use]
    pub fn lit(mut self) -> Subject {
        self.scene.material.shaded = true;
        self
    }

    /// With something else changed.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut Subject)) -> Subject {
        change(&mut self);
        self
    }

    /// The volume as the machine has it, and as data that are exactly its words, so that words alone are between it and reals.
    ///
    /// # Errors
    /// A volume that is refused.
    pub fn load(&self) -> Result<LoadedVolume, InputError> {
        let data = self.volume.clone();
        if self.scene.volume.labels {
            return labels_to_words("stress".into(), data, None, &self.machine, self.mask);
        }
        let mut loaded = to_words("stress".into(), data, Some(WINDOW), &self.machine, self.mask)?;
        let full = f64::from((1_u32 << self.machine.words.voxel_bits) - 1);
        let value = |word: &u16| WINDOW[0] + f64::from(*word) / full * (WINDOW[1] - WINDOW[0]);
        loaded.data.samples = Samples::F64(loaded.words.words.iter().map(value).collect());
        Ok(loaded)
    }
}

/// A machine of wide words: ends of their own length, samples in the middle of steps.
pub(crate) fn machine() -> MachineSpec {
    let words = Words { voxel_bits: 16, opacity_bits: 16, table_bits: 14, ..Words::default() };
    let rays = Rays { template: TemplateRule::PlaneFloor, ends: RayEnds::Exact, ..Rays::default() };
    MachineSpec { lanes: 8, words, rays, ..MachineSpec::default() }
}
