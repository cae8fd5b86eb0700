//! Parameters of files as rows of tables.
//!
//! A [`Parameter`] says of one key what it is, which values are legal where the rest is as it is, and how it is read and set. Checks, printed
//! defaults, lists of parameters and studies that vary one read the same rows. [`locate`] finds a key's line in a text, and [`Unread`] says
//! in plain words why a text could not be read.

mod choice;
mod describe;
mod explain;
mod fault;
mod field;
mod legal;
pub mod locate;
mod row;
mod value;

pub use choice::{Choice, named, names, nearest_name};
pub use describe::Description;
pub use explain::Unread;
pub use fault::{Fault, check, number_fault};
pub use field::{Field, Unfit, ValueKind, assign, assign_each, each, kind, kind_of_each, legal, optional};
pub use legal::Legal;
pub use row::Parameter;
pub use value::Value;
