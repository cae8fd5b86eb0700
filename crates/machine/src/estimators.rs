//! The table of gradient estimators: what tells them apart, as numbers. Sections 4 of the paper and 3 of the design.

use crate::GradientMethod;

/// From which samples an estimator takes its differences.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Differences {
    /// The next sample along u, v and the ray, less the one before.
    Central,
    /// Nine such pairs for each component, with weights 4, 2, 1 by their distance: ¼ stands for ⅓.
    Weighted,
    /// Along the ray, and between the feet of the perpendiculars on the rays beside: two lerps for u and two for v.
    Feet,
    /// Along u and v, and straight behind and before the sample, each bilinear between four rays: three lerps each.
    Bilinear,
}

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Estimator {
    /// The method.
    pub method: GradientMethod,
    /// Its name in machine files.
    pub name: &'static str,
    /// What it is called.
    pub title: &'static str,
    /// Its samples.
    pub differences: Differences,
    /// Whether what the ray's difference has of u and v is taken away: Gw = Gr − du·Gu − dv·Gv.
    pub sheared: bool,
    /// Whether each difference is divided by the length that it was taken over.
    pub normalised: bool,
    /// The unit that computes it, in vectors: rows that differ in their factors alone share one.
    pub unit: &'static str,
    /// The parameter METHOD of the unit in RTL.
    pub rtl: u32,
    /// The parameters of the unit's module in RTL.
    pub rtl_parameters: &'static str,
    /// Where it is from.
    pub source: &'static str,
}

/// A row whose differences are normalised and not sheared.
macro_rules! row {
    ($method:ident, $name:literal, $differences:ident, $title:literal, $unit:literal, $rtl:literal) => {
        Estimator {
            method: GradientMethod::$method,
            name: $name,
            title: $title,
            differences: Differences::$differences,
            sheared: false,
            normalised: true,
            unit: concat!("gradient-", $unit),
            rtl: $rtl,
            rtl_parameters: concat!(".METHOD(", $rtl, "), .PERSPECTIVE(1)"),
            source: "Pfister et al. 1995, section 4",
        }
    };
}

/// Every estimator, in the order in which they are listed.
pub const ESTIMATORS: [Estimator; 7] = [
    row!(Six, "6", Central, "Gradient, 6 neighbours", "6", 6),
    row!(TwentySix, "26", Weighted, "Gradient, 26 neighbours", "26", 26),
    Estimator { normalised: false, ..row!(Ten, "10", Feet, "Gradient, 10 neighbours", "10", 10) },
    row!(TenNormalised, "10n", Feet, "Gradient, 10 neighbours", "10", 10),
    row!(Twelve, "12", Bilinear, "Gradient, 12 neighbours", "12", 12),
    Estimator {
        sheared: true,
        source: "ours",
        ..row!(SixSheared, "6d", Central, "Gradient, 6 neighbours and the ray's shear", "6d", 61)
    },
    Estimator {
        sheared: true,
        source: "ours",
        ..row!(TwentySixSheared, "26d", Weighted, "Gradient, 26 neighbours and the ray's shear", "26d", 261)
    },
];

impl Estimator {
    /// Bits by which the weights of a component exceed 1; they are dropped with the low bits of the sum.
    pub const fn extra_bits(&self) -> u32 {
        match self.differences {
            Differences::Weighted => 4,
            Differences::Central | Differences::Feet | Differences::Bilinear => 0,
        }
    }

    /// Bits of a difference beyond those of a sample and its sign: the weights', and two for the sum with products of two others.
    pub const fn difference_bits(&self) -> u32 {
        self.extra_bits() + if self.sheared { 2 } else { 0 }
    }

    /// Lerps for each gradient.
    pub const fn lerps(&self) -> u32 {
        match self.differences {
            Differences::Central | Differences::Weighted => 0,
            Differences::Feet => 4,
            Differences::Bilinear => 6,
        }
    }

    /// Pairs of samples whose differences a component adds up.
    pub const fn pairs(&self) -> u32 {
        match self.differences {
            Differences::Weighted => 9,
            Differences::Central | Differences::Feet | Differences::Bilinear => 1,
        }
    }

    /// Whether one pair of rays' directions decides its weights, so that all rays must have it: it is for parallel frames alone.
    pub const fn needs_parallel_rays(&self) -> bool {
        matches!(self.differences, Differences::Feet)
    }
}

impl GradientMethod {
    /// Its row.
    pub const fn row(self) -> &'static Estimator {
        &ESTIMATORS[self as usize]
    }

    /// The name in machine files.
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// Every estimator with its name.
    pub const ALL: [(GradientMethod, &'static str); ESTIMATORS.len()] = {
        let mut all = [(GradientMethod::Six, ""); ESTIMATORS.len()];
        let mut i = 0;
        while i < all.len() {
            all[i] = (ESTIMATORS[i].method, ESTIMATORS[i].name);
            i += 1;
        }
        all
    };
}

impl From<GradientMethod> for &'static str {
    fn from(method: GradientMethod) -> &'static str {
        method.name()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;
    use serde::de::IntoDeserializer;
    use serde::de::value::{Error, StrDeserializer};

    #[test]
    fn each_method_has_its_row_and_its_name() {
        for row in &ESTIMATORS {
            assert_eq!(row.method.row(), row);
            let name: StrDeserializer<'_, Error> = row.name.into_deserializer();
            assert_eq!(GradientMethod::deserialize(name).unwrap(), row.method);
        }
        let names: Vec<&str> = ESTIMATORS.iter().map(|row| row.name).collect();
        assert_eq!(names, ["6", "26", "10", "10n", "12", "6d", "26d"]);
    }
}
