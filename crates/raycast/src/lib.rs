//! Reference ray casters in f64
