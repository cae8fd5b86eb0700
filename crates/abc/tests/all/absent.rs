//! A sample that takes no part, because of a cut or of the threshold, keeps its word and has nothing else.

use crate::registers::{Dice, frame, neighbourhood};
use cube3_abc::golden::{Shaded, shade};

#[test]
fn a_sample_that_takes_no_part_keeps_its_word_and_has_nothing_else() {
    let mut dice = Dice::new(1995);
    let (mut cut, mut outside) = (0, 0);
    for _ in 0..2000 {
        let setup = frame(&mut dice);
        let s = neighbourhood(&mut dice, setup.words.sample_bits());
        let at = [dice.within(-100, 100), dice.within(-100, 100), dice.within(0, 100)];
        let is_cut = setup.clips.iter().any(|clip| setup.geometry.evaluate(&clip.distance, at) < 0);
        let [low, high] = setup.classification.threshold;
        let is_outside = !(low..=high).contains(&(s[1][1][1] as u32));
        let counted = shade(&s, at, &setup);
        assert_eq!(counted.value.sample, s[1][1][1]);
        assert_eq!(counted.value.present, !is_cut && !is_outside);
        if is_cut || is_outside {
            assert_eq!(counted.value, Shaded { sample: s[1][1][1], ..Shaded::default() });
            assert_eq!(counted.overflows, 0);
        }
        cut += u32::from(is_cut);
        outside += u32::from(is_outside);
    }
    assert!(cut > 100 && outside > 100, "{cut}, {outside}");
}
