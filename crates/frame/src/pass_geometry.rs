//! The geometry of a pass, by its eye.

use crate::fan::{Fan, FanRays, FanShape};
use crate::perspective::{MARGIN, OVERLAP, PassShape, PerspectivePass, reach};
use crate::{Geometry, SLOPE_FRACTION_BITS, Template};
use cube3_machine::{RaySlots, TemplateRule};

impl Geometry {
    /// The geometry of a perspective pass; `None` where none of its rays meets a voxel.
    pub fn perspective(shape: &PassShape) -> Option<Geometry> {
        let [nu, nv, depths] = shape.size;
        let [eye_u, eye_v, eye_w] = shape.eye;
        // On the eye's own plane all rays are at one place, and nothing there has a gradient.
        let first_depth = (eye_w.floor() + 1.0).max(0.0);
        if first_depth >= depths as f64 {
            return None;
        }
        let first_depth = first_depth as usize;
        let (distance, plane) = grid(eye_w, shape.grid * depths as f64);
        let along = [eye_w, distance, plane];
        let doubled = plane != 0.0;
        let most_reach = reach((first_depth as f64 - eye_w) / distance, shape.reach);
        let overlap = if doubled && shape.joins { (distance * OVERLAP).floor() } else { 0.0 };
        let margin = MARGIN + f64::from(most_reach) + overlap;
        let planes = [first_depth, depths];
        let (along_u, along_v) = (rays(eye_u, along, planes, nu, margin), rays(eye_v, along, planes, nv, margin));
        let steepest = along_u.slopes.iter().chain(&along_v.slopes).map(|slope| slope.abs()).max().unwrap_or(0);
        let offset = shape.offset.min(largest_offset(shape.rule, steepest, shape.weight_bits));
        let fans = FanShape { first_depth, depths, offset, weight_bits: shape.weight_bits, rule: shape.rule };
        let spacing = if plane == 0.0 && first_depth == 0 { 1.0 } else { (first_depth as f64 - eye_w) / distance };
        let empty = || Template { columns: Vec::new(), weights: Vec::new() };
        Some(Geometry {
            size: shape.size,
            axes: shape.axes,
            slopes: [0; 2],
            offset,
            weight_bits: shape.weight_bits,
            rule: shape.rule,
            slots: RaySlots::Padded,
            u: empty(),
            v: empty(),
            perspective: Some(PerspectivePass {
                u: Fan::new(along_u, &fans, nu)?,
                v: Fan::new(along_v, &fans, nv)?,
                first_depth,
                grid_plane: register(plane),
                spacing: [register(spacing), register(1.0 / distance)],
                doubled,
                most_reach,
                overlap: overlap as u32,
            }),
        })
    }

    /// What the fans of a perspective pass are made with.
    pub fn fan_shape(&self) -> FanShape {
        FanShape {
            first_depth: self.perspective.as_ref().map_or(0, |pass| pass.first_depth),
            depths: self.size[2],
            offset: self.offset,
            weight_bits: self.weight_bits,
            rule: self.rule,
        }
    }
}

/// The largest legal offset for rays up to a slope: equation (3), and none where a ray is at 45° or steeper.
pub(crate) fn largest_offset(rule: TemplateRule, steepest: i64, weight_bits: u32) -> u32 {
    let steepest = steepest.min(1 << SLOPE_FRACTION_BITS) as u32;
    crate::largest_offset(rule, [steepest; 2], weight_bits)
}

/// The distance of the grid plane from the eye, and its w: the base plane, or where the eye is nearer than `least`, that far behind it.
///
/// A plane that no register tells from the base plane is the base plane.
fn grid(eye_w: f64, least: f64) -> (f64, f64) {
    if -eye_w >= least || register(eye_w + least) == 0 { (-eye_w, 0.0) } else { (least, eye_w + least) }
}

fn register(x: f64) -> i64 {
    (x * f64::from(1_u32 << SLOPE_FRACTION_BITS)).round() as i64
}

/// Rays along one axis from an eye at `eye`, `distance` from the grid plane at `plane`.
fn rays(
    eye: f64,
    [eye_w, distance, plane]: [f64; 3],
    [first_depth, depths]: [usize; 2],
    columns: usize,
    margin: f64,
) -> FanRays {
    // The ray that is at x on plane k crosses the grid at x + (x − e)·(1/m − 1).
    let crossing = |x: f64, k: f64| {
        let behind = k - eye_w;
        if behind > 0.0 {
            x + (x - eye) * ((plane - k) / behind)
        } else if x > eye {
            f64::INFINITY
        } else {
            f64::NEG_INFINITY
        }
    };
    let ends = [first_depth as f64, depths as f64];
    let [low, high] = [-1.0, columns as f64 + 1.0];
    let meets = [
        ends.map(|k| crossing(low, k)).into_iter().fold(f64::INFINITY, f64::min),
        ends.map(|k| crossing(high, k)).into_iter().fold(f64::NEG_INFINITY, f64::max),
    ];
    let steep = [eye - distance - margin, eye + distance + margin];
    let first = meets[0].max(steep[0]).floor();
    let last = meets[1].min(steep[1]).ceil();
    let count = if last >= first { (last - first) as usize + 1 } else { 0 };
    let first_spacing = (first_depth as f64 - eye_w) / distance;
    let from_base = plane == 0.0 && first_depth == 0;
    let start = |g: f64| if from_base { g } else { eye + (g - eye) * first_spacing };
    // One more than the fan has: the last one's neighbour.
    let places = (0..=count).map(|i| first + i as f64);
    FanRays {
        first: first as i64,
        starts: places.clone().map(|g| register(start(g))).collect(),
        slopes: places.map(|g| register((g - eye) / distance)).collect(),
        cut: meets[1] > steep[1],
    }
}
