//! A run saved at a cycle, and resumed.
//!
//! ```text
//!   magic, schema │ header: program, fidelity, digests of machine, frames and voxels, cycle │ state │ SHA-256 of all before
//! ```
//! The state is what changes in a run ([`Archived`]). What does not is built again from machine file, scene and volume, and the
//! digests tell whether they are the same.

use crate::fidelity::Fidelity;
use crate::machine::Machine;
use cube3_channel::{Archive, ArchiveError, Archived};
use cube3_frame::FrameSetup;
use cube3_machine::MachineSpec;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::borrow::Borrow;
use std::io::Read;
use std::path::Path;

const MAGIC: &[u8] = b"cube3 checkpoint\n";
const SCHEMA: u32 = 2;
const DIGEST_BYTES: usize = 32;
/// Most bytes that are read.
const LIMIT_BYTES: u64 = 8 << 30;

/// Why a run cannot be saved or resumed.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The file.
    #[error("{path}: {error}; give a file that --checkpoint-at has written")]
    File {
        /// The file.
        path: String,
        /// What is wrong with it.
        error: std::io::Error,
    },
    /// Bytes of something else.
    #[error("this is no checkpoint; give a file that --checkpoint-at has written")]
    Magic,
    /// A file of another version.
    #[error(
        "the checkpoint was written by {found}, and this is {expected}: resume it with the program that wrote it, or run again"
    )]
    Version {
        /// Who wrote it.
        found: String,
        /// Who reads it.
        expected: String,
    },
    /// A file that was cut off or changed.
    #[error("the checkpoint is damaged: its bytes are not those that were written; run again without --resume")]
    Damaged,
    /// Another run.
    #[error("the checkpoint is of another run: its {what} differs; give what it was saved with")]
    Other {
        /// What differs.
        what: &'static str,
    },
    /// A state that does not fit.
    #[error("{0}; run again without --resume")]
    State(#[from] ArchiveError),
    /// A cycle behind the end of the run.
    #[error("the run took {cycles} cycles, and was to be saved at cycle {at}: give --checkpoint-at below {cycles}")]
    Beyond {
        /// Cycles of the run.
        cycles: u64,
        /// The cycle asked for.
        at: u64,
    },
    /// A cycle before the state that a run was resumed from.
    #[error(
        "the run goes on from cycle {cycle}, and was to be saved at cycle {at}: give --checkpoint-at {cycle} or above"
    )]
    Before {
        /// First cycle of the run.
        cycle: u64,
        /// The cycle asked for.
        at: u64,
    },
}

/// What a run is of: a state fits to no other.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RunIdentity {
    fidelity: String,
    machine: [u8; DIGEST_BYTES],
    frames: [u8; DIGEST_BYTES],
    volume: [u8; DIGEST_BYTES],
}

impl RunIdentity {
    /// The identity of a run of some frames on a machine, with a volume of voxel words (x fastest).
    pub fn new(
        fidelity: &str,
        machine: &MachineSpec,
        frames: &[impl Borrow<FrameSetup>],
        dims: [usize; 3],
        words: &[u16],
    ) -> RunIdentity {
        let text = |value: Result<String, serde_json::Error>| {
            Sha256::digest(value.unwrap_or_else(|error| error.to_string())).into()
        };
        let mut volume = Sha256::new();
        dims.iter().for_each(|&side| volume.update((side as u64).to_le_bytes()));
        let mut bytes = Vec::new();
        for words in words.chunks(1 << 16) {
            bytes.clear();
            bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
            volume.update(&bytes);
        }
        RunIdentity {
            fidelity: fidelity.to_owned(),
            machine: text(serde_json::to_string(machine)),
            frames: text(serde_json::to_string(&frames.iter().map(Borrow::borrow).collect::<Vec<&FrameSetup>>())),
            volume: volume.finalize().into(),
        }
    }

    fn check(&self, saved: &RunIdentity) -> Result<(), CheckpointError> {
        let parts = [
            ("fidelity", self.fidelity == saved.fidelity),
            ("machine", self.machine == saved.machine),
            ("volume", self.volume == saved.volume),
            ("scene or plan", self.frames == saved.frames),
        ];
        match parts.into_iter().find(|(_, same)| !same) {
            Some((what, _)) => Err(CheckpointError::Other { what }),
            None => Ok(()),
        }
    }
}

/// What a checkpoint says of itself.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Header {
    version: String,
    identity: RunIdentity,
    cycle: u64,
}

fn program(schema: u32, version: &str) -> String {
    format!("cube3 {version} (checkpoint schema {schema})")
}

/// A run as it stands, as the bytes of a file.
///
/// # Errors
/// A state that cannot be written.
pub fn save<F: Fidelity>(machine: &mut Machine<F>, identity: &RunIdentity) -> Result<Vec<u8>, CheckpointError> {
    let version = env!("CARGO_PKG_VERSION").to_owned();
    let mut header = Part(Header { version, identity: identity.clone(), cycle: machine.now() });
    let mut bytes = [MAGIC, &SCHEMA.to_le_bytes()].concat();
    let head = Archive::save(&mut header)?;
    bytes.extend((head.len() as u32).to_le_bytes());
    bytes.extend(head);
    bytes.extend(Archive::save(machine)?);
    let digest = Sha256::digest(&bytes);
    bytes.extend_from_slice(&digest);
    Ok(bytes)
}

/// Brings a machine that has just been built to the state that was saved.
///
/// # Errors
/// Bytes that are no checkpoint, are damaged, or are of another program or run. The machine is then of no use.
pub fn restore<F: Fidelity>(
    bytes: &[u8],
    machine: &mut Machine<F>,
    identity: &RunIdentity,
) -> Result<(), CheckpointError> {
    let rest = bytes.strip_prefix(MAGIC).ok_or(CheckpointError::Magic)?;
    let (schema, rest) = rest.split_first_chunk::<4>().ok_or(CheckpointError::Damaged)?;
    let schema = u32::from_le_bytes(*schema);
    let expected = program(SCHEMA, env!("CARGO_PKG_VERSION"));
    if schema != SCHEMA {
        let found = format!("a program with checkpoint schema {schema}");
        return Err(CheckpointError::Version { found, expected });
    }
    let (body, digest) = rest.split_last_chunk::<DIGEST_BYTES>().ok_or(CheckpointError::Damaged)?;
    if Sha256::digest(&bytes[..bytes.len() - DIGEST_BYTES]).as_slice() != digest {
        return Err(CheckpointError::Damaged);
    }
    let (length, body) = body.split_first_chunk::<4>().ok_or(CheckpointError::Damaged)?;
    let head = u32::from_le_bytes(*length) as usize;
    let (head, state) = body.split_at_checked(head).ok_or(CheckpointError::Damaged)?;
    let mut header = Part(Header { version: String::new(), identity: identity.clone(), cycle: 0 });
    Archive::restore(head, &mut header)?;
    let Header { version, identity: saved, cycle: _ } = header.0;
    if version != env!("CARGO_PKG_VERSION") {
        return Err(CheckpointError::Version { found: program(schema, &version), expected });
    }
    identity.check(&saved)?;
    Ok(Archive::restore(state, machine)?)
}

/// A header in an archive of its own.
struct Part(Header);

impl Archived for Part {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        archive.item(&mut self.0)
    }
}

/// The bytes of a checkpoint file. A file of something else is not read beyond its first bytes.
///
/// # Errors
/// A file that cannot be read, is too large, or is no checkpoint.
pub fn read(path: &Path) -> Result<Vec<u8>, CheckpointError> {
    let failed = |error| CheckpointError::File { path: path.display().to_string(), error };
    let mut file = std::fs::File::open(path).map_err(failed)?;
    let mut bytes = Vec::new();
    (&mut file).take(MAGIC.len() as u64).read_to_end(&mut bytes).map_err(failed)?;
    if bytes != MAGIC {
        return Err(failed(std::io::Error::other("this is no checkpoint")));
    }
    let rest = (&mut file).take(LIMIT_BYTES).read_to_end(&mut bytes).map_err(failed)?;
    if rest as u64 == LIMIT_BYTES {
        return Err(failed(std::io::Error::other(format!("this is larger than {LIMIT_BYTES} bytes"))));
    }
    Ok(bytes)
}
