//! The names of choices in machine files.

use crate::{
    AcquisitionMode, BankHash, BurstOrder, BusKind, ConeKind, ControllerKind, GradientMethod, Layout, LookAheadFreed,
    LookAheadUnit, MemoryType, RayEnds, RaySlots, Reuse, ShadingUnit, TemplateRule,
};
use cube3_parameter::Choice;

macro_rules! names {
    ($($type:ident: $($choice:ident $name:literal),+;)+) => {$(
        impl Choice for $type {
            const NAMES: &'static [(Self, &'static str)] = &[$(($type::$choice, $name)),+];
        }
    )+};
}

names! {
    AcquisitionMode: DualPort "dual-port", CycleStealing "cycle-stealing", DoubleBuffer "double-buffer";
    BankHash: Plain "plain", Xor "xor", DigitSum "digit-sum";
    BurstOrder: Interleaved "interleaved", Sequential "sequential";
    BusKind: Gather "gather", Rotate "rotate";
    ConeKind: FoldedTree "folded-tree", ShiftedTree "shifted-tree", Chain "chain", Accumulator "accumulator";
    ControllerKind: InOrder "in-order", FrFcfs "fr-fcfs";
    Layout: Rows "rows", Blocks "blocks", MiniBlocks "mini-blocks";
    LookAheadFreed: Word "word", Column "column";
    LookAheadUnit: Words "words", Bursts "bursts";
    MemoryType: Ideal "ideal", Vram "vram", FastPage "fast-page", Sdram "sdram", Hbm "hbm";
    RayEnds: Published "published", Exact "exact";
    RaySlots: Wrapped "wrapped", Padded "padded";
    Reuse: None "none", Ray "ray", Plane "plane", Both "both";
    ShadingUnit: Phong "phong", ReflectanceTable "reflectance-table";
    TemplateRule: SampleFloor "sample-floor", PlaneFloor "plane-floor", Nearest "nearest";
}

impl Choice for GradientMethod {
    const NAMES: &'static [(Self, &'static str)] = &GradientMethod::ALL;
}

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
    fn same_as_in_files<C: Choice + DeserializeOwned + Debug>() {
        for (choice, name) in C::NAMES {
            assert_eq!(read::<C>(name).unwrap(), *choice);
            assert_eq!(choice.name(), *name);
        }
        let known = read::<C>("?").unwrap_err().to_string();
        assert_eq!(known.matches('`').count(), 2 + 2 * C::NAMES.len(), "{known}");
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
