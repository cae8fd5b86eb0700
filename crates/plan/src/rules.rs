//! The rules: what may be left out, each by itself.

/// Something that may be left out of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Rule {
    /// The gradient unit and its planes of samples.
    GradientUnit,
    /// The factors of the gradient's components.
    GradientScale,
    /// The normaliser.
    Normaliser,
    /// The shading unit.
    ShadingUnit,
    /// Depth cueing.
    DepthCue,
    /// The gradient's rows of the opacity table.
    GradientRows,
    /// Cut planes and crop box.
    HalfSpaces,
    /// The buffers of first planes.
    ClosingPlanes,
    /// The base planes of faces that no ray needs.
    OtherFaces,
}

/// A rule's row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RuleRow {
    /// The rule.
    pub rule: Rule,
    /// Its name in reports.
    pub name: &'static str,
    /// What it leaves out.
    pub what: &'static str,
    /// Whether a frame can have the part although the scene does not need it. The others say what the scene has not.
    pub can_idle: bool,
}

const fn row(rule: Rule, name: &'static str, what: &'static str, can_idle: bool) -> RuleRow {
    RuleRow { rule, name, what, can_idle }
}

/// Every rule.
pub const RULES: &[RuleRow] = &[
    row(Rule::GradientUnit, "gradient-unit", "gradient unit", true),
    row(Rule::GradientScale, "gradient-scale", "gradient scale", true),
    row(Rule::Normaliser, "normaliser", "normaliser", true),
    row(Rule::ShadingUnit, "shading-unit", "shading unit", true),
    row(Rule::DepthCue, "depth-cue", "depth cueing", true),
    row(Rule::GradientRows, "gradient-rows", "gradient rows of the opacity table", false),
    row(Rule::HalfSpaces, "half-spaces", "cut planes and crop box", false),
    row(Rule::ClosingPlanes, "closing-planes", "closing planes", false),
    row(Rule::OtherFaces, "other-faces", "base planes of the other faces", false),
];

impl Rule {
    /// Its row of the table.
    pub fn row(self) -> &'static RuleRow {
        &RULES[self as usize]
    }
}

/// Which rules are followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rules(u32);

impl Rules {
    /// Every rule.
    pub const ALL: Rules = Rules((1 << RULES.len()) - 1);
    /// No rule: everything is built.
    pub const NONE: Rules = Rules(0);

    /// These, but for one.
    #[must_use]
    pub const fn without(self, rule: Rule) -> Rules {
        Rules(self.0 & !(1 << rule as u32))
    }

    /// Whether a rule is followed.
    pub const fn follow(self, rule: Rule) -> bool {
        self.0 & (1 << rule as u32) != 0
    }
}

/// Every rule, or none.
impl From<bool> for Rules {
    fn from(plan: bool) -> Rules {
        if plan { Rules::ALL } else { Rules::NONE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_is_its_row() {
        for (i, row) in RULES.iter().enumerate() {
            assert_eq!((row.rule as usize, row.rule.row()), (i, row));
            assert!(Rules::ALL.follow(row.rule) && !Rules::NONE.follow(row.rule));
            let others = Rules::ALL.without(row.rule);
            assert!(RULES.iter().all(|other| others.follow(other.rule) == (other.rule != row.rule)), "{}", row.name);
        }
    }
}
