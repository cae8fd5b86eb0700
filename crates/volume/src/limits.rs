//! How much memory there is, and how much a volume may take, checked before it is taken.

use crate::error::show_dims;
use crate::{Ordering, RawLayout, SampleType, VolumeError};
use rustix::process::{Resource, getrlimit};
use std::fmt;
use std::fs::read_to_string;
use std::path::{Path, PathBuf};

/// Allowed where the system does not say how much memory it has: 16 GiB.
const FALLBACK_LIMIT_BYTES: u64 = 16 << 30;
/// Where control groups are, of the second and of the first version.
const GROUPS: &str = "/sys/fs/cgroup";

/// What bounds the memory that can be taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryBound {
    /// What the system can give: `MemAvailable` of `/proc/meminfo`.
    System,
    /// The limit of the process's control group, or of one above it.
    ControlGroup,
    /// The address space of the process, as `ulimit -v` sets it.
    AddressSpace,
    /// An assumption: the system says nothing.
    Assumed,
}

impl fmt::Display for MemoryBound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            MemoryBound::System => "available on this machine (MemAvailable of /proc/meminfo)",
            MemoryBound::ControlGroup => "left in the control group (its memory.max)",
            MemoryBound::AddressSpace => "left in the address space (ulimit -v)",
            MemoryBound::Assumed => "assumed to be there: the system does not say",
        })
    }
}

/// Memory that can be taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Bytes.
    pub bytes: u64,
    /// What allows no more.
    pub bound: MemoryBound,
}

/// What can be taken under each bound that there is; at least one.
pub fn memory_bounds() -> Vec<Memory> {
    let proc = |name: &str| read_to_string(Path::new("/proc").join(name)).unwrap_or_default();
    let address_space = getrlimit(Resource::As).current.map(|limit| {
        let mapped = kib(&proc("self/status"), "VmSize:").unwrap_or(0);
        limit.saturating_sub(mapped)
    });
    let found = [
        (kib(&proc("meminfo"), "MemAvailable:"), MemoryBound::System),
        (control_group(&proc("self/cgroup"), Path::new(GROUPS)), MemoryBound::ControlGroup),
        (address_space, MemoryBound::AddressSpace),
    ];
    let mut bounds: Vec<Memory> =
        found.into_iter().filter_map(|(bytes, bound)| bytes.map(|bytes| Memory { bytes, bound })).collect();
    if bounds.is_empty() {
        bounds.push(Memory { bytes: FALLBACK_LIMIT_BYTES, bound: MemoryBound::Assumed });
    }
    bounds
}

/// The memory that can be taken: the least of [`memory_bounds`]. The system's numbers move from one reading to the next.
pub fn available_memory() -> Memory {
    least(memory_bounds())
}

/// The bound that allows the least; the first of equal ones.
fn least(bounds: Vec<Memory>) -> Memory {
    let least = bounds.into_iter().min_by_key(|memory| memory.bytes);
    least.unwrap_or(Memory { bytes: FALLBACK_LIMIT_BYTES, bound: MemoryBound::Assumed })
}

/// A number of KiB behind a name at the beginning of a line, in bytes.
fn kib(text: &str, name: &str) -> Option<u64> {
    let number = text.lines().find_map(|line| line.strip_prefix(name))?;
    number.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// What the control groups of a process, as `/proc/self/cgroup` names them, and those above them leave of their limits: their pages of
/// files, which the system takes back when it needs them, are not counted.
fn control_group(groups: &str, root: &Path) -> Option<u64> {
    let line = |line: &str| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?.trim_start_matches('/'));
        // The second version has one tree, and no names of controllers; the first a tree for each.
        if controllers.is_empty() {
            return left(root.to_owned(), path, ["memory.max", "memory.current", "inactive_file"]);
        }
        let memory = controllers.split(',').any(|controller| controller == "memory");
        let names = ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"];
        if memory { left(root.join("memory"), path, names) } else { None }
    };
    groups.lines().filter_map(line).min()
}

/// The least that is left from a tree's root down to a group: names of the limit, the use, and the pages of files in `memory.stat`.
fn left(root: PathBuf, path: &str, [limit, used, files]: [&str; 3]) -> Option<u64> {
    let below = path.split('/').scan(root.clone(), |folder, name| {
        folder.push(name);
        Some(folder.clone())
    });
    let of = |folder: PathBuf| {
        let number = |name: &str| read_to_string(folder.join(name)).ok()?.trim().parse::<u64>().ok();
        let (limit, used) = (number(limit)?, number(used)?);
        let stat = read_to_string(folder.join("memory.stat")).unwrap_or_default();
        let files = stat.lines().find_map(|line| line.strip_prefix(files)?.trim().parse::<u64>().ok()).unwrap_or(0);
        Some(limit.saturating_sub(used.saturating_sub(files)))
    };
    std::iter::once(root).chain(below).filter_map(of).min()
}

/// How to read a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The most memory that the samples may take, in bytes. `None`: what can be taken
    /// ([`available_memory`]).
    pub memory_limit_bytes: Option<u64>,
    /// Which volume to take, from 0, of a file that holds a series (a fourth axis).
    pub frame: usize,
    /// How the grid's axes run.
    pub ordering: Ordering,
    /// What a bare raw file holds. Other formats say so themselves and ignore it.
    pub raw: Option<RawLayout>,
}

impl ReadOptions {
    /// The limit in force, in bytes.
    pub fn limit(&self) -> u64 {
        self.memory_limit_bytes.unwrap_or_else(|| available_memory().bytes)
    }
}

/// The number of samples of a grid, if they fit the address space and the limit.
pub(crate) fn sample_count(
    dims: [usize; 3],
    sample_type: SampleType,
    limit: u64,
    file: &str,
) -> Result<usize, VolumeError> {
    let too_large = |needed: String| VolumeError::TooLarge {
        file: file.to_owned(),
        dims: show_dims(&dims),
        sample_type,
        needed,
        limit,
    };
    let count = dims.iter().try_fold(1u64, |p, &d| p.checked_mul(d as u64));
    let bytes = count.and_then(|c| c.checked_mul(sample_type.bytes() as u64));
    match (count, bytes) {
        (Some(c), Some(b)) if b <= limit && b <= isize::MAX as u64 => Ok(c as usize),
        (_, Some(b)) => Err(too_large(b.to_string())),
        _ => Err(too_large("more than 2^64".to_owned())),
    }
}

/// An empty vector with room for `count` samples, or an error where the system has no memory.
pub(crate) fn reserve<T>(
    count: usize,
    dims: [usize; 3],
    sample_type: SampleType,
    file: &str,
) -> Result<Vec<T>, VolumeError> {
    let mut samples = Vec::new();
    let needed = (count as u64).saturating_mul(size_of::<T>() as u64);
    samples.try_reserve_exact(count).map_err(|_| no_room(file, dims, sample_type, needed))?;
    Ok(samples)
}

/// The error of a system that has less memory than it said.
pub(crate) fn no_room(file: &str, dims: [usize; 3], sample_type: SampleType, needed: u64) -> VolumeError {
    VolumeError::TooLarge {
        file: file.to_owned(),
        dims: show_dims(&dims),
        sample_type,
        needed: needed.to_string(),
        limit: available_memory().bytes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::{create_dir_all, write};

    #[test]
    fn numbers_of_the_system_are_in_kib() {
        let text = "MemTotal:  24 kB\nMemAvailable:     3 kB\nVmSize:\t12 MB\n";
        assert_eq!((kib(text, "MemAvailable:"), kib(text, "VmSize:"), kib(text, "MemFree:")), (Some(3072), None, None));
    }

    /// Groups of the second version: the tightest one of all above binds, without its pages of files.
    #[test]
    fn the_tightest_control_group_binds() {
        let root = tempfile::tempdir().unwrap();
        let group = |path: &str, limit: &str, used: &str, files: &str| {
            let folder = root.path().join(path);
            create_dir_all(&folder).unwrap();
            write(folder.join("memory.max"), limit).unwrap();
            write(folder.join("memory.current"), used).unwrap();
            write(folder.join("memory.stat"), format!("anon 5\ninactive_file {files}\n")).unwrap();
        };
        let left = |text: &str| control_group(text, root.path());
        assert_eq!(left("0::/a/b/c\n"), None);
        group("a", "1000\n", "300\n", "100");
        group("a/b", "max\n", "200\n", "0");
        assert_eq!(left("0::/a/b/c\n"), Some(800));
        group("a/b/c", "500\n", "600\n", "20");
        assert_eq!(left("0::/a/b/c\n"), Some(0));
        assert_eq!(left("0::/a/b\n"), Some(800));
        assert_eq!(left("0::/\n"), None);
        group("", "90\n", "30\n", "0");
        assert_eq!((left("0::/\n"), left("0::/a\n"), left("1:cpu:/a\n")), (Some(60), Some(60), None));
    }

    #[test]
    fn a_control_group_of_the_first_version_binds() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("memory/job");
        create_dir_all(&folder).unwrap();
        write(folder.join("memory.limit_in_bytes"), "4096\n").unwrap();
        write(folder.join("memory.usage_in_bytes"), "1096\n").unwrap();
        write(folder.join("memory.stat"), "inactive_file 7\ntotal_inactive_file 96\n").unwrap();
        let left = |text: &str| control_group(text, root.path());
        assert_eq!(left("7:cpu,memory:/job\n3:pids:/other\n"), Some(3096));
        assert_eq!(left("3:pids:/job\n"), None);
    }

    #[test]
    fn the_least_bound_is_what_is_available() {
        let of = |bytes, bound| Memory { bytes, bound };
        let (system, group, space) =
            (of(9, MemoryBound::System), of(4, MemoryBound::ControlGroup), of(4, MemoryBound::AddressSpace));
        assert_eq!(least(vec![system, group, space]), group);
        assert_eq!(least(vec![space, system]), space);
        assert_eq!(least(vec![]), of(FALLBACK_LIMIT_BYTES, MemoryBound::Assumed));
    }

    /// What the system itself says: two readings need not be equal, so each is looked at alone.
    #[test]
    fn the_system_says_what_it_has() {
        let bounds = memory_bounds();
        assert!(bounds.iter().any(|memory| memory.bound == MemoryBound::System) && !bounds.is_empty());
        assert!(bounds.iter().all(|memory| memory.bound != MemoryBound::Assumed));
        assert!(available_memory().bytes > 0);
    }
}
