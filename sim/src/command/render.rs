//! `cube3 render`: one picture by any method.

use super::kept::CacheArguments;
use super::run::{keep_inputs, print};
use super::scene::SceneArguments;
use super::{fits, on_threads, threads};
use crate::output::write_files;
use crate::problem::Outcome;
use crate::progress::{Bars, Waiting};
use clap::Args;
use cube3::Runs;
use cube3::memory::{Case, Grid};
use cube3_inputs::load_volume;
use cube3_method::{Choice, Kept, Subject};
use cube3_picture::Rendering;
use cube3_rendering::MethodError;
use cube3_report::{count, png_rgb8, sha256_hex, to_rgb8};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Version of the file's form.
const SCHEMA: u32 = 1;

/// Arguments of `cube3 render`.
#[derive(Debug, Args)]
pub struct RenderArguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// How: a method of `cube3 methods`, its options behind colons as in image-order:0.25.
    #[arg(long, value_name = "NAME[:OPTION]", default_value = "image-order", value_parser = choice)]
    method: Choice,
    #[command(flatten)]
    kept: CacheArguments,
    /// Machine file, or the name of a preset: what function and cycle run, and along whose rays sheared and true are.
    #[arg(long, value_name = "FILE.toml|NAME", default_value = "cube3-128")]
    machine: String,
    /// Run every unit, also those that cannot change the picture.
    #[arg(long)]
    no_plan: bool,
    /// Give voxels that are not finite the word 0, instead of refusing them.
    #[arg(long)]
    mask_non_finite: bool,
    /// Threads; all cores without it.
    #[arg(long)]
    threads: Option<usize>,
    /// Folder for picture and numbers.
    #[arg(long, value_name = "DIR", default_value = "out/render")]
    out: PathBuf,
}

fn choice(text: &str) -> Result<Choice, MethodError> {
    text.parse()
}

impl RenderArguments {
    /// Makes the picture, prints what it took, and writes the files.
    ///
    /// # Errors
    /// What went wrong, in words.
    pub fn execute(self) -> Outcome<()> {
        keep_inputs(self.scene.file(), &self.machine, &self.out)?;
        let scene = self.scene.scene(|_| {})?;
        let machine = self.scene.machine(&self.machine)?;
        self.method.method.check(&scene)?;
        let read = self.scene.read_options()?;
        let grid = Grid::of_scene(&scene.volume, &read)?;
        let threads = threads(self.threads)?;
        // The machine's own run is the larger of the two.
        let runs =
            if self.method.method.about.name == cube3_method::CYCLE.about.name { Runs::Cycle } else { Runs::Function };
        let mask = self.mask_non_finite;
        fits(&Case { scene: &scene, machine: &machine, grid, runs, reference: true, mask, threads }.frame())?;
        let bars = Bars::default();
        let (source, kept) = on_threads(self.threads, || {
            let waiting = Waiting::new("volume");
            let volume = load_volume(&scene, &machine, &read, mask)?;
            drop(waiting);
            let thick = scene.thickened(volume.single);
            let subject = Subject { plan: !self.no_plan, ..Subject::new(&thick, &machine, &volume) };
            let watch = |what: &'static str, done, all| bars.set(what, done, all);
            let kept = match self.kept.cache() {
                Some(cache) => cache.render(&self.method, &subject, &watch)?,
                None => Kept { rendering: self.method.render(&subject, &watch)?, made_s: None, unkept: None },
            };
            Ok((volume.source, kept))
        })?;
        drop(bars);
        print(&summary(&self.method, &source, &kept))?;
        let rendering = kept.rendering;
        let picture = &rendering.picture;
        let rgb = to_rgb8(picture);
        let numbers = json!({
            "schema": SCHEMA,
            "method": self.method.to_string(),
            "source": self.method.method.about.source,
            "volume": source,
            "samples": rendering.samples,
            "bytes": rendering.bytes,
            "phases": phases(&rendering),
            "time_s": rendering.seconds(),
            "made_s": kept.made_s,
            "bound_max": rendering.bound.as_ref().map(|bound| bound.iter().copied().fold(0.0, f64::max)),
            "digest": sha256_hex(&rgb),
        });
        let written = write_files(
            &self.out,
            &[
                ("image.png", png_rgb8(picture.width, picture.height, &rgb)?),
                ("rendering.json", (serde_json::to_string_pretty(&numbers)? + "\n").into_bytes()),
                ("scene.toml", scene.to_toml()?.into_bytes()),
                ("machine.toml", machine.to_toml().into_bytes()),
            ],
        )?;
        print(&format!("wrote {}\n", written.join(" ")))
    }
}

fn phases(rendering: &Rendering) -> Vec<Value> {
    rendering.phases.iter().map(|phase| json!({ "name": phase.name, "time_s": phase.seconds })).collect()
}

fn summary(method: &Choice, source: &str, Kept { rendering, made_s, unkept }: &Kept) -> String {
    let seconds = rendering.seconds();
    let phases: Vec<String> =
        rendering.phases.iter().map(|phase| format!("{} {:.3} s", phase.name, phase.seconds)).collect();
    let picture = &rendering.picture;
    let mut text = format!(
        "{method} of {source}: {} × {} pixels\n{} samples",
        picture.width,
        picture.height,
        count(rendering.samples)
    );
    match made_s {
        Some(made) => text += &format!(", made by an earlier run in {made:.3} s, and kept; read in {seconds:.3} s\n"),
        None => {
            let speed = if seconds > 0.0 { rendering.samples as f64 / seconds / 1e6 } else { 0.0 };
            text += &format!(" in {seconds:.3} s, {speed:.1} M a second ({})\n", phases.join(", "));
        }
    }
    if let Some(bound) = &rendering.bound {
        let most = bound.iter().copied().fold(0.0, f64::max);
        text += &format!("no channel of a pixel is off by more than {most:.2e} of full scale\n");
    }
    if let Some(why) = unkept {
        text += &format!("the picture could not be kept for the next run: {why}\n");
    }
    text
}
