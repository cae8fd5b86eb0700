//! Every way to make a picture gives every picture that has a closed form.

use cube3_method::{METHODS, Method};
use cube3_tests::known_answers::{ANSWERS, Answer, KnownAnswer};
use rayon::prelude::*;

/// The pixels of all views that were asked for, and those that are farther from the closed form than the method may be.
fn held(known: &KnownAnswer, method: &'static Method) -> (usize, Vec<String>) {
    let (mut pixels, mut most, mut faults) = (0, 0.0_f64, Vec::new());
    for (view, question) in known.questions().iter().enumerate() {
        let Some(picture) = question.picture(method) else { continue };
        for (pixel, chord) in question.chords().into_iter().enumerate() {
            let Some(Answer { value, steps, words }) = chord.and_then(|chord| (known.answer)(&chord)) else { continue };
            let tolerance = if method.about.in_words { steps + words } else { steps };
            let error = (picture[pixel] - value).abs();
            pixels += 1;
            most = most.max(error / tolerance);
            if error > tolerance {
                let (known, method, got) = (known.name, method.about.name, picture[pixel]);
                faults.push(format!("{known}, {method}, view {view}, pixel {pixel}: {got} for {value} ± {tolerance}"));
            }
        }
    }
    println!("{:>16} {:>12}: {pixels:>4} pixels, {most:.3} of the tolerance", known.name, method.about.name);
    (pixels, faults)
}

#[test]
fn every_method_knows_every_answer() {
    let pairs: Vec<_> = ANSWERS.iter().flat_map(|known| METHODS.iter().map(move |&method| (known, method))).collect();
    let held: Vec<_> = pairs.par_iter().map(|(known, method)| held(known, method)).collect();
    let faults: Vec<&String> = held.iter().flat_map(|(_, faults)| faults).collect();
    assert!(faults.is_empty(), "{} faults, the first: {}", faults.len(), faults[0]);
    for ((known, method), (pixels, _)) in pairs.iter().zip(&held) {
        let asked = known.questions().iter().any(|question| method.check(&question.scene).is_ok());
        assert!(*pixels > 40 || !asked, "{} {}: {pixels} pixels", known.name, method.about.name);
    }
}
