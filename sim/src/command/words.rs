//! `cube3 verify --words`: the study of word lengths.

use super::run::{keep_inputs, print};
use super::scene::SceneArguments;
use super::{fits, on_threads, threads};
use crate::output::{remove, write_files};
use crate::problem::Outcome;
use crate::progress::Waiting;
use clap::Args;
use cube3::Runs;
use cube3::memory::{Case, Grid};
use cube3_inputs as inputs;
use cube3_scene::Image;
use cube3_study::words::wire::Wire;
use cube3_study::words::{Options, csv, json, page, plots, study, summary};
use std::path::Path;

/// Voxels a side of the phantom, where neither scene nor volume is given.
const SIZE: usize = 64;
/// Pixels a side of its picture.
const SIDE_PX: u32 = 192;

/// Arguments of the study.
#[derive(Debug, Args)]
pub struct WordsArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Words whose length is varied, e.g. accumulator,opacity; all without it.
    #[arg(long, requires = "words", value_name = "LIST", value_delimiter = ',', value_parser = wire)]
    wires: Vec<Wire>,
    /// Bound of a picture's mean error, in levels of 1/255.
    #[arg(long, requires = "words", value_name = "LEVELS", allow_negative_numbers = true, default_value_t = Options::default().bound_levels, value_parser = bound)]
    bound: f64,
    /// Bound of the mean angle of the normalised gradient.
    #[arg(long, requires = "words", value_name = "DEGREES", allow_negative_numbers = true, default_value_t = Options::default().bound_deg, value_parser = bound)]
    angle_bound: f64,
    /// Threads; all cores without it.
    #[arg(long, requires = "words")]
    threads: Option<usize>,
}

fn wire(name: &str) -> Result<Wire, String> {
    let known = || Wire::ALL.map(Wire::name).join(", ");
    let name = name.trim().trim_end_matches("_bits");
    Wire::ALL.into_iter().find(|wire| wire.name() == name).ok_or_else(|| format!("known are {}", known()))
}

fn bound(text: &str) -> Result<f64, String> {
    let value: Option<f64> = text.parse().ok();
    value.filter(|value| value.is_finite() && *value > 0.0).ok_or_else(|| "give a number above 0, e.g. 0.5".into())
}

impl WordsArguments {
    /// Makes the study for a machine, prints its tables and writes its files into a folder.
    ///
    /// # Errors
    /// What went wrong, in words.
    pub fn execute(self, machine: &str, out: &Path) -> Outcome<()> {
        keep_inputs(self.scene.file(), machine, out)?;
        let scene = self.scene.scene(|scene| {
            scene.image = Image { width_px: SIDE_PX, height_px: SIDE_PX, ..scene.image };
            scene.volume.size_voxels = Some(SIZE);
        })?;
        let machine = self.scene.machine(machine)?;
        let mut wires = Wire::ALL.to_vec();
        if !self.wires.is_empty() {
            wires.retain(|wire| self.wires.contains(wire));
        }
        let options = Options { wires, bound_levels: self.bound, bound_deg: self.angle_bound };
        let read = self.scene.read_options()?;
        let case = Case {
            scene: &scene,
            machine: &machine,
            grid: Grid::of_scene(&scene.volume, &read)?,
            runs: Runs::Function,
            reference: true,
            mask: false,
            threads: threads(self.threads)?,
        };
        fits(&case.words_study())?;
        let study = on_threads(self.threads, || {
            let volume = inputs::load_volume(&scene, &machine, &read, false)?;
            let scene = scene.thickened(volume.single);
            let _waiting = Waiting::new("word lengths");
            Ok(study(&scene, &machine, &volume, &options)?)
        })?;
        print(&summary(&study))?;
        let plots = plots(&study)?;
        let mut files: Vec<(&str, Vec<u8>)> = vec![
            ("words.csv", csv(&study)?.into_bytes()),
            ("words.json", json(&study)?.into_bytes()),
            ("words.html", page(&study, &plots).into_bytes()),
            ("front.svg", plots.front.into_bytes()),
            ("wires-wide.svg", plots.wires_wide.into_bytes()),
            ("wires-machine.svg", plots.wires_machine.into_bytes()),
            ("scene.toml", scene.to_toml()?.into_bytes()),
            ("machine.toml", machine.to_toml().into_bytes()),
        ];
        for (name, svg) in [("gradients.svg", plots.gradients), ("thin.svg", plots.thin)] {
            match svg {
                Some(svg) => files.push((name, svg.into_bytes())),
                // One of an earlier study would be taken for this one's.
                None => remove(&out.join(name))?,
            }
        }
        print(&format!("\nwrote {}\n", write_files(out, &files)?.join(" ")))
    }
}
