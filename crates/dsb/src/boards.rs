//! Boards of lanes in a ring, and the words of a beam that cross the links between them.
//!
//! ```text
//!   ┌─ board 0 ─┐ link ┌─ board 1 ─┐ link         ┌─ board b − 1 ─┐
//!   │ lanes 0…  │◄────►│           │◄────►  …  ◄──►│               │◄──► board 0
//!   └───────────┘      └───────────┘              └───────────────┘
//! ```
//! A beam is turned as a whole: all of its words that move by as many lanes go the same way round, the shorter one.

use crate::BoardSpec;
use crate::golden::{module, slot};
use cube3_cfb::golden::output_lane;
use cube3_frame::Geometry;
use cube3_machine::RaySlots;
use std::ops::Range;

/// Words of one beam on the links.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkWords {
    /// Over the busiest link in its busier direction.
    pub busiest: u64,
    /// Over all links in both directions.
    pub all: u64,
}

impl LinkWords {
    /// Of the words over each link, forwards and backwards.
    pub fn of(links: &[[u64; 2]]) -> LinkWords {
        let words = || links.iter().flatten().copied();
        LinkWords { busiest: words().max().unwrap_or(0), all: words().sum() }
    }
}

/// Words `x` of a beam, from `start` to before `end`, that move by the same number of lanes.
#[derive(Clone, Copy, Debug)]
struct Group {
    start: usize,
    end: usize,
    turn: usize,
}

impl BoardSpec {
    /// The lanes from and to which the words of the beam of row `v` at a depth move, in a parallel view.
    pub fn moves(&self, geometry: &Geometry, v: usize, depth: usize) -> impl Iterator<Item = [usize; 2]> {
        let lanes = self.lanes;
        (0..geometry.size[0]).map(move |x| {
            let from = output_lane(lanes, [x, v, depth]);
            [from, module(lanes, slot(geometry, x, depth), depth)]
        })
    }

    /// The lanes from and to which the words of a perspective plane's beam at a depth move: for each slot its column; where slots need
    /// their own cells, two columns of two rows.
    pub fn gathered(&self, geometry: &Geometry, plane: usize, depth: usize) -> Vec<[usize; 2]> {
        let mut moves = Vec::new();
        let Some(pass) = &geometry.perspective else {
            return moves;
        };
        let copies = if pass.doubled { 2 } else { 1 };
        let rows = [geometry.row_at(pass.v.first + plane as i64, depth), geometry.row_below(plane, depth)];
        for row in rows.into_iter().take(copies).flatten() {
            for columns in [pass.u.near_row(depth), pass.u.right_row(depth)].into_iter().take(copies) {
                let inside = columns.iter().enumerate().filter(|(_, x)| (0..geometry.size[0] as i32).contains(x));
                moves.extend(
                    inside.map(|(j, &x)| {
                        [output_lane(self.lanes, [x as usize, row, depth]), module(self.lanes, j, depth)]
                    }),
                );
            }
        }
        moves
    }

    /// The words of a beam of a plane, row and depth over each link, forwards and backwards, in a parallel view those of some ray slots; `links`
    /// has a place for each board. In a parallel view in closed form: of words that turn by r lanes, those cross a link that start in the r
    /// lanes before it.
    pub fn beam_words(
        &self,
        geometry: &Geometry,
        slots: Range<usize>,
        [plane, v, depth]: [usize; 3],
        links: &mut [[u64; 2]],
    ) {
        links.fill([0; 2]);
        if self.boards == 1 {
            return;
        }
        if geometry.perspective.is_some() {
            return self.hopped(&self.gathered(geometry, plane, depth), links);
        }
        let groups = self.groups(geometry, slots, v, depth);
        let words: usize = groups.iter().map(|group| group.end - group.start).sum();
        if geometry.size[0].is_multiple_of(self.lanes) && words.is_multiple_of(self.lanes) {
            // Neighbours in neighbouring lanes, over the row's end too: as many start in each lane, and all turn alike.
            let (turn, back) = (groups[0].turn, self.lanes - groups[0].turn);
            let each = (words / self.lanes * turn.min(back)) as u64;
            links.fill(if turn <= back { [each, 0] } else { [0, each] });
            return;
        }
        for (board, crossing) in links.iter_mut().enumerate() {
            let link = self.first_lane(board);
            for group in groups {
                let back = self.lanes - group.turn;
                if group.turn <= back {
                    crossing[0] += self.in_window(group, v + depth, link + back, group.turn);
                } else {
                    crossing[1] += self.in_window(group, v + depth, link, back);
                }
            }
        }
    }

    /// The same as [`walk`](crate::golden::walk), from board to board.
    fn hopped(&self, moves: &[[usize; 2]], links: &mut [[u64; 2]]) {
        for &[from, to] in moves {
            let backwards = 2 * ((to + self.lanes - from) % self.lanes) > self.lanes;
            let [mut at, end] = if backwards { [to, from] } else { [from, to] }.map(|lane| self.board(lane));
            while at != end {
                at = (at + 1) % self.boards;
                links[at][usize::from(backwards)] += 1;
            }
        }
    }

    /// The words of a beam by how far they turn: those at and behind the column of the discrete rays, and those before it, which are
    /// of other rays where slots are shared.
    fn groups(&self, geometry: &Geometry, slots: Range<usize>, v: usize, depth: usize) -> [Group; 2] {
        let [n, column] = [geometry.size[0], geometry.u.columns[depth] as usize];
        let turn = |ahead: usize, behind: usize| (ahead + self.lanes - behind % self.lanes) % self.lanes;
        match geometry.slots {
            RaySlots::Wrapped => {
                let column = column % n;
                // Slots from this on have the voxels before the column.
                let seam = n - column;
                let [start, end] = [slots.start.min(seam), slots.end.min(seam)].map(|slot| slot + column);
                let before = Group { start, end, turn: turn(0, column + v) };
                let [start, end] = [slots.start.max(seam), slots.end.max(seam)].map(|slot| slot - seam);
                [before, Group { start, end, turn: turn(n, column + v) }]
            }
            RaySlots::Padded => {
                let turn = turn(geometry.shear_u(), column + v);
                let [Range { start, end }, _] = geometry.columns(slots, depth);
                [Group { start, end, turn }, Group { start: n, end: n, turn }]
            }
        }
    }

    /// How many words of a group start in the `width` lanes from `first` on; word x starts in lane x + `skew`.
    fn in_window(&self, group: Group, skew: usize, first: usize, width: usize) -> u64 {
        let lanes = self.lanes;
        let count = group.end - group.start;
        let (rounds, rest) = (count / lanes, count % lanes);
        let ahead = (first + lanes - (group.start + skew) % lanes) % lanes;
        let straight = rest.min(ahead + width).saturating_sub(ahead);
        let around = rest.min((ahead + width).saturating_sub(lanes));
        (rounds * width + straight + around) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rotator;
    use crate::golden::{rotation, walk};
    use cube3_cases::cases;
    use cube3_frame::{Axes, PassShape, largest_offset, slope_register};
    use cube3_machine::TemplateRule;
    use proptest::prelude::*;

    fn geometry(size: [usize; 3], slopes: [f64; 2], slots: RaySlots) -> Geometry {
        let rule = TemplateRule::SampleFloor;
        let slopes = slopes.map(slope_register);
        let offset = largest_offset(rule, slopes, 8).min(128);
        Geometry::new(size, Axes { axis: [0, 1, 2], reversed: [false; 3] }, slopes, offset, 8, rule, slots)
    }

    /// The pass of an eye anywhere, near and far, along w.
    fn passes() -> impl Strategy<Value = Geometry> {
        let size = [1_usize..12, 1_usize..9, 1_usize..12];
        let across = -20.0..30.0_f64;
        let eye = (across.clone(), across, prop_oneof![-8.0..8.0_f64, -100.0..0.0_f64]).prop_map(<[f64; 3]>::from);
        (size, eye, 0_u32..128, any::<bool>()).prop_filter_map(
            "rays that meet the volume",
            |(size, eye, offset, plane)| {
                Geometry::perspective(&PassShape {
                    size,
                    axes: Axes { axis: [0, 1, 2], reversed: [false; 3] },
                    eye,
                    offset,
                    weight_bits: 8,
                    rule: if plane { TemplateRule::PlaneFloor } else { TemplateRule::SampleFloor },
                    grid: 0.5,
                    reach: 1,
                    joins: false,
                })
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(2000) })]

        #[test]
        fn the_closed_form_is_the_walk(
            size in [1_usize..20, 1_usize..9, 1_usize..20], du in 0.0..=1.0_f64, dv in 0.0..=1.0_f64, padded: bool,
            lanes in 1_usize..14, part in 0.0..1.0_f64, v in 0_usize..9, depth in 0_usize..20, edges in [0_usize..50, 0_usize..50],
        ) {
            let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
            let geometry = geometry(size, [du, dv], slots);
            let (v, depth) = (v % size[1], depth % size[2]);
            let boards = 1 + (part * lanes as f64) as usize;
            let spec = BoardSpec { boards, lanes, latency: 1 };
            let mut links = vec![[0; 2]; boards];
            let [all, _] = geometry.slot_counts();
            let some = edges.map(|edge| edge.min(all));
            for slots in [0..all, some[0].min(some[1])..some[0].max(some[1])] {
                let of_slots = |x: &usize| slots.contains(&slot(&geometry, *x, depth));
                let moves = (0..size[0]).zip(spec.moves(&geometry, v, depth)).filter(|(x, _)| of_slots(x));
                let walk = walk(&spec, moves.map(|(_, lanes)| lanes));
                spec.beam_words(&geometry, slots, [0, v, depth], &mut links);
                prop_assert_eq!(&links, &walk);
            }
        }

        #[test]
        fn a_full_beam_sends_its_rotation_over_every_link(
            n in 2_usize..20, du in 0.0..=1.0_f64, dv in 0.0..=1.0_f64, plane in 0_usize..20, depth in 0_usize..20, part in 0.0..1.0_f64,
        ) {
            let geometry = geometry([n; 3], [du, dv], RaySlots::Wrapped);
            let (plane, depth) = (plane % n, depth % n);
            let boards = 2 + (part * (n - 1) as f64) as usize;
            let row = (plane + geometry.v.columns[depth] as usize) % n;
            let turned = rotation(&geometry, plane, depth);
            let mut links = vec![[0; 2]; boards];
            BoardSpec { boards, lanes: n, latency: 1 }.beam_words(&geometry, 0..n, [0, row, depth], &mut links);
            let words = LinkWords::of(&links);
            let each = turned.min(n - turned) as u64;
            prop_assert_eq!(words, LinkWords { busiest: each, all: boards as u64 * each });
        }

        #[test]
        fn gathered_beams_take_the_same_links_as_word_by_word(
            geometry in passes(), lanes in 1_usize..14, part in 0.0..1.0_f64, plane in 0_usize..99, depth in 0_usize..12,
        ) {
            let (plane, depth) = (plane % geometry.slot_counts()[1], depth % geometry.size[2]);
            let boards = 1 + (part * lanes as f64) as usize;
            let spec = BoardSpec { boards, lanes, latency: 1 };
            let mut links = vec![[0; 2]; boards];
            // The row is that of the plane.
            spec.beam_words(&geometry, 0..0, [plane, 0, depth], &mut links);
            prop_assert_eq!(links, walk(&spec, spec.gathered(&geometry, plane, depth)));
        }

        #[test]
        fn the_words_that_move_are_those_that_the_bus_gathers(
            geometry in passes(), lanes in 1_usize..14, plane in 0_usize..99, depth in 0_usize..12,
        ) {
            let (plane, depth) = (plane % geometry.slot_counts()[1], depth % geometry.size[2]);
            let pass = geometry.perspective.as_ref().unwrap();
            // A beam with the place of each of its words, from 1, as the frame buffer sends it.
            let width = geometry.size[0].div_ceil(lanes) * lanes;
            let rows = if pass.doubled { 2 } else { 1 };
            let beam: Vec<u16> = (1..=(rows * width) as u16).collect();
            let mut aligned = Vec::new();
            Rotator { lanes }.gather(&geometry, plane, depth, &beam, &mut aligned);
            let moved = aligned.iter().enumerate().filter(|(_, word)| **word > 0);
            let mut moved: Vec<[usize; 2]> = moved.map(|(to, word)| [(*word as usize - 1) % lanes, to % lanes]).collect();
            let spec = BoardSpec { boards: 1, lanes, latency: 1 };
            let mut gathered = spec.gathered(&geometry, plane, depth);
            moved.sort_unstable();
            gathered.sort_unstable();
            prop_assert_eq!(gathered, moved);
        }

        #[test]
        fn boards_have_their_lanes(lanes in 1_usize..200, part in 0.0..1.0_f64) {
            let boards = 1 + (part * lanes as f64) as usize;
            let spec = BoardSpec { boards, lanes, latency: 1 };
            for lane in 0..lanes {
                let board = spec.board(lane);
                prop_assert!(spec.first_lane(board) <= lane && lane < spec.first_lane(board + 1));
            }
            for board in 0..boards {
                let width = spec.first_lane(board + 1) - spec.first_lane(board);
                prop_assert!(width == lanes / boards || width == lanes.div_ceil(boards));
            }
        }
    }

    #[test]
    fn the_way_round_is_the_shorter_one() {
        let spec = BoardSpec { boards: 8, lanes: 512, latency: 1 };
        assert_eq!([1, 4, 5, 7].map(|to| spec.hops(0, to)), [1, 4, 3, 1]);
        assert_eq!((spec.diameter(), spec.neighbour_hops(2)), (4, 1));
        let narrow = BoardSpec { boards: 8, lanes: 9, latency: 1 };
        assert_eq!(narrow.neighbour_hops(2), 2);
        assert_eq!(BoardSpec { boards: 1, ..spec }.neighbour_hops(2), 0);
    }
}
