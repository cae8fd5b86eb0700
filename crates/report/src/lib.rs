//! The report of `cube3 run`: what the machine did, what it cost and how far the picture is off.
//!
//! [`RunReport`] holds every number once. [`to_json`], [`table`] and [`html`] are three views of it,
//! for a script, a terminal and a browser:
//!
//! ```text
//!                  ┌─► to_json, write_json   report.json
//!     RunReport ───┼─► table                 the terminal
//!                  └─► html  ◄── png_rgb8    report.html, one page that needs nothing else
//! ```

mod adapters;
mod bars;
mod check;
mod command_line;
mod digest;
mod drawing;
mod error;
mod fact;
mod facts;
mod glossary;
mod headline;
mod html;
mod json;
mod measures;
mod opacity_report;
mod parameter_list;
mod pictures;
mod png;
mod quantity;
mod resources_report;
mod run_report;
mod savings;
mod schema;
mod sequence;
mod shares;
mod table;
mod topology;

pub use self::png::{png_rgb8, to_rgb8};
pub use adapters::{axes_report, channel_reports, left_out, traffic_report, unit_reports, view_report};
pub use digest::{DigestReport, sha256_hex};
pub use error::ReportError;
pub use html::html;
pub use json::{from_json, to_json, write_json};
pub use opacity_report::{OpacityChange, OpacityReport};
pub use parameter_list::{name_list, parameter_list};
pub use pictures::Figure;
pub use quantity::{count, number, percentage};
pub use resources_report::{
    InterfaceReport, LimitWithout, LimitsReport, LinesReport, LinkReport, MemoryBits, MemoryTraffic, OperatorsReport,
    ReorderTraffic, ResourcesReport, TrafficReport,
};
pub use run_report::{
    AxesReport, ChannelReport, ErrorReport, FootprintError, LeftOut, NO_OBJECT, PassReport, PerspectiveReport,
    PlanReport, Program, ReferenceError, RunReport, SCHEMA, SidesReport, SourcesReport, TimingCounts, TimingReport,
    UnitReport, ViewReport, VolumeReport, WallReport, WordsReport,
};
pub use savings::SavingsReport;
pub use schema::JSON_SCHEMA;
pub use sequence::{AcquisitionReport, FrameReport, SequenceReport};
pub use table::table;
pub use topology::Drawing;
