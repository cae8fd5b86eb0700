//! From what the machine's crates count and hold to parts of the report.

mod counters;
mod directions;
mod plan;
mod view;

pub use counters::{channel_reports, traffic_report, unit_reports};
pub use directions::axes_report;
pub use plan::left_out;
pub use view::view_report;
