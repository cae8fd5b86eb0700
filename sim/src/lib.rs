//! The Cube-3 machine put together, and the experiments on it.

pub mod fidelity;
pub mod function;
pub mod host_port;
pub mod machine;
