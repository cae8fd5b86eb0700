//! Cubic frame buffer: 3-D skewed memory modules
