//! The words of a command as a person would type them.

/// The words with spaces between; quoted for a POSIX shell where it would read a word as something else.
pub(crate) fn command_line(words: &[String]) -> String {
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./:=,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.into() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_split_or_read_them() {
        for (words, line) in [
            (vec!["cube3", "run", "--yaw", "-30"], "cube3 run --yaw -30"),
            (vec!["cube3", "run", "--volume", "my head.nrrd"], "cube3 run --volume 'my head.nrrd'"),
            (vec!["cube3", ""], "cube3 ''"),
            (vec!["it's", "$HOME", "a*"], r"'it'\''s' '$HOME' 'a*'"),
            (vec![], ""),
        ] {
            let words: Vec<String> = words.into_iter().map(String::from).collect();
            assert_eq!(command_line(&words), line);
        }
    }
}
