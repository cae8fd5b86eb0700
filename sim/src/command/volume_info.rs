//! What `cube3 volume info` says.

use super::run::print;
use crate::problem::Outcome;
use cube3_volume::{FileInfo, Space, Volume, readable};

/// Bars of the histogram.
const BINS: usize = 16;
/// Width of the longest bar, in characters.
const BAR: usize = 40;

/// Prints what a volume is; `about` is its file, of whose series it is volume `time`.
///
/// # Errors
/// A terminal that takes no text.
pub(super) fn info(source: &str, volume: &Volume, about: Option<(&FileInfo, usize)>) -> Outcome<()> {
    let [x, y, z] = volume.dims;
    let [sx, sy, sz] = volume.spacing.map(readable);
    let [ox, oy, oz] = volume.origin.map(readable);
    let mut text = format!("{source}\n  size     {x} × {y} × {z} voxels");
    if let Some((about, time)) = about.filter(|(about, _)| about.volumes > 1) {
        let last = about.volumes - 1;
        text += &format!(
            ", a series of {}: this is volume {time} (--time takes another, 0 to {last}; --frames plays them)",
            about.volumes
        );
    }
    text += &format!("\n  type     {}\n", volume.sample_type());
    if let Some((about, _)) = about {
        text += &axes(volume, about);
    }
    text += &format!("  spacing  {sx} × {sy} × {sz}\n  origin   {ox}, {oy}, {oz}\n");
    if let Some(left) = volume.world.left_over().in_words() {
        text += &format!("  rest     {left}; `cube3 volume resample --straight` takes it away\n");
    }
    for remark in about.iter().flat_map(|(about, _)| &about.remarks) {
        text += &format!("  note     {remark}\n");
    }
    if let Some(place) = volume.first_non_finite() {
        text += &format!("  note     {place}\n");
    }
    let ((low, high), strange) = volume.finite_range();
    if strange < volume.len() as u64 {
        text += &format!("  range    {} to {}\n", readable(low), readable(high));
        if strange > 0 {
            return print(&format!("{text}  strange  {strange} voxels are NaN or infinite; no histogram\n"));
        }
        let histogram = volume.histogram(BINS)?;
        let most = histogram.counts.iter().copied().max().unwrap_or(1).max(1);
        let width = high / BINS as f64 - low / BINS as f64;
        for (bin, &count) in histogram.counts.iter().enumerate() {
            // Logarithmic, or air hides all else.
            let share = (count as f64 + 1.0).ln() / (most as f64 + 1.0).ln();
            let bar = "█".repeat((share * BAR as f64).round() as usize);
            text += &format!("  {:>12}  {bar:<BAR$}  {count}\n", readable(low + bin as f64 * width));
        }
        text += "  bars are logarithmic\n";
    }
    print(&text)
}

/// In which order the voxels are stored and drawn.
fn axes(volume: &Volume, about: &FileInfo) -> String {
    let (stored, drawn) = (volume.world.stored_letters(), volume.world.letters());
    let [i, j, k] = about.stored_dims;
    match about.world.space {
        Space::Patient if about.world.letters() == "RAS" => {
            format!(
                "  axes     stored {stored} ({i} × {j} × {k}), drawn {drawn}: x to the right, y to the front, z up\n"
            )
        }
        Space::Unknown if about.world.taken.is_stored() => "  axes     not said: drawn as stored\n".into(),
        _ => format!("  axes     stored {stored} ({i} × {j} × {k}), drawn {drawn}\n"),
    }
}
