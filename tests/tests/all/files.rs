//! The files of each crate and the arrows between them.

use cube3_tests::files::{Files, Module};
use cube3_tests::golden_breaks::root;
use std::fs;

fn module(path: &str) -> Module {
    path.split("::").filter(|name| !name.is_empty()).map(String::from).collect()
}

#[test]
fn no_file_uses_itself_by_way_of_others() {
    let crates = fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path());
    let folders: Vec<_> = crates.chain([root().join("sim"), root().join("tests")]).collect();
    assert!(folders.len() > 30);
    let mut arrows = 0;
    for folder in folders {
        let files = Files::of(&folder.join("src")).unwrap();
        arrows += files.uses().values().map(|uses| uses.len()).sum::<usize>();
        let circles = files.circles();
        let shown = circles.iter().map(|(module, uses)| format!("{} uses {uses:?}\n", module.join("::")));
        assert!(circles.is_empty(), "{}:\n{}", folder.display(), shown.collect::<String>());
    }
    assert!(arrows > 500, "{arrows} arrows are too few to be all");
}

#[test]
fn no_file_is_long() {
    let mut waiting: Vec<_> = ["crates", "sim", "tests"].map(|name| root().join(name)).into();
    let mut seen = 0;
    while let Some(path) = waiting.pop() {
        if path.is_dir() {
            waiting.extend(fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()));
        } else if path.extension().is_some_and(|end| end == "rs")
            && path.strip_prefix(root()).is_ok_and(|path| path.iter().any(|part| part == "src"))
        {
            let lines = fs::read_to_string(&path).unwrap().lines().count();
            assert!(lines <= 500, "{} has {lines} lines", path.display());
            seen += 1;
        }
    }
    assert!(seen > 300, "{seen} files are too few to be all");
}

#[test]
fn circles_are_found_through_names_that_are_given_on() {
    let crate_of = |b: &str| {
        let mut files = Files::default();
        files.add(module(""), "mod a;\nmod b;\nmod c;\npub use a::{One, shown as other};\npub use b::*;\n");
        files.add(
            module("a"),
            "use crate::{\n    Two,\n};\nmod part;\npub struct One(Two);\npub fn shown() {\n    part::run();\n}\n",
        );
        files.add(module("a::part"), "use super::One;\npub fn run(_: One) {}\n");
        files.add(module("b"), b);
        files.add(module("c"), "use crate::{One, Two};\n");
        files.circles()
    };
    for b in [
        "pub struct Two;\n",
        "// crate::One\npub struct Two(&'static str);\npub const TEXT: &str = \"crate::One\";\n",
        "pub struct Two;\n\n#[cfg(test)]\nmod tests {\n    use crate::One;\n}\n",
        "pub struct Two;\npub use crate::One as Given;\n",
    ] {
        assert!(crate_of(b).is_empty(), "{b}");
    }
    for b in [
        "use crate::One;\npub struct Two;\n",
        "pub struct Two(Option<Box<crate::One>>);\n",
        "use super::a::One;\npub enum Two { A(One) }\n",
        "pub(crate) use super::a::One;\npub enum Two { A(One) }\n",
        "use crate::other;\npub struct Two;\n",
        "use crate::a;\npub struct Two(a::One);\n",
        "use crate::a::{self as first};\npub struct Two(first::One);\n",
        "use crate::*;\npub struct Two(One);\n",
    ] {
        let circles = crate_of(b);
        assert_eq!(circles.keys().cloned().collect::<Vec<_>>(), [module("a"), module("b")], "{b}");
    }
    // By way of a part: b uses the part, the part its whole, and the whole uses b.
    let circles = crate_of("use crate::a::part::run;\npub struct Two;\npub fn go() {\n    run();\n}\n");
    assert_eq!(circles.len(), 3, "{circles:?}");
    assert!(circles.contains_key(&module("a::part")), "{circles:?}");
}
