//! The machine put together: units on their channels, with data in every token (*cycle*) or in none (*timing*).
//!
//! ```text
//!   cfb ─[beams]─► bus ─[aligned]─► dsb ─[rays]─► trilin ─[samples]─► abc ─[shaded]─► cone ─[pixels]─► host
//! ```
//!
//! - [`Machine`]: units and channels; its `tick` reads like the block diagram.
//! - [`Fidelity`]: what tokens carry.
//! - [`links`]: what boards cost. [`host_port`]: the machine's end of the host link.
//! - [`checkpoint`]: a run saved at a cycle. [`acquisition`]: what a frame saw of volumes that came in while it was read.

#![warn(missing_docs)]

pub mod acquisition;
mod archive;
mod assemble;
pub mod checkpoint;
mod counters;
mod error;
mod fidelity;
pub mod host_port;
mod identity;
pub mod links;
mod machine;
mod token;

pub use assemble::Data;
pub use counters::{ChannelReading, RunCounters};
pub use error::RunError;
pub use fidelity::{Cycle, Fidelity, Timing};
pub use machine::{CHANNELS, Joint, Machine, UNITS};
pub use token::{Token, TokenKind};
