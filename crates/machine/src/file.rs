//! Machines as TOML text.

use crate::{MachineError, MachineSpec, PARAMETERS, relations};
use cube3_parameter::locate::line_of;
use cube3_parameter::{Unread, check, number_fault};
use toml::de::DeTable;

impl MachineSpec {
    /// Reads a machine file's text; `place` names it in errors.
    ///
    /// # Errors
    /// Syntax, unknown keys and names, and values out of range, each with its place.
    pub fn from_toml(text: &str, place: &str) -> Result<MachineSpec, MachineError> {
        let at = |line: Option<usize>| line.map_or_else(|| place.to_owned(), |line| format!("{place}:{line}"));
        let syntax = |error: toml::de::Error, document: &DeTable| {
            let unread = Unread::new(&error, text, document);
            MachineError::Syntax { place: at(unread.line), unread }
        };
        let document = DeTable::parse(text).map_err(|error| syntax(error, &DeTable::new()))?;
        let document = document.get_ref();
        let place_of = |key: &str| at(line_of(text, document, key));
        let machine: MachineSpec = toml::from_str(text).map_err(|error| {
            let error = syntax(error, document);
            match number_fault(PARAMETERS, text, document, error.key()) {
                Some(fault) => MachineError::Value { place: place_of(&fault.key), fault: Box::new(fault) },
                None => error,
            }
        })?;
        machine.check_at(place_of)?;
        Ok(machine)
    }

    /// The machine as a file.
    pub fn to_toml(&self) -> String {
        toml::to_string_pretty(self).unwrap_or_default()
    }

    /// Checks every range and what must hold between values; `place` names the machine in errors.
    ///
    /// # Errors
    /// The first value out of range, then the first that do not go together.
    pub fn check(&self, place: &str) -> Result<(), MachineError> {
        self.check_at(|_| place.to_owned())
    }

    fn check_at(&self, place_of: impl Fn(&str) -> String) -> Result<(), MachineError> {
        check(PARAMETERS, self).map_err(|fault| MachineError::Value { place: place_of(&fault.key), fault })?;
        relations::check(self).map_err(|conflict| MachineError::Conflict { place: place_of(conflict.key), conflict })
    }
}
