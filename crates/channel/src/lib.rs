//! Clock, bounded pipelined channels, and the accounting of units.
//!
//! A machine is a set of units that are joined by [`Channel`]s. In every cycle each unit ticks once, in any
//! order, and then every channel commits; what was pushed becomes visible, and what was popped gives its
//! credit back, only after that. So the order of the ticks cannot matter.
//!
//! ```text
//!            push             pop
//!   unit A ───────► channel ───────► unit B      tick A, tick B, …, then commit every channel
//!          ◄─ credit         ◄─ token
//! ```

mod account;
mod archive;
mod channel;
mod clock;
mod pipe;
mod stall;
mod transfer;

pub use account::{Account, Activity, Reason};
pub use archive::{Archive, ArchiveError, Archived, Payload};
pub use channel::{Channel, ChannelCounters, ChannelError};
pub use clock::{ClockDomain, gcd};
pub use pipe::Pipe;
pub use stall::{Deadlock, PortState, Wait, diagnose};
pub use transfer::TokenTransfer;
