//! The layout of `report.json`, for programs that read it.

/// The JSON schema (draft 2020-12) of what [`to_json`](crate::to_json) writes: each key with its type, unit and meaning, and which are always there.
pub const JSON_SCHEMA: &str = include_str!("../report.schema.json");
