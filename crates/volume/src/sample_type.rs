//! The names of the eight numeric types.

use strum::{Display, IntoStaticStr, VariantArray};

/// The type of a volume's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Display, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "lowercase")]
pub enum SampleType {
    /// Unsigned, 8 bits.
    U8,
    /// Signed, 8 bits.
    I8,
    /// Unsigned, 16 bits.
    U16,
    /// Signed, 16 bits.
    I16,
    /// Unsigned, 32 bits.
    U32,
    /// Signed, 32 bits.
    I32,
    /// IEEE 754 single precision.
    F32,
    /// IEEE 754 double precision.
    F64,
}

impl SampleType {
    /// All eight, in the order of [`Samples`](crate::Samples).
    pub const ALL: [SampleType; SampleType::VARIANTS.len()] = *SampleType::VARIANTS.first_chunk().unwrap();

    /// Size of one sample in bytes.
    pub fn bytes(self) -> usize {
        match self {
            SampleType::U8 | SampleType::I8 => 1,
            SampleType::U16 | SampleType::I16 => 2,
            SampleType::U32 | SampleType::I32 | SampleType::F32 => 4,
            SampleType::F64 => 8,
        }
    }

    /// Whether the type can hold NaN and infinities.
    pub fn is_float(self) -> bool {
        matches!(self, SampleType::F32 | SampleType::F64)
    }

    /// The name, as it is read: `u8`, `i8`, … `f64`.
    pub fn name(self) -> &'static str {
        self.into()
    }
}
