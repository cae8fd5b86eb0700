//! The report's numbers in words, once for both the terminal and the browser.

use cube3_metrics::ImageError;
use serde_json::Value;

use crate::command_line::command_line;
use crate::fact::Fact;
use crate::quantity::{count, number, percentage, prefixed, sizes};
use crate::{
    AxesReport, ErrorReport, OpacityReport, PassReport, ResourcesReport, RunReport, SidesReport, TimingReport,
    TrafficReport, UnitReport, WallReport,
};

/// What the host made of what was asked for, and by what the report was written.
pub(crate) fn derived(report: &RunReport) -> Vec<Fact> {
    let volume = &report.volume;
    let view = &report.view;
    let flips = flipped_axes(view.flips);
    let spacing = volume.spacing.map(number).join(" × ");
    let slopes = view.slopes.map(number).join(", ");
    let mut facts = vec![("Spacing", spacing), ("Voxel words", volume.conversion.clone())];
    facts.extend(volume.axes.iter().map(axes));
    facts.extend(view.sides.iter().map(sides));
    facts.extend([
        ("Major axis", format!("{}, {flips}", view.major_axis)),
        ("Slopes du, dv", slopes),
        ("Sampling", format!("offset {}, {}", number(view.offset), view.template_rule)),
    ]);
    match &view.perspective {
        None => facts.push(("Base plane", format!("{} pixels", sizes(&view.base_plane_size)))),
        Some(perspective) => {
            let eye = perspective.eye_voxel.map(number).join(", ");
            let field = number(perspective.field_of_view_deg);
            facts.push(("Eye", format!("voxel ({eye}), field of view {field}°")));
            facts.extend(perspective.passes.iter().map(|pass| ("Base plane", base_plane(pass))));
        }
    }
    facts.extend(report.words.opacity.iter().map(OpacityReport::fact));
    facts.extend([
        ("Seed", report.seed.to_string()),
        ("Written by", format!("{} {}", report.program.name, report.program.version)),
    ]);
    facts
}

/// What was asked for: machine, volume, scene, view, mode, estimator, runs and the command line.
pub(crate) fn asked(report: &RunReport) -> Vec<Fact> {
    let sources = &report.sources;
    let machine = match (&sources.machine_preset, &sources.machine_file) {
        (Some(preset), _) => Some(format!("preset {preset}")),
        (None, Some(file)) => Some(format!("file {file}")),
        (None, None) => report.machine.get("name").and_then(Value::as_str).map(String::from),
    };
    let volume = format!("{}, {} voxels", report.volume.source, sizes(&report.volume.dims));
    let mode = report.scene.get("mode").and_then(Value::as_str);
    let mut facts = Vec::new();
    facts.extend(machine.map(|machine| ("Machine", machine)));
    facts.push(("Volume", volume));
    facts.extend(sources.scene_file.iter().map(|file| ("Scene", format!("file {file}"))));
    facts.extend(view(&report.scene).map(|view| ("View", view)));
    facts.extend(mode.map(|mode| ("Mode", mode.into())));
    facts.extend(estimator(report).map(|estimator| ("Gradient estimator", estimator)));
    facts.push(("Runs made", report.fidelity.clone()));
    if !report.command.is_empty() {
        facts.push(("Command", command_line(&report.command)));
    }
    facts
}

/// The view of a scene in words.
fn view(scene: &Value) -> Option<String> {
    let view = scene.get("view")?;
    let degrees = |key: &str| view.get(key).and_then(Value::as_f64);
    let mut parts: Vec<String> = [("yaw", "yaw_deg"), ("tilt", "tilt_deg"), ("roll", "roll_deg")]
        .into_iter()
        .filter_map(|(name, key)| Some((name, degrees(key)?)))
        .filter(|&(name, angle)| name != "roll" || angle != 0.0)
        .map(|(name, angle)| format!("{name} {}°", number(angle)))
        .collect();
    if let Some(direction) = view.get("direction").and_then(Value::as_array) {
        let direction: Vec<String> = direction.iter().filter_map(Value::as_f64).map(number).collect();
        parts.push(format!("along ({})", direction.join(", ")));
    }
    let field = view.pointer("/perspective/field_of_view_deg").and_then(Value::as_f64);
    parts.push(field.map_or("parallel".into(), |field| format!("perspective of {}°", number(field))));
    Some(parts.join(", "))
}

/// The machine's gradient estimator, and whether the plan left it out.
fn estimator(report: &RunReport) -> Option<String> {
    let name = report.machine.pointer("/abc/gradient")?.as_str()?;
    let unit = report.plan.left_out.iter().find(|item| item.rule == GRADIENT_UNIT);
    Some(unit.map_or(name.into(), |unit| format!("{name}; left out here: {}", unit.why)))
}

/// The rule that leaves out the gradient unit.
const GRADIENT_UNIT: &str = "gradient-unit";

/// How the file's axes became those of the frame buffer.
fn axes(axes: &AxesReport) -> Fact {
    let mut text = format!("stored {}, drawn {}", axes.stored, axes.drawn);
    for (angle, what) in [(axes.turned_deg, "turned by"), (axes.slanted_deg, "slanted by")] {
        if angle >= 0.01 {
            text += &format!(", {what} {}°", number(angle));
        }
    }
    ("Axes", text)
}

/// Which side of the picture is which.
fn sides(sides: &SidesReport) -> Fact {
    let SidesReport { left, right, top, bottom, front } = sides;
    ("Sides", format!("{left} on the left, {right} on the right, {top} above, {bottom} below, {front} towards the eye"))
}

/// The base plane of a pass, and how well its rays cover the volume.
fn base_plane(pass: &PassReport) -> String {
    let cells = if pass.own_cells { ", slots with their own cells" } else { "" };
    format!(
        "{}, {} pixels{cells}; rays {} voxels apart behind, {} of the voxels unused, cells of at most {}",
        pass.axis,
        sizes(&pass.base_plane_size),
        number(pass.back_spacing_voxel),
        percentage(pass.unused_voxel_fraction),
        pass.widest_cell_voxel,
    )
}

/// What the machine did with its time.
pub(crate) fn timing(timing: &TimingReport) -> Vec<Fact> {
    let beams = count(timing.beams);
    let slots = count(timing.ray_slots);
    vec![
        ("Cycles", format!("{}, {} of them to fill", count(timing.cycles), count(timing.fill_cycles))),
        ("Clock", prefixed(timing.clock_hz, "Hz")),
        ("Frame time", prefixed(timing.frame_time_s, "s")),
        ("Frames per second", format!("{}, in an animation {}", number(timing.fps), number(timing.fps_sustained))),
        ("Frame interval", format!("{} cycles", count(timing.frame_interval_cycles))),
        ("Beams", format!("{beams} in {slots} ray slots")),
        ("Samples", count(timing.samples)),
        ("Samples per second", prefixed(timing.samples_per_s, "samples/s")),
    ]
}

/// What the machine is made of, in sums.
pub(crate) fn resources(resources: &ResourcesReport) -> Vec<Fact> {
    let total = &resources.total;
    let bits: u64 = resources.memory.iter().map(|memory| memory.bits).sum();
    let mut facts = vec![
        ("Multipliers", count(total.multipliers)),
        ("Adders", count(total.adders)),
        ("Comparators", count(total.comparators)),
    ];
    if total.dividers > 0 {
        facts.push(("Dividers", count(total.dividers)));
    }
    facts.push(("Memory", prefixed(bits as f64, "bits")));
    facts.push(("Frames per second for each GB/s of memory", number(resources.fps_per_memory_gb_per_s)));
    facts.push(("Samples per second for each multiplier", prefixed(resources.samples_per_s_per_multiplier, "")));
    facts
}

/// What went through memory, bus, links and host's port.
pub(crate) fn traffic(traffic: &TrafficReport) -> Vec<Fact> {
    let mut facts = Vec::new();
    if let Some(memory) = &traffic.memory {
        let (hits, reads) = (memory.row_hits, memory.reads.max(1));
        let open = percentage(hits as f64 / reads as f64);
        facts.push(("Memory", format!("{} words in {} reads", count(memory.words), count(memory.reads))));
        facts.push(("Rows", format!("{open} of the reads found theirs open")));
        facts.push(("Refreshes", count(memory.refreshes)));
    }
    if let Some(buffer) = &traffic.reorder {
        let (peak, words) = (count(buffer.peak_words), count(buffer.words));
        let rows = format!("{} mini-blocks in {} rows", count(buffer.mini_blocks), count(buffer.rows));
        facts.push(("Reorder buffer", format!("{rows}, at most {peak} words of {words}")));
    }
    let used = traffic.bus_words as f64 / traffic.bus_slots.max(1) as f64;
    facts.push(("Bus", format!("{} words, {} of what it can", count(traffic.bus_words), percentage(used))));
    if traffic.link_words > 0 {
        let (all, peak) = (count(traffic.link_words), count(traffic.link_peak_words));
        facts.push(("Links", format!("{all} words of beams, at most {peak} of a beam over one")));
    }
    if let Some(link) = traffic.links.iter().rev().max_by_key(|link| link.words) {
        let (words, queued) = (count(link.words), count(link.peak_words));
        let busy = link.slots.map_or_else(String::new, |slots| {
            let part = percentage(link.words as f64 / slots.max(1) as f64);
            format!(", {part} of what it can, at most {queued} queued")
        });
        facts.push(("Busiest link", format!("{}, {}: {words} words{busy}", link.link, link.direction)));
    }
    facts.push((
        "Host",
        format!("{} pixels, {}", count(traffic.host_pixels), prefixed(traffic.host_bytes as f64, "bytes")),
    ));
    facts
}

/// Each measure of the error, over the whole image and over the object alone; none where there was nothing to measure.
pub(crate) fn errors(error: &ErrorReport) -> Vec<(&'static str, [String; 2])> {
    let (Some(whole), Some(object)) = (&error.whole, &error.footprint.error) else {
        return Vec::new();
    };
    let both = |text: fn(&ImageError) -> String| [text(whole), text(object)];
    let mut rows = vec![
        ("Mean relative RGB distance", both(|e| percentage(e.mean_relative))),
        ("99th percentile of that", both(|e| percentage(e.percentile_99))),
        ("Largest, of a channel", both(|e| percentage(e.max))),
        ("Bias, picture less reference", both(|e| percentage(e.bias))),
        ("RMS", both(|e| percentage(e.rms))),
        ("PSNR", both(|e| psnr(e.psnr_db))),
        ("Pixels off by more than 1/255", both(|e| percentage(e.fraction_off))),
    ];
    if let Some(own) = &error.reference {
        // Without a bound it was held against itself at half its step.
        let what = if own.against_bound.is_some() {
            "The reference's own, to the converged integral"
        } else {
            "The reference's own, at half its step"
        };
        rows.push((what, [String::new(), percentage(own.error.mean_relative)]));
    }
    if let Some(bound) = error.reference_bound {
        rows.push(("The reference's own, at most, of a channel", [percentage(bound), String::new()]));
    }
    if let Some(angle) = error.gradient_mean_deg {
        rows.push(("Mean gradient angle", [String::new(), format!("{}°", number(angle))]));
    }
    rows
}

/// Peak signal-to-noise ratio in words.
pub(crate) fn psnr(psnr_db: Option<f64>) -> String {
    psnr_db.map_or("∞, equal".into(), |decibels| format!("{} dB", number(decibels)))
}

/// How long the simulation took. Nothing for what was not run.
pub(crate) fn wall(wall: &WallReport) -> Vec<Fact> {
    let seconds = |value: Option<f64>| value.map(|value| prefixed(value, "s"));
    [
        ("Making or reading the volume", seconds(wall.volume_s)),
        ("Timing run", seconds(wall.timing_s)),
        ("Function run", seconds(wall.function_s)),
        ("Cycle run", seconds(wall.cycle_s)),
        ("Reference", seconds(wall.reference_s)),
        ("All together", seconds(wall.total_s)),
        ("Function run's rate", wall.samples_per_s.map(|rate| prefixed(rate, "samples/s"))),
        ("Threads", wall.threads.map(|threads| threads.to_string())),
    ]
    .into_iter()
    .filter_map(|(what, value)| Some((what, value?)))
    .collect()
}

/// One kind of cycles of a unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct CycleShare<'a> {
    pub(crate) kind: CycleKind,
    /// The kind's name, or the reason to wait.
    pub(crate) name: &'a str,
    pub(crate) cycles: u64,
    pub(crate) thousandths: u32,
}

/// What a cycle of a unit goes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CycleKind {
    Busy,
    Starved,
    Blocked,
    Waiting,
}

/// The unit's cycles by kind, each reason to wait on its own; the shares add up to 1000 thousandths.
pub(crate) fn cycle_shares(unit: &UnitReport) -> Vec<CycleShare<'_>> {
    let kinds = [
        (CycleKind::Busy, "busy", unit.busy),
        (CycleKind::Starved, "starved", unit.starved),
        (CycleKind::Blocked, "blocked", unit.blocked),
    ];
    let reasons = unit.waiting.iter();
    let reasons = reasons.map(|(reason, &cycles)| (CycleKind::Waiting, reason.as_str(), cycles));
    let parts: Vec<_> = kinds.into_iter().chain(reasons).collect();
    let cycles: Vec<u64> = parts.iter().map(|part| part.2).collect();
    let shares = crate::shares::thousandths(&cycles);
    let parts = parts.into_iter().zip(shares);
    parts.map(|((kind, name, cycles), thousandths)| CycleShare { kind, name, cycles, thousandths }).collect()
}

/// A name for the page: the scene's or else the volume's.
pub(crate) fn subject(report: &RunReport) -> &str {
    let name = report.scene.get("name").and_then(Value::as_str);
    name.unwrap_or(&report.volume.source)
}

fn flipped_axes(flips: [bool; 3]) -> String {
    let flipped: Vec<&str> =
        ["x", "y", "z"].into_iter().zip(flips).filter_map(|(axis, flip)| flip.then_some(axis)).collect();
    if flipped.is_empty() { "no axis flipped".into() } else { format!("flipped {}", flipped.join(", ")) }
}
