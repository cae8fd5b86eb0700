//! A grid of samples with its spacing and origin.

use rayon::prelude::*;

use crate::error::show_dims;
use crate::samples::CHUNK;
use crate::{Sample, SampleType, Samples, VolumeError, World, with_samples};

/// A regular grid of samples. Voxel centres are at integer grid coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// Voxels along x, y and z; each at least 1.
    pub dims: [usize; 3],
    /// Distance between neighbouring voxel centres along x, y and z, in the file's unit (often
    /// mm); positive and finite.
    pub spacing: [f64; 3],
    /// Position of voxel (0, 0, 0) in world coordinates; finite.
    pub origin: [f64; 3],
    /// What world coordinates mean, and how the axes run in them.
    pub world: World,
    /// The samples, x fastest, then y, then z; as many as the product of `dims`.
    pub samples: Samples,
}

impl Volume {
    /// A volume of checked parts, with its origin at (0, 0, 0) and its axes along those of an unknown world.
    ///
    /// # Errors
    ///
    /// [`VolumeError::Grid`] when a dimension is 0, their product overflows or is not the number
    /// of samples, or a spacing is not positive and finite.
    pub fn new(dims: [usize; 3], spacing: [f64; 3], samples: Samples) -> Result<Self, VolumeError> {
        Self { dims, spacing, origin: [0.0; 3], world: World::default(), samples }.checked()
    }

    /// The same volume at another origin.
    ///
    /// # Errors
    ///
    /// [`VolumeError::Grid`] when a coordinate is NaN or infinite.
    pub fn with_origin(self, origin: [f64; 3]) -> Result<Self, VolumeError> {
        Self { origin, ..self }.checked()
    }

    /// The same voxels elsewhere in the world.
    ///
    /// # Errors
    ///
    /// [`VolumeError::Grid`] when a coordinate is NaN or infinite, or the directions are no unit vectors.
    pub fn with_world(self, origin: [f64; 3], world: World) -> Result<Self, VolumeError> {
        if !world.directions.iter().all(|d| (d.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 1e-6) {
            return Err(VolumeError::Grid {
                what: "directions",
                reason: format!("{:?} are no unit vectors", world.directions),
                remedy: "give a vector of length 1 for each axis",
            });
        }
        Self { origin, world, ..self }.checked()
    }

    fn checked(self) -> Result<Self, VolumeError> {
        check_grid(self.dims, self.spacing, self.origin)?;
        let count = self.dims.iter().try_fold(1usize, |p, &d| p.checked_mul(d));
        if count != Some(self.samples.len()) {
            return Err(VolumeError::Grid {
                what: "samples",
                reason: format!("{} given for {} voxels", self.samples.len(), show_dims(&self.dims)),
                remedy: "give one sample for each voxel",
            });
        }
        Ok(self)
    }

    /// A volume computed voxel by voxel, on all cores: `sample(x, y, z)`.
    ///
    /// # Errors
    ///
    /// As [`Volume::new`], and [`VolumeError::TooLarge`] when the memory cannot be had.
    pub fn from_fn<S: Sample>(
        dims: [usize; 3],
        spacing: [f64; 3],
        sample: impl Fn(usize, usize, usize) -> S + Sync,
    ) -> Result<Self, VolumeError> {
        check_grid(dims, spacing, [0.0; 3])?;
        let count = crate::limits::sample_count(dims, S::TYPE, u64::MAX, "volume")?;
        let mut samples = crate::limits::reserve::<S>(count, dims, S::TYPE, "volume")?;
        samples.resize(count, S::default());
        samples.par_chunks_mut(dims[0]).enumerate().for_each(|(row, beam)| {
            let (y, z) = (row % dims[1], row / dims[1]);
            for (x, s) in beam.iter_mut().enumerate() {
                *s = sample(x, y, z);
            }
        });
        Self::new(dims, spacing, S::wrap(samples))
    }

    /// The type of the samples.
    pub fn sample_type(&self) -> SampleType {
        self.samples.sample_type()
    }

    /// Bytes of the samples.
    pub fn bytes(&self) -> u64 {
        (self.samples.len() * self.sample_type().bytes()) as u64
    }

    /// The number of voxels.
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// Whether there are no voxels; never true of a volume made by [`Volume::new`].
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Index of voxel (x, y, z) in storage order.
    #[inline]
    pub fn index(&self, x: usize, y: usize, z: usize) -> usize {
        (z * self.dims[1] + y) * self.dims[0] + x
    }

    /// Voxel (x, y, z) of the sample at `index` in storage order.
    pub fn position(&self, index: usize) -> [usize; 3] {
        let [nx, ny, _] = self.dims;
        [index % nx, index / nx % ny, index / nx / ny]
    }

    /// The sample at voxel (x, y, z); exact for every type.
    ///
    /// # Panics
    ///
    /// When the voxel is outside the volume.
    #[inline]
    pub fn value(&self, x: usize, y: usize, z: usize) -> f64 {
        assert!(x < self.dims[0] && y < self.dims[1] && z < self.dims[2], "voxel outside the volume");
        self.samples.value(self.index(x, y, z))
    }

    /// All samples as `f64`, in storage order.
    pub fn to_f64(&self) -> Vec<f64> {
        self.each(|value| value)
    }

    /// All samples as `f32`, in storage order, each rounded to nearest.
    pub fn to_f32(&self) -> Vec<f32> {
        self.each(|value| value as f32)
    }

    /// The volume with `change` done to each sample and the result kept as `S`, by
    /// [`Sample::nearest`].
    pub fn map<S: Sample>(&self, change: impl Fn(f64) -> f64 + Sync) -> Volume {
        Volume { samples: S::wrap(self.each(|value| S::nearest(change(value)))), ..*self }
    }

    fn each<T: bytemuck::Zeroable + Send>(&self, make: impl Fn(f64) -> T + Sync) -> Vec<T> {
        let mut made: Vec<T> = bytemuck::allocation::zeroed_vec(self.len());
        made.par_chunks_mut(CHUNK).enumerate().for_each(|(i, made)| {
            with_samples!(&self.samples, v => {
                made.iter_mut().zip(&v[i * CHUNK..]).for_each(|(made, &s)| *made = make(f64::from(s)));
            });
        });
        made
    }
}

/// Checks what can be checked of a grid before any sample exists.
pub(crate) fn check_grid(dims: [usize; 3], spacing: [f64; 3], origin: [f64; 3]) -> Result<(), VolumeError> {
    if dims.contains(&0) {
        return Err(VolumeError::Grid {
            what: "dimensions",
            reason: format!("{} holds no voxel", show_dims(&dims)),
            remedy: "every dimension must be at least 1",
        });
    }
    if !spacing.iter().all(|s| s.is_finite() && *s > 0.0) {
        return Err(VolumeError::Grid {
            what: "spacing",
            reason: format!("{spacing:?} is no distance between voxels"),
            remedy: "every spacing must be positive and finite",
        });
    }
    if !origin.iter().all(|o| o.is_finite()) {
        return Err(VolumeError::Grid {
            what: "origin",
            reason: format!("{origin:?} is no position"),
            remedy: "every coordinate must be finite",
        });
    }
    Ok(())
}
