//! Image and gradient errors
