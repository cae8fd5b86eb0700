//! The cases of the stress: each shows what it is about.

use cube3_method::CONVERGED;
use cube3_study::stress::{CASES, Truth};

/// A case in which no ray meets anything would hold whatever a method does.
#[test]
fn every_subject_of_every_case_shows_something() {
    let mut empty = Vec::new();
    for case in CASES.iter().filter(|case| case.refused.is_none()) {
        for (place, subject) in (case.subjects)().iter().enumerate() {
            let (_, picture) = Truth::new(subject).unwrap().picture(&CONVERGED, subject).unwrap();
            if picture.pixels.iter().all(|pixel| *pixel == subject.scene.background) {
                empty.push((case.name, place));
            }
        }
    }
    // Of nothing, nothing is seen; 10⁻³⁰ moves no digit of a grey background.
    assert_eq!(empty, [("opacity 0 everywhere", 0), ("opacity of a unit length from 1e-30 to 1e-3", 0)]);
}
