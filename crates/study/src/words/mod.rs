//! The study of word lengths: what each word costs and what it does to picture and gradients.
//!
//! ```text
//!   wire ──► sweeps ──► picture (the scene in words against the same samples in reals), cost
//!               │  └──► thin    (the cone alone, rays of thin opacity)
//!               └──► front ──► files (CSV, JSON), summary (terminal), page (HTML, with plots)
//! ```

pub mod cost;
mod files;
pub mod levels;
mod page;
pub mod picture;
mod plot;
mod plots;
mod summary;
pub mod sweeps;
pub mod thin;
pub mod wire;

pub use files::{csv, json};
pub use page::page;
pub use plots::{Plots, plots};
pub use summary::summary;

use crate::error::Outcome;
use cost::PartCost;
use cube3_host::picture_setup;
use cube3_inputs::LoadedVolume;
use cube3_machine::MachineSpec;
use cube3_metrics::WorkPrecision;
use cube3_scene::Scene;
use picture::{Aim, SceneCase};
use sweeps::{Row, ThinRow};
use thin::ThinCase;
use wire::{Variant, Wire};

/// Version of the files' form.
pub const SCHEMA: u32 = 1;

/// What is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Wires that are varied.
    pub wires: Vec<Wire>,
    /// Bound of a picture's mean error, in levels of 1/255.
    pub bound_levels: f64,
    /// Bound of the mean angle of the normalised gradient, in degrees.
    pub bound_deg: f64,
}

impl Default for Options {
    /// Every wire; half a level; a degree.
    fn default() -> Self {
        Options { wires: Wire::ALL.to_vec(), bound_levels: 0.5, bound_deg: 1.0 }
    }
}

/// What the study found.
#[derive(Clone, Debug)]
pub struct Study {
    /// What was asked; wires that the scene does not use are left out.
    pub options: Options,
    /// Wires asked for that this scene does not use.
    pub unused: Vec<Wire>,
    /// The scene.
    pub scene: Scene,
    /// The machine.
    pub machine: MachineSpec,
    /// Where the volume comes from, and voxels along x, y, z.
    pub volume: (String, [usize; 3]),
    /// Points of the scene, in the order in which they were measured.
    pub rows: Vec<Row>,
    /// Points of the cone alone.
    pub thin: Vec<ThinRow>,
    /// What the logic of the machine's own words is made of.
    pub parts: Vec<PartCost>,
    /// Designs that were measured.
    pub designs: usize,
}

/// Makes the study.
///
/// # Errors
/// A scene that the machine cannot be set up for, or in perspective.
pub fn study(scene: &Scene, machine: &MachineSpec, volume: &LoadedVolume, options: &Options) -> Outcome<Study> {
    let mut case = SceneCase::new(scene, machine, volume)?;
    let own = picture_setup(scene, machine, &volume.info(), true)?.setups.into_iter().next();
    let has_gradient = own.as_ref().is_some_and(|setup| setup.gradient.is_some());
    let has_normal = own.as_ref().is_some_and(|setup| setup.normaliser.is_some());
    let used = |wire: &Wire| match wire {
        Wire::Gradient => has_gradient,
        Wire::Normal => has_normal,
        Wire::TableGradient => scene.transfer.is_two_dimensional(),
        _ => true,
    };
    let (wires, unused): (Vec<Wire>, Vec<Wire>) = options.wires.iter().partition(|wire| used(wire));
    let mut rows = sweeps::families(&mut case, &machine.words)?;
    let one_wire = sweeps::one_wire(&mut case, &machine.words, &wires)?;
    let found = sweeps::search(&mut case, &machine.words, &wires, &one_wire, options.bound_levels)?;
    rows.extend(one_wire);
    rows.extend(found);
    let thin = sweeps::thin(&ThinCase::new(), &machine.words, &wires);
    Ok(Study {
        parts: own.as_ref().map_or_else(Vec::new, |setup| cost::parts(machine, setup)),
        options: Options { wires, ..options.clone() },
        unused,
        scene: scene.clone(),
        machine: machine.clone(),
        volume: (volume.source.clone(), volume.words.dims),
        rows,
        thin,
        designs: case.count(),
    })
}

/// Of some rows those that no other beats in cost and mean error, by rising cost: indices of rows. Of those with the same cost and
/// error, the first.
///
/// # Errors
/// An error that is not finite.
pub fn front(rows: &[Row], of: &[usize], aim: Aim) -> Outcome<Vec<usize>> {
    let point = |&index: &usize| {
        let measured = &rows[index].measured;
        WorkPrecision { cost: measured.cost.total_bits() as f64, error: measured.error(aim) }
    };
    let points: Vec<WorkPrecision> = of.iter().map(point).collect();
    let mut kept: Vec<usize> = Vec::new();
    for place in cube3_metrics::front(&points)? {
        let last = kept.last().map(point);
        if last.is_none_or(|last| last != points[place]) {
            kept.push(of[place]);
        }
    }
    Ok(kept)
}

impl Study {
    /// The front over all rows, or over those of one variant: indices of rows, by rising cost.
    ///
    /// # Errors
    /// An error that is not finite.
    pub fn front(&self, aim: Aim, variant: Option<Variant>) -> Outcome<Vec<usize>> {
        let of = |index: &usize| variant.is_none_or(|variant| self.rows[*index].design.variant() == variant);
        let of: Vec<usize> = (0..self.rows.len()).filter(of).collect();
        front(&self.rows, &of, aim)
    }

    /// The cheapest row whose mean error is at most so many levels; of equally cheap ones that with the least error.
    pub fn cheapest(&self, aim: Aim, levels: f64) -> Option<&Row> {
        let within = self.rows.iter().filter(|row| row.measured.error(aim) <= levels);
        within.min_by(|a, b| {
            let [a, b] = [a, b].map(|row| row.measured);
            a.cost.total_bits().cmp(&b.cost.total_bits()).then(a.error(aim).total_cmp(&b.error(aim)))
        })
    }
}
