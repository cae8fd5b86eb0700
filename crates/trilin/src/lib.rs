//! Sheared trilinear interpolation
