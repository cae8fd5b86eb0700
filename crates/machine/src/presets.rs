//! Machines that have a name.

use crate::MachineSpec;

/// Each name with its machine file, which says where its numbers are from.
pub const PRESETS: [(&str, &str); 7] = [
    ("cube3-128", MachineSpec::COMMENTED_DEFAULT),
    ("cube3-256", include_str!("../presets/cube3-256.toml")),
    ("cube3-512", include_str!("../presets/cube3-512.toml")),
    ("cube3-board", include_str!("../presets/cube3-board.toml")),
    ("cube4-teramac", include_str!("../presets/cube4-teramac.toml")),
    ("em-cube", include_str!("../presets/em-cube.toml")),
    ("volumepro-500", include_str!("../presets/volumepro-500.toml")),
];
