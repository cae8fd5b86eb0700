//! The reduction for one ray from any leaf of the circle, and front to back.

use crate::golden::{Node, Segment, combine};
use cube3_scene::Mode;
use cube3_word::Words;

/// A tree over the leaves of one ray among those of a circle, in the order of the circle from its start: `leaves[0]` is the leaf
/// at place `first` behind the start. Equals the ray's segment of [`circle`](crate::golden::circle): places of other rays have nothing. The leaves are
/// overwritten.
pub fn tree_of_ray(leaves: &mut [Node], first: usize, mode: Mode, words: &Words) -> Node {
    let (mut first, mut end) = (first, first + leaves.len());
    // One node is left: the levels above it pass it on.
    while end > first + 1 {
        let (from, to) = (first / 2, (end - 1) / 2 + 1);
        for node in from..to {
            // A level is made in the place of the one before, which it never overtakes.
            let child =
                |place: usize| if (first..end).contains(&place) { leaves[place - first] } else { Node::default() };
            let combined = combine(mode, child(2 * node), child(2 * node + 1), words);
            leaves[node - from] = combined;
        }
        (first, end) = (from, to);
    }
    leaves.first().copied().unwrap_or_default()
}

/// The same front to back, for a chain or an accumulator: `of(depth)` is the sample at a depth.
pub fn in_order(depths: usize, of: impl Fn(usize) -> Segment, mode: Mode, words: &Words) -> Vec<Segment> {
    in_order_by(depths, of, &mut |left, right| combine(mode, left, right, words))
}

/// [`in_order`] with `node(left, right)` for each node.
#[inline]
pub fn in_order_by(
    depths: usize,
    of: impl Fn(usize) -> Segment,
    node: &mut impl FnMut(Node, Node) -> Node,
) -> Vec<Segment> {
    let mut segments: Vec<Segment> = Vec::new();
    for next in (0..depths).map(of) {
        match segments.last_mut().filter(|last| last.ray == next.ray) {
            Some(last) => last.node = node(last.node, next.node),
            None => segments.push(next),
        }
    }
    segments
}

/// Appends the segments of what lies behind.
pub fn join(left: &mut Vec<Segment>, right: Vec<Segment>, mode: Mode, words: &Words) {
    join_by(left, right, &mut |left, right| combine(mode, left, right, words));
}

/// [`join`] with `node(left, right)` for the node that joins two stretches of a ray.
#[inline]
pub fn join_by(left: &mut Vec<Segment>, right: Vec<Segment>, node: &mut impl FnMut(Node, Node) -> Node) {
    let mut right = right.into_iter();
    if let Some(last) = left.last_mut()
        && let Some(first) = right.next()
    {
        if last.ray == first.ray {
            last.node = node(last.node, first.node);
        } else {
            left.push(first);
        }
    }
    left.extend(right);
}
