//! The base plane of a frame without the clock: bands of planes on all cores.

use crate::canonical_volume::CanonicalVolume;
use crate::parallel::Worker;
use crate::perspective::PassWorker;
use cube3_abc::lanes::AbcLanes;
use cube3_cone::lanes::Accumulator;
use cube3_frame::{BasePlane, FrameSetup, Overflows, Schedule};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// What a function run gives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FunctionRun {
    /// The base plane.
    pub base: BasePlane,
    /// Words that were saturated.
    pub overflows: Overflows,
}

/// Renders the base plane on all cores of the current rayon pool. With `skip`, transparent stretches are not shaded,
/// which changes no bit. `progress(done, all)` is called with the planes that are done.
pub fn render(
    setup: &FrameSetup,
    volume: &CanonicalVolume<'_>,
    skip: bool,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> FunctionRun {
    if setup.words.accumulator_bits <= 16 {
        render_in::<u32>(setup, volume, skip, progress)
    } else {
        render_in::<u64>(setup, volume, skip, progress)
    }
}

fn render_in<T: Accumulator>(
    setup: &FrameSetup,
    volume: &CanonicalVolume<'_>,
    skip: bool,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> FunctionRun {
    let geometry = &setup.geometry;
    let mut base = BasePlane::empty(geometry, setup.words.accumulator_bits);
    let width = base.width;
    let schedule = Schedule::of(geometry, setup.cone.leaves, None);
    let bands = schedule.bands(geometry, 4 * rayon::current_num_threads());
    let done = AtomicU64::new(0);
    // One set of tables for all bands.
    let abc = AbcLanes::new(setup, skip);
    let overflows = base
        .pixels
        .par_chunks_mut(width * bands.height())
        .enumerate()
        .map(|(number, pixels)| {
            let (rows, pixels) = (bands.band(number), pixels.chunks_mut(width));
            let count = pixels.len() as u64;
            let overflows = match &geometry.perspective {
                None => Worker::<T>::new(setup, &bands, volume, abc.clone()).band(rows, pixels),
                Some(pass) => PassWorker::<T>::new(setup, pass, &bands, volume, abc.clone()).band(rows, pixels),
            };
            let done = done.fetch_add(count, Ordering::Relaxed) + count;
            progress(done, bands.rows() as u64);
            overflows
        })
        .reduce(Overflows::default, Overflows::plus);
    FunctionRun { base, overflows }
}
