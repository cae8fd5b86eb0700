//! What to show: view, transfer function, light, mode, cut planes
