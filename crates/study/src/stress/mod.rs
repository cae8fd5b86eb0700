//! The stiff and the extreme: every method on every case, against the integral with a bound for each pixel.
//!
//! ```text
//!   CASES ─► Subject ─► truth (converged) ─► each method's picture ─► error, bound, finite, in range
//!   FORMULAS ─► each formula of a unit, and the classic one beside it, against closed forms
//! ```
//! A method that joins the table is stressed with the others: what its bound goes by is in its row.

mod cases;
mod formulas;
mod measure;
mod subject;

pub use cases::{CASES, Case};
pub use formulas::{FORMULAS, Formula, Tried};
pub use measure::{Measure, StressError, Truth};
pub use subject::Subject;

use cube3_method::{Method, RenderError};
use cube3_rendering::MethodError;
use serde::Serialize;

/// A method, or a formula, on a case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What the case is about.
    pub group: String,
    /// The case.
    pub case: String,
    /// The method.
    pub method: String,
    /// What error and bound are counted in: levels of 255 for pictures.
    pub unit: &'static str,
    /// The worst error against the truth; none where the truth is not known, or the case is to be refused.
    pub error: Option<f64>,
    /// Its bound.
    pub bound: f64,
    /// A classic formula that fails here, and is shown beside the one that is used.
    pub classic: bool,
    /// Whether every value is within its bound.
    pub kept: bool,
    /// Whether every value is finite.
    pub finite: bool,
    /// Whether every value is within its range.
    pub in_range: bool,
    /// Why nothing was made, where that was not to be.
    pub refused: Option<String>,
    /// Seconds that it took.
    pub time_s: f64,
}

/// Levels of full scale.
pub const LEVELS: f64 = 255.0;

impl Row {
    /// Whether nothing is wrong.
    pub fn holds(&self) -> bool {
        self.classic || self.kept && self.finite && self.in_range && self.refused.is_none()
    }

    fn new(case: &Case, method: &Method) -> Row {
        Row {
            group: case.group.into(),
            case: case.name.into(),
            method: method.about.name.into(),
            unit: "levels",
            error: None,
            bound: 0.0,
            classic: false,
            kept: true,
            finite: true,
            in_range: true,
            refused: None,
            time_s: 0.0,
        }
    }

    /// Takes the measure of another subject in: the one nearest to its bound is shown.
    fn add(&mut self, measure: &Measure) {
        self.kept &= measure.kept;
        self.finite &= measure.finite;
        self.in_range &= measure.in_range;
        self.time_s += measure.seconds;
        let Some(error) = measure.error.map(|error| LEVELS * error) else { return };
        if self.error.is_none_or(|worst| error >= worst) {
            (self.error, self.bound) = (Some(error), LEVELS * measure.bound);
        }
    }
}

/// A case by every method of a table that can show it.
pub fn stress(case: &Case, methods: &[&'static Method]) -> Vec<Row> {
    let mut rows: Vec<Row> = methods.iter().map(|method| Row::new(case, method)).collect();
    let mut shown = vec![false; methods.len()];
    for subject in (case.subjects)() {
        let truth = Truth::new(&subject);
        for ((row, method), shown) in rows.iter_mut().zip(methods).zip(&mut shown) {
            let measured = match &truth {
                Ok(truth) => truth.measure(method, &subject).map_err(Refused::of),
                Err(error) => Err(Refused::Told(error.to_string())),
            };
            match (measured, case.refused) {
                // What a method cannot show is not asked of it.
                (Err(Refused::NotAsked), _) => continue,
                (Ok(measure), None) => row.add(&measure),
                (Ok(_), Some(_)) => row.refused = Some("it was shown, and is to be refused".into()),
                (Err(Refused::Told(told)), Some(part)) if told.contains(part) => {}
                (Err(Refused::Told(told)), _) => row.refused = Some(told),
            }
            *shown = true;
        }
    }
    rows.into_iter().zip(shown).filter_map(|(row, shown)| shown.then_some(row)).collect()
}

/// Why there is no measure.
enum Refused {
    /// The method cannot show it.
    NotAsked,
    /// What was told.
    Told(String),
}

impl Refused {
    fn of(error: StressError) -> Refused {
        match error {
            StressError::Render(RenderError::Method(MethodError::Lacks { .. }) | RenderError::NoFrame) => {
                Refused::NotAsked
            }
            error => Refused::Told(error.to_string()),
        }
    }
}

/// A formula, and the classic way beside it.
pub fn try_formula(formula: &Formula) -> Vec<Row> {
    let row = |tried: Tried, classic: bool, time_s: f64| Row {
        group: "formulas".into(),
        case: formula.name.into(),
        method: tried.name.into(),
        unit: formula.unit,
        error: Some(tried.error),
        bound: formula.bound,
        classic,
        kept: tried.error <= formula.bound,
        finite: tried.error.is_finite(),
        in_range: true,
        refused: None,
        time_s,
    };
    let timed = |way: fn() -> Tried| {
        let start = std::time::Instant::now();
        let tried = way();
        (tried, start.elapsed().as_secs_f64())
    };
    let (ours, time_s) = timed(formula.ours);
    let classic = formula.classic.map(|way| {
        let (tried, time_s) = timed(way);
        row(tried, true, time_s)
    });
    std::iter::once(row(ours, false, time_s)).chain(classic).collect()
}
