//! What `cargo run` is built from may be used by anyone for anything.

use serde_json::Value;
use spdx::{Expression, ParseMode};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

/// Licences that ask for their text to be kept, and for nothing else.
const PERMISSIVE: [&str; 9] =
    ["0BSD", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "BSL-1.0", "ISC", "MIT", "Unicode-3.0", "Zlib"];

/// Whether a licence's expression can be met by permissive licences alone.
fn is_permissive(licence: &str) -> bool {
    let Ok(expression) = Expression::parse_mode(licence, ParseMode::LAX) else { return false };
    expression.evaluate(|wanted| wanted.license.id().is_some_and(|id| PERMISSIVE.contains(&id.name)))
}

/// What a command prints.
fn printed(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What `cargo metadata` says of the workspace on this computer's platform: nothing that is built for another need be there.
fn metadata() -> Value {
    let version = printed(Command::new("rustc").arg("-vV"));
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.toml");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["metadata", "--format-version", "1", "--offline", "--filter-platform", host, "--manifest-path"]);
    serde_json::from_str(&printed(command.arg(manifest))).unwrap()
}

/// The name and licence of each crate that the command is built from, its own among them: what it links, and what runs while it is
/// compiled.
fn licences(metadata: &Value) -> BTreeMap<String, String> {
    let list = |value: &Value| value.as_array().unwrap().clone();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let packages: BTreeMap<String, Value> =
        list(&metadata["packages"]).into_iter().map(|package| (text(&package["id"]), package)).collect();
    let uses: BTreeMap<String, Vec<String>> = list(&metadata["resolve"]["nodes"])
        .iter()
        .map(|node| {
            let built = |used: &Value| list(&used["dep_kinds"]).iter().any(|kind| kind["kind"] != "dev");
            let used = list(&node["deps"]).into_iter().filter(built).map(|used| text(&used["pkg"]));
            (text(&node["id"]), used.collect())
        })
        .collect();
    let command = packages.iter().filter(|(_, package)| package["name"] == "cube3-sim");
    let mut waiting: Vec<String> = command.map(|(id, _)| id.clone()).collect();
    let mut seen = BTreeSet::new();
    while let Some(id) = waiting.pop() {
        if seen.insert(id.clone()) {
            waiting.extend(uses[&id].iter().cloned());
        }
    }
    let named = |id: &String| {
        let package = &packages[id];
        (format!("{} {}", text(&package["name"]), text(&package["version"])), text(&package["license"]))
    };
    seen.iter().map(named).collect()
}

#[test]
fn every_dependency_of_the_command_has_a_permissive_licence() {
    let licences = licences(&metadata());
    assert!(licences.keys().any(|name| name.starts_with("glam ")), "{licences:?}");
    assert!(
        licences.keys().any(|name| name.starts_with("serde_derive ")),
        "what runs while they are compiled: {licences:?}"
    );
    assert!(!licences.keys().any(|name| name.starts_with("proptest ")), "tests are not built into it: {licences:?}");
    let others: Vec<String> = licences
        .iter()
        .filter(|(_, licence)| !is_permissive(licence))
        .map(|(name, licence)| format!("{name} has the licence \"{licence}\""))
        .collect();
    assert!(others.is_empty(), "not on the list of permissive licences:\n{}", others.join("\n"));
}

#[test]
fn a_licence_that_binds_is_found_in_any_expression() {
    for licence in ["MIT", "MIT/Apache-2.0", "(MIT OR Apache-2.0) AND Unicode-3.0", "GPL-2.0-only OR MIT"] {
        assert!(is_permissive(licence), "{licence}");
    }
    for licence in [
        "GPL-3.0-or-later",
        "MIT AND LGPL-2.1-only",
        "MPL-2.0",
        "Apache-2.0 AND (GPL-2.0-only OR SSPL-1.0)",
        "",
        "to be asked for",
    ] {
        assert!(!is_permissive(licence), "{licence}");
    }
}
