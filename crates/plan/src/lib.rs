//! What a scene does not need of a machine: rules, which of them a frame follows, and what each saves.
//!
//! ```text
//!   scene, machine, rules ──► Plan ──► host ──► registers ──► items
//! ```
//! A [`Plan`] says which parts a frame gets, before any is made. What a rule leaves out changes no bit of the picture. The items are read off
//! the registers that were made, so that list and frame cannot differ.

mod item;
mod needs;
mod rules;
mod savings;

pub use item::Item;
pub use needs::{Needs, Plan, Presence};
pub use rules::{RULES, Rule, RuleRow, Rules};
pub use savings::Savings;
