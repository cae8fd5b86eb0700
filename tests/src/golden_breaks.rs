//! Code that is broken on purpose: lists of breaks, of definitions and of what is measured, and a copy of the workspace in which each is made
//! and must be caught.

use serde::Deserialize;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// How long a test program may run before it counts as stuck.
const LIMIT: Duration = Duration::from_secs(120);

/// What a copy is made of, from the workspace's root.
const PARTS: [&str; 7] = ["Cargo.toml", "Cargo.lock", "crates", "sim", "tests", "docs", "traces"];

/// Code broken on purpose: one place of a file is replaced.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Break {
    /// What is wrong then.
    pub what: String,
    /// The file, from the workspace's root.
    pub file: String,
    /// Text that is there once.
    pub find: String,
    /// What stands there instead.
    pub replace: String,
    /// The module of the package of tests that must catch it; the tests of the file's crate where none is given.
    pub test: Option<String>,
}

/// Tests that are run together.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Suite {
    /// All of a crate, by its folder.
    Crate(String),
    /// One module of the package of tests.
    Test(String),
}

/// A list of breaks.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Breaks {
    #[serde(rename = "break")]
    breaks: Vec<Break>,
}

/// The root of the workspace.
pub fn root() -> &'static Path {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.parent().unwrap_or(tests)
}

/// All breaks of `tests/golden_breaks.toml`: those of definitions.
///
/// # Panics
/// Where the file cannot be read.
pub fn breaks() -> Vec<Break> {
    list(DEFINITIONS)
}

/// All breaks of `tests/measurement_breaks.toml`: those of what is counted, limited, measured and left out.
///
/// # Panics
/// Where the file cannot be read.
pub fn measurement_breaks() -> Vec<Break> {
    list(MEASUREMENTS)
}

/// The lists, from the workspace's root.
const DEFINITIONS: &str = "tests/golden_breaks.toml";
const MEASUREMENTS: &str = "tests/measurement_breaks.toml";

fn list(name: &str) -> Vec<Break> {
    let path = root().join(name);
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let Breaks { breaks } = toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    breaks
}

/// The first break of each file, in the lists' order.
pub fn one_each(breaks: &[Break]) -> Vec<Break> {
    let mut files = BTreeSet::new();
    breaks.iter().filter(|of| files.insert(&of.file)).cloned().collect()
}

/// What differs between the working tree and a revision.
#[derive(Clone, Debug)]
pub struct Changes {
    /// Files, from the workspace's root.
    pub files: BTreeSet<String>,
    /// Breaks that the lists had.
    pub listed: Vec<Break>,
}

impl Changes {
    /// The changes since a revision of git.
    ///
    /// # Errors
    /// A revision that git does not know.
    pub fn since(revision: &str) -> Result<Changes, String> {
        let git = |arguments: &[&str]| {
            let output = Command::new("git").current_dir(root()).args(arguments).output();
            let output = output.map_err(|error| format!("git: {error}"))?;
            let [text, fault] =
                [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
            if output.status.success() { Ok(text) } else { Err(format!("git {}: {fault}", arguments.join(" "))) }
        };
        let changed = git(&["diff", "--relative", "--name-only", "--no-renames", revision, "--"])?;
        let new = git(&["ls-files", "--others", "--exclude-standard"])?;
        // A revision may have had no such list, or one of another form: then all of its breaks are new.
        let list = |name: &str| {
            let text = git(&["show", &format!("{revision}:./{name}")]).ok()?;
            toml::from_str(&text).ok().map(|Breaks { breaks }| breaks)
        };
        let listed = [DEFINITIONS, MEASUREMENTS].into_iter().filter_map(list).flatten().collect();
        Ok(Changes { files: changed.lines().chain(new.lines()).map(String::from).collect(), listed })
    }

    /// Whether a break is of a file that has changed, or is new itself.
    pub fn touch(&self, of: &Break) -> bool {
        self.files.contains(&of.file) || !self.listed.contains(of)
    }
}

/// The files that hold definitions, from the workspace's root, in order: of every crate's `golden.rs` and those in a folder of that name
/// the ones that give functions to other rooms, and the arithmetic of words that they are made of.
///
/// # Panics
/// Where the folder of the crates cannot be read.
pub fn definitions() -> Vec<String> {
    let names = |folder: &str| -> Vec<String> {
        let entries = fs::read_dir(root().join(folder)).into_iter().flatten();
        entries.filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned())).collect()
    };
    let crates = names("crates");
    assert!(!crates.is_empty(), "the folder of the crates cannot be read");
    let golden = crates.iter().flat_map(|name| {
        let parts = format!("crates/{name}/src/golden");
        let parts = names(&parts).into_iter().map(move |part| format!("{parts}/{part}"));
        parts.chain([format!("crates/{name}/src/golden.rs")]).filter(|file| {
            let text = fs::read_to_string(root().join(file)).unwrap_or_default();
            ["pub fn ", "pub(crate) fn "].iter().any(|function| text.contains(function))
        })
    });
    let words = ["crates/word/src/rounding.rs", "crates/word/src/unit.rs"].map(String::from);
    let files: BTreeSet<String> = golden.chain(words).collect();
    files.into_iter().collect()
}

impl Break {
    /// The text of the broken file.
    ///
    /// # Errors
    /// A file that cannot be read, and a text to be replaced that is not there exactly once.
    pub fn text(&self) -> Result<String, String> {
        let text = fs::read_to_string(root().join(&self.file)).map_err(|error| format!("{}: {error}", self.file))?;
        match text.matches(&self.find).count() {
            1 => Ok(text.replacen(&self.find, &self.replace, 1)),
            count => Err(format!("{}: `{}` is there {count} times, not once ({})", self.file, self.find, self.what)),
        }
    }

    /// The tests that must catch it.
    pub fn suite(&self) -> Suite {
        match &self.test {
            Some(test) => Suite::Test(test.clone()),
            None => Suite::Crate(self.file.split('/').nth(1).unwrap_or_default().into()),
        }
    }
}

impl Suite {
    /// The package that it is in.
    pub fn package(&self) -> String {
        match self {
            Suite::Crate(name) => format!("cube3-{name}"),
            Suite::Test(_) => "cube3-tests".into(),
        }
    }

    /// The package's folder, from the workspace's root.
    fn folder(&self) -> PathBuf {
        match self {
            Suite::Crate(name) => Path::new("crates").join(name),
            Suite::Test(_) => "tests".into(),
        }
    }

    /// What is compiled and run, one after another. Most breaks are caught by the unit tests, and the others need not be compiled then.
    fn targets(&self) -> &'static [&'static [&'static str]] {
        match self {
            Suite::Crate(name) if root().join("crates").join(name).join("tests").is_dir() => {
                &[&["--lib"], &["--test", "all"]]
            }
            Suite::Crate(_) => &[&["--lib"]],
            Suite::Test(_) => &[&["--test", "all"]],
        }
    }

    /// What the programs are told: which of their tests are run.
    fn filter(&self) -> Option<String> {
        match self {
            Suite::Crate(_) => None,
            Suite::Test(module) => Some(format!("{module}::")),
        }
    }
}

/// What became of a break.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// A test failed, or did not end.
    Caught,
    /// All tests passed.
    Missed,
}

/// A copy of the workspace, which is compiled into a folder of its own.
pub struct Copy {
    folder: PathBuf,
}

impl Copy {
    /// Makes the copy under a folder, or brings up to date what is there: what has not changed is not compiled again.
    ///
    /// # Errors
    /// What cannot be read or written.
    pub fn new(folder: &Path) -> Result<Copy, String> {
        let copy = Copy { folder: folder.to_path_buf() };
        let sources = copy.sources();
        fs::create_dir_all(&sources).map_err(|error| format!("{}: {error}", sources.display()))?;
        PARTS.iter().try_for_each(|part| mirror(&root().join(part), &sources.join(part)))?;
        Ok(copy)
    }

    fn sources(&self) -> PathBuf {
        self.folder.join("workspace")
    }

    /// Runs a suite up to the first of its targets that does not pass; which that is.
    ///
    /// # Errors
    /// What does not compile.
    fn failing(&self, suite: &Suite) -> Result<Option<usize>, String> {
        for (number, targets) in suite.targets().iter().enumerate() {
            if !self.passes(suite, targets)? {
                return Ok(Some(number));
            }
        }
        Ok(None)
    }

    fn passes(&self, suite: &Suite, targets: &[&str]) -> Result<bool, String> {
        for program in self.compile(suite, targets)? {
            let mut run = Command::new(&program);
            run.current_dir(self.sources().join(suite.folder())).arg("--quiet").args(suite.filter());
            // What is found need not be made small.
            run.env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "true").env("PROPTEST_MAX_SHRINK_ITERS", "0");
            run.stdout(Stdio::null()).stderr(Stdio::null());
            if !ended(&mut run)?.is_some_and(|status| status.success()) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Tries breaks of a suite, one after another, and gives what became of each to `tell`. Targets that fail on a break must pass on the
    /// code as it is: else they would catch anything.
    ///
    /// # Errors
    /// A break that does not compile, a target that fails although nothing is broken, and files that cannot be read or written.
    pub fn try_breaks(
        &self,
        suite: &Suite,
        breaks: &[&Break],
        mut tell: impl FnMut(&Break, Outcome),
    ) -> Result<(), String> {
        let mut caught_by = BTreeSet::new();
        for of in breaks {
            let failing = self.broken(of).map_err(|error| format!("{}: \"{}\": {error}", of.file, of.what))?;
            tell(of, if failing.is_some() { Outcome::Caught } else { Outcome::Missed });
            caught_by.extend(failing);
        }
        for number in caught_by {
            if !self.passes(suite, suite.targets()[number])? {
                return Err(format!("{suite:?} of {} fails although nothing is broken", suite.package()));
            }
        }
        Ok(())
    }

    /// The target of its suite that fails on a break. The file is whole again afterwards.
    fn broken(&self, of: &Break) -> Result<Option<usize>, String> {
        let path = self.sources().join(&of.file);
        let write = |text: &str| fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()));
        let whole = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        write(&of.text()?)?;
        let outcome = self.failing(&of.suite());
        write(&whole)?;
        outcome
    }

    /// Compiles tests of a suite; the programs.
    fn compile(&self, suite: &Suite, targets: &[&str]) -> Result<Vec<PathBuf>, String> {
        let mut cargo = Command::new("cargo");
        cargo.args(["test", "--no-run", "--profile", "mutants", "--message-format", "json-render-diagnostics"]);
        cargo.args(["--package", &suite.package()]).args(targets);
        cargo.env("CARGO_TARGET_DIR", self.folder.join("made"));
        let output = cargo.current_dir(self.sources()).output().map_err(|error| format!("cargo: {error}"))?;
        if !output.status.success() {
            return Err(format!("{} does not compile\n{}", suite.package(), String::from_utf8_lossy(&output.stderr)));
        }
        let messages = String::from_utf8_lossy(&output.stdout).into_owned();
        let programs = messages.lines().filter_map(|line| {
            // Programs of the package, which are made for its tests, are none.
            let message: Message = serde_json::from_str(line).ok()?;
            message.executable.filter(|_| message.profile.is_some_and(|profile| profile.test))
        });
        Ok(programs.collect())
    }
}

/// What cargo says of a program that it has made.
#[derive(Deserialize)]
struct Message {
    executable: Option<PathBuf>,
    profile: Option<Profile>,
}

/// How it was made.
#[derive(Deserialize)]
struct Profile {
    test: bool,
}

/// Runs a program to its end; none where it is stuck and was stopped.
fn ended(program: &mut Command) -> Result<Option<ExitStatus>, String> {
    let name = PathBuf::from(program.get_program());
    let fault = |error: std::io::Error| format!("{}: {error}", name.display());
    let start = Instant::now();
    let mut child = program.spawn().map_err(fault)?;
    while start.elapsed() < LIMIT {
        if let Some(status) = child.try_wait().map_err(fault)? {
            return Ok(Some(status));
        }
        sleep(Duration::from_millis(5));
    }
    child.kill().and_then(|()| child.wait()).map_err(fault)?;
    Ok(None)
}

/// Makes `to` what `from` is: a file, or a folder with all that is in it. Files that are the same are not touched.
fn mirror(from: &Path, to: &Path) -> Result<(), String> {
    let fault = |path: &Path, error: std::io::Error| format!("{}: {error}", path.display());
    if from.is_file() {
        let bytes = fs::read(from).map_err(|error| fault(from, error))?;
        if fs::read(to).is_ok_and(|there| there == bytes) {
            return Ok(());
        }
        return fs::write(to, bytes).map_err(|error| fault(to, error));
    }
    fs::create_dir_all(to).map_err(|error| fault(to, error))?;
    let names = |folder: &Path| -> Result<BTreeSet<std::ffi::OsString>, String> {
        let entries = fs::read_dir(folder).map_err(|error| fault(folder, error))?;
        entries.map(|entry| Ok(entry.map_err(|error| fault(folder, error))?.file_name())).collect()
    };
    let wanted = names(from)?;
    for gone in names(to)?.difference(&wanted).map(|name| to.join(name)) {
        let removed = if gone.is_dir() { fs::remove_dir_all(&gone) } else { fs::remove_file(&gone) };
        removed.map_err(|error| fault(&gone, error))?;
    }
    wanted.iter().try_for_each(|name| mirror(&from.join(name), &to.join(name)))
}
