//! A frame by definition: every sample, gradient, shade and pixel from registers and voxels, by the units' `golden` modules alone.
//!
//! ```text
//!   voxels ──► sample ──► neighbourhood ──► shade ──► leaf ──► pixel ──► base plane
//!              trilin                       abc       cone     cone
//! ```
//! There are no beams, slots, lanes, channels or cycles here: a ray is asked for, and what it needs is worked out. It holds for every frame
//! that registers can describe, parallel or in perspective. The machine, its vectors and its RTL must equal it to the bit.
//!
//! Each method with `_wires` in its name gives the same, and shows a [`Probe`] what the wires of every unit on the way carry. A walk over a
//! frame, [`Definition::base_plane_wires`], shows every sample and every node once:
//!
//! ```text
//!   ray r ─┬─ sample k ─┬─ trilin      wires of a sample, where it is in the volume
//!          │            ├─ clip, gradient, normalise, classify, phong or reflectance, lit, cue
//!          │            └─ leaf
//!          ├─ node n                   in the order of the cone
//!          └─ pixel
//! ```
//! Pfister et al. 1995, sections 3 to 5.

use cube3_abc::golden::{Counted, Local, Neighbourhood, Shaded, Stages, behind_the_eye, local_gradient, shade_wires};
use cube3_cone::golden::{Node, leaf_wires, pixel_wires, reduce_wires};
use cube3_frame::{BasePlane, DiscreteRay, FrameSetup};
use cube3_trilin::golden::{Weights, cell_wires, lift};
use cube3_word::Probe;

/// A frame of a volume.
#[derive(Clone, Copy, Debug)]
pub struct Definition<'a> {
    setup: &'a FrameSetup,
    voxels: &'a [u16],
}

impl<'a> Definition<'a> {
    /// The frame that registers make of voxel words, x fastest.
    ///
    /// # Panics
    /// Where there are not as many voxels as the registers are for.
    pub fn new(setup: &'a FrameSetup, voxels: &'a [u16]) -> Definition<'a> {
        let dims = setup.geometry.dims();
        assert_eq!(voxels.len(), dims.iter().product::<usize>(), "voxels of a volume of {dims:?}");
        Definition { setup, voxels }
    }

    /// The registers.
    pub fn setup(&self) -> &'a FrameSetup {
        self.setup
    }

    /// Every ray of the frame, in the order of the base plane's pixels.
    pub fn rays(&self) -> impl Iterator<Item = DiscreteRay> + use<> {
        let (first, [width, height]) = (self.setup.geometry.first_ray(), self.setup.geometry.base_plane_size());
        let places = (0..height as i64).flat_map(move |row| (0..width as i64).map(move |column| [row, column]));
        places.map(move |[row, column]| DiscreteRay { u: first.u + column, v: first.v + row })
    }

    /// The voxel words around sample k of a ray, `[w][v][u]`; 0 where there is no voxel.
    pub fn corners(&self, ray: DiscreteRay, k: usize) -> [[[u16; 2]; 2]; 2] {
        let geometry = &self.setup.geometry;
        let [nx, ny, _] = geometry.dims();
        let corner = |wvu: [usize; 3]| {
            let [x, y, z] = geometry.axes.voxel(geometry.size, geometry.corner(ray, k, wvu)?);
            Some(self.voxels[x + nx * (y + ny * z)])
        };
        [0, 1].map(|w| [0, 1].map(|v| [0, 1].map(|u| corner([w, v, u]).unwrap_or(0))))
    }

    /// Sample k of a ray, where it is in the volume.
    pub fn sample(&self, ray: DiscreteRay, k: i64) -> Option<i32> {
        self.sample_wires(ray, k, &mut ())
    }

    /// [`Definition::sample`], and what its wires carry.
    pub fn sample_wires(&self, ray: DiscreteRay, k: i64, probe: &mut impl Probe) -> Option<i32> {
        let FrameSetup { geometry, words, .. } = self.setup;
        if !geometry.has_sample(ray, k) {
            return None;
        }
        let corners = self.corners(ray, k as usize).map(|w| w.map(|v| v.map(|voxel| lift(voxel, words))));
        let [u, v] = geometry.weights(ray, k as usize);
        let weights = Weights { w: geometry.offset, u, v };
        Some(probe.within("trilin", 0, |probe| cell_wires(corners, weights, words, probe)))
    }

    /// Sample k of a ray, which is in the volume, and its 26 neighbours; the border where there is none.
    pub fn neighbourhood(&self, ray: DiscreteRay, k: i64) -> Neighbourhood {
        let border = self.setup.gradient.map_or(0, |registers| registers.border);
        let apart = self.setup.reach(k as usize);
        let beside = |u: i64, v: i64| DiscreteRay { u: ray.u + u * apart, v: ray.v + v * apart };
        [-1, 0, 1].map(|w| [-1, 0, 1].map(|v| [-1, 0, 1].map(|u| self.sample(beside(u, v), k + w).unwrap_or(border))))
    }

    /// The gradient at sample k of a ray, clipped or not: where it is in the volume, and the frame has gradients.
    pub fn gradient(&self, ray: DiscreteRay, k: i64) -> Option<[i32; 3]> {
        let registers = self.setup.gradient.as_ref().filter(|_| self.setup.geometry.has_sample(ray, k))?;
        let at = [ray.u, ray.v, k];
        let around = behind_the_eye(&self.neighbourhood(ray, k), at, self.setup);
        Some(local_gradient(&around, registers, &Local::new(at, registers, self.setup), &self.setup.words).value)
    }

    /// What the stages of shading make of sample k of a ray, where it is in the volume.
    pub fn stages(&self, ray: DiscreteRay, k: i64) -> Option<Stages> {
        self.stages_wires(ray, k, &mut ())
    }

    /// [`Definition::stages`], and what the wires of the sample and of each stage carry.
    pub fn stages_wires(&self, ray: DiscreteRay, k: i64, probe: &mut impl Probe) -> Option<Stages> {
        self.sample_wires(ray, k, probe)?;
        Some(shade_wires(&self.neighbourhood(ray, k), [ray.u, ray.v, k], self.setup, probe))
    }

    /// Sample k of a ray as it goes into the cone; nothing where it is not in the volume.
    pub fn shade(&self, ray: DiscreteRay, k: i64) -> Counted<Shaded> {
        self.shade_wires(ray, k, &mut ())
    }

    /// [`Definition::shade`], and what the wires on the way carry.
    pub fn shade_wires(&self, ray: DiscreteRay, k: i64, probe: &mut impl Probe) -> Counted<Shaded> {
        self.stages_wires(ray, k, probe).map_or_else(Counted::default, |stages| stages.shaded)
    }

    /// The leaf of sample k of a ray.
    pub fn leaf(&self, ray: DiscreteRay, k: i64) -> Node {
        self.leaf_wires(ray, k, &mut ())
    }

    /// [`Definition::leaf`], and what the wires on the way carry.
    pub fn leaf_wires(&self, ray: DiscreteRay, k: i64, probe: &mut impl Probe) -> Node {
        let shaded = self.shade_wires(ray, k, probe).value;
        probe.within("leaf", 0, |probe| leaf_wires(&shaded, &self.setup.cone, &self.setup.words, probe))
    }

    /// The pixel of a ray: red, green, blue (opacity-weighted) and opacity.
    pub fn pixel(&self, ray: DiscreteRay) -> Counted<[u32; 4]> {
        self.pixel_wires(ray, &mut ())
    }

    /// [`Definition::pixel`], and what the wires on the way carry.
    pub fn pixel_wires(&self, ray: DiscreteRay, probe: &mut impl Probe) -> Counted<[u32; 4]> {
        let FrameSetup { geometry, cone, words, .. } = self.setup;
        let mut at = |k: usize| probe.within("sample", k, |probe| self.leaf_wires(ray, k as i64, probe));
        let leaves: Vec<Node> = (0..geometry.size[2]).map(&mut at).collect();
        let node = reduce_wires(&leaves, cone, words, probe);
        probe.within("pixel", 0, |probe| pixel_wires(node, cone, words, probe))
    }

    /// The base plane: the pixel of every ray.
    pub fn base_plane(&self) -> BasePlane {
        self.base_plane_wires(&mut ())
    }

    /// [`Definition::base_plane`], and what every wire of the frame carries.
    pub fn base_plane_wires(&self, probe: &mut impl Probe) -> BasePlane {
        let mut base = BasePlane::empty(&self.setup.geometry, self.setup.words.accumulator_bits);
        for (place, (pixel, ray)) in base.pixels.iter_mut().zip(self.rays()).enumerate() {
            *pixel = probe.within("ray", place, |probe| self.pixel_wires(ray, probe).value);
        }
        base
    }
}
