//! What a person should know of a run, in sentences: that the tables are not the scene, that the words are crowded, why nothing is
//! visible.

use crate::crowded_words::{Crowding, crowding};
use crate::opacity_check::{CheckedFrame, OpacityCheck, is_worth_a_note};
use cube3_frame::{BasePlane, FrameSetup};
use cube3_host::PictureFrames;
use cube3_inputs::LoadedVolume;
use cube3_machine::MachineSpec;
use cube3_report::{OpacityReport, count, number, percentage};
use cube3_scene::{Mode, Scene};
use cube3_word::unit_resize;

/// What was found out about volume, scene and tables before anything ran.
pub(crate) struct Findings<'a> {
    scene: &'a Scene,
    machine: &'a MachineSpec,
    volume: &'a LoadedVolume,
    /// The first frame of the picture, that of the view's direction.
    setup: Option<&'a FrameSetup>,
    /// Voxels by word.
    counts: Vec<u64>,
    check: Option<OpacityCheck>,
    crowding: Option<Crowding>,
}

impl<'a> Findings<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        machine: &'a MachineSpec,
        volume: &'a LoadedVolume,
        frames: &'a PictureFrames,
    ) -> Findings<'a> {
        let counts = volume.words.counts();
        let setup = frames.setups.first().map(AsRef::as_ref);
        let check = setup.map(|setup| CheckedFrame { scene, machine, volume, setup, counts: &counts }.check());
        let crowding = crowding(volume, &counts);
        Findings { scene, machine, volume, setup, counts, check, crowding }
    }

    /// The opacity table's part of the report. None in modes that show a single sample of a ray: its opacity is rounded once, and
    /// summed with nothing.
    pub(crate) fn opacity(&self) -> Option<OpacityReport> {
        let summed = !matches!(self.scene.mode, Mode::Maximum | Mode::Minimum);
        self.check.as_ref().filter(|_| summed).map(|check| check.report)
    }

    /// The notes on a run that gave these base planes, where it gave any, of so many samples.
    pub(crate) fn notes(&self, bases: Option<&[BasePlane]>, samples: u64) -> Vec<String> {
        let visible = |bases: &[BasePlane]| bases.iter().flat_map(|base| &base.pixels).any(|pixel| pixel[3] > 0);
        if bases.is_some_and(|bases| !visible(bases)) {
            return vec![format!("nothing is visible: {}", self.why_nothing(samples))];
        }
        let crowded = self.crowding.map(|crowding| self.crowded(crowding));
        crowded.into_iter().chain(self.table()).collect()
    }

    /// Where the opacity table is not the scene's.
    fn table(&self) -> Option<String> {
        let report = self.opacity()?;
        let rounding = is_worth_a_note(&report.rounding).then(|| self.rounding()).flatten();
        // Crowded words have their own note, and the same remedy.
        let narrow = is_worth_a_note(&report.entries) && self.crowding.is_none();
        let entries = narrow.then(|| self.entries()).flatten();
        let parts: Vec<String> = rounding.into_iter().chain(entries).collect();
        (!parts.is_empty()).then(|| parts.join("; "))
    }

    /// What the word of an opacity does.
    fn rounding(&self) -> Option<String> {
        let (check, frame) = (self.check.as_ref()?, self.frame()?);
        let (report, words) = (&check.report, &frame.setup.words);
        let [real, held] = check.rounded.map(number);
        let bits = words.opacity_bits.min(words.accumulator_bits);
        let remedy = match frame.words_that_hold() {
            None => "no words.opacity_bits holds it: the longest is 16".into(),
            Some(better) => {
                let keys = [
                    ("words.opacity_bits", words.opacity_bits, better.opacity_bits),
                    ("words.accumulator_bits", words.accumulator_bits, better.accumulator_bits),
                ];
                let longer = keys.iter().filter(|(_, now, then)| then > now);
                let longer: Vec<String> = longer.map(|(key, _, bits)| format!("{key} = {bits}")).collect();
                format!("{} in the machine file holds it", longer.join(" and "))
            }
        };
        let share = percentage(report.rounding.fraction);
        Some(match self.scene.mode {
            Mode::FirstOpaque | Mode::LastOpaque => format!(
                "{share} of the voxels are opaque in the scene and not in the table, or the other way round, in words of {bits} bits; {remedy}"
            ),
            _ => format!(
                "opacities of {share} of the voxels are off by more than a tenth in words of {bits} bits: {real} becomes {held}; {remedy}"
            ),
        })
    }

    /// What the width of the table's entries does.
    fn entries(&self) -> Option<String> {
        let (check, frame) = (self.check.as_ref()?, self.frame()?);
        let report = &check.report;
        let [value, real, centre] = check.misplaced.map(number);
        let now = frame.setup.words.table_bits;
        let remedy = match frame.table_bits_that_hold() {
            Some(bits) if self.scene.volume.labels => {
                format!("words.table_bits = {bits} in the machine file tells these labels apart")
            }
            Some(bits) => format!(
                "words.table_bits = {bits} in the machine file, or a narrower volume.window in the scene, tells them apart"
            ),
            None if self.scene.volume.labels => "no words.table_bits tells these labels apart: number them anew".into(),
            None => "a narrower volume.window in the scene tells them apart".into(),
        };
        Some(format!(
            "a table entry covers {} values (words.table_bits = {now}), and the transfer function changes within: {} of the voxels have the \
             opacity of another value, as {value} that of {centre} instead of {real}; {remedy}",
            number(report.entry_width),
            percentage(report.entries.fraction)
        ))
    }

    /// What far values do to the rest.
    fn crowded(&self, Crowding { voxels, words, values }: Crowding) -> String {
        let total: u64 = self.counts.iter().sum();
        let [least, greatest] = values.map(number);
        let [low, high] = self.volume.words.window.map(number);
        let shared = if words == 1 { "1 voxel word".into() } else { format!("{words} voxel words") };
        format!(
            "all but {} of {} voxels have values from {least} to {greatest} and share {shared} of {}, since the words reach from {low} to \
             {high}; volume.window = [{least}, {greatest}] in the scene gives them all words",
            count(total - voxels),
            count(total),
            count(self.counts.len() as u64)
        )
    }

    fn frame(&self) -> Option<CheckedFrame<'_>> {
        let &Findings { scene, machine, volume, setup, .. } = self;
        setup.map(|setup| CheckedFrame { scene, machine, volume, setup, counts: &self.counts })
    }

    /// Why a picture is empty: the first reason on the way from the volume to the picture.
    fn why_nothing(&self, samples: u64) -> String {
        let scene = self.scene;
        let Some(setup) = self.setup.filter(|_| samples > 0) else {
            return match scene.view.perspective {
                Some(_) => "no ray from this eye meets the volume; turn the view, or move the eye".into(),
                None => {
                    "the volume has no sample in this view; try another view, or rays.offset = 0 in the machine file"
                        .into()
                }
            };
        };
        let surface = matches!(scene.mode, Mode::FirstOpaque | Mode::LastOpaque);
        let opaque = scene.transfer.opaque_alpha;
        let shows = |opacity: f64| if surface { opacity >= opaque } else { opacity > 0.0 };
        let Some([from, to]) = extent(scene, shows) else {
            return match surface {
                true => {
                    format!("the transfer function's opacity is nowhere transfer.opaque_alpha = {}", number(opaque))
                }
                false => "the transfer function is transparent everywhere".into(),
            };
        };
        let left = self.words_left(setup);
        if !left.contains(&true) {
            return self.why_no_word(shows, [from, to]);
        }
        if !self.any_within(&left) {
            return self.why_cut();
        }
        let voxels: u64 = self.counts.iter().zip(&left).filter(|(_, left)| **left).map(|(count, _)| count).sum();
        let share = percentage(voxels as f64 / self.counts.iter().sum::<u64>() as f64);
        match scene.mode {
            _ if scene.view.perspective.is_some() => {
                format!(
                    "{share} of the voxels have a value that is shown, and no ray of this eye meets them; turn the view, or move the eye"
                )
            }
            Mode::Maximum => "the largest value of each ray is transparent".into(),
            Mode::Minimum => "the smallest value of each ray is transparent".into(),
            Mode::WeightedSum => format!(
                "{share} of the voxels have an opacity, but no ray's mean of it fills half a word; words.accumulator_bits = {} in the machine \
                 file can be raised to 32",
                setup.words.accumulator_bits
            ),
            _ if scene.transfer.is_two_dimensional() => {
                "no sample has a value and a gradient that the transfer function shows".into()
            }
            _ if scene.crop.as_ref().is_some_and(|crop| (0..3).any(|i| crop.min_voxel[i] == crop.max_voxel[i])) => {
                "the crop box has no thickness".into()
            }
            _ => format!(
                "{share} of the voxels have a value that is shown, but the samples, between voxels, have other values; rays.offset = 0 in \
                 the machine file puts them on planes of voxels"
            ),
        }
    }

    /// Why no voxel's word has an opacity in the table: the scene, the crowded words, the threshold, or the table.
    fn why_no_word(&self, shows: impl Fn(f64) -> bool, [from, to]: [f64; 2]) -> String {
        if let Some(check) = self.check.as_ref().filter(|check| check.report.lost_fraction > 0.0) {
            let by_rounding = check.report.rounding.fraction >= check.report.entries.fraction;
            let why = if by_rounding { self.rounding() } else { self.entries() };
            return why.unwrap_or_default();
        }
        let scene = self.scene;
        if let Some(crowding) = self.crowding.filter(|crowding| crowding.values[1] >= from && crowding.values[0] <= to)
        {
            return self.crowded(crowding);
        }
        let occurs =
            |(word, _): (usize, &u64)| shows(scene.transfer.opacity_at(self.volume.words.value_of(word as f64), 0.0));
        if scene.threshold.is_some() && self.counts.iter().enumerate().filter(|(_, n)| **n > 0).any(occurs) {
            return "the threshold removes all voxels that the transfer function shows".into();
        }
        let [low, high] = self.volume.words.window.map(number);
        let range = match [from, to].map(|bound| bound.is_finite().then(|| number(bound))) {
            [Some(from), Some(to)] => format!("only within {from} to {to}"),
            [Some(from), None] => format!("only from {from} on"),
            [None, Some(to)] => format!("only up to {to}"),
            [None, None] => "somewhere".into(),
        };
        let what =
            if matches!(scene.mode, Mode::FirstOpaque | Mode::LastOpaque) { "is opaque" } else { "shows something" };
        format!(
            "no voxel has a value that is shown: data values are {low} to {high}, and the transfer function {what} {range}"
        )
    }

    /// Words that voxels have and for which the table has an opacity that comes through.
    fn words_left(&self, setup: &FrameSetup) -> Vec<bool> {
        let (table, words) = (&setup.classification, &setup.words);
        let shows = |word: u32| match self.scene.mode {
            Mode::FirstOpaque | Mode::LastOpaque => word >= setup.cone.opaque,
            _ => unit_resize(word, words.opacity_bits, words.accumulator_bits) > 0,
        };
        let left = |(word, &count): (usize, &u64)| {
            let sample = (word as u32) << words.sample_fraction_bits;
            let index = (sample >> table.index_shift) as usize;
            let mut entries = table.opacity.iter().skip(index).step_by(table.colour.len());
            count > 0 && (table.threshold[0]..=table.threshold[1]).contains(&sample) && entries.any(|&word| shows(word))
        };
        self.counts.iter().enumerate().map(left).collect()
    }

    /// Whether a voxel with one of these words is left by cut planes and crop box.
    fn any_within(&self, left: &[bool]) -> bool {
        let words = &self.volume.words;
        let [nx, ny, _] = words.dims;
        let within = |index: usize| {
            let at = [index % nx, index / nx % ny, index / nx / ny].map(|i| i as f64);
            !self.scene.cuts.iter().any(|cut| cut.removes(at))
                && !self.scene.crop.as_ref().is_some_and(|crop| crop.removes(at))
        };
        words.words.iter().enumerate().any(|(index, &word)| left[usize::from(word)] && within(index))
    }

    /// What has removed all that is shown.
    fn why_cut(&self) -> String {
        let dims = self.volume.words.dims;
        let outside =
            self.scene.crop.as_ref().is_some_and(|crop| {
                (0..3).any(|i| crop.max_voxel[i] < 0.0 || crop.min_voxel[i] > (dims[i] - 1) as f64)
            });
        if outside {
            let last = dims.map(|n| n - 1);
            return format!("the crop box lies outside of the volume, whose voxels are [0, 0, 0] to {last:?}");
        }
        let what = match (&self.scene.crop, self.scene.cuts.as_slice()) {
            (Some(_), []) => "the crop box leaves",
            (None, _) => "the cut planes leave",
            (Some(_), _) => "the crop box and the cut planes leave",
        };
        format!("{what} no voxel that the transfer function shows")
    }
}

/// The values from the first to the last that a scene's transfer function shows; without an end where it does so beyond all points.
fn extent(scene: &Scene, shows: impl Fn(f64) -> bool) -> Option<[f64; 2]> {
    let transfer = &scene.transfer;
    let functions = std::iter::once(&transfer.opacity).chain(transfer.layers.iter().map(|layer| &layer.opacity));
    let extents = functions.filter_map(|points| {
        let first = points.iter().position(|point| shows(point[1]))?;
        let last = points.iter().rposition(|point| shows(point[1]))?;
        let from = if first == 0 { f64::NEG_INFINITY } else { points[first - 1][0] };
        let to = points.get(last + 1).map_or(f64::INFINITY, |point| point[0]);
        Some([from, to])
    });
    extents.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}
