//! Fast bus and 2-D skewed buffers
