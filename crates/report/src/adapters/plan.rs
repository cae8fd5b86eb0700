//! What the plan left out.

use crate::{LeftOut, SavingsReport};
use cube3_plan::{Item, Savings};

/// The plan's items as rows of the report.
pub fn left_out(items: &[Item]) -> Vec<LeftOut> {
    let entry = |item: &Item| {
        let (row, savings) = (item.row(), savings(&item.savings));
        LeftOut {
            rule: row.name.into(),
            what: row.what.into(),
            why: item.why.into(),
            saves: savings.in_words(),
            savings,
        }
    };
    items.iter().map(entry).collect()
}

fn savings(saved: &Savings) -> SavingsReport {
    let Savings { operators, cycles, bytes, operations, passes } = *saved;
    SavingsReport { operators_per_lane: operators, cycles, bytes, operations, passes }
}
