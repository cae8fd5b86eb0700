//! The clock over all frames of a sequence, while volumes come in.

use crate::machine_run::MachineRun;
use crate::options::Runs;
use crate::{Error, Outcome};
use cube3_cfb::{AcquisitionPort, PortSpec};
use cube3_frame::{BasePlane, FrameSetup, Overflows};
use cube3_inputs::Series;
use cube3_machine::MachineSpec;
use cube3_picture::Watch;
use cube3_pipeline::{Machine, RunCounters, RunError, Timing};
use std::sync::Arc;
use std::time::Instant;

/// What the clock gave.
pub(crate) struct Clocked {
    pub(crate) counters: RunCounters,
    pub(crate) port: Option<AcquisitionPort>,
    /// In runs with real data, the base planes.
    pub(crate) bases: Vec<BasePlane>,
    pub(crate) overflows: Overflows,
}

/// Runs the clock over all frames, of which some begin a picture, with or without data.
pub(crate) fn clock(
    machine: &MachineSpec,
    series: &mut Series,
    (setups, pictures): (Vec<Arc<FrameSetup>>, Vec<u32>),
    port: Option<PortSpec>,
    runs: Runs,
    run: &mut MachineRun,
    watch: Watch<'_>,
) -> Outcome<Clocked> {
    let start = Instant::now();
    let data = (runs == Runs::Cycle).then(|| setups.clone());
    let mut timing: Machine<Timing> = Machine::timing(machine, setups)?;
    if let Some(port) = port {
        timing.acquire(port);
        timing.begin_pictures(pictures.clone());
    }
    timing.run(&|done, all| watch("timing", done, all)).map_err(RunError::from)?;
    let (counters, after) = (timing.counters(), timing.port().cloned());
    let seconds = start.elapsed().as_secs_f64();
    let Some(setups) = data else {
        run.timing_s = Some(seconds);
        return Ok(Clocked { counters, port: after, bases: Vec::new(), overflows: Overflows::default() });
    };
    let start = Instant::now();
    let first = series.shared_first();
    let mut machine = Machine::cycle(machine, setups, first.words.dims, &first.words.words)?;
    if let (Some(spec), Some(port)) = (port, &after) {
        let begun = port.written().div_ceil(spec.voxels);
        let limit = series.limit_bytes();
        let bytes = begun.saturating_mul(spec.voxels * 2);
        if bytes > limit {
            return Err(Error::Volumes { volumes: begun, bytes, limit });
        }
        let words = (1..=begun).map(|index| Ok(series.volume(index)?.words.words.clone()));
        machine.acquire_volumes(spec, words.collect::<Outcome<Vec<Vec<u16>>>>()?);
        machine.begin_pictures(pictures);
    }
    machine.run(&|done, all| watch("cycle", done, all)).map_err(RunError::from)?;
    run.cycle_s = Some(start.elapsed().as_secs_f64());
    let (counters, port, overflows) = (machine.counters(), machine.port().cloned(), machine.overflows());
    Ok(Clocked { counters, port, bases: machine.into_base_planes(), overflows })
}
