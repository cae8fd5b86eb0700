//! Rows of mini-blocks along the beams of a frame: which beams use one, and so how many words the reorder buffer holds.
//!
//! The beam of plane i at depth k is row v of the voxels of plane w = k, and lies in the row (⌊y/2⌋, ⌊z/2⌋) of mini-blocks, y and z its voxels'
//! coordinates along the axes of v and w. Another row of voxels at the same depth, and both at the depth beside it, lie there too. From
//! plane to plane the row of voxels at a depth moves by one, so that a row of mini-blocks is used in two or three planes that follow each
//! other; where planes wrap round, some are used in the first planes and again in the last. A row stays in the buffer as long as the same
//! plane or the next one uses it again.

use crate::golden::Placement;
use crate::unit::{CfbSpec, row};
use cube3_host::{Geometry, LookAheadUnit, MachineSpec, MemoryModel};

/// The mini-block, along the axis behind v (1) or w (2), of a row or depth.
fn mini(geometry: &Geometry, axis: usize, coordinate: usize) -> usize {
    let Geometry { axes, size, .. } = geometry;
    let voxel = if axes.reversed[axis] { size[axis] - 1 - coordinate } else { coordinate };
    voxel / Placement::MINI
}

/// Mini-blocks of a row.
pub(super) fn row_minis(geometry: &Geometry) -> usize {
    geometry.size[0].div_ceil(Placement::MINI)
}

/// Which mini-block along its axis is number `number` of a row, in the order of u.
pub(super) fn along(geometry: &Geometry, number: usize) -> usize {
    if geometry.axes.reversed[0] { row_minis(geometry) - 1 - number } else { number }
}

/// The number within its row, in the order of u, of the mini-block that voxel u is in.
pub(super) fn number(geometry: &Geometry, u: usize) -> usize {
    along(geometry, mini(geometry, 0, u))
}

/// Words of a row.
pub(super) fn row_words(geometry: &Geometry) -> u64 {
    (row_minis(geometry) * Placement::MINI_WORDS) as u64
}

/// The mini-blocks along w that a depth is in.
pub(super) fn pair(geometry: &Geometry, depth: u32) -> usize {
    mini(geometry, 2, depth as usize)
}

/// The depth that is in the same mini-blocks.
fn partner(geometry: &Geometry, depth: u32) -> Option<u32> {
    let beside = [depth.checked_sub(1), Some(depth + 1).filter(|&depth| (depth as usize) < geometry.size[2])];
    beside.into_iter().flatten().find(|&beside| pair(geometry, beside) == pair(geometry, depth))
}

/// The mini-blocks along v that a row of voxels is in.
pub(super) fn of_voxels(geometry: &Geometry, v: usize) -> usize {
    mini(geometry, 1, v)
}

/// The rows of mini-blocks that the beam of a plane at a depth uses, in the order in which it does: none where it is outside of the
/// volume, two where slots need their own cells and these lie in both.
pub(super) fn used(geometry: &Geometry, plane: u32, depth: u32) -> [Option<usize>; 2] {
    let Some(near) = row(geometry, plane, depth) else {
        return [None; 2];
    };
    let near = of_voxels(geometry, near as usize);
    let below = if geometry.doubled() { geometry.row_below(plane as usize, depth as usize) } else { None };
    [Some(near), below.map(|v| of_voxels(geometry, v)).filter(|&below| below != near)]
}

/// Whether the beam of a plane at a depth, which uses row `j`, is the first to do so since the row was last in the buffer.
pub(super) fn is_first(geometry: &Geometry, plane: u32, depth: u32, j: usize) -> bool {
    let partner = partner(geometry, depth);
    let uses = |plane, depth| used(geometry, plane, depth).contains(&Some(j));
    let before = partner.is_some_and(|partner| partner < depth && uses(plane, partner));
    let beside = plane
        .checked_sub(1)
        .is_some_and(|above| uses(above, depth) || partner.is_some_and(|partner| uses(above, partner)));
    !before && !beside
}

/// Whether it is the last one before the row leaves the buffer.
pub(super) fn is_last(geometry: &Geometry, plane: u32, depth: u32, j: usize) -> bool {
    let partner = partner(geometry, depth);
    let uses = |plane, depth| used(geometry, plane, depth).contains(&Some(j));
    let behind = partner.is_some_and(|partner| partner > depth && uses(plane, partner));
    let below = plane + 1;
    let beside = (below as usize) < geometry.slot_counts()[1]
        && (uses(below, depth) || partner.is_some_and(|partner| uses(below, partner)));
    !behind && !beside
}

/// What a frame needs of the reorder buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReorderNeed {
    /// Words of the rows that some beam finds in the buffer together: with fewer it would wait for ever.
    pub least: u64,
    /// Words that let the modules read at one rate throughout the frame, as late as each beam allows; and the words that they are asked for
    /// ahead, and two rows more.
    pub steady: u64,
    /// Rows of mini-blocks that are read, some twice.
    pub rows: u64,
    /// Words that are read.
    pub words: u64,
}

impl ReorderNeed {
    /// The need of a frame on a machine.
    ///
    /// With N(t) rows asked for first by the beams up to beam t, R(t) rows left behind by those before it, and the beam from cycle s(t) to
    /// e(t) of T: reading N(T) rows at one rate, row N(t) has to be there at s(t), so the reading begins at the least of s(t) − T·N(t)/N(T)
    /// at the latest, and at e(t) the buffer holds what has been read until then less R(t).
    pub fn new(machine: &MachineSpec, geometry: &Geometry) -> ReorderNeed {
        let spec = CfbSpec::new(machine, geometry);
        let [planes, depths] = [geometry.slot_counts()[1], geometry.size[2]].map(|n| n as u32);
        let (mut cycle, mut asked, mut left, mut least) = (0, 0_u64, 0_u64, 0);
        let (mut starts, mut ends) = (Vec::new(), Vec::new());
        for plane in 0..planes {
            for depth in 0..depths {
                let rows = used(geometry, plane, depth).into_iter().flatten();
                let (before, mut leave) = (asked, 0);
                for j in rows {
                    asked += u64::from(is_first(geometry, plane, depth, j));
                    leave += u64::from(is_last(geometry, plane, depth, j));
                }
                least = least.max(asked - left);
                if asked > before {
                    starts.push([cycle, asked]);
                }
                cycle += spec.cycles(row(geometry, plane, depth));
                if leave > 0 {
                    ends.push([cycle, left]);
                    left += leave;
                }
            }
        }
        // In rows · cycles.
        let ahead = |[at, rows]: [u64; 2]| i128::from(asked) * i128::from(at) - i128::from(cycle) * i128::from(rows);
        let begin = starts.into_iter().map(ahead).min().unwrap_or(0);
        let most = ends.into_iter().map(ahead).max().unwrap_or(0);
        let held = ((most - begin) as u64).div_ceil(cycle.max(1));
        let words = row_words(geometry);
        let model = MemoryModel::of_machine(&machine.cfb);
        let burst = model.burst.min(Placement::MINI_WORDS);
        let bursts = match machine.cfb.look_ahead_unit {
            LookAheadUnit::Words => model.look_ahead.div_ceil(burst),
            LookAheadUnit::Bursts => model.look_ahead,
        };
        let outstanding = bursts * burst * machine.lanes;
        ReorderNeed {
            least: least * words,
            steady: (held.max(least) + 2) * words + outstanding as u64,
            rows: asked,
            words: asked * words,
        }
    }
}
