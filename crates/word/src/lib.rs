//! Fixed-point words: rounding, saturation, interpolation, every bit-exact operation
