//! How much memory a volume may take, checked before it is taken.

use crate::error::show_dims;
use crate::{Ordering, RawLayout, SampleType, VolumeError};

/// Allowed where the system does not say how much memory it has: 16 GiB.
const FALLBACK_LIMIT_BYTES: u64 = 16 << 30;

/// How to read a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The most memory that the samples may take, in bytes. `None`: what the system says is
    /// available (`MemAvailable` of `/proc/meminfo`), or 16 GiB where it says nothing.
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
        self.memory_limit_bytes.unwrap_or_else(|| available_memory().unwrap_or(FALLBACK_LIMIT_BYTES))
    }
}

fn available_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kib.checked_mul(1024)
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
        limit: available_memory().unwrap_or(0),
    }
}
