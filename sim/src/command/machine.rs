//! `cube3 machine`: presets, parameters, a machine with every key.

use super::list::ListArguments;
use super::run::print;
use crate::problem::Outcome;
use clap::Args;
use cube3_inputs as inputs;
use cube3_machine::{MachineSpec, PARAMETERS, PRESETS, about};
use cube3_report::name_list;

/// Arguments of `cube3 machine`.
#[derive(Debug, Args)]
pub struct MachineArguments {
    /// Preset or machine file to print with every key, its range and what it is; the default machine without it.
    #[arg(value_name = "NAME|FILE.toml", conflicts_with = "parameters")]
    machine: Option<String>,
    #[command(flatten)]
    list: ListArguments,
    /// List the presets.
    #[arg(long, conflicts_with_all = ["machine", "parameters"])]
    presets: bool,
}

impl MachineArguments {
    /// Prints what is asked for.
    ///
    /// # Errors
    /// A machine that cannot be read.
    pub fn execute(self) -> Outcome<()> {
        if let Some(list) = self.list.of(PARAMETERS, &MachineSpec::default())? {
            return print(&list);
        }
        if self.presets {
            return print(&name_list(&PRESETS.map(|(name, text)| (name, about(text)))));
        }
        let machine = self.machine.map_or_else(|| Ok(MachineSpec::default()), |name| inputs::machine(&name))?;
        print(&machine.commented())
    }
}
