//! Whether a report follows a JSON schema: those rules of draft 2020-12 that the report's own schema is made of, and no others.

use serde_json::{Map, Value};

/// Rules that say nothing of a value.
const SILENT: [&str; 5] = ["$schema", "$defs", "title", "description", "$ref"];

/// Every place of a value that does not follow a schema, as `/path: what is wrong`.
///
/// # Panics
/// At a rule that is not known here: a schema is never followed for want of a reading.
pub fn faults(schema: &Value, value: &Value) -> Vec<String> {
    let mut found = Vec::new();
    walk(schema, schema, value, "", &mut found);
    found
}

fn walk(root: &Value, schema: &Value, value: &Value, path: &str, found: &mut Vec<String>) {
    if let Some(reference) = schema.get("$ref") {
        let target = reference.as_str().and_then(|name| root.pointer(name.strip_prefix('#')?));
        walk(root, target.unwrap_or_else(|| panic!("{reference} leads nowhere")), value, path, found);
    }
    let Some(rules) = schema.as_object() else { panic!("{schema} is no schema") };
    for (rule, wanted) in rules.iter().filter(|(rule, _)| !SILENT.contains(&rule.as_str())) {
        if !holds(root, rules, rule, wanted, value, path, found) {
            found.push(format!("{path}: {value} breaks {rule} {wanted}"));
        }
    }
}

/// Whether one rule holds; faults inside of the value are added to those found.
fn holds(
    root: &Value,
    rules: &Map<String, Value>,
    rule: &str,
    wanted: &Value,
    value: &Value,
    path: &str,
    found: &mut Vec<String>,
) -> bool {
    // A rule of numbers says nothing of a text, and so on.
    let number =
        |holds: fn(f64, f64) -> bool| value.as_f64().is_none_or(|value| holds(value, wanted.as_f64().unwrap()));
    let length = |holds: fn(u64, u64) -> bool| {
        value.as_array().is_none_or(|items| holds(items.len() as u64, wanted.as_u64().unwrap()))
    };
    match rule {
        "type" => match wanted {
            Value::Array(types) => types.iter().any(|name| is_a(value, name)),
            name => is_a(value, name),
        },
        "const" => value == wanted,
        "enum" => wanted.as_array().unwrap().contains(value),
        "minimum" => number(|value, wanted| value >= wanted),
        "maximum" => number(|value, wanted| value <= wanted),
        "exclusiveMinimum" => number(|value, wanted| value > wanted),
        "exclusiveMaximum" => number(|value, wanted| value < wanted),
        "minItems" => length(|length, wanted| length >= wanted),
        "maxItems" => length(|length, wanted| length <= wanted),
        "pattern" => {
            assert_eq!(wanted, "^[0-9a-f]{64}$");
            let digit = |c: char| matches!(c, '0'..='9' | 'a'..='f');
            value.as_str().is_none_or(|text| text.len() == 64 && text.chars().all(digit))
        }
        "required" => value.as_object().is_none_or(|entries| {
            wanted.as_array().unwrap().iter().all(|key| entries.contains_key(key.as_str().unwrap()))
        }),
        "properties" => {
            for (key, value) in value.as_object().into_iter().flatten() {
                if let Some(schema) = wanted.get(key) {
                    walk(root, schema, value, &format!("{path}/{key}"), found);
                }
            }
            true
        }
        "additionalProperties" => {
            let known = |key: &String| rules.get("properties").is_some_and(|known| known.get(key).is_some());
            let mut others = value.as_object().into_iter().flatten().filter(|(key, _)| !known(key));
            if *wanted == Value::Bool(false) {
                return others.next().is_none();
            }
            others.for_each(|(key, value)| walk(root, wanted, value, &format!("{path}/{key}"), found));
            true
        }
        "items" => {
            for (index, item) in value.as_array().into_iter().flatten().enumerate() {
                walk(root, wanted, item, &format!("{path}/{index}"), found);
            }
            true
        }
        "anyOf" => {
            let follows = |schema: &Value| {
                let mut faults = Vec::new();
                walk(root, schema, value, path, &mut faults);
                faults
            };
            let mut tried: Vec<Vec<String>> = wanted.as_array().unwrap().iter().map(follows).collect();
            if tried.iter().any(Vec::is_empty) {
                return true;
            }
            // The first choice is what the value should be where it is not null.
            found.append(&mut tried[0]);
            true
        }
        _ => panic!("{path}: the rule {rule} is not known"),
    }
}

fn is_a(value: &Value, name: &Value) -> bool {
    match name.as_str().unwrap() {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|value| value.fract() == 0.0),
        other => panic!("the type {other} is not known"),
    }
}
