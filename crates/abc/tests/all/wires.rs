//! What a probe sees of the definitions: every wire once, on its own place, without a gap, and with the value that its name says.

use crate::registers::{Dice, bright, neighbourhood, normaliser};
use cube3_abc::golden::{
    Local, Neighbourhood, ReflectedLight, TableAddresses, classify, cued_wires, direction_index_wires, lit_wires,
    local_gradient_wires, normalise_wires, phong_wires,
};
use cube3_cases::cases;
use cube3_frame::{Classification, GradientRegisters, GradientRows, GradientScale, LinearFactor};
use cube3_machine::GradientMethod;
use cube3_word::{Probe, Rounding, Words, unit_full};
use proptest::prelude::*;
use std::collections::BTreeMap;

/// Values by part, name and place; the places of a part's wires begin at that of the part.
#[derive(Default)]
struct Wires {
    part: (&'static str, usize),
    seen: BTreeMap<(&'static str, &'static str), BTreeMap<usize, i128>>,
}

impl Probe for Wires {
    fn wire(&mut self, name: &'static str, place: usize, value: i128) {
        let (part, first) = self.part;
        let before = self.seen.entry((part, name)).or_default().insert(first + place, value);
        assert_eq!(before, None, "{part} {name} {place} twice");
    }

    fn within<R>(&mut self, part: &'static str, place: usize, work: impl FnOnce(&mut Self) -> R) -> R {
        let outer = std::mem::replace(&mut self.part, (part, place));
        let result = work(self);
        self.part = outer;
        result
    }
}

impl Wires {
    /// The wires of a name in order of their places; none where there is no such wire.
    fn all(&self, part: &'static str, name: &'static str) -> Vec<i128> {
        let places = self.seen.get(&(part, name));
        let of = |places: &BTreeMap<usize, i128>| {
            assert!(places.keys().copied().eq(0..places.len()), "{part} {name} has gaps: {places:?}");
            places.values().copied().collect()
        };
        places.map_or(Vec::new(), of)
    }
}

/// A gradient of any method; its wires, its words and whether they were held.
fn gradient(s: &Neighbourhood, method: GradientMethod, local: &Local, words: &Words) -> (Wires, [(i32, bool); 3]) {
    let scale = Some(GradientScale { factors: [0; 3], kept_bits: 1 });
    let registers = GradientRegisters { method, weights: [0; 2], scale, border: 0 };
    let mut wires = Wires::default();
    let words = local_gradient_wires(s, &registers, local, words, &mut wires);
    (wires, words)
}

fn any_words() -> Words {
    Words { voxel_bits: 12, sample_fraction_bits: 4, gradient_bits: 10, weight_bits: 8, ..Words::default() }
}

fn any_local(dice: &mut Dice) -> Local {
    let mut weights = || [dice.word(0, 256), dice.word(0, 256)];
    let (here, behind, before) = (weights(), weights(), weights());
    let one = 1 << GradientScale::FACTOR_BITS;
    let mirrored = [dice.one_in(2), dice.one_in(2)];
    let factors = Some([0; 3].map(|_| dice.word(0, one)));
    Local { mirrored, here, behind, before, factors, nearness: Some(dice.word(0, one)) }
}

/// The neighbourhood as a gradient unit takes it that runs against u or v.
fn turned(s: &Neighbourhood, [u, v]: [bool; 2]) -> Neighbourhood {
    let place = |i: usize, mirror: bool| if mirror { 2 - i } else { i };
    [0, 1, 2].map(|c| [0, 1, 2].map(|b| [0, 1, 2].map(|a| s[c][place(b, v)][place(a, u)])))
}

fn wide(far: i32, near: i32) -> i128 {
    i128::from(far) - i128::from(near)
}

fn rounded(words: &Words, value: i128, bits: u32) -> i128 {
    let half = if words.rounding == Rounding::Nearest && bits > 0 { 1 << (bits - 1) } else { 0 };
    (value + half) >> bits
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(400) })]

    #[test]
    fn components_show_their_way_from_the_difference_to_the_word(seed: u64) {
        let mut dice = Dice::new(seed);
        let words = any_words();
        let s = neighbourhood(&mut dice, 16);
        let local = any_local(&mut dice);
        let factors = local.factors.unwrap();
        for (method, _) in GradientMethod::ALL {
            let (wires, held) = gradient(&s, method, &local, &words);
            let extra = if matches!(method, GradientMethod::TwentySix | GradientMethod::TwentySixSheared) { 4 } else { 0 };
            for i in 0..3 {
                let (part, place) = if i < 2 { ("across", i) } else { ("along", 0) };
                let one = |name| wires.all(part, name)[place];
                let sign = if i < 2 && local.mirrored[i] { -1 } else { 1 };
                let turned = sign * one("difference");
                prop_assert_eq!(one("product"), turned * i128::from(factors[i]));
                prop_assert_eq!(one("scaled"), rounded(&words, one("product"), GradientScale::FACTOR_BITS - 1));
                prop_assert_eq!(one("dropped"), rounded(&words, one("scaled"), words.gradient_drop() + extra));
                prop_assert_eq!(one("word"), one("dropped").clamp(-1024, 1023));
                prop_assert_eq!(held[i], (one("word") as i32, one("word") != one("dropped")));
                if i < 2 {
                    prop_assert_eq!(one("turned"), turned);
                }
            }
            // The difference along the ray has no mirror.
            prop_assert_eq!(wires.all("along", "turned"), []);
            let near = |name| wires.all("along", name)[0];
            prop_assert_eq!(near("near_product"), near("straight") * i128::from(local.nearness.unwrap()));
            prop_assert_eq!(near("near"), rounded(&words, near("near_product"), GradientScale::FACTOR_BITS));
            let across = wires.all("across", "difference");
            if matches!(method, GradientMethod::SixSheared | GradientMethod::TwentySixSheared) {
                let products = wires.all("along", "shear_product");
                prop_assert_eq!(&products, &[0, 1].map(|i| across[i] * i128::from(local.here[i])));
                prop_assert_eq!(near("shear_sum"), products[0] + products[1]);
                prop_assert_eq!(near("shear"), rounded(&words, near("shear_sum"), words.weight_bits));
                prop_assert_eq!(near("difference"), near("near") - near("shear"));
            } else {
                prop_assert_eq!(near("difference"), near("near"));
            }
        }
    }

    #[test]
    fn pairs_and_lerps_are_on_their_places(seed: u64) {
        let mut dice = Dice::new(seed);
        let words = any_words();
        let taken = neighbourhood(&mut dice, 16);
        let local = any_local(&mut dice);
        let s = turned(&taken, local.mirrored);
        let (wires, _) = gradient(&taken, GradientMethod::TwentySix, &local, &words);
        let pairs = wires.all("", "pair");
        for (a, b) in (0..9).map(|i| (i / 3, i % 3)) {
            let place = 3 * a + b;
            prop_assert_eq!(pairs[place], wide(s[a][b][2], s[a][b][0]));
            prop_assert_eq!(pairs[9 + place], wide(s[a][2][b], s[a][0][b]));
            prop_assert_eq!(pairs[18 + place], wide(s[2][a][b], s[0][a][b]));
        }
        prop_assert_eq!(pairs.len(), 27);

        let (wires, _) = gradient(&taken, GradientMethod::Ten, &local, &words);
        let feet = [(s[1][1][2], s[0][1][2]), (s[1][1][0], s[2][1][0]), (s[1][2][1], s[0][2][1]), (s[1][0][1], s[2][0][1])];
        prop_assert_eq!(wires.all("foot", "difference"), feet.map(|(side, on_ray)| wide(on_ray, side)));
        let value = wires.all("foot", "value");
        prop_assert_eq!(wires.all("across", "difference"), [value[0] - value[1], value[2] - value[3]]);

        let (wires, _) = gradient(&taken, GradientMethod::Twelve, &local, &words);
        // Behind the sample, and then before it: near and far along u, and then along v.
        let edges = [(2, 1, 0), (2, 0, 0), (0, 1, 2), (0, 2, 2)].map(|(w, v, u)| wide(s[w][v][u], s[w][v][1]));
        prop_assert_eq!(wires.all("along_u", "difference"), edges);
        let along_u = wires.all("along_u", "value");
        prop_assert_eq!(wires.all("along_v", "difference"), [along_u[1] - along_u[0], along_u[3] - along_u[2]]);
        let along_v = wires.all("along_v", "value");
        prop_assert_eq!(wires.all("along", "straight"), [along_v[0] - along_v[1]]);
        let weights = [local.behind[0], local.behind[0], local.before[0], local.before[0]].map(i128::from);
        prop_assert_eq!(wires.all("along_u", "product"), [0, 1, 2, 3].map(|i| edges[i] * weights[i]));
    }

    #[test]
    fn the_normaliser_shows_its_block_and_its_length(
        gradient in prop::array::uniform3(prop_oneof![-9_i32..10, -(1 << 23)..1 << 23]), bits in 4_u32..=15,
    ) {
        let words = Words { normal_bits: bits, ..Words::default() };
        let table = normaliser(bits, 6);
        let mut wires = Wires::default();
        let normal = normalise_wires(gradient, &table, &words, &mut wires);
        let sizes = gradient.map(|g| i128::from(g.unsigned_abs()));
        prop_assert_eq!(wires.all("", "size"), sizes);
        let Some(highest) = sizes.iter().max().and_then(|largest| largest.checked_ilog2()) else {
            prop_assert_eq!(wires.seen.len(), 1);
            return Ok(());
        };
        let one = |name| wires.all("", name)[0];
        prop_assert_eq!(one("highest"), i128::from(highest));
        let block = sizes.map(|size| (size << 31 >> highest) >> (32 - bits));
        prop_assert_eq!(wires.all("", "block"), block);
        prop_assert_eq!(one("square"), block.iter().map(|a| a * a).sum::<i128>());
        let first = 1 << table.root_bits;
        prop_assert_eq!(one("index"), (one("square") >> (2 * bits - 2 - table.root_bits)) - first);
        prop_assert_eq!(one("reciprocal"), i128::from(table.root[one("index") as usize]));
        let products = block.map(|a| a * one("reciprocal"));
        prop_assert_eq!(wires.all("", "product"), products);
        let rounded = products.map(|product| (product + (1 << (bits - 1))) >> bits);
        prop_assert_eq!(wires.all("", "rounded"), rounded);
        let unit = rounded.map(|unit| unit.min(1 << (bits - 1)));
        prop_assert_eq!(wires.all("", "unit"), unit);
        let direction = [0, 1, 2].map(|i| i128::from(gradient[i].signum()) * unit[i]);
        prop_assert_eq!(wires.all("", "direction"), direction);
        prop_assert_eq!(normal.direction.map(i128::from), direction);
        prop_assert_eq!(one("length"), (0..3).map(|i| block[i] * unit[i]).sum::<i128>());
        prop_assert_eq!(one("aligned"), one("length") << highest);
        prop_assert_eq!(one("magnitude"), i128::from(normal.magnitude));
    }

    #[test]
    fn the_light_unit_shows_each_light_on_its_place(seed: u64, normal in prop::array::uniform3(-256_i32..=256)) {
        let mut dice = Dice::new(seed);
        let words = Words { normal_bits: 9, colour_bits: 8, ..Words::default() };
        let phong = bright(&mut dice, &words, 4);
        let directions = [[100, -30, 256], [0; 3], [-256, 256, 1], [256, 256, 256]];
        let mut wires = Wires::default();
        let light = phong_wires(normal, &phong, |number| [directions[number], directions[3 - number]], &words, &mut wires);
        let dot = |direction: [i32; 3]| (0..3).map(|i| i128::from(normal[i]) * i128::from(direction[i])).sum::<i128>();
        prop_assert_eq!(wires.all("towards", "dot"), directions.map(dot));
        prop_assert_eq!(wires.all("half", "dot"), [3, 2, 1, 0].map(|i| dot(directions[i])));
        for part in ["towards", "half"] {
            let [dots, positive, rounds, cosine] = ["dot", "positive", "rounded", "cosine"].map(|name| wires.all(part, name));
            for i in 0..4 {
                prop_assert_eq!(positive[i], dots[i].abs());
                prop_assert_eq!(rounds[i], rounded(&words, positive[i], 8));
                prop_assert_eq!(cosine[i], rounds[i].min(256));
            }
        }
        let [index, power] = ["index", "power"].map(|name| wires.all("half", name));
        let (towards, half) = (wires.all("towards", "cosine"), wires.all("half", "cosine"));
        prop_assert_eq!(index, half.iter().map(|&half| rounded(&words, half, 8 - phong.power_bits)).collect::<Vec<_>>());
        prop_assert_eq!(&power, &[1 << words.colour_bits; 4]);
        let [by_cosine, diffuse, by_power, specular] =
            ["diffuse_product", "diffuse", "specular_product", "specular"].map(|name| wires.all("light", name));
        prop_assert_eq!(by_cosine.len(), 12);
        for (place, (source, i)) in phong.lights.iter().flat_map(|source| [(source, 0), (source, 1), (source, 2)]).enumerate() {
            prop_assert_eq!(by_cosine[place], i128::from(source.diffuse[i]) * towards[place / 3]);
            prop_assert_eq!(diffuse[place], rounded(&words, by_cosine[place], 8));
            prop_assert_eq!(by_power[place], i128::from(source.specular[i]) * power[place / 3]);
            prop_assert_eq!(specular[place], rounded(&words, by_power[place], 8));
        }
        let sum = |rows: &[i128], first: u32| [0, 1, 2].map(|i| i128::from(first) + (0..4).map(|k| rows[3 * k + i]).sum::<i128>());
        prop_assert_eq!(wires.all("", "diffuse"), sum(&diffuse, phong.ambient));
        prop_assert_eq!(wires.all("", "specular"), sum(&specular, 0));
        prop_assert_eq!(light.diffuse.map(i128::from), sum(&diffuse, phong.ambient));
        prop_assert_eq!(light.specular.map(i128::from), sum(&specular, 0));
    }

    #[test]
    fn the_direction_index_shows_its_face_and_coordinates(
        gradient in prop::array::uniform3(prop_oneof![-3_i32..4, -2000..2000]), bits in 2_u32..=5,
    ) {
        let mut wires = Wires::default();
        let entry = direction_index_wires(gradient, bits, &mut wires);
        let sizes = gradient.map(|g| i128::from(g.unsigned_abs()));
        let largest = sizes[0].max(sizes[1]).max(sizes[2]);
        prop_assert_eq!(wires.all("", "size"), sizes);
        prop_assert_eq!(wires.all("", "largest"), [largest]);
        prop_assert_eq!(entry.is_none(), largest == 0);
        if let Some(entry) = entry {
            let axis = (0..3).find(|&i| sizes[i] == largest).unwrap();
            let others = [(axis + 1) % 3, (axis + 2) % 3];
            let half = 1 << (bits - 1);
            let dividends = others.map(|i| sizes[i] * half);
            let quotients = dividends.map(|dividend| dividend / largest);
            let held = quotients.map(|quotient| quotient.min(half - 1));
            let coordinates = [0, 1].map(|i| if gradient[others[i]] < 0 { half - 1 - held[i] } else { half + held[i] });
            let face = 2 * axis as i128 + i128::from(gradient[axis] < 0);
            prop_assert_eq!(wires.all("", "dividend"), dividends);
            prop_assert_eq!(wires.all("", "quotient"), quotients);
            prop_assert_eq!(wires.all("", "held"), held);
            prop_assert_eq!(wires.all("", "coordinate"), coordinates);
            prop_assert_eq!(wires.all("", "face"), [face]);
            let expected = (face * 2 * half + coordinates[1]) * 2 * half + coordinates[0];
            prop_assert_eq!(wires.all("", "entry"), [expected]);
            prop_assert_eq!(entry as i128, expected);
        }
    }

    #[test]
    fn colours_show_their_products_and_sums(
        colour in prop::array::uniform3(0_u32..=255), diffuse in prop::array::uniform3(0_u32..4000),
        specular in prop::array::uniform3(0_u32..300), factor in 0_u32..=1 << LinearFactor::WORD_BITS,
    ) {
        let words = Words { colour_bits: 8, ..Words::default() };
        let mut wires = Wires::default();
        let lit = lit_wires(colour, ReflectedLight { diffuse, specular }, &words, &mut wires);
        let products = [0, 1, 2].map(|i| i128::from(colour[i]) * i128::from(diffuse[i]));
        let scaled = products.map(|product| rounded(&words, product, 8));
        let sums = [0, 1, 2].map(|i| scaled[i] + i128::from(specular[i]));
        prop_assert_eq!(wires.all("", "product"), products);
        prop_assert_eq!(wires.all("", "scaled"), scaled);
        prop_assert_eq!(wires.all("", "sum"), sums);
        prop_assert_eq!(wires.all("", "value"), sums.map(|sum| sum.min(255)));
        prop_assert_eq!(lit, sums.map(|sum| (sum.min(255) as u32, sum > 255)));
        let mut wires = Wires::default();
        let cued = cued_wires(colour, factor, &words, &mut wires).map(i128::from);
        let products = colour.map(|c| i128::from(c) * i128::from(factor));
        prop_assert_eq!(wires.all("", "product"), products);
        prop_assert_eq!(wires.all("", "value"), cued);
        prop_assert_eq!(cued, products.map(|product| rounded(&words, product, LinearFactor::WORD_BITS)));
    }
}

#[test]
fn tables_are_read_at_the_entry_of_class_row_and_index() {
    let words = Words { sample_fraction_bits: 0, voxel_bits: 8, opacity_bits: 16, ..Words::default() };
    let (rows, entries) = (GradientRows { shift: 2, rows: 3 }, 16);
    let table = Classification {
        threshold: [20, 200],
        index_shift: 4,
        opacity: (0..2 * rows.rows * entries).collect(),
        colour: (0..entries).map(|i| [i, 100 + i, 200 + i]).collect(),
        gradient_rows: Some(rows),
    };
    for sample in 0..=unit_full(words.sample_bits()) {
        for magnitude in 0..20 {
            for class in 0..2 {
                let mut wires = Wires::default();
                let found = TableAddresses::of(&table).find(class, sample as i32, magnitude, &mut wires);
                let visible = (20..=200).contains(&sample);
                assert_eq!(wires.all("", "visible"), [i128::from(visible)]);
                assert_eq!(found.is_some(), visible);
                if let Some([opacity, colour]) = found {
                    let row = (magnitude / 4).min(2);
                    let entry = (class * 3 + row) * entries + sample / 16;
                    assert_eq!([opacity, colour], [entry as usize, sample as usize / 16]);
                    assert_eq!(wires.all("", "index"), [i128::from(sample / 16)]);
                    assert_eq!(wires.all("", "shifted"), [i128::from(magnitude / 4)]);
                    assert_eq!(wires.all("", "row"), [i128::from(row)]);
                    assert_eq!(wires.all("", "entry"), [i128::from(entry)]);
                    let expected = (row * entries + sample / 16, table.colour[colour]);
                    assert_eq!(classify(sample as i32, magnitude, &table), Some(expected));
                }
            }
        }
    }
}
