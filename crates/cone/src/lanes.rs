//! The same reduction for one ray from any leaf of the circle, and for whole rows of rays at once.

mod accumulator;
mod ray;
mod rows;
mod slot;

pub use accumulator::Accumulator;
pub use ray::{in_order, in_order_by, join, join_by, tree_of_ray};
pub use rows::{ConeLanes, RowNode};
pub(crate) use slot::SlotLanes;

#[cfg(test)]
mod tests;
