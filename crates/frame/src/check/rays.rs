//! What differs from ray to ray in perspective, and the ends of rays.

use super::{Checked, absent, choice, length, list_follows, present, range, ranges, triples};
use crate::{EndRegisters, Fan, FrameSetup, GradientScale, PerspectivePass, RayRegisters, Shading};

/// Largest component of a view vector.
const MOST_VIEW: i32 = 1 << 28;

pub(super) fn check(setup: &FrameSetup) -> Checked {
    if let (Some(rays), Some(pass)) = (&setup.rays, &setup.geometry.perspective) {
        by_ray(rays, pass)?;
        lights(rays, setup)?;
        lengths(rays)?;
        by_depth(rays, pass, setup)?;
    }
    if let Some(registers) = &setup.ends {
        ends(registers, setup)?;
    }
    Ok(())
}

/// View vectors and slopes, a register for each ray of an axis.
fn by_ray(rays: &RayRegisters, pass: &PerspectivePass) -> Checked {
    let from = "the rays of geometry.perspective";
    for (name, view, fan) in [("view_u", &rays.view_u, &pass.u), ("view_v", &rays.view_v, &pass.v)] {
        let path = format!("rays.{name}");
        length(&path, view.len(), fan.count(), from)?;
        ranges(&path, view, -MOST_VIEW, MOST_VIEW)?;
    }
    range("rays.view_w", rays.view_w, 0, MOST_VIEW)?;
    let slopes = |fan: &Fan| fan.slopes.iter().map(|&slope| RayRegisters::slope_register(slope)).collect::<Vec<u32>>();
    for (name, list, fan) in [("slope_u", &rays.slope_u, &pass.u), ("slope_v", &rays.slope_v, &pass.v)] {
        list_follows(&format!("rays.{name}"), list, slopes(fan).into_iter(), from)?;
    }
    for (name, list, fan) in [("length_u", &rays.length_u, &pass.u), ("length_v", &rays.length_v, &pass.v)] {
        length(&format!("rays.{name}"), list.len(), fan.count(), from)?;
    }
    Ok(())
}

/// Each light of the shading unit stands at the eye or not.
fn lights(rays: &RayRegisters, setup: &FrameSetup) -> Checked {
    let lights = match &setup.shading {
        Some(Shading::Phong(phong)) => phong.lights.len(),
        _ => 0,
    };
    length("rays.at_eye", rays.at_eye.len(), lights, "shading.Phong.lights")
}

/// Every ray has a class of step lengths for which there is a table.
fn lengths(rays: &RayRegisters) -> Checked {
    let most = (rays.length_classes << RayRegisters::CLASS_SHIFT) - 1;
    ranges("rays.length_u", &rays.length_u, 0, most)?;
    let longest = rays.length_v.iter().copied().max().unwrap_or(0);
    ranges("rays.length_v", &rays.length_v, 0, most)?;
    ranges("rays.length_u", &rays.length_u, 0, most - longest)
}

/// What follows from the distance between rays at a depth.
fn by_depth(rays: &RayRegisters, pass: &PerspectivePass, setup: &FrameSetup) -> Checked {
    let (depths, offset, bits) = (setup.geometry.size[2], setup.geometry.offset, setup.geometry.weight_bits);
    let from = "geometry.perspective and geometry.offset";
    let registers = |i: usize| {
        let at = move |k: usize| pass.neighbour_spacing(k as i64, offset, bits);
        (0..depths).map(move |k| RayRegisters::closeness_registers(at(k))[i])
    };
    list_follows("rays.closeness", &rays.closeness, registers(0), from)?;
    length("rays.factors", rays.factors.len(), depths, "geometry.size")?;
    triples("rays.factors", &rays.factors, 1 << GradientScale::FACTOR_BITS)?;
    for (field, list) in [("rays.reach", &rays.reach), ("rays.nearness", &rays.nearness)] {
        let Some(list) = list else {
            present(field, !pass.doubled, "a near frame")?;
            continue;
        };
        absent(field, !pass.doubled, "neighbours are the next rays, as far as a voxel")?;
        if field == "rays.reach" {
            let reach = |k: usize| pass.reach_at(k as i64, offset, bits);
            list_follows(field, list, (0..depths).map(reach), from)?;
        } else {
            list_follows(field, list, registers(1), from)?;
        }
    }
    Ok(())
}

fn ends(registers: &EndRegisters, setup: &FrameSetup) -> Checked {
    let mode = setup.cone.mode;
    choice("cone.mode", mode, mode.adds_up(), "the parts of a step in `ends` are for modes that add up along a ray")?;
    for (i, face) in registers.faces.iter().enumerate() {
        setup.linear(&format!("ends.faces[{i}].distance"), &face.distance)?;
    }
    let classes = setup.rays.as_ref().map_or(1, |rays| rays.length_classes);
    range("ends.first_class", registers.first_class, classes, classes)?;
    length("ends.steps", registers.steps.len(), classes as usize, "rays.length_classes")?;
    ranges("ends.steps", &registers.steps, 0, 1 << EndRegisters::STEP_BITS)
}
