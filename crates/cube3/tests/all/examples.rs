//! The examples run.

#[allow(dead_code, reason = "the program begins elsewhere")]
#[path = "../../examples/check_unit.rs"]
mod check_unit;
#[path = "../../examples/picture_error.rs"]
mod picture_error;
#[path = "../../examples/throughput.rs"]
mod throughput;

#[test]
fn a_throughput_report() {
    throughput::main().unwrap();
}

#[test]
fn a_picture_with_its_error() {
    picture_error::main().unwrap();
}

#[test]
fn a_unit_checked_against_outside_vectors() {
    check_unit::devices().unwrap();
}
