//! Where one voxel goes: on the bus, and in a skewed buffer. The definition.

use crate::BoardSpec;
use cube3_frame::Geometry;

use cube3_machine::RaySlots;
use cube3_word::Probe;

/// The slot of a plane that voxel `x` of a beam (its place along u) belongs to at a depth.
///
/// Wrapped: `(x − X(k)) mod n`. Padded: `x − X(k)` from the leftmost ray.
pub fn slot(geometry: &Geometry, x: usize, depth: usize) -> usize {
    let column = geometry.u.columns[depth] as usize;
    match geometry.slots {
        RaySlots::Wrapped => (x as i64 - column as i64).rem_euclid(geometry.size[0] as i64) as usize,
        RaySlots::Padded => x + geometry.shear_u() - column,
    }
}

/// The module of a skewed buffer that holds ray slot `j` at depth `k`: `(j + k) mod lanes`.
///
/// For one k, neighbouring j are in different modules (a beam is written); for one j, neighbouring k are (a ray
/// is read).
pub fn module(lanes: usize, j: usize, k: usize) -> usize {
    (j + k) % lanes
}

/// Place of slot `j` in the lane order of an aligned beam at depth `k`: chunks of `lanes` slots, each by module.
pub fn beam_lane(lanes: usize, j: usize, k: usize) -> usize {
    j / lanes * lanes + module(lanes, j, k)
}

/// Place of depth `k` in the lane order of ray slot `j`: chunks of `lanes` depths, each by module.
pub fn ray_lane(lanes: usize, j: usize, k: usize) -> usize {
    k / lanes * lanes + module(lanes, j, k)
}

/// How far the bus turns the beam of `plane` at a depth, where a beam fills the lanes: from the frame buffer's lane
/// `(u + v + w) mod n` to the skewed buffer's `(j + k) mod n`.
///
/// From a beam to the next of its plane it changes by 2 at most.
pub fn rotation(geometry: &Geometry, plane: usize, depth: usize) -> usize {
    let row = match geometry.slots {
        RaySlots::Wrapped => (plane + geometry.v.columns[depth] as usize) % geometry.size[1],
        RaySlots::Padded => plane + geometry.v.columns[depth] as usize - geometry.shear_v(),
    };
    turn(geometry.size[0], row, slot(geometry, 0, depth), &mut ())
}

/// The same from the beam's row and the slot of its first voxel, and what its wires carry. From lane `row + k + x` to lane
/// `slot + k + x`: the depth does not matter.
pub fn turn(lanes: usize, row: usize, first_slot: usize, probe: &mut impl Probe) -> usize {
    let difference = first_slot as i64 - row as i64;
    let rotation = difference.rem_euclid(lanes as i64) as usize;
    probe.wire("difference", 0, difference.into());
    probe.wire("rotation", 0, rotation as i128);
    rotation
}

/// A beam that fills the lanes, turned: what was in lane l is in `(l + rotation) mod lanes`.
pub fn turned<T: Copy>(beam: &[T], rotation: usize) -> Vec<T> {
    let lanes = beam.len();
    (0..lanes).map(|lane| beam[(lane + lanes - rotation) % lanes]).collect()
}

/// Words over each link (link b joins board b − 1 and board b), forwards and backwards, of words that move from lane to lane:
/// word by word and step by step, each the shorter way round. The definition, for any bus.
pub fn walk(ring: &BoardSpec, moves: impl IntoIterator<Item = [usize; 2]>) -> Vec<[u64; 2]> {
    let mut links = vec![[0; 2]; ring.boards];
    if ring.boards == 1 {
        return links;
    }
    for [from, to] in moves {
        let turn = (to + ring.lanes - from) % ring.lanes;
        let backwards = 2 * turn > ring.lanes;
        let mut lane = from;
        while lane != to {
            let next = (lane + if backwards { ring.lanes - 1 } else { 1 }) % ring.lanes;
            if ring.board(lane) != ring.board(next) {
                links[ring.board(if backwards { lane } else { next })][usize::from(backwards)] += 1;
            }
            lane = next;
        }
    }
    links
}
