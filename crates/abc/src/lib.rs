//! Gradient estimation, classification and shading
