//! Volumes from formulas.

use strum::{Display, EnumString, IntoStaticStr, VariantArray};

use crate::{Volume, VolumeError};

mod beating_heart;
mod blocks;
mod engine;
mod head;
mod shepp_logan;
mod signals;
mod solid;
mod sphere;

/// A volume made by a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Display, EnumString, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case", parse_err_ty = VolumeError, parse_err_fn = unknown)]
pub enum Phantom {
    /// A human head as a CT scanner sees it.
    Head,
    /// A solid ball with a soft edge.
    Sphere,
    /// The test signal of Marschner and Lobb.
    MarschnerLobb,
    /// The Shepp-Logan head in three dimensions.
    SheppLogan,
    /// Concentric spherical shells, from thinner than a voxel to several voxels thick.
    Shells,
    /// A smooth field of low density.
    Fog,
    /// A machined block with bores and dense inserts.
    Engine,
    /// Blocks of nothing and of full density in turn.
    Checker,
    /// A heart that beats in a thorax.
    BeatingHeart,
}

/// What may be chosen of a phantom; `None` takes the default of each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhantomParams {
    /// Sphere: radius in voxels; default 26/64 of the cube's side.
    pub radius: Option<f64>,
    /// Sphere: width of the soft edge in voxels; default 2.2.
    pub ramp: Option<f64>,
    /// Sphere and shells: centre in voxels; default the cube's centre, (n − 1)/2.
    pub centre: Option<[f64; 3]>,
    /// Checker: side of a block in voxels; default 8.
    pub period: Option<usize>,
    /// Beating heart: phase of the beat, 0 and every whole number the end of filling; default 0.
    pub phase: Option<f64>,
}

impl Phantom {
    /// All of them.
    pub const ALL: [Phantom; Phantom::VARIANTS.len()] = *Phantom::VARIANTS.first_chunk().unwrap();

    /// The name, as it is read.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Whether it changes with [`PhantomParams::phase`].
    pub fn moves(self) -> bool {
        self == Phantom::BeatingHeart
    }

    /// The phantom in a cube of `size` voxels a side at unit spacing.
    ///
    /// # Errors
    ///
    /// [`VolumeError::Grid`] when `size` is 0, [`VolumeError::TooLarge`] when the memory cannot be
    /// had, [`VolumeError::Parameter`] for a parameter outside its range.
    pub fn generate(&self, size: usize, params: &PhantomParams) -> Result<Volume, VolumeError> {
        if params.phase.is_some() && !self.moves() {
            return Err(VolumeError::Parameter {
                name: "phase",
                reason: format!("{self} does not move"),
                remedy: "leave the phase out, or take beating-heart",
            });
        }
        match self {
            Phantom::Head => head::head(size),
            Phantom::Sphere => sphere::sphere(size, params),
            Phantom::MarschnerLobb => signals::marschner_lobb(size),
            Phantom::SheppLogan => shepp_logan::shepp_logan(size),
            Phantom::Shells => sphere::shells(size, params),
            Phantom::Fog => signals::fog(size),
            Phantom::Engine => engine::engine(size),
            Phantom::Checker => signals::checker(size, params),
            Phantom::BeatingHeart => beating_heart::beating_heart(size, params),
        }
    }
}

fn unknown(name: &str) -> VolumeError {
    VolumeError::unknown(
        "phantom",
        name,
        "write head, sphere, marschner-lobb, shepp-logan, shells, fog, engine, checker or beating-heart",
    )
}
