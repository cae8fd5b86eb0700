//! Classification, gradient, normaliser, shading, depth cue and cone.

use super::{Checked, absent, choice, follows, length, list_follows, present, range, ranges, ranges_at, triples};
use crate::{
    Classification, ConeRegisters, EndRegisters, FrameSetup, GradientRegisters, GradientScale, Normaliser, Phong,
    RayRegisters, ReflectanceTable, SLOPE_FRACTION_BITS, Shading,
};
use cube3_machine::Differences;
use cube3_scene::MOST_LIGHTS;
use cube3_word::{Words, unit_full};

pub(super) fn check(setup: &FrameSetup) -> Checked {
    let words = &setup.words;
    readers(setup)?;
    classification(setup)?;
    if let Some(registers) = &setup.gradient {
        gradient(registers, setup)?;
    }
    if let Some(table) = &setup.normaliser {
        normaliser(table, words)?;
    }
    match &setup.shading {
        Some(Shading::Phong(registers)) => phong(registers, words)?,
        Some(Shading::Table(table)) => reflectance(table, words)?,
        None => {}
    }
    if let Some(cue) = &setup.depth_cue {
        setup.linear("depth_cue.factor", &cue.factor)?;
    }
    cone(&setup.cone, words)
}

/// What reads gradients and normals has them.
fn readers(setup: &FrameSetup) -> Checked {
    let (gradient, normaliser) = (setup.gradient.is_some(), setup.normaliser.is_some());
    match &setup.shading {
        Some(Shading::Phong(_)) => {
            present("gradient", gradient, "the shading unit")?;
            present("normaliser", normaliser, "the shading unit")?;
        }
        Some(Shading::Table(_)) => {
            absent("shading.Table", setup.rays.is_some(), "a table has light for one direction to the eye alone")?;
            present("gradient", gradient, "the shading unit")?;
        }
        None => {}
    }
    if setup.classification.gradient_rows.is_some() {
        present("gradient", gradient, "the opacity table")?;
        present("normaliser", normaliser, "the opacity table")?;
    }
    if normaliser {
        present("gradient", gradient, "the normaliser")?;
    }
    Ok(())
}

/// The threshold, and a table of opacity for each row, each class of step lengths and each part of a step.
fn classification(setup: &FrameSetup) -> Checked {
    let (words, Classification { threshold, index_shift, opacity, colour, gradient_rows }) =
        (&setup.words, &setup.classification);
    ranges("classification.threshold", threshold, 0, unit_full(words.sample_bits()))?;
    let shift = words.sample_bits() - words.table_bits;
    follows("classification.index_shift", *index_shift, shift, "words")?;
    let rows = match gradient_rows {
        None => 1,
        Some(rows) => {
            range("classification.gradient_rows.shift", rows.shift, 0, 30)?;
            let of_words = 1 << words.table_gradient_bits;
            follows("classification.gradient_rows.rows", rows.rows, of_words, "words.table_gradient_bits")?;
            rows.rows as usize
        }
    };
    length("classification.colour", colour.len(), 1 << words.table_bits, "words.table_bits")?;
    triples("classification.colour", colour, unit_full(words.colour_bits))?;
    if let Some(rays) = &setup.rays {
        range("rays.length_classes", rays.length_classes, 1, RayRegisters::MOST_CLASSES)?;
    }
    let lengths = setup.rays.as_ref().map_or(1, |rays| rays.length_classes as usize);
    let classes = lengths + if setup.ends.is_some() { EndRegisters::CLASSES as usize } else { 0 };
    let from = "words, gradient_rows, rays.length_classes and ends";
    length("classification.opacity", opacity.len(), colour.len() * rows * classes, from)?;
    ranges("classification.opacity", opacity, 0, unit_full(words.opacity_bits))
}

fn gradient(registers: &GradientRegisters, setup: &FrameSetup) -> Checked {
    let words = &setup.words;
    let perpendicular = registers.method.row().differences == Differences::Feet;
    if perpendicular {
        let reason = "in perspective the feet of its perpendiculars differ for every ray";
        choice("gradient.method", registers.method, setup.rays.is_none(), reason)?;
        ranges("gradient.weights", &registers.weights, 0, 1 << words.weight_bits)?;
    } else {
        let drop = SLOPE_FRACTION_BITS - words.weight_bits;
        let weights = setup.geometry.slopes.map(|slope| (slope + (1 << (drop - 1))) >> drop);
        list_follows("gradient.weights", &registers.weights, weights.into_iter(), "geometry.slopes")?;
    }
    match &registers.scale {
        Some(scale) => {
            ranges("gradient.scale.factors", &scale.factors, 0, 1 << GradientScale::FACTOR_BITS)?;
            let room = GradientScale::room(registers.method, words).min(GradientScale::FACTOR_BITS);
            range("gradient.scale.kept_bits", scale.kept_bits, 0, room)?;
        }
        None => present("gradient.scale", setup.rays.is_none(), "each depth of a perspective frame")?,
    }
    range("gradient.border", registers.border, 0, unit_full(words.sample_bits()))
}

/// The bits of a table's index, and the table that they make.
fn normaliser(table: &Normaliser, words: &Words) -> Checked {
    range("normaliser.root_bits", table.root_bits, 4, 10.min(2 * (words.normal_bits - 1)))?;
    let made = Normaliser::new(words.normal_bits, table.root_bits);
    list_follows("normaliser.root", &table.root, made.root.into_iter(), "words.normal_bits and root_bits")
}

/// The largest intensity that multiplies, and the largest that is added.
fn intensities(words: &Words) -> [u32; 2] {
    [Phong::MOST_INTENSITY << words.colour_bits, Phong::MOST_INTENSITY * unit_full(words.colour_bits)]
}

fn phong(registers: &Phong, words: &Words) -> Checked {
    let [multiplies, added] = intensities(words);
    let field = |name: &str| format!("shading.Phong.{name}");
    range(&field("ambient"), registers.ambient, 0, multiplies)?;
    if registers.lights.len() > MOST_LIGHTS {
        range(&field("lights"), registers.lights.len() as i128, 0, MOST_LIGHTS as i128)?;
    }
    let one = 1 << (words.normal_bits - 1);
    for (i, light) in registers.lights.iter().enumerate() {
        let field = |name: &str| field(&format!("lights[{i}].{name}"));
        ranges(&field("direction"), &light.direction, -one, one)?;
        ranges(&field("halfway"), &light.halfway, -one, one)?;
        ranges(&field("diffuse"), &light.diffuse, 0, multiplies)?;
        ranges(&field("specular"), &light.specular, 0, added)?;
    }
    range(&field("power_bits"), registers.power_bits, 1, 11.min(words.normal_bits - 1))?;
    length(&field("power"), registers.power.len(), (1 << registers.power_bits) + 1, "power_bits")?;
    ranges(&field("power"), &registers.power, 0, 1 << words.colour_bits)
}

fn reflectance(table: &ReflectanceTable, words: &Words) -> Checked {
    let [multiplies, added] = intensities(words);
    let field = |name: &str| format!("shading.Table.{name}");
    range(&field("bits"), table.bits, 2, 8)?;
    for (name, list, high) in [("diffuse", &table.diffuse, multiplies), ("specular", &table.specular, added)] {
        length(&field(name), list.len(), 6 << (2 * table.bits), "bits")?;
        triples(&field(name), list, high)?;
    }
    range(&field("flat"), table.flat, 0, multiplies)
}

fn cone(cone: &ConeRegisters, words: &Words) -> Checked {
    ranges_at(|_| "cone.leaves".to_owned(), [cone.leaves as i128], 1, 4096)?;
    range("cone.opaque", cone.opaque, 1, unit_full(words.opacity_bits))?;
    range("cone.sum_weight", cone.sum_weight, 0, 1_u64 << ConeRegisters::WEIGHT_BITS)
}
