//! Saving and restoring what changes in a run.
//!
//! A thing lists its changing parts once, in [`Archived::archive`], and that list serves both ways:
//!
//! ```text
//!   machine ──archive──► bytes ──archive──► machine of the same machine file and frames, at the same cycle
//! ```
//! What a machine is built from (data sheets, registers, memories that are only read) is not in the bytes: a machine is first
//! built again, and then restored.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// What a token carries: a value to begin with, and a way into an archive and back.
pub trait Payload: Default + Serialize + DeserializeOwned {}

impl<T: Default + Serialize + DeserializeOwned> Payload for T {}

/// A thing with parts that change in a run.
pub trait Archived {
    /// Hands each changing part to the archive, always in the same order.
    ///
    /// # Errors
    /// Bytes that do not fit.
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError>;
}

/// Bytes that are not those of the machine which reads them.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArchiveError {
    /// They end too early, or hold something else.
    #[error("the saved state does not fit: {0}")]
    Bytes(#[from] postcard::Error),
    /// A list that has another length in this machine.
    #[error("the saved state does not fit: {found} entries where this machine has {expected}")]
    Length {
        /// Entries in the bytes.
        found: usize,
        /// Entries in the machine.
        expected: usize,
    },
    /// More tokens than a channel holds.
    #[error("the saved state does not fit: {found} tokens in channel {name}, which holds {capacity}")]
    Tokens {
        /// The channel.
        name: &'static str,
        /// Tokens in the bytes.
        found: usize,
        /// Tokens that fit.
        capacity: usize,
    },
    /// Bytes behind the last part.
    #[error("the saved state does not fit: {0} bytes are left over")]
    LeftOver(usize),
}

/// Parts on their way into bytes, or out of them.
#[derive(Debug)]
pub struct Archive<'a>(Way<'a>);

#[derive(Debug)]
enum Way<'a> {
    Save(Vec<u8>),
    Restore(&'a [u8]),
}

impl<'a> Archive<'a> {
    /// The bytes of a thing's parts.
    ///
    /// # Errors
    /// A part that cannot be written.
    pub fn save(thing: &mut impl Archived) -> Result<Vec<u8>, ArchiveError> {
        let mut archive = Archive(Way::Save(Vec::new()));
        thing.archive(&mut archive)?;
        match archive.0 {
            Way::Save(bytes) => Ok(bytes),
            Way::Restore(_) => Ok(Vec::new()),
        }
    }

    /// Gives a thing the parts that bytes hold. After an error it is of no use.
    ///
    /// # Errors
    /// Bytes that do not fit.
    pub fn restore(bytes: &'a [u8], thing: &mut impl Archived) -> Result<(), ArchiveError> {
        let mut archive = Archive(Way::Restore(bytes));
        thing.archive(&mut archive)?;
        match archive.0 {
            Way::Restore(rest) if !rest.is_empty() => Err(ArchiveError::LeftOver(rest.len())),
            _ => Ok(()),
        }
    }

    /// A part.
    ///
    /// # Errors
    /// Bytes that do not fit.
    pub fn item<T: Serialize + DeserializeOwned>(&mut self, item: &mut T) -> Result<(), ArchiveError> {
        match &mut self.0 {
            Way::Save(bytes) => *bytes = postcard::to_extend(&*item, std::mem::take(bytes))?,
            Way::Restore(bytes) => (*item, *bytes) = postcard::take_from_bytes(bytes)?,
        }
        Ok(())
    }

    /// A list whose length the machine fixes.
    ///
    /// # Errors
    /// Bytes that do not fit, and a list of another length.
    pub fn list<T: Serialize + DeserializeOwned>(&mut self, list: &mut Vec<T>) -> Result<(), ArchiveError> {
        let expected = list.len();
        self.item(list)?;
        if list.len() == expected { Ok(()) } else { Err(ArchiveError::Length { found: list.len(), expected }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    #[derive(Debug, PartialEq)]
    struct Thing {
        number: u64,
        list: Vec<u16>,
    }

    impl Archived for Thing {
        fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
            let Thing { number, list } = self;
            archive.item(number)?;
            archive.list(list)
        }
    }

    #[test]
    fn parts_come_back_and_bytes_of_another_thing_do_not() {
        let mut thing = Thing { number: 300, list: vec![1, 2, 70] };
        let bytes = Archive::save(&mut thing).unwrap();
        let mut other = Thing { number: 0, list: vec![0; 3] };
        Archive::restore(&bytes, &mut other).unwrap();
        assert_eq!(thing, other);
        let mut shorter = Thing { number: 0, list: vec![0; 2] };
        let error = Archive::restore(&bytes, &mut shorter).unwrap_err();
        assert_eq!(error, ArchiveError::Length { found: 3, expected: 2 });
        assert!(matches!(Archive::restore(&bytes[..3], &mut other), Err(ArchiveError::Bytes(_))));
        let longer = [bytes.as_slice(), &[0]].concat();
        assert_eq!(Archive::restore(&longer, &mut other), Err(ArchiveError::LeftOver(1)));
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn any_bytes_are_taken_or_refused(bytes: Vec<u8>) {
            let mut thing = Thing { number: 0, list: vec![0; 3] };
            let _ = Archive::restore(&bytes, &mut thing);
            prop_assert!(thing.list.len() <= bytes.len().max(3));
        }
    }
}
