//! The Cube-3 machine put together, the experiments on it, and the `cube3` command.

pub mod acquisition;
pub mod animation;
pub mod bench;
pub mod checkpoint;
pub mod clocked;
pub mod command;
pub mod fidelity;
pub mod function;
mod function_perspective;
pub mod gradient_error;
pub mod host_port;
pub mod inputs;
pub mod limits;
pub mod links;
pub mod machine;
pub mod output;
pub mod problem;
pub mod progress;
mod ray_spacing;
pub mod record;
pub mod resources;
pub mod rtl_frame;
pub mod run;
pub mod sequence;
pub mod topology;
pub mod trace;
pub mod words_study;
