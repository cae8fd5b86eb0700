//! The geometry registers: templates and fans follow from slopes, and are made again.

use super::{Checked, absent, choice, fans, follows, length, list_follows, present, range, ranges_at};
use crate::pass_geometry::largest_offset;
use crate::perspective::OVERLAP;
use crate::{FrameSetup, Geometry, LARGEST_SIDE, PerspectivePass, SLOPE_FRACTION_BITS, Template};
use cube3_machine::RaySlots;

/// One as a slope.
const ONE: i64 = 1 << SLOPE_FRACTION_BITS;

/// Most voxels, times the planes of the volume, by which rays come apart from plane to plane: the grid plane is at least a tenth of the
/// volume's depth from the eye.
const MOST_SPACING: i64 = 10;

/// Most rays from a sample to the neighbours that its gradient reads.
const MOST_REACH: u32 = 64;

/// Slopes and offset.
const RAYS: &str = "slopes, offset and rule";

pub(super) fn check(setup: &FrameSetup) -> Checked {
    let geometry = &setup.geometry;
    ranges_at(|i| format!("geometry.size[{i}]"), geometry.size.map(|n| n as i128), 1, LARGEST_SIDE as i128)?;
    let axes = geometry.axes.axis;
    ranges_at(|i| format!("geometry.axes.axis[{i}]"), axes.map(|a| a as i128), 0, 2)?;
    let all = (0..3).all(|axis| axes.contains(&axis));
    choice("geometry.axes.axis", axes, all, "u, v and w have a voxel axis each")?;
    let bits = geometry.weight_bits;
    follows("geometry.weight_bits", bits, setup.words.weight_bits, "words.weight_bits")?;
    range("geometry.offset", geometry.offset, 0, (1 << bits) - 1)?;
    match &geometry.perspective {
        None => {
            absent("rays", setup.rays.is_some(), "all rays of a parallel frame have one direction")?;
            parallel(geometry)
        }
        Some(pass) => {
            let reader = "a perspective frame";
            present("rays", setup.rays.is_some(), reader)?;
            let rays_near = setup.rays.as_ref().is_some_and(|rays| rays.reach.is_some());
            perspective(geometry, pass, rays_near)
        }
    }
}

/// du is the larger slope, and templates follow.
fn parallel(geometry: &Geometry) -> Checked {
    let [du, dv] = geometry.slopes;
    range("geometry.slopes[0]", du, 0, ONE)?;
    range("geometry.slopes[1]", dv, 0, du)?;
    let legal = crate::largest_offset(geometry.rule, geometry.slopes, geometry.weight_bits);
    range("geometry.offset", geometry.offset, 0, legal)?;
    for (name, given, slope) in [("u", &geometry.u, du), ("v", &geometry.v, dv)] {
        let path = format!("geometry.{name}");
        // Lengths first: nothing is made for a volume that is not there.
        length(&format!("{path}.columns"), given.columns.len(), geometry.size[2] + 1, "geometry.size")?;
        length(&format!("{path}.weights"), given.weights.len(), geometry.size[2], "geometry.size")?;
        let made = Template::new(geometry.rule, slope, geometry.offset, geometry.weight_bits, geometry.size[2]);
        list_follows(&format!("{path}.columns"), &given.columns, made.columns.into_iter(), RAYS)?;
        list_follows(&format!("{path}.weights"), &given.weights, made.weights.into_iter(), RAYS)?;
    }
    Ok(())
}

fn perspective(geometry: &Geometry, pass: &PerspectivePass, rays_near: bool) -> Checked {
    let from = "rays that are in perspective";
    follows("geometry.slots", geometry.slots, RaySlots::Padded, from)?;
    for (i, slope) in geometry.slopes.into_iter().enumerate() {
        follows(&format!("geometry.slopes[{i}]"), slope, 0, from)?;
    }
    for (name, given) in [("u", &geometry.u), ("v", &geometry.v)] {
        length(&format!("geometry.{name}.columns"), given.columns.len(), 0, from)?;
        length(&format!("geometry.{name}.weights"), given.weights.len(), 0, from)?;
    }
    let depths = geometry.size[2];
    let path = "geometry.perspective";
    let field = |name: &str| format!("{path}.{name}");
    range(&field("first_depth"), pass.first_depth as i128, 0, depths as i128 - 1)?;
    grid(pass, depths, rays_near)?;
    let steepest = steepest(pass);
    let fans = [("u", &pass.u, geometry.size[0]), ("v", &pass.v, geometry.size[1])];
    for (name, fan, columns) in fans {
        fans::ranges(fan, &field(name), geometry, [steepest, farthest(columns, depths, steepest)])?;
    }
    let steepest = pass.u.slopes.iter().chain(&pass.v.slopes).map(|slope| slope.abs()).max().unwrap_or(0);
    let legal = largest_offset(geometry.rule, steepest, geometry.weight_bits);
    range("geometry.offset", geometry.offset, 0, legal)?;
    for (name, fan, columns) in fans {
        fans::follows_from_rays(fan, &field(name), geometry, pass, columns)?;
    }
    Ok(())
}

/// The grid plane, the distances between rays, and what depends on how near the eye is.
fn grid(pass: &PerspectivePass, depths: usize, rays_near: bool) -> Checked {
    let field = |name: &str| format!("geometry.perspective.{name}");
    let planes = depths as i64;
    let [first, step] = pass.spacing;
    range(&field("grid_plane"), pass.grid_plane, 0, (planes + 4 * planes) * ONE)?;
    range(&field("spacing[1]"), step, 0, MOST_SPACING * ONE / planes + 1)?;
    range(&field("spacing[0]"), first, 0, if pass.first_depth > 0 { step } else { ONE })?;
    range(&field("most_reach"), pass.most_reach, 1, MOST_REACH)?;
    let behind = pass.grid_plane != 0;
    if pass.doubled != behind && pass.doubled != rays_near {
        follows(&field("doubled"), pass.doubled, behind, "geometry.perspective.grid_plane and rays.reach")?;
    }
    if !pass.doubled {
        let from = "an eye from which the base plane is the grid plane";
        follows(&field("first_depth"), pass.first_depth, 0, from)?;
        follows(&field("grid_plane"), pass.grid_plane, 0, from)?;
        follows(&field("spacing[0]"), first, ONE, from)?;
        follows(&field("most_reach"), pass.most_reach, 1, from)?;
        return follows(&field("overlap"), pass.overlap, 0, from);
    }
    range(&field("spacing[1]"), step, 1, MOST_SPACING * ONE / planes + 1)?;
    range(&field("grid_plane"), pass.grid_plane, 1, (planes + 4 * planes) * ONE)?;
    // Rays are a voxel apart on the grid plane, to the rounding of the three registers.
    let away = pass.grid_plane - pass.first_depth as i64 * ONE;
    let apart = i128::from(first) + ((i128::from(away) * i128::from(step)) >> SLOPE_FRACTION_BITS);
    let rounded = 3 + i128::from((away.abs() + step) >> SLOPE_FRACTION_BITS);
    if (apart - i128::from(ONE)).abs() > rounded {
        let plane = (ONE - first) as f64 / step as f64 * ONE as f64;
        let plane = plane as i64 + pass.first_depth as i64 * ONE;
        follows(&field("grid_plane"), pass.grid_plane, plane, "geometry.perspective.spacing")?;
    }
    // Some rays of the distance to the grid plane, where frames join.
    let rays = |step: f64| (OVERLAP * ONE as f64 / step).floor() as u32;
    let joined = [rays(step as f64 + 0.5), rays(step as f64 - 0.5)];
    if pass.overlap != 0 {
        range(&field("overlap"), pass.overlap, joined[0], joined[1])?;
    }
    Ok(())
}

/// The largest slope of a ray: 1, and as many rays more as pictures and gradients need.
fn steepest(pass: &PerspectivePass) -> i64 {
    ONE + (i64::from(pass.most_reach) + i64::from(pass.overlap) + 3) * (pass.spacing[1] + 1)
}

/// The farthest place of a ray at its first plane from which it meets the volume.
fn farthest(columns: usize, depths: usize, steepest: i64) -> i64 {
    (columns as i64 + 2) * ONE + depths as i64 * steepest
}
