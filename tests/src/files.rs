//! The files of a crate, and which use which: no circle may be among them.
//!
//! Names are followed to the file that defines them, through those that only give them on (`pub use`). A file and the folder of its name
//! are whole and parts: each may use the other, but a circle through a third file may go by neither. Tests may use what they like. A method
//! is not followed: it is of its type's file.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path;

/// A module, by its names from the crate's root.
pub type Module = Vec<String>;

/// The modules of a crate.
#[derive(Clone, Debug, Default)]
pub struct Files {
    modules: BTreeMap<Module, Source>,
}

/// What a file says of others.
#[derive(Clone, Debug, Default)]
struct Source {
    /// Items that it defines.
    items: BTreeSet<String>,
    /// What it imports, and under which name.
    imports: Vec<Path>,
    /// What it gives on, and under which name; `*` for all that is there.
    gives: Vec<Path>,
    /// Paths and names in its code.
    names: BTreeSet<Vec<String>>,
}

/// A path and the name that stands for it.
type Path = (Vec<String>, String);

/// Characters of names.
fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// A source without comments, texts and tests.
fn stripped(text: &str) -> String {
    let mut code = String::new();
    for line in text.lines().map(|line| line.split("//").next().unwrap_or_default()) {
        if line.starts_with("#[cfg(test)]") {
            // Tests are the last that a file has, or a line that names their file.
            code.push_str("#[cfg(test)]\n");
            continue;
        }
        if code.ends_with("#[cfg(test)]\n") && line.contains("mod ") {
            code.truncate(code.len() - "#[cfg(test)]\n".len());
            if line.trim_end().ends_with('{') {
                break;
            }
            continue;
        }
        for (number, part) in line.split('"').enumerate() {
            if number % 2 == 0 {
                code.push_str(part);
            }
        }
        code.push('\n');
    }
    code
}

/// The paths of an import: `a::{b, c::d as e}` is `a::b`, and `a::c::d` under the name `e`.
fn paths(tree: &str) -> Vec<Path> {
    let Some((front, rest)) = tree.split_once('{') else {
        let (path, name) = tree.split_once(" as ").unwrap_or((tree, ""));
        let mut path: Vec<String> = path.split("::").map(|name| name.trim().to_owned()).collect();
        // `a::{self, b}` is `a` itself.
        path.pop_if(|last| last == "self" && !tree.starts_with("self"));
        let name = if name.is_empty() { path.last().cloned().unwrap_or_default() } else { name.trim().to_owned() };
        return vec![(path, name)];
    };
    let inner = rest.rsplit_once('}').map_or(rest, |(inner, _)| inner);
    let (mut parts, mut depth) = (vec![String::new()], 0);
    for c in inner.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        match c {
            ',' if depth == 0 => parts.push(String::new()),
            c => parts.last_mut().into_iter().for_each(|part| part.push(c)),
        }
    }
    let parts = parts.iter().filter(|part| !part.trim().is_empty());
    parts.flat_map(|part| paths(&format!("{}{}", front.trim(), part.trim()))).collect()
}

impl Source {
    fn of(text: &str) -> Source {
        let code = stripped(text);
        let mut source = Source::default();
        let mut body = String::new();
        let mut code = code.as_str();
        while let Some(at) = import(code) {
            let (before, from) = code.split_at(at);
            let line = before.rfind('\n').map_or(0, |end| end + 1);
            body.push_str(&before[..line]);
            let end = from.find(';').unwrap_or(from.len());
            let given = before[line..].trim().starts_with("pub");
            let list = if given { &mut source.gives } else { &mut source.imports };
            list.extend(paths(&from["use ".len()..end].replace('\n', " ")));
            code = &from[end..];
        }
        body.push_str(code);
        let words: Vec<&str> = body.split(|c: char| !is_word(c) && c != ':').filter(|word| !word.is_empty()).collect();
        for pair in words.windows(2) {
            if ["fn", "struct", "enum", "trait", "type", "const", "static", "macro_rules"].contains(&pair[0]) {
                source.items.insert(pair[1].trim_matches(':').to_owned());
            }
        }
        source.names = words.iter().map(|word| word.split("::").map(str::to_owned).collect()).collect();
        source
    }
}

/// Where the next import is.
fn import(code: &str) -> Option<usize> {
    code.match_indices("use ").map(|(at, _)| at).find(|&at| {
        let line = code[..at].rfind('\n').map_or(0, |end| end + 1);
        let before = code[line..at].trim();
        before.is_empty() || before == "pub" || (before.starts_with("pub(") && before.ends_with(')'))
    })
}

impl Files {
    /// The files of a crate's folder `src`; programs beside its library apart.
    ///
    /// # Errors
    /// A folder or file that cannot be read.
    pub fn of(folder: &path::Path) -> std::io::Result<Files> {
        let mut files = Files::default();
        files.read(folder, &[])?;
        let tests: Vec<Module> =
            files.modules.keys().filter(|module| module.iter().any(|name| name == "tests")).cloned().collect();
        tests.iter().for_each(|module| drop(files.modules.remove(module)));
        Ok(files)
    }

    fn read(&mut self, folder: &path::Path, module: &[String]) -> std::io::Result<()> {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_dir() {
                if name != "bin" {
                    self.read(&path, &[module, &[name]].concat())?;
                }
                continue;
            }
            match name.as_str() {
                "main" => {}
                "lib" | "mod" => self.add(module.to_vec(), &fs::read_to_string(&path)?),
                _ => self.add([module, &[name]].concat(), &fs::read_to_string(&path)?),
            }
        }
        Ok(())
    }

    /// Adds a file.
    pub fn add(&mut self, module: Module, text: &str) {
        self.modules.insert(module, Source::of(text));
    }

    /// The module that defines what a path leads to, as it stands in a module; none outside of the crate.
    fn defines(&self, from: &Module, path: &[String], seen: &mut BTreeSet<(Module, String)>) -> Option<Module> {
        let (mut at, mut path) = match path.first()?.as_str() {
            "crate" => (Vec::new(), &path[1..]),
            "self" => (from.clone(), &path[1..]),
            "super" => {
                let ups = path.iter().take_while(|name| *name == "super").count();
                (from[..from.len().checked_sub(ups)?].to_vec(), &path[ups..])
            }
            name if self.modules.contains_key(&[&from[..], &[name.to_owned()]].concat()) => (from.clone(), path),
            _ => return None,
        };
        while let [name, rest @ ..] = path
            && self.modules.contains_key(&[&at[..], std::slice::from_ref(name)].concat())
        {
            at.push(name.clone());
            path = rest;
        }
        let source = self.modules.get(&at)?;
        let Some(name) = path.first() else { return Some(at) };
        if source.items.contains(name) || !seen.insert((at.clone(), name.clone())) {
            return Some(at);
        }
        let given = source.gives.iter().chain(&source.imports);
        let mut follow = given.filter_map(|(path, given)| match given.as_str() {
            "*" => {
                let all = [&path[..path.len() - 1], std::slice::from_ref(name)].concat();
                let found = self.defines(&at, &all, seen)?;
                self.modules[&found].items.contains(name).then_some(found)
            }
            given if given == name => self.defines(&at, path, seen),
            _ => None,
        });
        follow.next().or(Some(at.clone()))
    }

    /// Which module uses which.
    pub fn uses(&self) -> BTreeMap<Module, BTreeSet<Module>> {
        let used = |(module, source): (&Module, &Source)| {
            let globs: Vec<&[String]> = source
                .imports
                .iter()
                .filter_map(|(path, name)| path.get(..path.len() - 1).filter(|_| name == "*"))
                .collect();
            let named = source.names.iter().flat_map(|path| {
                // A name that was imported stands for its path.
                let known = source.imports.iter().chain(&source.gives).find(|(_, name)| *name == path[0]);
                match known {
                    Some((from, _)) => vec![[from, &path[1..]].concat()],
                    None => globs.iter().copied().chain([&[][..]]).map(|glob| [glob, path].concat()).collect(),
                }
            });
            let imported = source.imports.iter().map(|(path, _)| path.clone());
            let used = named.chain(imported).filter_map(|path| self.defines(module, &path, &mut BTreeSet::new()));
            (module.clone(), used.filter(|used| used != module).collect())
        };
        self.modules.iter().map(used).collect()
    }

    /// The modules that are in circles, or between them. What a part uses of its whole counts where what the whole uses of its parts does
    /// not, and the other way round.
    pub fn circles(&self) -> BTreeMap<Module, BTreeSet<Module>> {
        let up = |module: &Module, used: &Module| module.starts_with(used);
        let down = |module: &Module, used: &Module| used.starts_with(module);
        let mut circles = self.circles_without(down);
        circles.extend(self.circles_without(up));
        circles
    }

    /// What is left when those that use none of the others are taken away, and those that none uses; some arrows are left out.
    fn circles_without(&self, left_out: impl Fn(&Module, &Module) -> bool) -> BTreeMap<Module, BTreeSet<Module>> {
        let mut left = self.uses();
        left.iter_mut().for_each(|(module, uses)| uses.retain(|used| !left_out(module, used)));
        loop {
            let used: BTreeSet<Module> = left.values().flatten().cloned().collect();
            let ends = |(module, uses): &(&Module, &BTreeSet<Module>)| uses.is_empty() || !used.contains(*module);
            let Some(end) = left.iter().find(ends).map(|(module, _)| module.clone()) else { return left };
            left.remove(&end);
            left.values_mut().for_each(|uses| {
                uses.remove(&end);
            });
        }
    }
}
