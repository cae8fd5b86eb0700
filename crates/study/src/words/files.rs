//! The study as CSV and as JSON: the same columns.

use super::levels::ImageLevels;
use super::picture::Aim;
use super::sweeps::{Row, Sweep, ThinRow};
use super::thin;
use super::wire::{Order, Wire};
use super::{SCHEMA, Study};
use crate::error::Outcome;
use cube3_word::Words;
use serde_json::{Map, Value, json};

/// A row of the table: name and value of each column, those without a value null.
type Columns = Vec<(String, Value)>;

/// What both kinds of points have.
fn columns(case: &str, sweep: Sweep, words: &Words, order: Order, used: &[Wire], error: ImageLevels) -> Columns {
    let (wire, bits) = match sweep {
        Sweep::OneWire(_, wire, bits) => (json!(wire.name()), json!(bits)),
        Sweep::Uniform(bits) => (json!("all"), json!(bits)),
        Sweep::Grid | Sweep::Search(_) | Sweep::Machine => (Value::Null, Value::Null),
    };
    let mut columns: Columns = vec![
        ("case".into(), json!(case)),
        ("sweep".into(), json!(sweep.name())),
        ("wire".into(), wire),
        ("wire_bits".into(), bits),
        ("order".into(), json!(order)),
        ("rounding".into(), json!(words.rounding.name())),
    ];
    columns.extend(Wire::ALL.map(|wire| {
        let bits = if used.contains(&wire) { json!(wire.of(words)) } else { Value::Null };
        (format!("{}_bits", wire.name()), bits)
    }));
    columns.extend([
        ("image_mean_levels".into(), json!(error.mean)),
        ("image_rms_levels".into(), json!(error.rms)),
        ("image_max_levels".into(), json!(error.max)),
    ]);
    columns
}

fn of_row(row: &Row, on_front: [bool; 2]) -> Columns {
    let (design, measured) = (&row.design, &row.measured);
    let mut columns = columns("scene", row.sweep, &design.words, design.order, &Wire::ALL, measured.image);
    let gradient = measured.gradient.map(|error| error.gradient);
    let normal = measured.gradient.and_then(|error| error.normal);
    columns.extend([
        ("gradient_mean_deg".into(), json!(gradient.map(|angles| angles.mean_deg))),
        ("gradient_p99_deg".into(), json!(gradient.map(|angles| angles.p99_deg))),
        ("gradient_max_deg".into(), json!(gradient.map(|angles| angles.max_deg))),
        ("normal_mean_deg".into(), json!(normal.map(|angles| angles.mean_deg))),
        ("normal_p99_deg".into(), json!(normal.map(|angles| angles.p99_deg))),
        ("normal_max_deg".into(), json!(normal.map(|angles| angles.max_deg))),
        ("thin_mean_levels".into(), json!(measured.thin.mean)),
        ("gradient_lost_fraction".into(), json!(measured.gradient.map(|error| error.lost_fraction))),
        ("logic_bits".into(), json!(measured.cost.logic_bits)),
        ("memory_bits".into(), json!(measured.cost.memory_bits)),
        ("cost_bits".into(), json!(measured.cost.total_bits())),
        ("frame_buffer_bits".into(), json!(measured.cost.frame_buffer_bits)),
        ("fine_tables".into(), json!(design.fine_tables)),
        ("on_front".into(), json!(on_front[0])),
        ("on_front_with_thin".into(), json!(on_front[1])),
    ]);
    columns
}

fn of_thin(row: &ThinRow) -> Columns {
    columns("thin-opacity", row.sweep, &row.words, row.order, &Wire::OF_THE_CONE, row.error)
}

fn scene_columns(study: &Study) -> Outcome<Vec<Columns>> {
    let mut on_front = vec![[false; 2]; study.rows.len()];
    for (place, aim) in Aim::ALL.into_iter().enumerate() {
        study.front(aim, None)?.iter().for_each(|&index| on_front[index][place] = true);
    }
    Ok(study.rows.iter().zip(on_front).map(|(row, on_front)| of_row(row, on_front)).collect())
}

/// One table: the points of the scene, then those of the cone alone. A column that a point does not have is empty.
///
/// # Errors
/// An error that is not finite.
pub fn csv(study: &Study) -> Outcome<String> {
    let mut text = String::new();
    let cell = |value: &Value| match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    let mut header: Vec<String> = Vec::new();
    for columns in scene_columns(study)?.into_iter().chain(study.thin.iter().map(of_thin)) {
        if header.is_empty() {
            header = columns.iter().map(|(name, _)| name.clone()).collect();
            text += &(format!("schema,{}\n", header.join(",")));
        }
        let mut cells: Vec<String> = columns.iter().map(|(_, value)| cell(value)).collect();
        cells.resize(header.len(), String::new());
        text += &format!("{SCHEMA},{}\n", cells.join(","));
    }
    Ok(text)
}

/// The same points as objects, with what was asked and what the thin rays are.
///
/// # Errors
/// A number that JSON cannot hold.
pub fn json(study: &Study) -> Outcome<String> {
    let object = |columns: Columns| Value::Object(columns.into_iter().collect::<Map<String, Value>>());
    let (source, dims) = &study.volume;
    let parts: Vec<Value> = study
        .parts
        .iter()
        .map(|part| json!({ "part": part.part, "count": part.count, "operators": part.operators, "cells_bits": part.cells }))
        .collect();
    let value = json!({
        "schema": SCHEMA,
        "program": { "name": "cube3", "version": env!("CARGO_PKG_VERSION") },
        "bound_levels": study.options.bound_levels,
        "bound_deg": study.options.bound_deg,
        "wires": study.options.wires,
        "unused_wires": study.unused,
        "scene": study.scene,
        "machine": study.machine,
        "volume": { "source": source, "dims": dims },
        "designs": study.designs,
        "points": scene_columns(study)?.into_iter().map(object).collect::<Vec<Value>>(),
        "thin_opacity": {
            "samples": thin::SAMPLES,
            "rays": thin::RAYS,
            "thickest_opacity": thin::THICKEST,
            "seed": thin::SEED,
            "points": study.thin.iter().map(of_thin).map(object).collect::<Vec<Value>>(),
        },
        "logic_of_the_machine": parts,
    });
    Ok(serde_json::to_string_pretty(&value)? + "\n")
}
