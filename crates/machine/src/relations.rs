//! What must hold between the values of a machine, each of them legal on its own.

use crate::{ControllerKind, Layout, MachineSpec, MemoryModel};
use cube3_parameter::{Choice, Field, Value};

/// Values that do not go together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} = {value} is {reason}")]
pub struct Conflict {
    /// The key of the value that is told.
    pub key: &'static str,
    /// The value.
    pub value: Value,
    /// What it is, and what would be right.
    pub reason: &'static str,
}

/// Whether the values go together.
///
/// # Errors
/// The first that do not.
pub fn check(machine: &MachineSpec) -> Result<(), Conflict> {
    let check =
        |good: bool, key, value: Value, reason| if good { Ok(()) } else { Err(Conflict { key, value, reason }) };
    let cfb = &machine.cfb;
    let mini_blocks = cfb.layout == Layout::MiniBlocks;
    check(
        cfb.layout.takes(cfb.skew, machine.lanes),
        "cfb.skew",
        cfb.skew.value(),
        "not for cfb.layout = \"mini-blocks\": its first coefficient shares a factor with the lanes; choose another skew or layout",
    )?;
    check(
        !mini_blocks || cfb.controller == ControllerKind::InOrder,
        "cfb.controller",
        Value::Text(cfb.controller.name().to_owned()),
        "not for cfb.layout = \"mini-blocks\": their rows are read in order; leave it \"in-order\", or choose another layout",
    )?;
    check(
        cfb.reorder_words.is_none() || mini_blocks,
        "cfb.reorder_words",
        cfb.reorder_words.value(),
        "only for cfb.layout = \"mini-blocks\": other layouts are read in the order of the beams; leave it out",
    )?;
    let clock_hz = machine.memory_clock_hz();
    check(
        MemoryModel::of_machine(cfb).refreshes_in_time(clock_hz),
        "cfb.memory_clock_hz",
        clock_hz.value(),
        "too slow: refreshing would take more than a quarter of the time; give a faster clock",
    )?;
    check(
        clock_hz / machine.clock_hz <= MemoryModel::MOST_TICKS,
        "cfb.memory_clock_hz",
        clock_hz.value(),
        "above 65536 ticks in a cycle of clock_hz; give a slower clock, or a faster pipeline",
    )
}
