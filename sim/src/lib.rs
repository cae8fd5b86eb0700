//! The Cube-3 machine put together, the experiments on it, and the `cube3` command.

pub mod bench;
pub mod command;
pub mod fidelity;
pub mod function;
mod function_perspective;
pub mod gradient_error;
pub mod host_port;
pub mod inputs;
pub mod machine;
pub mod output;
pub mod problem;
pub mod progress;
pub mod run;
