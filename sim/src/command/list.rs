//! Lists of parameters.

use crate::problem::Outcome;
use clap::Args;
use cube3_parameter::{Description, Parameter};
use cube3_report::parameter_list;

/// Options of a list of parameters.
#[derive(Debug, Args)]
pub struct ListArguments {
    /// List every parameter: key, default, range, what it is.
    #[arg(long)]
    parameters: bool,
    /// List them as JSON, with kinds, units and sources.
    #[arg(long, requires = "parameters")]
    json: bool,
}

impl ListArguments {
    /// The list of a table, if it is asked for.
    ///
    /// # Errors
    /// JSON that cannot be made.
    pub fn of<T>(&self, table: &[Parameter<T>], default: &T) -> Outcome<Option<String>> {
        if !self.parameters {
            return Ok(None);
        }
        let parameters: Vec<Description> = table.iter().map(|row| row.describe(default)).collect();
        Ok(Some(if self.json {
            serde_json::to_string_pretty(&parameters)? + "\n"
        } else {
            parameter_list(&parameters)
        }))
    }
}
