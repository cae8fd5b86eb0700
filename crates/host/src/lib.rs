//! The host computer: base plane, templates, tables, registers, warp
