//! Which samples take part, and their opacity and colour.

use cube3_frame::{Classification, DiscreteRay, EndRegisters, FrameSetup, GradientRows};
use cube3_word::Probe;

/// Whether sample k of a ray takes part by its place alone: it is in the volume, and within every clip.
pub fn in_place(ray: DiscreteRay, k: i64, setup: &FrameSetup) -> bool {
    let at = [ray.u, ray.v, k];
    setup.geometry.has_sample(ray, k) && setup.clips.iter().all(|clip| setup.geometry.evaluate(&clip.distance, at) >= 0)
}

/// The class of the opacity table of sample k of ray (u, v), which is in the volume and within every clip: that of the ray's step length;
/// for the first and the last of such samples of a ray, where ends have parts, that of the part of a step that it stands for.
pub fn opacity_class(at: [i64; 3], setup: &FrameSetup) -> u32 {
    let ray = DiscreteRay { u: at[0], v: at[1] };
    let none_of = |mut depths: std::ops::Range<i64>| setup.ends.is_some() && !depths.any(|k| in_place(ray, k, setup));
    let ends = [none_of(0..at[2]), none_of(at[2] + 1..setup.geometry.size[2] as i64)];
    class_of(ends, at, setup)
}

/// The same for a sample that is known to be the `first` or the `last` of its ray, both or neither.
pub fn class_of([first, last]: [bool; 2], at: [i64; 3], setup: &FrameSetup) -> u32 {
    let step = setup.rays.as_ref().map_or(0, |rays| {
        let [row, column] = setup.geometry.slot_of(DiscreteRay { u: at[0], v: at[1] });
        rays.length_class(row, column)
    });
    match &setup.ends {
        Some(ends) if first || last => {
            let half = 1 << (EndRegisters::REACH_BITS - 1);
            let before = if first { reach(at, true, setup, ends) } else { half };
            let behind = if last { reach(at, false, setup, ends) } else { half };
            end_class(before + behind, last, step, ends)
        }
        _ => step,
    }
}

/// How far a ray reaches from its sample k, towards the eye or away from it, before it is outside of the volume or a clip: steps, a
/// fraction of [`EndRegisters::REACH_BITS`], at most [`EndRegisters::MOST_REACH`].
pub fn reach(at: [i64; 3], towards_eye: bool, setup: &FrameSetup, ends: &EndRegisters) -> u32 {
    let half_spaces = setup.clips.iter().chain(&ends.faces);
    let reaches = half_spaces.map(|half_space| {
        let distance = setup.geometry.evaluate(&half_space.distance, at);
        let step = setup.geometry.step(&half_space.distance, [at[0], at[1]]);
        steps_to(distance, if towards_eye { step } else { -step })
    });
    reaches.min().unwrap_or(EndRegisters::MOST_REACH << EndRegisters::REACH_BITS)
}

/// The steps in which a distance is used up, rounded to nearest; the most there are where it never is. A sample that rounded weights
/// have let out of the volume has none.
pub fn steps_to(distance: i64, step: i64) -> u32 {
    let most = i64::from(EndRegisters::MOST_REACH);
    if step <= 0 || distance >= most * step {
        return EndRegisters::MOST_REACH << EndRegisters::REACH_BITS;
    }
    let twice = (distance.max(0) << (EndRegisters::REACH_BITS + 1)) + step;
    (twice / (2 * step)) as u32
}

/// The table for a part of a step, a fraction of [`EndRegisters::REACH_BITS`], of a ray of a class of step lengths: to the nearest part of
/// the longest step. Between two, the last sample of a ray takes the lower one and another the higher, so that the two ends of a ray
/// which share a step have all of it.
pub fn end_class(part: u32, last: bool, step_class: u32, ends: &EndRegisters) -> u32 {
    let length = part * ends.steps[step_class as usize];
    let bits = EndRegisters::REACH_BITS + EndRegisters::STEP_BITS - EndRegisters::PART_BITS;
    let rounded = (length + (1 << (bits - 1)) - u32::from(last)) >> bits;
    ends.first_class + rounded
}

/// Opacity and colour of a sample word by the tables of a parallel frame; a sample outside of the threshold has none.
pub fn classify(sample: i32, magnitude: u32, table: &Classification) -> Option<(u32, [u32; 3])> {
    classify_in(0, sample, magnitude, table)
}

/// The same with the opacity table of a class of step lengths or of an end.
pub fn classify_in(class: u32, sample: i32, magnitude: u32, table: &Classification) -> Option<(u32, [u32; 3])> {
    classify_wires(class, sample, magnitude, table, &mut ())
}

/// [`classify_in`], and what its wires carry.
pub fn classify_wires(
    class: u32,
    sample: i32,
    magnitude: u32,
    table: &Classification,
    probe: &mut impl Probe,
) -> Option<(u32, [u32; 3])> {
    let [opacity, colour] = TableAddresses::of(table).find(class, sample, magnitude, probe)?;
    Some((table.opacity[opacity], table.colour[colour]))
}

/// Where the classification tables hold what becomes of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableAddresses {
    /// See [`Classification::threshold`].
    pub threshold: [u32; 2],
    /// See [`Classification::index_shift`].
    pub index_shift: u32,
    /// One row where opacity does not depend on the gradient.
    pub rows: GradientRows,
    /// Entries of a row.
    pub entries: usize,
}

impl TableAddresses {
    /// Those of a table.
    pub fn of(table: &Classification) -> TableAddresses {
        TableAddresses {
            threshold: table.threshold,
            index_shift: table.index_shift,
            rows: table.gradient_rows.unwrap_or(GradientRows { shift: 0, rows: 1 }),
            entries: table.colour.len(),
        }
    }

    /// The entries of opacity and of colour; none for a sample outside of the threshold.
    pub fn find(&self, class: u32, sample: i32, magnitude: u32, probe: &mut impl Probe) -> Option<[usize; 2]> {
        let word = sample as u32;
        let visible = (self.threshold[0]..=self.threshold[1]).contains(&word);
        probe.wire("visible", 0, visible.into());
        if !visible {
            return None;
        }
        let index = (word >> self.index_shift) as usize;
        let shifted = magnitude >> self.rows.shift;
        let row = shifted.min(self.rows.rows - 1);
        let entry = (class * self.rows.rows + row) as usize * self.entries + index;
        probe.wire("index", 0, index as i128);
        probe.wire("shifted", 0, shifted.into());
        probe.wire("row", 0, row.into());
        probe.wire("entry", 0, entry as i128);
        Some([entry, index])
    }
}
