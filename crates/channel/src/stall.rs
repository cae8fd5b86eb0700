//! When nothing can move: who waits for whom.

use std::fmt;

/// What a port lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PortState {
    /// An input with no token.
    Empty,
    /// An output with no room.
    Full,
}

/// A unit that cannot go on, and the unit that would have to move first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wait {
    /// The unit.
    pub unit: &'static str,
    /// Its port, or the inner resource, that stops it.
    pub port: String,
    /// What the port lacks.
    pub state: PortState,
    /// Tokens there.
    pub occupancy: usize,
    /// Tokens that fit.
    pub capacity: usize,
    /// The unit that would have to move.
    pub upon: &'static str,
}

impl fmt::Display for Wait {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lack = match self.state {
            PortState::Empty => "empty",
            PortState::Full => "full",
        };
        let Wait { unit, port, occupancy, capacity, upon, .. } = self;
        write!(f, "{unit} waits for {upon}: {port} is {lack} ({occupancy} of {capacity})")
    }
}

/// A machine that cannot move.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("nothing can move after cycle {cycle}: {}", list(.waits, *.circular))]
pub struct Deadlock {
    /// The last cycle in which something moved.
    pub cycle: u64,
    /// The waits, each upon the next; the last upon the first where they are circular.
    pub waits: Vec<Wait>,
    /// Whether the waits close to a circle.
    pub circular: bool,
}

fn list(waits: &[Wait], circular: bool) -> String {
    let mut text = waits.iter().map(Wait::to_string).collect::<Vec<_>>().join("; ");
    if circular {
        text.push_str("; which closes the circle");
    }
    text
}

/// Finds the circle of waits, or else the chain that ends at a unit which waits for nothing.
pub fn diagnose(cycle: u64, waits: &[Wait]) -> Deadlock {
    let next = |unit: &str| waits.iter().find(|wait| wait.unit == unit);
    let mut longest: Vec<Wait> = Vec::new();
    for start in waits {
        let mut chain: Vec<Wait> = Vec::new();
        let mut at = Some(start);
        while let Some(wait) = at {
            if let Some(place) = chain.iter().position(|seen| seen.unit == wait.unit) {
                return Deadlock { cycle, waits: chain.split_off(place), circular: true };
            }
            chain.push(wait.clone());
            at = next(wait.upon);
        }
        if chain.len() > longest.len() {
            longest = chain;
        }
    }
    Deadlock { cycle, waits: longest, circular: false }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wait(unit: &'static str, upon: &'static str) -> Wait {
        Wait { unit, port: "p".into(), state: PortState::Empty, occupancy: 0, capacity: 2, upon }
    }

    #[test]
    fn the_circle_is_found_behind_a_chain() {
        let waits = [wait("a", "b"), wait("b", "c"), wait("c", "b"), wait("d", "a")];
        let deadlock = diagnose(9, &waits);
        assert!(deadlock.circular);
        assert_eq!(deadlock.waits, [wait("b", "c"), wait("c", "b")]);
        let text = deadlock.to_string();
        assert!(text.starts_with("nothing can move after cycle 9: b waits for c: p is empty (0 of 2)"), "{text}");
    }

    #[test]
    fn without_a_circle_the_longest_chain_is_named() {
        let deadlock = diagnose(1, &[wait("b", "c"), wait("a", "b")]);
        assert!(!deadlock.circular);
        assert_eq!(deadlock.waits.len(), 2);
    }
}
