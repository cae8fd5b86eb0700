//! The names of choices in machine files.

use crate::{
    AcquisitionMode, BankHash, BurstOrder, BusKind, ConeKind, ControllerKind, GradientMethod, Layout, LookAheadFreed,
    LookAheadUnit, MemoryType, RayEnds, RaySlots, Reuse, ShadingUnit, TemplateRule,
};
use cube3_parameter::Choice;

impl Choice for AcquisitionMode {}
impl Choice for BankHash {}
impl Choice for BurstOrder {}
impl Choice for BusKind {}
impl Choice for ConeKind {}
impl Choice for ControllerKind {}
impl Choice for GradientMethod {}
impl Choice for Layout {}
impl Choice for LookAheadFreed {}
impl Choice for LookAheadUnit {}
impl Choice for MemoryType {}
impl Choice for RayEnds {}
impl Choice for RaySlots {}
impl Choice for Reuse {}
impl Choice for ShadingUnit {}
impl Choice for TemplateRule {}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::de::value::{Error, StrDeserializer};
    use serde::de::{DeserializeOwned, IntoDeserializer};
    use std::fmt::Debug;

    fn read<C: DeserializeOwned>(name: &str) -> Result<C, Error> {
        let name: StrDeserializer<'_, Error> = name.into_deserializer();
        C::deserialize(name)
    }

    /// Files know each choice by its name, and no choice beside them.
    fn same_as_in_files<C: Choice + DeserializeOwned + Debug + PartialEq>() {
        for &choice in C::VARIANTS {
            assert_eq!(read::<C>(choice.name()).unwrap(), choice);
        }
        let known = read::<C>("?").unwrap_err().to_string();
        assert_eq!(known.matches('`').count(), 2 + 2 * C::VARIANTS.len(), "{known}");
    }

    #[test]
    fn names_are_those_of_files() {
        same_as_in_files::<AcquisitionMode>();
        same_as_in_files::<BankHash>();
        same_as_in_files::<BurstOrder>();
        same_as_in_files::<BusKind>();
        same_as_in_files::<ConeKind>();
        same_as_in_files::<ControllerKind>();
        same_as_in_files::<GradientMethod>();
        same_as_in_files::<Layout>();
        same_as_in_files::<LookAheadFreed>();
        same_as_in_files::<LookAheadUnit>();
        same_as_in_files::<MemoryType>();
        same_as_in_files::<RayEnds>();
        same_as_in_files::<RaySlots>();
        same_as_in_files::<Reuse>();
        same_as_in_files::<ShadingUnit>();
        same_as_in_files::<TemplateRule>();
    }
}
