//! Machines that have a name.

/// Each name with its machine file, which says where its numbers are from.
pub const PRESETS: [(&str, &str); 7] = [
    ("cube3-128", include_str!("../presets/cube3-128.toml")),
    ("cube3-256", include_str!("../presets/cube3-256.toml")),
    ("cube3-512", include_str!("../presets/cube3-512.toml")),
    ("cube3-board", include_str!("../presets/cube3-board.toml")),
    ("cube4-teramac", include_str!("../presets/cube4-teramac.toml")),
    ("em-cube", include_str!("../presets/em-cube.toml")),
    ("volumepro-500", include_str!("../presets/volumepro-500.toml")),
];

/// What a machine file says of itself: the first sentence of the comment that it begins with.
pub fn about(text: &str) -> String {
    let comment = text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim);
    let comment = comment.collect::<Vec<_>>().join(" ");
    let ends = |at: &usize| comment[at + 1..].trim_start().chars().next().is_none_or(char::is_uppercase);
    let end = comment.match_indices('.').map(|(at, _)| at).find(ends);
    comment[..end.unwrap_or(comment.len())].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_preset_is_told_by_its_first_sentence() {
        assert_eq!(
            about("# A machine (Osborne et al. 1997) of 1.5 parts,\n# small. The rest\nlanes = 3"),
            "A machine (Osborne et al. 1997) of 1.5 parts, small"
        );
        assert!(PRESETS.iter().all(|(_, text)| !about(text).is_empty()));
    }
}
